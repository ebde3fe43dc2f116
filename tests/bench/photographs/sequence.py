"""The photographs of the hand-held dodecahedron as one sequence: `python -m …sequence`.

One tracker sees all of them in their order. They were taken by hand, one now and then, and nothing
tells when: from one to the next the hand moves by up to 21 cm and half a turn. The body is that of
its file beside the tests.
"""

import argparse
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.photographs.dodecahedron import body_model, camera, paths, photograph, reference
from tests.bench.photographs.marker_corners import Array
from tests.bench.photographs.scoring import are_right, are_wrong

BODY_FILE = Path(__file__).parents[2] / "tracking" / "dodecahedron.toml"
"""The file of the body, written from `body_model`: `--write-body` does that again."""

INTERVAL_S = 1.5
"""Time between two photographs that the tracker is told [s]."""


@dataclass(frozen=True)
class SequenceScore:
    """How the sequence was tracked. Pairs are medians and 95th percentiles."""

    frames: int
    """Photographs."""

    found: int
    """Those with a trusted pose."""

    right: int
    """Those with a pose within 10 mm and 5° of the bundle adjustment."""

    wrong: int
    """Those with a trusted pose more than 20 mm or 10° off."""

    error: tuple[float, float]
    """Reprojection error [px]."""

    shift: tuple[float, float]
    """Distance from the pose of the bundle adjustment [m]."""

    turn: tuple[float, float]
    """The same of the angle [rad]."""

    step_shift: tuple[float, float]
    """How far the step from one picture to the next is off that of the bundle adjustment [m]."""

    step_turn: tuple[float, float]
    """The same of its angle [rad]."""


def track(numbers: Sequence[int]) -> list[CubeState]:
    """Show some photographs to one tracker, in their order."""
    tracker = CubeTracker(CubeModel.load(BODY_FILE), camera())
    return [
        tracker.update(Frame(photograph(number), index * INTERVAL_S, index))
        for index, number in enumerate(numbers)
    ]


def score(numbers: Sequence[int], states: Sequence[CubeState]) -> SequenceScore:
    """Compare the states of some photographs with the bundle adjustment."""
    truths = [reference().camera_from_body[number] @ body_model()[1] for number in numbers]
    poses = [state.camera_from_cube if state.visible else None for state in states]
    both = list(zip(poses, truths, strict=True))
    errors = np.array([se3.delta(pose, truth) for pose, truth in both if pose is not None])
    steps = np.array(
        [
            se3.delta(one, other) - se3.delta(one_truth, other_truth)
            for (one, one_truth), (other, other_truth) in itertools.pairwise(both)
            if one is not None and other is not None
        ]
    )
    return SequenceScore(
        len(states),
        len(errors),
        int(np.count_nonzero(are_right(errors))),
        int(np.count_nonzero(are_wrong(errors))),
        _spread(np.array([state.reprojection_error for state in states if state.visible])),
        _spread(np.linalg.norm(errors[:, :3], axis=1)),
        _spread(np.linalg.norm(errors[:, 3:], axis=1)),
        _spread(np.linalg.norm(steps[:, :3], axis=1)),
        _spread(np.linalg.norm(steps[:, 3:], axis=1)),
    )


def _spread(values: Array) -> tuple[float, float]:
    return float(np.median(values)), float(np.quantile(values, 0.95))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--write-body", action="store_true", help=f"write {BODY_FILE.name} again")
    if parser.parse_args().write_body:
        from cubeling.tracking.cube.file import write_cube

        write_cube(body_model()[0], BODY_FILE)
    numbers = range(len(paths()))
    result = score(numbers, track(numbers))
    console = Console()
    console.print(
        f"{result.frames} photographs: {result.found} trusted, "
        f"{result.right} within 10 mm and 5°, {result.wrong} silently wrong"
    )
    table = Table("", "median", "95 %")
    for name, spread, scale, unit in (
        ("reprojection error", result.error, 1.0, "px"),
        ("off the bundle adjustment", result.shift, 1e3, "mm"),
        ("", result.turn, 180 / np.pi, "°"),
        ("step to the next picture off", result.step_shift, 1e3, "mm"),
        ("", result.step_turn, 180 / np.pi, "°"),
    ):
        table.add_row(name, *(f"{scale * each:.2f} {unit}" for each in spread))
    console.print(table)


if __name__ == "__main__":
    main()
