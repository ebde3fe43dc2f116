"""The thread that captures: it opens a device, reads it, and opens it again when it was lost."""

import threading
from collections.abc import Callable
from contextlib import closing

import numpy as np

from tracking.errors import TrackingError
from tracking.sources.device import Clock, Device, Shot
from tracking.sources.health import Setting, SourceState
from tracking.sources.pictures import Picture
from tracking.sources.timing import ExposureClock, QueueGauge

SILENCE_S = 0.8
"""A live source without a new picture for so long is lost: told within a second, come what may."""

FIRST_S = 2.0
"""So long may the first picture after opening take: the camera starts its sensor."""

OPENING_S = 8.0
"""Some cameras and drivers take seconds before they can be asked for a picture at all."""

RETRY_S = 0.5
"""Between two tries to open a lost device."""

STUCK_S = 12.0
"""A thread that is so long in the driver is left behind, and another one opens the device.

More than the 10 s that OpenCV itself gives V4L2: before, the device is still held."""

LEFT_BEHIND = 3
"""No more threads than this are left behind in a driver."""

POLL_S = 0.02
"""How often a waiting side looks at the clock; a new picture wakes it at once."""


class _Reader:
    """One thread's hold on the device."""

    def __init__(self) -> None:
        self.device: Device | None = None
        self.entered: float | None = None
        """Since when the thread is inside the driver [s]; None: it is not."""


class Capture:
    """The capture thread and the one place in which the newest picture waits.

    One thread opens, reads and closes the device, and does so again and again once a first picture
    came. A driver that does not return for `STUCK_S` keeps its thread; a new one takes over, and
    the old one, should it ever return, closes what it holds and ends.
    """

    def __init__(
        self, connect: Callable[[], Device], name: str, clock: Clock, tell_frozen: bool
    ) -> None:
        self._connect, self._name, self._clock = connect, name, clock
        self._tell_frozen = tell_frozen
        self._changed = threading.Condition()
        self._stopped = threading.Event()
        self._shot: Shot | None = None
        self._last: Picture | bytes | None = None
        self._stamps, self._rejected = ExposureClock(), ""
        self._left = 0
        self.state: SourceState = "recovering"
        """What the thread knows; that nothing comes, the waiting side must see by itself."""
        self.problem = ""
        self.frozen = False
        """Whether the last loss was a picture that stood still."""
        self.since = self.heard = clock()
        self.came = False
        """Whether there ever was a picture."""
        self.rate = 30.0
        self.settings: tuple[Setting, ...] = ()
        self.gauge, self.dropped, self.gaps = QueueGauge(self.rate), 0, 0
        self._reader = self._start()

    def newest(self, timeout: float) -> Shot | None:
        """Wait for a picture newer than the last; None after `timeout` [s] or `stop`."""
        began, waited = self._clock(), timeout <= 0
        with self._changed:
            while not self._stopped.is_set():
                if self._shot is not None:
                    shot, self._shot = self._shot, None
                    return shot
                self._replace_stuck()
                if self.failed_to_open or (waited and self._clock() - began >= timeout):
                    return None
                self._changed.wait(POLL_S)
                waited = True
        return None

    @property
    def failed_to_open(self) -> bool:
        """Whether the device never gave a picture, and will not."""
        return not self.came and self.state == "lost"

    @property
    def opening(self) -> bool:
        """Whether the driver has not even answered to being opened."""
        return self._reader.device is None

    @property
    def by_driver(self) -> bool:
        """Whether the last picture bears the driver's time."""
        return self._stamps.by_driver

    def reject(self, problem: str) -> None:
        """Say that what comes is no use, so that the device is opened anew."""
        self._rejected = problem

    def stop(self) -> None:
        """End the thread, or leave it behind where its device does not answer."""
        self._stopped.set()
        with self._changed:
            self._changed.notify_all()
        device = self._reader.device
        if device is not None:
            device.interrupt()
        if self._thread is not threading.current_thread():
            self._thread.join(0.5)

    def _start(self) -> _Reader:
        reader = _Reader()
        self._reader = reader
        # A daemon, as it may be stuck in a driver when the program wants to end.
        self._thread = threading.Thread(
            target=self._run, args=(reader,), name=f"capture {self._name}", daemon=True
        )
        self._thread.start()
        return reader

    def _replace_stuck(self) -> None:
        entered = self._reader.entered
        if not self.came or entered is None or self._left >= LEFT_BEHIND:
            return
        if self._clock() - entered >= STUCK_S:
            self._left += 1
            device = self._reader.device
            self._start()
            if device is not None:
                device.interrupt()

    def _current(self, reader: _Reader) -> bool:
        return reader is self._reader and not self._stopped.is_set()

    def _run(self, reader: _Reader) -> None:
        while self._current(reader):
            reader.entered = self._clock()
            try:
                with closing(self._connect()) as device:
                    self._opened(reader, device)
                    self._read(reader, device)
                    reader.entered = self._clock()  # a dead driver may not let go either
            except TrackingError as error:
                self._lose(reader, "lost", str(error))
            except Exception as error:  # a driver may raise anything; a dead thread says nothing
                self._lose(reader, "lost", f"{self._name} failed: {error}")
            reader.device = reader.entered = None
            if not self.came:
                return  # who opens it is told, and may try another one
            self._pause(RETRY_S)

    def _pause(self, seconds: float) -> None:
        began = self._clock()
        while not self._stopped.wait(POLL_S) and self._clock() - began < seconds:
            pass

    def _opened(self, reader: _Reader, device: Device) -> None:
        with self._changed:
            reader.device = device
            if not self._current(reader):
                return
            self.rate = device.rate
            self.gauge, deepest = QueueGauge(device.rate), self.gauge.deepest
            self.gauge.deepest = deepest
            if self.came:
                self.state = "recovering"
            else:
                self.heard = self._clock()

    def _read(self, reader: _Reader, device: Device) -> None:
        quiet, limit, again = self._clock(), FIRST_S, False
        while self._current(reader):
            began = reader.entered = self._clock()
            picture = device.read()
            now = self._clock()
            reader.entered = None
            fresh = picture is not None and not (self._tell_frozen and _same(picture, self._last))
            if fresh:
                quiet, limit, again, self._last = now, SILENCE_S, True, picture
            elif self.came and now - quiet >= limit:
                state: SourceState = "lost" if picture is None else "frozen"
                self._lose(reader, state, "", quiet)
                return
            if self._rejected:
                self._lose(reader, "lost", self._rejected)
                return
            if picture is None:
                self._stopped.wait(POLL_S)  # a lost camera fails at once, again and again
            elif again:
                self._publish(reader, device, Shot(picture, now), now - began)

    def _publish(self, reader: _Reader, device: Device, shot: Shot, waited: float) -> None:
        with self._changed:
            if not self._current(reader):
                return
            arrival = shot.taken
            taken = self._stamps.stamp(arrival, device.exposed)
            self.gauge.add(waited, arrival, arrival - taken if self.by_driver else None)
            self.dropped += self._shot is not None
            self._shot, self.settings = Shot(shot.picture, taken), device.settings
            if self.state != "running":
                self.state, self.problem, self.since = "running", "", arrival
            elif arrival - self.heard >= SILENCE_S:
                self.gaps, self.since = self.gaps + 1, arrival
            self.heard, self.came = arrival, True
            self._changed.notify_all()

    def _lose(
        self, reader: _Reader, state: SourceState, problem: str, since: float | None = None
    ) -> None:
        with self._changed:
            self._rejected = ""
            if not self._current(reader):
                return
            if self.state == "running":
                self.gaps += 1
                self.since = self.heard if since is None else since
            self.state, self.problem, self.frozen = state, problem, state == "frozen"
            self._changed.notify_all()


def _same(one: Picture | bytes | None, other: Picture | bytes | None) -> bool:
    if one is None or other is None or isinstance(one, bytes) or isinstance(other, bytes):
        return one is other or (type(one) is type(other) and one == other)
    return np.array_equal(one, other)
