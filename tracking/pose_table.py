"""A video as a table of poses: where the cube is in each of its frames."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cubeling.files import write_whole
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.sources import open_source
from cubeling.tracking.tracker.tracker import CubeTracker

COLUMNS = (
    *("time_s", "verdict", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "reprojection_error_px"),
)
"""The columns of the file, named as in the tables of `cubeling export`."""


@dataclass(frozen=True)
class PoseTable:
    """The pose of a cube in each of N frames, NaN where it is not known."""

    times: Array
    """Time of each frame [s], (N,)."""

    verdicts: tuple[str, ...]
    """"trusted" for each frame in which the cube was found, else "unseen" or why it was refused."""

    positions: Array
    """Centre of the cube in the camera frame, x right, y down, z forward [m], (N, 3)."""

    quaternions: Array
    """Rotation from the cube to the camera frame, unit quaternions xyzw with w ≥ 0, (N, 4)."""

    reprojection_errors: Array
    """Root mean square residual of each pose [px], (N,)."""

    def __len__(self) -> int:
        return len(self.times)

    @property
    def visible(self) -> Array:
        """Whether the cube was found and its pose is trusted, (N,)."""
        return np.array([verdict == "trusted" for verdict in self.verdicts], bool)

    def save(self, path: str | Path) -> None:
        """Write the table as CSV, with `COLUMNS` as its first line; what is not known is empty.

        Raises
        ------
        TrackingError
            The file cannot be written.
        """
        numbers = np.column_stack([self.positions, self.quaternions, self.reprojection_errors])
        text = io.StringIO(newline="")
        table = csv.writer(text, lineterminator="\n")
        table.writerow(COLUMNS)
        for time, verdict, row in zip(self.times, self.verdicts, numbers, strict=True):
            cells = ["" if np.isnan(number) else f"{number:.9g}" for number in row]
            table.writerow([f"{time:.6f}", verdict, *cells])
        write_whole(path, text.getvalue(), TrackingError)


def track_video(
    uri: str | Path, cube: str | Path = "companion", intrinsics: Intrinsics | None = None
) -> PoseTable:
    """Track a cube through a whole video.

    Parameters
    ----------
    uri
        A video, a session (.mcap) or "synthetic:NAME", as `open_source` takes it.
    cube
        A bundled cube, or your own .toml file.
    intrinsics
        The camera; None for that of the source, or else for a lens of 60°, whose focal length is
        measured on the way: until then, distances are only as right as that guess.
        `Intrinsics.load("camera.yaml")` reads a calibration.

    Raises
    ------
    TrackingError
        The source or the cube cannot be read, or the source is live and so never ends.
    """
    with open_source(str(uri)) as source:
        if source.live:
            raise TrackingError(f"'{uri}' is live and does not end: give a video or a session")
        camera = intrinsics or source.intrinsics or Intrinsics.guess(source.size)
        tracker = CubeTracker(CubeModel.load(str(cube)), camera)
        return _table([tracker.update(frame) for frame in source])


def _table(states: list[CubeState]) -> PoseTable:
    """Return the table of states; a pose counts where it is trusted."""
    poses = np.full((len(states), 7), np.nan)
    for row, state in zip(poses, states, strict=True):
        if state.visible and state.camera_from_cube is not None:
            row[:3] = state.camera_from_cube[:3, 3]
            row[3:] = se3.quaternion(state.camera_from_cube[:3, :3])
    return PoseTable(
        np.array([state.timestamp for state in states]),
        tuple(state.verdict for state in states),
        poses[:, :3],
        poses[:, 3:],
        np.array([state.reprojection_error for state in states]),
    )
