"""What the tracker finds out about a lens: `python -m tests.bench.lens [--only k1|focal|maker]`.

`k1`: the pictures are those of `webcam-nominal`, whose lens has k1 = 0.13 and claims 0. Every pose
has paper of its own, folded askew and bent. Each picture is shown twice, as the second is followed.

`focal`: a cube of bent paper is played with for seconds before cameras that nobody calibrated. The
guess is too long or too short by a factor, or that of 60° along the longer side.

`maker`: photographs of a dodecahedron with a lens that is said to be longer than it is.
"""

import argparse
from collections.abc import Iterator, Sequence as Items
from dataclasses import dataclass, replace

import numpy as np
from rich.console import Console

from cubeling.tracking import (
    CubeModel,
    CubeState,
    CubeTracker,
    Frame,
    Intrinsics,
    LensEstimate,
    se3,
)
from tests.bench.photographs.dodecahedron import body_model, camera, paths, photograph, reference
from tests.bench.photographs.marker_corners import Array
from tests.bench.tracking.cameras import PHONE, WEBCAM, WIDE_ANGLE, Camera
from tests.bench.tracking.ours import MEASURED_FOCAL
from tests.bench.tracking.plans import SequencePlan
from tests.bench.tracking.sequences import Sequence, draw, sequence

SEEDS, POSES = range(1, 6), 40

CAMERAS = {"phone, upright": PHONE, "wide angle, 100°": WIDE_ANGLE, "webcam, k1 = 0.13": WEBCAM}
"""Lenses that are guessed."""

FACTORS = (1.7, 1 / 1.7)
"""By how much a guess is too long."""

PLAY_SECONDS, PLAY_SEEDS = 6.0, (1, 2)
"""How long the cube is played with, and of how many motions."""

MAX_DEPTH_ERROR, MAX_ANGLE = 0.03, np.deg2rad(1.0)
"""Errors that a measured lens may leave: of the depth, as a share of it, and of the rotation."""

SETTLED_SHARE = 0.95
"""Share of the frames from a time on that must be so good."""

MAKER_ERRORS = (-0.03, -0.02, 0.02, 0.03)
"""By how much lenses of makers are longer than they say, as a share."""


def play(seen_by: Camera) -> SequencePlan:
    """Return how a person who holds the cube in view plays with it."""
    return SequencePlan(
        speed=0.25,
        turning=2.0,
        pace=(0.6, 1.2),
        depth=(0.25, 0.45),
        facing="corner",
        worn=True,
        shadows=True,
        camera=seen_by,
    )


@dataclass(frozen=True)
class Played:
    """What a tracker made of a guessed lens."""

    times: Array
    """Times of the frames with a trusted pose, (N,) [s]."""

    depth_errors: Array
    """Errors of their depth, as shares of it, (N,)."""

    angles: Array
    """Errors of their rotation, (N,) [rad]."""

    ratios: Array
    """Largest error of each along and about an axis, in stated standard deviations, (N,)."""

    focal_error: float
    """Error of the focal length at the end, as a share of it."""

    deviation: float
    """Its stated standard deviation."""

    lens: LensEstimate
    """What was learned of the distortion."""

    @property
    def settled(self) -> float:
        """Time from which on nearly all poses are good, of those of a second at least [s]."""
        good = (np.abs(self.depth_errors) < MAX_DEPTH_ERROR) & (self.angles < MAX_ANGLE)
        shares = np.cumsum(good[::-1])[::-1] / np.arange(len(good), 0, -1)
        early = self.times < self.times[-1] - 1.0
        late = np.flatnonzero(early & (shares < SETTLED_SHARE))
        if not len(late):
            return float(self.times[0])
        after = int(late[-1]) + 1
        return float(self.times[after]) if early[after] else np.inf


def play_through(made: Sequence, guesses: Items[Intrinsics]) -> list[Played]:
    """Track a sequence through several guesses of its lens."""
    trackers = [CubeTracker(CubeModel.load(made.cube), guess) for guess in guesses]
    states: list[list[CubeState]] = [[] for _ in guesses]
    # A play that leaves the picture ends there for a while.
    shown = [index for index in range(made.count) if made.in_view(index)]
    for index in shown:
        frame = Frame(made.frame(index), made.timestamp(index), index)
        for tracker, seen in zip(trackers, states, strict=True):
            seen.append(tracker.update(frame))
    truths = [made.truth(index) for index in shown]
    return [
        _played(tracker, seen, truths, float(made.matrix[0, 0]))
        for tracker, seen in zip(trackers, states, strict=True)
    ]


def _played(
    tracker: CubeTracker, states: Items[CubeState], truths: Items[Array], focal: float
) -> Played:
    rows = []
    for state, truth in zip(states, truths, strict=True):
        if state.visible and state.camera_from_cube is not None:
            error = se3.delta(state.camera_from_cube, truth)
            ratio = float((np.abs(error) / np.sqrt(np.diag(state.covariance))).max())
            angle = float(np.linalg.norm(error[3:]))
            rows.append((state.timestamp, error[2] / truth[2, 3], angle, ratio))
    found = tracker.measured_intrinsics
    times, depth_errors, angles, ratios = np.array(rows).reshape(-1, 4).T
    return Played(
        times,
        depth_errors,
        angles,
        ratios,
        float(found.matrix[0, 0]) / focal - 1,
        float(found.focal_deviation or 0.0),
        tracker.lens,
    )


def played(
    seconds: float = PLAY_SECONDS, seeds: Items[int] = PLAY_SEEDS
) -> Iterator[tuple[str, int, str, Played]]:
    """Play before every camera: its name, the seed, the guess, and what came of it."""
    for name, seen_by in CAMERAS.items():
        for seed in seeds:
            made = draw(play(seen_by), name, seed, round(seconds * 30))
            guess = Intrinsics.guess(made.size)
            longer = made.matrix[0, 0] / guess.matrix[0, 0]
            guesses = {
                f"× {factor:.2f}": guess.lengthen(longer * factor, guess.focal_deviation)
                for factor in FACTORS
            }
            guesses[f"60°: × {1 / longer:.2f}"] = guess
            guesses["none: calibrated"] = Intrinsics(
                made.matrix, made.distortion, made.size, MEASURED_FOCAL
            )
            for words, each in zip(
                guesses, play_through(made, list(guesses.values())), strict=True
            ):
                yield name, seed, words, each


def print_played(console: Console) -> None:
    """Print how soon and how truly the focal length is measured, each as soon as it is known."""
    for name, seed, words, each in played():
        late = each.times >= 5
        console.print(
            f"{name} ({seed}), guess {words}: {len(each.times)} trusted frames, "
            f"good from {each.settled:.1f} s, worst error {each.ratios.max():.2f} σ; after 5 s, "
            f"95 %: depth {np.quantile(np.abs(each.depth_errors[late]), 0.95):.2%}, "
            f"{np.degrees(np.quantile(each.angles[late], 0.95)):.2f}°; "
            f"f off by {each.focal_error:+.2%} ± {each.deviation:.2%}, "
            f"k1 {each.lens.k1:+.3f} ± {each.lens.deviation:.3f}{' off' if each.lens.off else ''}"
        )


def estimates(made: Sequence, told: Intrinsics) -> list[LensEstimate]:
    """What is known of the lens after each pose of a sequence, for a tracker told of `told`."""
    tracker, found = CubeTracker(CubeModel.load(made.cube), told), []
    for index in range(made.count):
        picture = made.frame(index)
        for again in range(2):
            tracker.update(Frame(picture, 2.0 * index + again / 30, 2 * index + again))
        found.append(tracker.lens)
    return found


def print_k1(console: Console) -> None:
    """Print k1 beyond what is claimed, with its standard deviation."""
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


def depth_ratios(error: float, numbers: Items[int]) -> Array:
    """Errors of the depth of single photographs in its stated standard deviations, (N,).

    Their lens is said to be longer by a share `error` than it is.
    """
    cube, body = body_model()
    told, found = camera().lengthen(1 + error, None), []
    for number in numbers:
        state = CubeTracker(cube, told).update(Frame(photograph(number), 0.0, 0))
        if state.visible and state.camera_from_cube is not None:
            truth = reference().camera_from_body[number] @ body
            off = state.camera_from_cube[2, 3] - truth[2, 3]
            found.append(off / np.sqrt(state.covariance[2, 2]))
    return np.array(found)


def print_maker(console: Console) -> None:
    """Print by how many of its standard deviations depth is off through a maker's lens."""
    for error in MAKER_ERRORS:
        ratios = np.abs(depth_ratios(error, range(len(paths()))))
        console.print(
            f"a lens said to be {error:+.0%} longer: depth of {len(ratios)} photographs off by "
            f"{np.median(ratios):.2f} σ in the median, {np.quantile(ratios, 0.95):.2f} in 95 %"
        )


def main() -> None:
    """Print what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=("k1", "focal", "maker"))
    only = parser.parse_args().only
    console = Console(width=140, highlight=False)
    for name, show in (("k1", print_k1), ("focal", print_played), ("maker", print_maker)):
        if only in (None, name):
            show(console)


if __name__ == "__main__":
    main()
