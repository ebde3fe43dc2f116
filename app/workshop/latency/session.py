"""Flipping the pattern on the screen and watching it through the camera."""

import time
from collections.abc import Callable
from typing import Protocol

import numpy as np

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.workshop.latency import MIN_FLIPS
from cubeling.app.workshop.latency.flips import FlipDetector
from cubeling.app.workshop.latency.pattern import PatternReader, Picture, draw_pattern
from cubeling.tracking import LiveFrames

PATIENCE_S = 30.0
"""Time without a flip that is seen, after which the measurement ends [s]."""

POLL_S = 0.02
"""Longest wait for a picture before the window is polled [s]."""

MIRROR_ADVICE = "A camera above the screen sees it in a hand mirror"


class PatternScreen(Protocol):
    """Shows the pattern. Whoever opens it closes it."""

    @property
    def closed(self) -> bool:
        """Whether the user wants to end."""

    def show_pattern(self, picture: Picture) -> None:
        """Show a picture of the pattern; it is on its way to the screen on return."""

    def poll(self) -> None:
        """Process the window's events, so that it can be closed."""


class LatencySession:
    """Measures the time from the screen through the camera to the program.

    Parameters
    ----------
    source
        A live camera; its frames are waited for at once, so none of them waits for the program.
    count
        Number of flips to see.
    seed
        Of the moments of the flips.
    clock
        The time [s] of the source's timestamps.
    """

    def __init__(
        self,
        source: LiveFrames,
        count: int,
        seed: int = 1,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._source, self._count, self._clock = source, count, clock
        self._reader = PatternReader()
        self.detector = FlipDetector(seed)
        """The flips so far."""
        self._stamp_ages: list[float] = []
        self._in_view = self._ever_seen = False
        self._words = ""

    @property
    def stamp_age(self) -> float:
        """Median time from a frame's timestamp to its arrival in the program [s]."""
        return float(np.median(self._stamp_ages)) if self._stamp_ages else 0.0

    def run(self, screen: PatternScreen) -> None:
        """Flip until enough flips are seen, none for a long time, or the user ends.

        Raises
        ------
        AppError
            Too few flips were seen to say anything.
        TrackingError
            The camera was lost.
        """
        detector = self.detector
        self._show(screen)
        last_progress, seen = self._clock(), 0
        while len(detector.flips) < self._count and not screen.closed:
            now = self._clock()
            frame = self._source.wait(min(POLL_S, detector.wait(now)), PATIENCE_S)
            if frame is not None:
                self._add(frame.timestamp, frame.image)
            now = self._clock()
            if detector.is_due(now):
                self._show(screen, flip=True)
            elif self._words != self._advice():
                self._show(screen)
            screen.poll()
            if len(detector.flips) > seen:
                last_progress, seen = now, len(detector.flips)
            elif now - last_progress > PATIENCE_S:
                break
        self.check(ended_by_user=screen.closed)

    def check(self, *, ended_by_user: bool) -> None:
        """Raise an AppError if too few flips were seen to say anything."""
        count = len(self.detector.flips)
        if count >= MIN_FLIPS:
            return
        if ended_by_user:
            raise AppError(
                f"stopped after {quantity(count, 'flip')} of the pattern; at least {MIN_FLIPS} "
                "count"
            )
        if not self._ever_seen:
            raise AppError(
                f"the camera did not see the pattern in {PATIENCE_S:.0f} s: point it at the "
                "screen, so near that the pattern fills half of the picture; a camera above the "
                "screen sees it in a hand mirror"
            )
        raise AppError(
            f"the camera saw only {quantity(count, 'flip')} of the pattern, and none in the last "
            f"{PATIENCE_S:.0f} s: hold the camera still, and dim the room if the screen is pale"
        )

    def _add(self, timestamp: float, image: Picture) -> None:
        arrived = self._clock()
        self._stamp_ages.append(arrived - timestamp)
        lightness = self._reader.read(image)
        self._in_view = lightness is not None
        self._ever_seen |= self._in_view
        self.detector.add(arrived, lightness)

    def _show(self, screen: PatternScreen, *, flip: bool = False) -> None:
        """Show the pattern as it is, or flipped, with the words of the moment."""
        detector = self.detector
        self._words = self._advice()
        screen.show_pattern(
            draw_pattern(
                detector.left_is_white != flip,
                self._words,
                "" if self._in_view else MIRROR_ADVICE,
                len(detector.flips) / self._count,
            )
        )
        if flip:
            detector.show(self._clock())

    def _advice(self) -> str:
        return "Hold it still" if self._in_view else "Point the camera at this screen"
