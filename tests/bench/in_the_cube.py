"""What an open cube costs, and how firmly its room sits in the paper.

`python -m tests.bench.in_the_cube` prints the time of a frame with the character inside over one
with it on the table, and how far corners of the room are from where they truly are in drawn
pictures, which is an upper bound for what a camera shows.
"""

import argparse
import time

import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.playground import Playground
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.characters.rendering import WALL_SHARE, create_context
from cubeling.characters.rendering.projection import project
from cubeling.tracking import CubeTracker, open_source
from cubeling.tracking.synthetic import open_synthetic

Array = NDArray[np.float64]

SKIPPED = 60
"""Frames before the first that counts: the cube is found, and its walls are open."""

SCENES = ("turn", "fingers", "wave", "static")
"""Scenes in which corners are compared: on the table, in the hand, in the air, and at rest."""


def frame_times(name: str, frames: int, context: moderngl.Context) -> tuple[Array, Array]:
    """Return the times of `Playground.step` with an open and with a closed cube [ms]."""
    with open_source(str(bundled_session(name))) as source:
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        playing = [
            Playground(name, intrinsics, context=context, inside=choice)
            for choice in ("always", "never")
        ]
        times = []
        for number, frame in enumerate(source):
            if number == SKIPPED + frames:
                break
            marks = [time.perf_counter()]
            for each in playing:
                each.step(frame)
                marks.append(time.perf_counter())
            times.append(1000.0 * np.diff(marks))
        for each in playing:
            each.close()
    opened, closed = np.array(times[SKIPPED:]).T
    return opened, closed


def corner_errors(scene: str, frames: int) -> Array:
    """Return how far the room's corners are from the truth, (frames, 8) [px].

    They are seen through the holes, at another depth than the print that the pose is measured on.
    """
    source = open_synthetic(scene)
    assert source.intrinsics is not None
    tracker = CubeTracker(source.cube, source.intrinsics)
    signs = (np.arange(8)[:, None] >> np.arange(3) & 1) - 0.5
    corners = np.column_stack([(1.0 - 2.0 * WALL_SHARE) * source.cube.edge * signs, np.ones(8)])
    errors = []
    for index in range(min(frames, source.count)):
        state = tracker.update(source.frame(index))
        if state.visible and state.camera_from_cube is not None:
            found, true = (
                project((corners @ pose.T)[:, :3], source.intrinsics.matrix)
                for pose in (state.camera_from_cube, source.truth(index))
            )
            errors.append(np.linalg.norm(found - true, axis=1))
    return np.array(errors)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=120, help="frames of each scene")
    given = parser.parse_args()
    context = create_context()
    costs = Table("scenario", "on the table ms", "in the cube ms", "ratio", title="a frame, median")
    for name in RECORDED_SCENARIOS:
        opened, closed = frame_times(name, given.frames, context)
        ratio = float(np.median(opened / closed))
        medians = (f"{np.median(each):.1f}" for each in (closed, opened))
        costs.add_row(name, *medians, f"{ratio:.2f}")
    context.release()
    errors = Table("scene", "frames", "median px", "95 % px", "largest px", title="room's corners")
    for scene in SCENES:
        found = corner_errors(scene, given.frames)
        figures = np.quantile(found, (0.5, 0.95, 1.0))
        errors.add_row(scene, str(len(found)), *(f"{figure:.2f}" for figure in figures))
    console = Console(width=100)
    console.print(costs)
    console.print(errors)


if __name__ == "__main__":
    main()
