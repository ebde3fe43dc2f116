"""One calibration: frames in, advice out, until the camera is known or the frames end."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from app.errors import AppError
from tracking import Frame, FrameSource, LiveFrames, TrackingError
from tracking.calibration import (
    Calibration,
    TargetFinder,
    ViewCollector,
    ViewCoverage,
    ViewResult,
    calibrate,
)

Picture = NDArray[np.uint8]

LOST = 0.7
"""After this time without the target it is asked for [s]."""


@dataclass(frozen=True)
class Advice:
    """What to tell the person now."""

    wish: str
    """What to do: "show", "still", "done", or a wish of the `ViewCoverage`."""

    taken: bool
    """Whether this very frame became a view."""

    views: int
    """How many views there are."""

    coverage: ViewCoverage
    """What is there and what is missing."""

    outlines: tuple[NDArray[np.float64], ...]
    """What is seen now, each (4, 2) [px]."""

    covered: Sequence[NDArray[np.float64]]
    """Where the target was seen in all views, each (4, 2) [px]."""


class CoachDisplay(Protocol):
    """Shows or prints the advice. Who makes it closes it."""

    @property
    def closed(self) -> bool:
        """Whether the person wants to end."""
        ...

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Tell what to do, over the picture (H, W, 3), which may be drawn on."""
        ...


PATIENCE = 30.0
"""A camera that is lost may come back for so long [s]."""

BREATH = 0.05
"""How long the window waits for a frame before it looks whether it is closed [s]."""


def _frames(source: FrameSource, display: CoachDisplay) -> Iterator[Frame]:
    """Yield frames; a camera that is lost does not keep a person from closing the window."""
    if not isinstance(source, LiveFrames):
        yield from source
        return
    while not display.closed:
        frame = source.wait(BREATH, PATIENCE)
        if frame is not None:
            yield frame


class CalibrationSession:
    """Collects views of whichever target is held up first.

    Parameters
    ----------
    finders
        The targets that may be shown.
    size
        Width and height of the frames [px].
    """

    def __init__(self, finders: Sequence[TargetFinder], size: tuple[int, int]) -> None:
        self._size = size
        self._pairs = [(finder, ViewCollector(finder, size)) for finder in finders]
        self._seen = -np.inf
        self.last: Picture | None = None
        """The last picture."""

    @property
    def finder(self) -> TargetFinder:
        """Finds the target that is held up."""
        return self._pairs[0][0]

    @property
    def collector(self) -> ViewCollector:
        """Has the views of it."""
        return self._pairs[0][1]

    def run(self, source: FrameSource, display: CoachDisplay, seconds: float) -> None:
        """Collect until the coach is content and the camera determined, or frames or time end."""
        first: float | None = None
        for frame in _frames(source, display):
            first = frame.timestamp if first is None else first
            glance = self._glance(frame)
            # A recording is looked through to its end: it cannot be asked for anything.
            done = source.live and self.collector.coverage.complete and self._determined()
            wish = "done" if done else self._advised(glance, frame.timestamp)
            collector = self.collector
            advice = Advice(
                wish,
                glance.verdict == "taken",
                len(collector.views),
                collector.coverage,
                glance.outlines,
                collector.outlines,
            )
            self.last = frame.image
            display.show_advice(frame.image.copy(), frame.timestamp, advice)
            late = source.live and frame.timestamp - first > seconds
            if done or late or display.closed:
                break
        if first is None:
            raise AppError("the source gave no picture at all")

    def calibrated(self) -> Calibration:
        """Return the camera that the views tell of.

        Raises
        ------
        TrackingError, AppError
            Nothing was seen, or the views do not determine the camera.
        """
        self.check_seen()
        collector = self.collector
        try:
            found = calibrate(collector.views, self.finder.target(self._size))
            found.check()
        except TrackingError as error:
            raise AppError(f"no camera is written: {error}") from error
        return found

    def check_seen(self) -> None:
        """Refuse to go on where the target was never seen."""
        if self._seen == -np.inf:
            what = "board" if len(self.finder.names) == 1 else "cube's markers"
            raise AppError(
                f"no {what} was seen in any picture: more light, nearer, and is it the right one?"
            )

    def _glance(self, frame: Frame) -> ViewResult:
        glances = [collector.update(frame) for _, collector in self._pairs]
        for pair, glance in zip(self._pairs, glances, strict=True):
            if glance.sample is not None:
                self._pairs = [pair]
                return glance
        return glances[0]

    def _advised(self, glance: ViewResult, now: float) -> str:
        collector = self.collector
        if glance.sample is not None:
            self._seen = now
        elif now - self._seen > LOST:
            return "show"
        wanted = collector.coverage.next_kind()
        return "still" if glance.verdict == "moving" and wanted in self._offered(glance) else wanted

    def _offered(self, glance: ViewResult) -> set[str]:
        return set() if glance.sample is None else self.collector.coverage.kinds_of(glance.sample)

    def _determined(self) -> bool:
        """Whether the views tell the camera well; if not, more are asked for."""
        try:
            good = calibrate(self.collector.views, self.finder.target(self._size)).good
        except TrackingError:
            good = False
        if not good:
            self.collector.coverage.require_more()
        return good
