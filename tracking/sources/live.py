"""A thread that captures, and a source that hands out the newest picture or says what is wrong."""

import threading
from collections.abc import Callable, Iterator
from typing import Protocol, TypeAlias

import numpy as np

from tracking.errors import TrackingError
from tracking.frame import Frame
from tracking.sources.base import FrameSource, Timeline
from tracking.sources.pictures import Picture, decode_jpeg

SILENCE_S = 2.0
"""A live source without a new frame for so long is gone."""

OPENING_S = 8.0
"""Some cameras and drivers take seconds before they can be asked for a frame at all."""

POLL_S = 0.02
"""How often the waiting side looks at the clock; a new picture wakes it at once."""

Clock: TypeAlias = Callable[[], float]


class Device(Protocol):
    """What pictures come from. Only the capture thread uses it, but for `interrupt`."""

    rate: float
    """Nominal rate [frames/s]."""

    def read(self) -> Picture | bytes | None:
        """Wait for the next picture: pixels or a JPEG; None where there was none.

        Raises
        ------
        TrackingError
            There will be no more.
        """
        ...

    def interrupt(self) -> None:
        """Make a waiting `read` return soon, if that can be done. Called from another thread."""
        ...

    def close(self) -> None:
        """Let go of the device."""
        ...


class LiveSource(FrameSource):
    """Frames that arrive by themselves; late ones are dropped for newer ones.

    Opening waits for the first frame. The device is opened, read and closed by one thread, so that
    a driver that never returns blocks nobody: the thread is left behind, and the error is said.

    Parameters
    ----------
    connect
        Opens the device; called in the capture thread.
    name
        How errors call the source: "camera 0".
    clock
        Seconds; stamps the frames, and tells when the source fell silent.
    tell_frozen
        Whether the very same picture for `SILENCE_S` counts as none.

    Raises
    ------
    TrackingError
        While opening and while iterating: nothing new came for `SILENCE_S`, or the device said why.
    """

    live = True
    duration = None
    intrinsics = None

    def __init__(
        self, connect: Callable[[], Device], name: str, clock: Clock, *, tell_frozen: bool = True
    ) -> None:
        self._name = name
        self._clock = clock
        self._timeline = Timeline()
        self._count = 0
        self._capture = _Capture(connect, name, clock, tell_frozen)
        try:
            self._first = self._next()
        except BaseException:
            self.close()
            raise
        assert self._first is not None  # only `close` ends a live source, and nobody has it yet
        height, width = self._first.image.shape[:2]
        self.size = (width, height)
        self.rate = self._capture.rate

    def __iter__(self) -> Iterator[Frame]:
        if self._first is not None:
            first, self._first = self._first, None
            yield first
        while (frame := self._next()) is not None:
            if frame.image.shape[1::-1] != self.size:
                width, height = frame.image.shape[1::-1]
                raise TrackingError(
                    f"the picture of {self._name} changed from {self.size[0]}x{self.size[1]} to "
                    f"{width}x{height}: keep the camera as it was when you started"
                )
            yield frame

    def close(self) -> None:
        """Stop capturing. Safe to call again, and from another thread; the iteration then ends."""
        self._first = None
        self._capture.stop()

    def _next(self) -> Frame | None:
        started = self._clock()
        while (shot := self._capture.newest()) is not None:
            picture, seconds = shot
            image = decode_jpeg(picture) if isinstance(picture, bytes) else picture
            if image is not None:
                jpeg = picture if isinstance(picture, bytes) else None
                stamp, index = self._timeline.stamp(seconds), self._count
                self._count += 1
                return Frame(image, stamp, index, jpeg, "jpeg" if jpeg else "")
            if seconds - started >= SILENCE_S:
                raise TrackingError(f"{self._name} sends pictures that cannot be decoded")
        return None


class _Capture:
    """The thread and the one place in which the newest picture waits."""

    def __init__(
        self, connect: Callable[[], Device], name: str, clock: Clock, tell_frozen: bool
    ) -> None:
        self._connect, self._name, self._clock = connect, name, clock
        self._tell_frozen = tell_frozen
        self._changed = threading.Condition()
        self._stopped = threading.Event()
        self._device: Device | None = None
        self._shot: tuple[Picture | bytes, float] | None = None
        self._error: TrackingError | None = None
        self._heard = clock()
        self.rate = 30.0
        # A daemon, as it may be stuck in a driver when the program wants to end.
        self._thread = threading.Thread(target=self._run, name=f"capture {name}", daemon=True)
        self._thread.start()

    def newest(self) -> tuple[Picture | bytes, float] | None:
        """Wait for a picture newer than the last; None after `stop`."""
        with self._changed:
            while not self._stopped.is_set():
                if self._shot is not None:
                    shot, self._shot = self._shot, None
                    return shot
                if self._error is not None:
                    raise self._error
                self._check_silence()
                self._changed.wait(POLL_S)
        return None

    def stop(self) -> None:
        """End the thread, or leave it behind where its device does not answer."""
        self._stopped.set()
        with self._changed:
            self._changed.notify_all()
        if self._device is not None:
            self._device.interrupt()
        if self._thread is not threading.current_thread():
            self._thread.join(0.5)

    def _check_silence(self) -> None:
        limit = OPENING_S if self._device is None else SILENCE_S
        if self._clock() - self._heard < limit:
            return
        if self._device is None:
            raise TrackingError(f"{self._name} did not open within {limit:g} s: plug it in again")
        raise TrackingError(
            f"{self._name} gave no picture for {limit:g} s: "
            "check that it is connected and that no other program uses it"
        )

    def _run(self) -> None:
        device = None
        try:
            device = self._connect()
            self._heard = self._clock()
            self.rate = device.rate
            self._device = device
            self._read(device)
        except TrackingError as error:
            self._fail(error)
        except Exception as error:  # a driver may raise anything; a dead thread would say nothing
            self._fail(TrackingError(f"{self._name} failed: {error}"))
        finally:
            if device is not None:
                device.close()

    def _read(self, device: Device) -> None:
        last: Picture | bytes | None = None
        changed = self._heard
        while not self._stopped.is_set():
            picture = device.read()
            now = self._clock()
            if picture is None:
                self._stopped.wait(POLL_S)  # a lost camera fails at once, again and again
                continue
            if last is None or not _same(picture, last):
                last, changed = picture, now
            elif self._tell_frozen and now - changed >= SILENCE_S:
                raise TrackingError(
                    f"{self._name} has given the very same picture for {SILENCE_S:g} s: "
                    "it is covered, frozen or unplugged"
                )
            with self._changed:
                self._shot, self._heard = (picture, now), now
                self._changed.notify_all()

    def _fail(self, error: TrackingError) -> None:
        with self._changed:
            self._error = error
            self._changed.notify_all()


def _same(one: Picture | bytes, other: Picture | bytes) -> bool:
    if isinstance(one, bytes) or isinstance(other, bytes):
        return one is other or (type(one) is type(other) and one == other)
    return np.array_equal(one, other)
