"""A camera whose images somebody else receives and pushes: that of a phone's browser."""

import threading
import time
from collections import deque

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.sources.capture import POLL_S
from cubeling.tracking.sources.device import Clock, DeviceSetting, jpeg_size
from cubeling.tracking.sources.live import LiveSource

NOMINAL_RATE = 30.0
"""Images a second of a camera that does not tell its rate."""

MAX_SIDE_PX = 2048
"""Most pixels of a side: what claims more is not decoded, whoever pushes it."""

CLOCK_WINDOW = 300
"""Images over which two clocks are compared: ten seconds, in which they drift by microseconds."""


class ClockOffset:
    """Brings times of another clock to ours, by when messages with such times arrive.

    The one that was quickest on its way tells the difference of the clocks, but for its own time on
    the way. A delay that grows is thus a delay, and no drift.

    >>> offset = ClockOffset()
    >>> offset.local(2.0, arrival=10.0), offset.local(2.5, arrival=10.9)
    (10.0, 10.5)
    """

    def __init__(self) -> None:
        self._differences: deque[float] = deque(maxlen=CLOCK_WINDOW)

    def local(self, remote: float, arrival: float) -> float:
        """Return a time of the other clock on ours, from when it arrived here [s]."""
        self._differences.append(arrival - remote)
        return remote + min(self._differences)


class ImageFeed:
    """Holds the newest image that was pushed. Any thread pushes, and any number of sources read."""

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self._clock = clock
        self._changed = threading.Condition()
        self._newest: tuple[bytes, float] | None = None
        self.number = 0
        """How many images were pushed."""
        self._offset = ClockOffset()
        self.size: tuple[int, int] | None = None
        """Width and height of the newest image [px]; None before the first one."""

    def begin(self) -> None:
        """Begin with another camera, whose clock is another one."""
        with self._changed:
            self._offset = ClockOffset()

    def push(self, jpeg: bytes, taken: float) -> bool:
        """Hold a JPEG, taken at a time of its camera's clock [s]; return False if it is none.

        Only its header is read. One that is `MAX_SIDE_PX` wide at most is taken.
        """
        size = jpeg_size(jpeg) if jpeg.startswith(b"\xff\xd8") else None
        if size is None or not (min(size) > 0 and max(size) <= MAX_SIDE_PX):
            return False
        with self._changed:
            self._newest = jpeg, self._offset.local(taken, self._clock())
            self.number += 1
            self.size = size
            self._changed.notify_all()
        return True

    def next(self, after: int, timeout: float) -> tuple[int, bytes, float] | None:
        """Wait for an image after the one of a number; return its number, the JPEG and its time."""
        with self._changed:
            self._changed.wait_for(lambda: self.number > after, timeout)
            if self._newest is None or self.number <= after:
                return None
            return self.number, *self._newest

    def wait_for_first(self, timeout: float) -> bool:
        """Return whether there is an image; wait for it for so many seconds."""
        return self.next(0, timeout) is not None


class PushedSource(LiveSource):
    """The images of a feed as frames; each keeps the very bytes that were pushed.

    Parameters
    ----------
    feed
        Where the images are pushed to; the newest one comes first.
    name
        Of the camera, in messages.
    clock
        Returns the time [s].

    Raises
    ------
    TrackingError
        No image came for 2 s.
    """

    def __init__(self, feed: ImageFeed, name: str, clock: Clock = time.monotonic) -> None:
        # A feed needs no time to be opened again, and pictures that come meanwhile would be lost.
        super().__init__(lambda: _FeedReader(feed), name, clock, retry_delay=0.0)


class _FeedReader:
    """Reads a feed as a device."""

    rate = NOMINAL_RATE
    settings: tuple[DeviceSetting, ...] = ()

    def __init__(self, feed: ImageFeed) -> None:
        self._feed = feed
        self._number = feed.number  # what was pushed before is not new, however long ago that was
        self._closed = False
        self.exposed: float | None = None

    def read(self) -> bytes | None:
        if self._closed:
            raise TrackingError("the camera was closed")
        found = self._feed.next(self._number, POLL_S)
        if found is None:
            return None
        self._number, jpeg, self.exposed = found
        return jpeg

    def interrupt(self) -> None:
        self._closed = True

    def close(self) -> None:
        self._closed = True
