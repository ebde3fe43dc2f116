"""The capture thread: it opens a device, reads it, and opens it again after a loss."""

import threading
from collections import deque
from collections.abc import Callable
from contextlib import closing

import numpy as np

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.sources.capture_timing import ExposureClock, QueueGauge
from cubeling.tracking.sources.device import (
    CapturedImage,
    Clock,
    Device,
    DeviceSetting,
    SourceState,
)

SILENCE_S = 0.8
"""A source without a new image for this time is lost; so a loss is reported within a second."""

FIRST_IMAGE_TIMEOUT_S = 2.0
"""Time for the first image after opening, in which the camera starts its sensor."""

OPEN_TIMEOUT_S = 8.0
"""Time for opening a device: some cameras and drivers take seconds."""

RETRY_DELAY_S = 0.5
"""Time between two attempts to open a lost device."""

STUCK_TIMEOUT_S = 12.0
"""A thread that blocks in the driver for this time is abandoned, and another one opens the device.
More than OpenCV's own 10 s for V4L2: before, the device is still in use."""

MAX_ABANDONED_THREADS = 3
"""Maximum number of threads that are left blocking in a driver."""

POLL_S = 0.02
"""How often a waiting thread checks the clock; a new image wakes it at once."""


class _DeviceReader:
    """The device of one thread."""

    def __init__(self) -> None:
        self.device: Device | None = None
        self.blocked_since: float | None = None
        """Since when the thread is inside the driver [s]; None if it is not."""


class CaptureThread:
    """Reads a device in a thread and keeps the newest image, or the newest ones.

    The thread reopens the device `retry_delay` [s] after a loss if an image ever arrived. The same
    image again and again for `frozen_after` [s] is a loss, too. If the driver does not return for
    `STUCK_TIMEOUT_S`, another thread takes over; if the first one ever returns, it closes its
    device and ends.
    """

    def __init__(
        self,
        connect: Callable[[], Device],
        name: str,
        clock: Clock,
        frozen_after: float,
        retry_delay: float = RETRY_DELAY_S,
    ) -> None:
        self._connect, self._name, self._clock = connect, name, clock
        self._frozen_after, self._retry_delay = frozen_after, retry_delay
        self._changed = threading.Condition()
        self._stopped = threading.Event()
        self._waiting: deque[CapturedImage] = deque(maxlen=1)
        self._last: Image | bytes | None = None
        self.exposure_clock, self._rejected = ExposureClock(), ""
        # Never decreases: each is a thread and a device that the program has lost.
        self._abandoned = 0
        self.state: SourceState = "recovering"
        """As known to the thread; the caller must detect by itself that nothing arrives."""
        self.problem = ""
        self.frozen = False
        """Whether the last loss was a frozen image."""
        self.since = self.last_arrival = clock()
        self.delivered = False
        """Whether an image ever arrived."""
        self.rate = 30.0
        self.settings: tuple[DeviceSetting, ...] = ()
        self.gauge, self.dropped, self.gaps = QueueGauge(self.rate), 0, 0
        self._start()

    @property
    def waiting(self) -> int:
        """How many images wait to be fetched."""
        return len(self._waiting)

    @property
    def max_waiting(self) -> int:
        """How many images are kept until they are fetched; of more, the oldest are dropped."""
        return self._waiting.maxlen or 1

    @max_waiting.setter
    def max_waiting(self, count: int) -> None:
        if count != self.max_waiting:
            with self._changed:
                self.dropped += max(len(self._waiting) - count, 0)
                self._waiting = deque(self._waiting, maxlen=count)

    def next(self, timeout: float) -> CapturedImage | None:
        """Wait for an image newer than the last one; None after `timeout` [s] or `stop`."""
        # With a timeout of 0 it still looks once for an image that is already there.
        began, waited = self._clock(), timeout <= 0
        with self._changed:
            while not self._stopped.is_set():
                if self._waiting:
                    # Taken away, so that no image is ever returned twice.
                    return self._waiting.popleft()
                self._replace_stuck_thread()
                if self.failed_to_open or (waited and self._clock() - began >= timeout):
                    return None
                self._changed.wait(POLL_S)
                waited = True
        return None

    @property
    def failed_to_open(self) -> bool:
        """Whether the device never delivered an image, and never will."""
        return not self.delivered and self.state == "lost"

    @property
    def opening(self) -> bool:
        """Whether the driver has not finished opening the device."""
        return self._reader.device is None

    def reject(self, problem: str) -> None:
        """Report that the images are unusable, so that the device is reopened."""
        self._rejected = problem

    def stop(self) -> None:
        """End the thread, or abandon it if its device does not return."""
        self._stopped.set()
        with self._changed:
            self._changed.notify_all()
        device = self._reader.device
        if device is not None:
            device.interrupt()
        # Bounded: a thread that blocks in the driver is left behind, as it is a daemon.
        if self._thread is not threading.current_thread():
            self._thread.join(0.5)

    def _start(self) -> None:
        reader = _DeviceReader()
        self._reader = reader
        # A daemon, as it may block in a driver when the program ends.
        self._thread = threading.Thread(
            target=self._run, args=(reader,), name=f"capture {self._name}", daemon=True
        )
        self._thread.start()

    def _replace_stuck_thread(self) -> None:
        since = self._reader.blocked_since
        if not self.delivered or since is None or self._abandoned >= MAX_ABANDONED_THREADS:
            return
        if self._clock() - since >= STUCK_TIMEOUT_S:
            self._abandoned += 1
            device = self._reader.device
            self._start()
            if device is not None:
                device.interrupt()

    def _is_current(self, reader: _DeviceReader) -> bool:
        return reader is self._reader and not self._stopped.is_set()

    def _run(self, reader: _DeviceReader) -> None:
        while self._is_current(reader):
            reader.blocked_since = self._clock()
            try:
                with closing(self._connect()) as device:
                    self._set_open(reader, device)
                    self._read(reader, device)
                    reader.blocked_since = self._clock()  # closing may block, too
            except TrackingError as error:
                self._set_lost(reader, "lost", str(error))
            except Exception as error:  # drivers raise anything, and a dead thread reports nothing
                self._set_lost(reader, "lost", f"{self._name} failed: {error}")
            reader.device = reader.blocked_since = None
            if not self.delivered:
                return  # the caller gets the error and may try another device
            began = self._clock()
            # In short waits on the given clock, which tests advance faster than the system's.
            while not self._stopped.wait(POLL_S) and self._clock() - began < self._retry_delay:
                pass

    def _set_open(self, reader: _DeviceReader, device: Device) -> None:
        with self._changed:
            reader.device = device
            if not self._is_current(reader):
                return
            self.rate = device.rate
            self.gauge = QueueGauge(device.rate, self.gauge.max_depth)
            if self.delivered:
                self.state = "recovering"
            else:
                self.last_arrival = self._clock()

    def _read(self, reader: _DeviceReader, device: Device) -> None:
        if not self.frozen:  # else the first image would count as new, though it is the frozen one
            self._last = None
        last_new, any_new = self._clock(), False
        while self._is_current(reader):
            began = reader.blocked_since = self._clock()
            image = device.read()
            now = self._clock()
            reader.blocked_since = None
            patience = self._frozen_after if image is not None else SILENCE_S
            if image is not None and not _same(image, self._last):
                last_new, any_new, self._last = now, True, image
            # Before the first image a camera may take its time; the caller has a timeout of its
            # own.
            elif self.delivered and now - last_new >= (
                patience if any_new else FIRST_IMAGE_TIMEOUT_S
            ):
                state: SourceState = "lost" if image is None else "frozen"
                self._set_lost(reader, state, "", last_new)
                return
            if self._rejected:
                self._set_lost(reader, "lost", self._rejected)
                return
            if image is None:
                self._stopped.wait(POLL_S)  # reads of a lost camera fail immediately
            elif any_new:
                self._publish(reader, device, image, now, now - began)

    def _publish(
        self,
        reader: _DeviceReader,
        device: Device,
        image: Image | bytes,
        arrival: float,
        waited: float,
    ) -> None:
        with self._changed:
            if not self._is_current(reader):
                return
            taken = self.exposure_clock.stamp(arrival, device.exposed)
            age = arrival - taken if self.exposure_clock.by_driver else None
            self.gauge.add(waited, arrival, age)
            # An image that nobody fetched: the caller is slower than the camera.
            self.dropped += len(self._waiting) == self._waiting.maxlen
            self._waiting.append(CapturedImage(image, taken))
            self.settings = device.settings
            if self.state != "running":
                self.state, self.problem, self.since = "running", "", arrival
            elif arrival - self.last_arrival >= SILENCE_S:
                self.gaps, self.since = self.gaps + 1, arrival
            self.last_arrival, self.delivered = arrival, True
            self._changed.notify_all()

    def _set_lost(
        self, reader: _DeviceReader, state: SourceState, problem: str, since: float | None = None
    ) -> None:
        with self._changed:
            self._rejected = ""
            if not self._is_current(reader):
                return
            if self.state == "running":
                self.gaps += 1
                self.since = self.last_arrival if since is None else since
            self.state, self.problem, self.frozen = state, problem, state == "frozen"
            self._changed.notify_all()


def _same(one: Image | bytes, other: Image | bytes | None) -> bool:
    # A live sensor has noise: two equal images mean that the driver repeats a frozen one
    # (opencv#5746).
    if isinstance(one, bytes) or isinstance(other, bytes) or other is None:
        return type(one) is type(other) and one == other
    return np.array_equal(one, other)
