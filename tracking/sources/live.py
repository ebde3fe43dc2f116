"""A source that hands out the newest picture of a device that may come and go."""

import statistics
import time
from collections import deque
from collections.abc import Callable, Iterator

from tracking.errors import TrackingError
from tracking.geometry.frame import Frame
from tracking.sources.base import FrameSource, Timeline
from tracking.sources.capture import (
    FIRST_S,
    OPENING_S,
    POLL_S,
    SILENCE_S,
    Capture,
)
from tracking.sources.device import Clock, Device, Shot
from tracking.sources.health import Health, SourceState
from tracking.sources.pictures import decode_jpeg
from tracking.sources.timing import RECENT

PATIENCE_S = 30.0
"""A plain iteration waits so long for a lost device to come back."""


class LiveSource(FrameSource):
    """Frames that arrive by themselves; late ones are dropped for newer ones.

    Opening waits for the first frame. The device is opened, read and closed by one thread, so that
    a driver that never returns blocks nobody. A device that is lost later is opened anew until it
    is back: `base.LiveFrames` says what the one who iterates sees of that.

    Parameters
    ----------
    connect
        Opens the device; called in the capture thread, again after each loss.
    name
        How errors call the source: "camera 0".
    clock
        Seconds; stamps the frames, and tells when the source fell silent.
    tell_frozen
        Whether the very same picture for `SILENCE_S` counts as none.

    Raises
    ------
    TrackingError
        While opening: the device does not open, or gives no picture.
    """

    live = True
    duration = None
    intrinsics = None

    def __init__(
        self,
        connect: Callable[[], Device],
        name: str,
        clock: Clock = time.monotonic,
        *,
        tell_frozen: bool = True,
    ) -> None:
        self._name = name
        self._clock = clock
        self._timeline = Timeline()
        self._count = 0
        self._closed = False
        self._garbage: float | None = None
        self._ages: deque[float] = deque(maxlen=RECENT)
        self._capture = Capture(connect, name, clock, tell_frozen)
        try:
            self._first: Frame | None = self._open()
        except BaseException:
            self.close()
            raise
        height, width = self._first.image.shape[:2]
        self.size = (width, height)
        self.rate = self._capture.rate

    def __iter__(self) -> Iterator[Frame]:
        while not self._closed:
            frame = self.wait(SILENCE_S, PATIENCE_S)
            if frame is not None:
                yield frame

    def wait(self, timeout: float, patience: float | None = None) -> Frame | None:
        """Wait for a new frame: see `base.LiveFrames`."""
        if self._first is not None:
            first, self._first = self._first, None
            return first
        frame = self._next(timeout)
        if frame is None:
            self._lose_patience(patience)
        elif frame.image.shape[1::-1] != self.size:
            width, height = frame.image.shape[1::-1]
            raise TrackingError(
                f"the picture of {self._name} changed from {self.size[0]}x{self.size[1]} to "
                f"{width}x{height}: keep the camera as it was when you started"
            )
        return frame

    @property
    def health(self) -> Health:
        """How the source fares at this moment."""
        capture = self._capture
        state, since, problem = self._state()
        return Health(
            self._name,
            state,
            since,
            problem,
            self._count,
            capture.dropped,
            capture.gaps,
            capture.gauge.rate,
            statistics.median(self._ages) if self._ages else 0.0,
            capture.gauge.depth,
            capture.gauge.deepest,
            "driver" if capture.by_driver else "arrival",
            capture.settings,
            capture.frozen and state in ("frozen", "recovering"),
        )

    def close(self) -> None:
        """Stop capturing. Safe to call again, and from another thread; the iteration then ends."""
        self._closed = True
        self._first = None
        self._capture.stop()

    def _open(self) -> Frame:
        while True:
            frame = self._next(POLL_S)
            if frame is not None:
                return frame
            now, capture = self._clock(), self._capture
            if capture.failed_to_open:
                raise TrackingError(capture.problem)
            if self._garbage is not None and now - self._garbage >= FIRST_S:
                raise TrackingError(self._undecodable)
            if not capture.came and now - capture.heard >= (
                OPENING_S if capture.opening else FIRST_S
            ):
                if capture.opening:
                    raise TrackingError(
                        f"{self._name} did not open within {OPENING_S:g} s: plug it in again"
                    )
                raise TrackingError(self._silent(FIRST_S))

    def _next(self, timeout: float) -> Frame | None:
        began = self._clock()
        while (shot := self._capture.newest(timeout)) is not None:
            frame = self._decoded(shot)
            if frame is not None:
                return frame
            now = self._clock()
            if self._garbage is not None and now - self._garbage >= SILENCE_S:
                self._capture.reject(self._undecodable)
            if now - began >= timeout:
                return None
        return None

    def _decoded(self, shot: Shot) -> Frame | None:
        jpeg = shot.picture if isinstance(shot.picture, bytes) else None
        image = shot.picture if jpeg is None else decode_jpeg(jpeg)
        now = self._clock()
        if image is None or isinstance(image, bytes):
            self._garbage = now if self._garbage is None else self._garbage
            return None
        self._garbage = None
        self._ages.append(now - shot.taken)
        stamp, index = self._timeline.stamp(shot.taken), self._count
        self._count += 1
        return Frame(image, stamp, index, jpeg, "jpeg" if jpeg else "")

    def _state(self) -> tuple[SourceState, float, str]:
        """Return what the source does, since when, and why.

        The thread may sit in a driver and see nothing; then silence is seen from here.
        """
        capture, now = self._capture, self._clock()
        if self._closed:
            return "closed", capture.since, ""
        if self._garbage is not None and now - self._garbage >= SILENCE_S:
            return "lost", self._garbage, self._undecodable
        if capture.state == "running":
            if now - capture.heard >= SILENCE_S:
                return "lost", capture.heard, self._silent(now - capture.heard)
            return "running", capture.since, ""
        lasted = now - capture.since
        if capture.problem:
            return capture.state, capture.since, capture.problem
        words = self._still(lasted) if capture.frozen else self._silent(lasted)
        return capture.state, capture.since, words

    def _lose_patience(self, patience: float | None) -> None:
        if patience is None:
            return
        state, since, problem = self._state()
        if state not in ("running", "closed") and self._clock() - since >= patience:
            raise TrackingError(problem)

    def _silent(self, seconds: float) -> str:
        return (
            f"{self._name} gave no picture for {seconds:.0f} s: "
            "check that it is connected and that no other program uses it"
        )

    def _still(self, seconds: float) -> str:
        return (
            f"{self._name} has given the very same picture for {seconds:.0f} s: "
            "it is covered, frozen or unplugged"
        )

    @property
    def _undecodable(self) -> str:
        return f"{self._name} sends pictures that cannot be decoded"
