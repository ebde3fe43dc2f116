"""A source that returns the newest image of a device that may be lost and come back."""

import math
import statistics
import time
from collections import deque
from collections.abc import Callable, Iterator

from cubeling.tracking.errors import NoCameraError, TrackingError
from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.sources.base import FrameSource, Timeline
from cubeling.tracking.sources.capture import (
    FIRST_IMAGE_TIMEOUT_S,
    OPEN_TIMEOUT_S,
    POLL_S,
    RETRY_DELAY_S,
    SILENCE_S,
    CaptureThread,
)
from cubeling.tracking.sources.capture_timing import RECENT_IMAGES
from cubeling.tracking.sources.device import (
    MAX_IMAGE_PX,
    CapturedImage,
    Clock,
    Device,
    Health,
    SourceState,
    decode_jpeg,
    is_cut_short,
    jpeg_size,
)

MAX_ITERATION_GAP_S = 30.0
"""How long a plain iteration waits for a lost device."""

MAX_FIRST_AGE_S = 0.5
"""The frame of the opening gives way to a newer one when it is older: a slow robot was opened."""


class LiveSource(FrameSource):
    """Frames that arrive by themselves; old ones are dropped in favour of newer ones.

    Opening waits for the first frame. `connect` opens the device, in the capture thread, so a
    driver that blocks does not block the caller; it is called again after each loss:
    `base.LiveFrames` describes what the caller sees. Identical images for `frozen_after` [s] count
    as a loss, and so do images that cannot be used for `SILENCE_S`, as they are broken or have
    another size than the first one. After a loss, it is opened again after `retry_delay` [s].
    Messages give the source's `name`: "camera 0".

    Raises
    ------
    TrackingError
        While opening: the device does not open, or delivers no image.
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
        frozen_after: float = SILENCE_S,
        retry_delay: float = RETRY_DELAY_S,
    ) -> None:
        self._name = name
        self._clock = clock
        self._timeline = Timeline()
        self._count = 0
        self._closed = False
        self._first_size: tuple[int, int] | None = None
        self._unusable = 0
        self._unusable_since: float | None = None
        self._unusable_text = ""
        self._latencies: deque[float] = deque(maxlen=RECENT_IMAGES)
        self._capture = CaptureThread(connect, name, clock, frozen_after, retry_delay)
        try:
            self._first: Frame | None = self._wait_for_first()
        except BaseException:
            self.close()
            raise
        self.size = self._size_of(self._first.image)
        self.rate = self._capture.rate

    def __iter__(self) -> Iterator[Frame]:
        while not self._closed:
            frame = self.wait(SILENCE_S, MAX_ITERATION_GAP_S)
            if frame is not None:
                yield frame

    def wait(self, timeout: float, patience: float | None = None) -> Frame | None:
        """Wait for a new frame: see `base.LiveFrames`."""
        first, self._first = self._first, None
        if first is not None and self._clock() - first.timestamp < MAX_FIRST_AGE_S:
            return first
        frame = self._next(timeout if first is None else 0.0) or first
        if frame is None and patience is not None:
            state, since, problem = self._state()
            if state not in ("running", "closed") and self._clock() - since >= patience:
                raise TrackingError(problem)
        return frame

    @property
    def waiting(self) -> int:
        """How many frames are kept now: with any, the last one is not the newest."""
        return self._capture.waiting

    @property
    def max_waiting(self) -> int:
        """How many frames are kept until they are waited for; of more, the oldest are dropped."""
        return self._capture.max_waiting

    @max_waiting.setter
    def max_waiting(self, count: int) -> None:
        self._capture.max_waiting = count

    @property
    def health(self) -> Health:
        """The current state of the source."""
        capture = self._capture
        state, since, problem = self._state()
        return Health(
            name=self._name,
            state=state,
            since=since,
            problem=problem,
            frames=self._count,
            dropped=capture.dropped,
            unusable=self._unusable,
            gaps=capture.gaps,
            rate=capture.gauge.rate,
            latency=statistics.median(self._latencies) if self._latencies else 0.0,
            mean_queue=capture.gauge.mean_depth,
            max_queue=capture.gauge.max_depth,
            stamped_by="driver" if capture.exposure_clock.by_driver else "arrival",
            settings=capture.settings,
            frozen=capture.frozen and state in ("frozen", "recovering"),
            images_unusable=state == "lost" and problem == self._unusable_text,
        )

    def close(self) -> None:
        """Stop capturing. May be called again, and from another thread; the iteration ends."""
        self._closed = True
        self._first = None
        self._capture.stop()

    def _wait_for_first(self) -> Frame:
        while True:
            frame = self._next(POLL_S)
            if frame is not None:
                return frame
            now, capture = self._clock(), self._capture
            if capture.failed_to_open:
                raise NoCameraError(capture.problem)
            since = self._unusable_since
            if since is not None and now - since >= FIRST_IMAGE_TIMEOUT_S:
                raise NoCameraError(self._unusable_text)
            if capture.delivered:
                continue
            waited = now - capture.last_arrival
            if capture.opening and waited >= OPEN_TIMEOUT_S:
                raise NoCameraError(
                    f"{self._name} did not open within {OPEN_TIMEOUT_S:g} s: plug it in again"
                )
            if not capture.opening and waited >= FIRST_IMAGE_TIMEOUT_S:
                raise NoCameraError(self._silence_text(FIRST_IMAGE_TIMEOUT_S))

    def _next(self, timeout: float) -> Frame | None:
        began = self._clock()
        while (captured := self._capture.next(timeout)) is not None:
            frame = self._decode(captured)
            if frame is not None:
                return frame
            now = self._clock()
            if self._unusable_since is not None and now - self._unusable_since >= SILENCE_S:
                self._capture.reject(self._unusable_text)
            if now - began >= timeout:
                return None
        return None

    def _decode(self, captured: CapturedImage) -> Frame | None:
        jpeg = captured.data if isinstance(captured.data, bytes) else None
        image = self._pixels(captured.data)
        now = self._clock()
        if image is None:
            self._unusable += 1
            if self._unusable_since is None:
                self._unusable_since = now
            return None
        self._unusable_since = None
        self._first_size = self._size_of(image)
        self._latencies.append(now - captured.taken)
        stamp, index = self._timeline.stamp(captured.taken), self._count
        self._count += 1
        return Frame(image, stamp, index, jpeg, "jpeg" if jpeg else "")

    def _pixels(self, data: Image | bytes) -> Image | None:
        """Return an image as pixels; None, and why in `_unusable_text`, if it cannot be used."""
        expected = self._first_size
        if isinstance(data, bytes):
            found = jpeg_size(data)
            # What EXIF data turn upright has the same number of pixels in its header. Any other
            # number is not decoded at all.
            other = expected and found and math.prod(found) != math.prod(expected)
            image = None if other else decode_jpeg(data)
            if image is not None and is_cut_short(data, image):
                image = None
        else:
            found, image = None, data
        if image is not None:
            found = self._size_of(image)
            if expected in (None, found):
                return image
        if found is not None and math.prod(found) > MAX_IMAGE_PX:
            self._unusable_text = (
                f"{self._name} sends images that claim {found[0]}x{found[1]} pixels"
            )
        elif expected is None or found in (None, expected):
            self._unusable_text = f"{self._name} sends images that cannot be decoded"
        else:
            sizes = " to ".join(f"{width}x{height}" for width, height in (expected, found))
            self._unusable_text = (
                f"the image of {self._name} changed from {sizes}: "
                "do not rotate or reconfigure the camera while it is in use"
            )
        return None

    @staticmethod
    def _size_of(image: Image) -> tuple[int, int]:
        height, width = image.shape[:2]
        return width, height

    def _state(self) -> tuple[SourceState, float, str]:
        """Return the state, since when it lasts, and the problem.

        Silence is detected here, because the thread may be blocked in a driver.
        """
        capture, now = self._capture, self._clock()
        if self._closed:
            return "closed", capture.since, ""
        if self._unusable_since is not None and now - self._unusable_since >= SILENCE_S:
            return "lost", self._unusable_since, self._unusable_text
        if capture.state == "running":
            silence = now - capture.last_arrival
            if silence >= SILENCE_S:
                return "lost", capture.last_arrival, self._silence_text(silence)
            return "running", capture.since, ""
        elapsed = now - capture.since
        problem = capture.problem
        if not problem and capture.frozen:
            problem = (
                f"{self._name} has repeated the same image for {elapsed:.0f} s: "
                "it is covered, frozen or unplugged"
            )
        return capture.state, capture.since, problem or self._silence_text(elapsed)

    def _silence_text(self, seconds: float) -> str:
        return (
            f"{self._name} delivered no image for {seconds:.0f} s: "
            "check that it is connected and that no other program uses it"
        )
