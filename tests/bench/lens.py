"""What the tracker finds out about a webcam's lens: `python -m tests.bench.lens`.

The pictures are those of `webcam-nominal`, whose lens has k1 = 0.13 and claims 0. Every pose has
paper of its own, folded askew and bent. Each picture is shown twice, as the second one is followed.
"""

from dataclasses import replace

import numpy as np
from rich.console import Console

from cubeling.tracking import CubeModel, CubeTracker, Frame, Intrinsics, LensEstimate
from tests.bench.tracking.sequences import Sequence, sequence

SEEDS, POSES = range(1, 6), 40


def estimates(made: Sequence, told: Intrinsics) -> list[LensEstimate]:
    """What is known of the lens after each pose of a sequence, for a tracker told of `told`."""
    tracker, found = CubeTracker(CubeModel.load(made.cube), told), []
    for index in range(made.count):
        picture = made.frame(index)
        for again in range(2):
            tracker.update(Frame(picture, 2.0 * index + again / 30, 2 * index + again))
        found.append(tracker.lens)
    return found


def main() -> None:
    """Print k1 beyond what is claimed, with its standard deviation."""
    console = Console(width=120, highlight=False)
    for seed in SEEDS:
        made = sequence("webcam-nominal", seed, POSES)
        claimed = Intrinsics(made.matrix, np.zeros(5), made.size)
        true = replace(claimed, distortion=made.distortion)
        for name, told in (("claims 0", claimed), ("true", true)):
            found = estimates(made, told)
            shown = [
                f"{each.k1:+.3f} ± {each.deviation:.3f}{' off' if each.off else ''}"
                for each in found[9::10]
            ]
            console.print(f"seed {seed}, {name}, after 10, 20 … poses: {', '.join(shown)}")


if __name__ == "__main__":
    main()
