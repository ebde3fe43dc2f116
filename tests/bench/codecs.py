"""Size and accuracy of recordings: `python -m tests.bench.codecs [--frames N]`.

The tracker sees what a recording holds. Each way to hold pictures that are no JPEG is measured on
the same rendered frames: the bytes, the time to encode and decode, and the error of the pose.
"""

import argparse
import time
from collections.abc import Callable

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.session import frame_encoder
from cubeling.app.session.frames import FrameEncoder
from cubeling.tracking import Frame
from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic import SyntheticSource, open_synthetic
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.accuracy import in_view

SCENES = (
    *(f"static?seed={seed}" for seed in range(2, 8)),
    "fingers",
    "turn",
    "sweep?speed=0.25",
    "follow?seed=3",
    "sketch",
    "companion",
)
"""Scenes at rest and in motion; a scene at rest shows one pose, so there are several."""

START_S = 1.0
"""When the frames of a scene begin: before, the cube rests [s]."""


def raw(size: tuple[int, int], rate: float) -> FrameEncoder:
    """Keep the pixels."""
    return lambda frame: frame


KINDS: dict[str, Callable[[tuple[int, int], float], FrameEncoder]] = {
    "the camera's pixels": raw,
    "jpeg": lambda size, rate: frame_encoder("jpeg", size, rate),
    "auto (h264)": lambda size, rate: frame_encoder("auto", size, rate),
}
"""The ways to hold pictures that are compared."""


class Measured:
    """What one way to hold pictures costs, over all scenes."""

    def __init__(self) -> None:
        self.sizes: list[int] = []
        self.seconds: list[float] = []
        self.shifts: list[float] = []
        self.turns: list[float] = []
        self.frames = 0

    def add_scene(self, source: SyntheticSource, frames: list[Frame], encode: FrameEncoder) -> None:
        """Track the encoded frames of a scene."""
        assert source.intrinsics is not None
        tracker = CubeTracker(source.cube, source.intrinsics)
        for frame in frames:
            start = time.thread_time()
            encoded = encode(frame)
            self.seconds.append(time.thread_time() - start)
            self.sizes.append(len(encoded.encoded or frame.image.tobytes()))
            state = tracker.update(encoded)
            if not in_view(source, frame.index):
                continue
            self.frames += 1
            if state.visible and state.camera_from_cube is not None:
                error = se3.delta(state.camera_from_cube, source.truth(frame.index))
                self.shifts.append(1000 * float(np.linalg.norm(error[:3])))
                self.turns.append(float(np.rad2deg(np.linalg.norm(error[3:]))))

    def row(self) -> tuple[str, ...]:
        """Return the line of the table."""
        size = float(np.mean(self.sizes))
        return (
            f"{size / 1000:.1f}",
            f"{size * 30 * 36 / 1e6:.0f}",
            f"{1000 * np.mean(self.seconds):.1f}",
            f"{100 * len(self.shifts) / self.frames:.1f}",
            f"{np.mean(self.shifts):.3f}",
            f"{np.median(self.shifts):.3f}",
            f"{np.percentile(self.shifts, 95):.3f}",
            f"{np.median(self.turns):.3f}",
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=50, help="frames of each scene")
    count = parser.parse_args().frames
    cv2.setNumThreads(1)  # so that the time of the thread is the time of the work
    measured = {name: Measured() for name in KINDS}
    for scene in SCENES:
        source = open_synthetic(scene)
        first = round(START_S * source.rate)
        frames = [source.frame(i) for i in range(first, min(first + count, source.count))]
        for name, kind in KINDS.items():
            measured[name].add_scene(source, frames, kind(source.size, source.rate))
    table = Table("pictures", "kB each", "MB in 36 s", "ms", "found %", title="Pose by recording")
    for column in ("mean mm", "median", "95 %", "median °"):
        table.add_column(column)
    for name, one in measured.items():
        table.add_row(name, *one.row())
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
