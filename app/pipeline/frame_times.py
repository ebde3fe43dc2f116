"""How long each part of the program takes in a frame, by a clock that is passed in."""

from collections import deque
from collections.abc import Callable

Lap = Callable[[str], None]
"""Called with the name of a part when it is done."""


class FrameTimes:
    """Adds up the time of each part, frame by frame, and keeps the last second.

    Parameters
    ----------
    clock
        Returns the time [s].
    span
        How long a frame is kept [s].
    """

    def __init__(self, clock: Callable[[], float], span: float = 1.0) -> None:
        self._clock, self._span = clock, span
        self._last = clock()
        self._frame: dict[str, float] = {}
        self._frames: deque[tuple[float, dict[str, float]]] = deque()

    def lap(self, part: str) -> None:
        """Count the time since the last call for a part, which may have several in a frame."""
        now = self._clock()
        self._frame[part] = self._frame.get(part, 0.0) + now - self._last
        self._last = now

    def so_far(self, without: str) -> float:
        """Return the time that the present frame took until the last lap, without a part [s]."""
        return sum(seconds for part, seconds in self._frame.items() if part != without)

    def end_frame(self) -> None:
        """Keep the times of the frame, and forget those before the span."""
        self._frames.append((self._last, self._frame))
        self._frame = {}
        while self._last - self._frames[0][0] > self._span:
            self._frames.popleft()

    def drop_frame(self) -> None:
        """Forget what was measured since the last frame ended: nothing was shown."""
        self._last = self._clock()
        self._frame = {}

    def means(self) -> dict[str, float]:
        """Return the mean time of each part in the last second's frames [s], {} before the first.

        >>> times = FrameTimes(iter([0.0, 0.25, 1.0]).__next__)
        >>> times.lap("tracking"), times.lap("drawing"), times.end_frame()
        (None, None, None)
        >>> times.means()
        {'tracking': 0.25, 'drawing': 0.75}
        """
        sums: dict[str, float] = {}
        for _, frame in self._frames:
            for part, seconds in frame.items():
                sums[part] = sums.get(part, 0.0) + seconds
        return {part: total / len(self._frames) for part, total in sums.items()}
