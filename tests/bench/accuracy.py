"""Accuracy of the tracker on rendered images with ground truth.

Run `python -m tests.bench.accuracy [--frames 300] [SCENE …]`.
"""

import argparse
import time
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.synthetic import SyntheticSource, open_synthetic
from cubeling.tracking.tracker.tracker import CubeTracker

SCENES = (
    "poses",
    "static",
    "fingers",
    "follow",
    "companion",
    "sweep?speed=0.25",
    "sweep?speed=0.5",
)
MIN_WRONG_ERROR = (0.020, np.deg2rad(10))
"""A pose further off than this [m, rad] is silently wrong: reported as valid."""

CHI2_95_PERCENT = 12.592
"""95 % quantile of χ² with six degrees of freedom: the bound of the stated ellipsoid."""

COLUMNS = (
    "scene",
    "in view",
    "found %",
    "wrong %",
    "mm",
    "mm 95 %",
    "°",
    "° 95 %",
    "inside 95 %",
    "jitter mm",
    "ms",
)


@dataclass(frozen=True)
class SceneAccuracy:
    """Measurements in one scene."""

    scene: str
    """Name of the scene, with its options."""

    states: list[CubeState]
    """The tracker's states in frames that show the whole cube."""

    errors: np.ndarray
    """Error of each visible state: translation [m] and rotation [rad], (N, 6)."""

    seconds: np.ndarray
    """Processing time of each frame [s]."""

    @property
    def row(self) -> tuple[str, ...]:
        """The line of the table."""
        visible = [state for state in self.states if state.visible]
        if not visible:
            return (self.scene, str(len(self.states)), "0", *("–",) * 7, self._milliseconds)
        shift = np.linalg.norm(self.errors[:, :3], axis=1)
        turn = np.linalg.norm(self.errors[:, 3:], axis=1)
        pairs = zip(self.errors, visible, strict=True)
        inside = [e @ np.linalg.solve(state.covariance, e) < CHI2_95_PERCENT for e, state in pairs]
        return (
            self.scene,
            str(len(self.states)),
            f"{100 * len(visible) / len(self.states):.1f}",
            f"{100 * np.mean((shift > MIN_WRONG_ERROR[0]) | (turn > MIN_WRONG_ERROR[1])):.1f}",
            f"{1000 * np.median(shift):.3f}",
            f"{1000 * np.percentile(shift, 95):.3f}",
            f"{np.rad2deg(np.median(turn)):.3f}",
            f"{np.rad2deg(np.percentile(turn, 95)):.3f}",
            f"{100 * np.mean(inside):.1f}",
            f"{1000 * self.errors[:, :3].std(axis=0).max():.3f}" if "static" in self.scene else "",
            self._milliseconds,
        )

    @property
    def _milliseconds(self) -> str:
        return f"{1000 * np.median(self.seconds):.1f}"


def in_view(source: SyntheticSource, index: int) -> bool:
    """Whether the whole cube is in the picture."""
    assert source.intrinsics is not None
    centre = source.truth(index)[:3, 3]
    if centre[2] < 0.1:
        return False
    pixel = source.intrinsics.matrix @ centre / centre[2]
    margin = source.intrinsics.matrix[0, 0] * source.cube.edge * 0.87 / centre[2]
    return all(margin < pixel[axis] < source.size[axis] - margin for axis in (0, 1))


def measure(scene: str, frames: int) -> SceneAccuracy:
    """Track one scene; with a new tracker for each frame if the poses are unrelated."""
    source = open_synthetic(scene)
    assert source.intrinsics is not None
    tracker = CubeTracker(source.cube, source.intrinsics)
    states, errors, seconds = [], [], []
    for index in range(min(frames, source.count)):
        frame = source.frame(index)
        if scene.startswith("poses"):
            tracker = CubeTracker(source.cube, source.intrinsics)
        start = time.perf_counter()
        state = tracker.update(frame)
        seconds.append(time.perf_counter() - start)
        if not in_view(source, index):
            continue
        states.append(state)
        if state.visible and state.camera_from_cube is not None:
            errors.append(se3.delta(state.camera_from_cube, source.truth(index)))
    return SceneAccuracy(scene, states, np.array(errors), np.array(seconds))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: {', '.join(SCENES)}")
    parser.add_argument("--frames", type=int, default=300, help="maximum for each scene")
    arguments = parser.parse_args()
    table = Table(title="Pose of the cube against the truth")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "scene" else "right")
    for scene in arguments.scenes or SCENES:
        table.add_row(*measure(scene, arguments.frames).row)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
