"""Sessions of a scenario's script, without pictures: nothing is drawn, and no cube is searched."""

from collections.abc import Iterator
from pathlib import Path
from typing import Self

import numpy as np
import pytest

from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import Progress, run
from cubeling.app.session import SessionOptions
from cubeling.tracking import CubeState, Frame, FrameMarkers
from cubeling.tracking.synthetic import SyntheticSource, open_synthetic

PICTURE_WIDTH, PICTURE_HEIGHT = 320, 180
"""Size of the pictures [px]."""

RATE = 6.0
"""Frames per second."""

VARIANCE = np.diag([1e-4**2] * 3 + [1e-3**2] * 3)
"""Of a pose, as the tracker states it for a cube on the table [m², rad²]."""


class Blank:
    """A source of black pictures at the times of a script."""

    live = False

    def __init__(self, script: SyntheticSource) -> None:
        self.intrinsics, self.size, self.rate = script.intrinsics, script.size, script.rate
        self.duration, self.count = script.duration, script.count
        self._script = script

    def __iter__(self) -> Iterator[Frame]:
        width, height = self.size
        black = np.zeros((height, width, 3), np.uint8)
        for index in range(self.count):
            yield Frame(black, self._script.time(index), index)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Do nothing: nothing is open."""


def play_script(
    name: str,
    record: Path | None = None,
    progress: Progress | None = None,
    seconds: float | None = None,
    script: str = "",
) -> None:
    """Play a script, that of a bundled recording, with the true pose of the cube in every frame."""
    source = open_synthetic(f"{script or name}?rate={RATE:g}&size={PICTURE_WIDTH}x{PICTURE_HEIGHT}")

    def track(_: TrackedCube, frame: Frame, markers: FrameMarkers | None) -> CubeState:
        pose = source.truth(frame.index)
        still = np.zeros(6)
        return CubeState(True, pose, still, VARIANCE, "markers", (), 0.1, frame.timestamp)

    options = SessionOptions(
        scenario=name, source="script", record=record, end_s=seconds, pictures=False
    )
    with (
        pytest.MonkeyPatch.context() as patch,
        open_session(options, source=Blank(source)) as session,
    ):
        patch.setattr(TrackedCube, "track", track)
        run(session, progress)
