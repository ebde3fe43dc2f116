"""A calibration session: frames in, advice out, until the camera is determined."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.tracking import Frame, FrameSource, LiveFrames, TrackingError
from cubeling.tracking.calibration import (
    Calibration,
    TargetFinder,
    ViewCollector,
    ViewCoverage,
    ViewResult,
    calibrate,
)

Picture = NDArray[np.uint8]

LOST_AFTER_S = 0.7
"""Time without the target after which the coach asks for it [s]."""


@dataclass(frozen=True)
class Advice:
    """What the coach shows in one frame."""

    request: str
    """What to do: "show", "still", "done", or a request of the `ViewCoverage`."""

    taken: bool
    """Whether this frame became a view."""

    views: int
    """Number of views so far."""

    coverage: ViewCoverage
    """Which views exist and which are missing."""

    outlines: tuple[NDArray[np.float64], ...]
    """Outlines of the target in this frame, each (4, 2) [px]."""

    covered: Sequence[NDArray[np.float64]]
    """Outlines of the target in all views, each (4, 2) [px]."""


class Coach(Protocol):
    """Shows or prints the advice. Whoever opens it closes it."""

    @property
    def closed(self) -> bool:
        """Whether the user wants to end the session."""

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Show the advice, over a picture (H, W, 3) that may be drawn on."""


RECOVERY_TIMEOUT_S = 30.0
"""Time in which a lost camera may come back [s]."""

POLL_INTERVAL_S = 0.05
"""Longest wait for a frame before the window is polled [s]."""


def _frames(source: FrameSource, coach: Coach) -> Iterator[Frame]:
    """Yield frames; the window can be closed even while the camera is lost."""
    if not isinstance(source, LiveFrames):
        yield from source
        return
    while not coach.closed:
        frame = source.wait(POLL_INTERVAL_S, RECOVERY_TIMEOUT_S)
        if frame is not None:
            yield frame


class CalibrationSession:
    """Collects views of the first target that is held up.

    Parameters
    ----------
    finders
        Find the targets that may be held up.
    size
        Width and height of the frames [px].
    """

    def __init__(self, finders: Sequence[TargetFinder], size: tuple[int, int]) -> None:
        self._size = size
        self._pairs = [(finder, ViewCollector(finder, size)) for finder in finders]
        self._last_seen = -np.inf
        self.last_picture: Picture | None = None
        """The last picture."""

    @property
    def finder(self) -> TargetFinder:
        """The finder of the target that is held up."""
        return self._pairs[0][0]

    @property
    def collector(self) -> ViewCollector:
        """The collector of its views."""
        return self._pairs[0][1]

    def run(self, source: FrameSource, coach: Coach, seconds: float) -> None:
        """Collect views until the camera is determined, or until frames or time end."""
        first: float | None = None
        for frame in _frames(source, coach):
            first = frame.timestamp if first is None else first
            result = self._collect(frame)
            # A recording is read to its end: it does not follow advice.
            done = source.live and self.collector.coverage.complete and self._is_determined()
            request = "done" if done else self._advice(result, frame.timestamp)
            collector = self.collector
            advice = Advice(
                request,
                result.verdict == "taken",
                len(collector.views),
                collector.coverage,
                result.outlines,
                collector.outlines,
            )
            self.last_picture = frame.image
            coach.show_advice(frame.image.copy(), frame.timestamp, advice)
            late = source.live and frame.timestamp - first > seconds
            if done or late or coach.closed:
                break
        if first is None:
            raise AppError("the source gave no picture at all")

    def calibrate(self) -> Calibration:
        """Return the camera that the views determine.

        Raises
        ------
        TrackingError, AppError
            No target was seen, or the views do not determine the camera.
        """
        self.check_seen()
        collector = self.collector
        try:
            found = calibrate(collector.views, self.finder.target(self._size))
            found.check()
        except TrackingError as error:
            raise AppError(f"the camera could not be calibrated: {error}") from error
        return found

    def check_seen(self) -> None:
        """Raise an `AppError` if the target was never seen."""
        if self._last_seen == -np.inf:
            what = "board" if len(self.finder.names) == 1 else "cube"
            raise AppError(
                f"no {what} was seen in any picture: use more light, hold it nearer, "
                "and check that it is the right one"
            )

    def _collect(self, frame: Frame) -> ViewResult:
        results = [collector.update(frame) for _, collector in self._pairs]
        for pair, result in zip(self._pairs, results, strict=True):
            if result.sample is not None:
                self._pairs = [pair]
                return result
        return results[0]

    def _advice(self, result: ViewResult, now: float) -> str:
        collector = self.collector
        if result.sample is not None:
            self._last_seen = now
        elif now - self._last_seen > LOST_AFTER_S:
            return "show"
        wanted = collector.coverage.next_kind()
        return (
            "still" if result.verdict == "moving" and wanted in self._kinds_of(result) else wanted
        )

    def _kinds_of(self, result: ViewResult) -> set[str]:
        return set() if result.sample is None else self.collector.coverage.kinds_of(result.sample)

    def _is_determined(self) -> bool:
        """Return whether the views determine the camera well; if not, ask for more."""
        try:
            good = calibrate(self.collector.views, self.finder.target(self._size)).good
        except TrackingError:
            good = False
        if not good:
            self.collector.coverage.require_more()
        return good
