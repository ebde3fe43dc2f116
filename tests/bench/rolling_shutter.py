"""How far a waved cube is off before a camera with a rolling shutter: `python -m …rolling_shutter`.

The rows are drawn one after the other; the pose counts at the time of the middle one.
"""

import argparse

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.tracking import CubeModel, CubeTracker, Frame
from cubeling.tracking.geometry import se3
from tests.tracking.drawn import CAMERA, Array, held, off, rolled

BANDS = 24
"""Bands of rows that are drawn at once."""

REACH_M, RATE = 0.12, 30.0
"""The hand moves so far to either side [m], before a camera with this rate [frames/s]."""

CUBE = CubeModel.load("companion")


def waved(
    readout: float, speed: float, way: Array, at: tuple[float, float, float], count: int
) -> tuple[Array, float]:
    """Errors [mm] of a cube that is waved, each frame, and the time that was measured [s]."""
    rest, tracker, errors = held(0.5, 0.6, 0.1, at), CubeTracker(CUBE, CAMERA), []

    for number in range(count):
        now = number / RATE

        def pose_at(late: float, now: float = now) -> Array:
            shift = way / np.linalg.norm(way) * REACH_M * np.sin(speed / REACH_M * (now + late))
            return se3.apply_delta(rest, np.concatenate([shift, np.zeros(3)]))

        state = tracker.update(Frame(rolled(CUBE, pose_at, readout, BANDS, number), now, number))
        errors.append(off(state.camera_from_cube, pose_at(0.0))[0] if state.visible else np.nan)
    return np.array(errors), tracker.readout


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--speed", type=float, default=0.5, help="at most [m/s] (%(default)s)")
    parser.add_argument("--frames", type=int, default=50, help="%(default)s")
    options = parser.parse_args()
    table = Table("shutter", "way", "place", "first 10, mm", "last half, mm (95 %)", "measured, ms")
    for milliseconds in (0, 10, 25):
        for way in ((1.0, 0, 0), (0, 1.0, 0), (1.0, 1.0, 0)):
            for at in ((0, 0.02, 0.4), (0, 0.07, 0.4), (0, -0.05, 0.35)):
                errors, readout = waved(
                    milliseconds / 1000, options.speed, np.array(way), at, options.frames
                )
                late = errors[options.frames // 2 :]
                table.add_row(
                    f"{milliseconds} ms",
                    str(way),
                    str(at),
                    f"{np.nanmedian(errors[:10]):.2f}",
                    f"{np.nanmedian(late):.2f} ({np.nanquantile(late, 0.95):.2f})",
                    f"{1000 * readout:.1f}",
                )
    Console().print(table)


if __name__ == "__main__":
    main()
