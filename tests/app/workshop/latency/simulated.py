"""A screen and a camera that sees it, in virtual time, with a delay that is known."""

from types import SimpleNamespace

import cv2
import numpy as np

from cubeling.app.workshop.latency.pattern import SIZE_PX as PATTERN_SIZE_PX
from cubeling.tracking import Frame, FrameSource, Health, Intrinsics

SIZE = (384, 216)


class SimulatedClock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class SimulatedScreen:
    """Lights up so long after it was told to [s]; Ctrl-C is pressed after `ends_after` polls."""

    def __init__(self, clock, lag=0.0):
        self._clock, self._lag = clock, lag
        self.lit = []
        self.closed = False
        self.polls, self.ends_after = 0, 0
        self.context = SimpleNamespace(info={"GL_RENDERER": "a graphics card"})

    def show_pattern(self, picture):
        self._clock.now += 0.002  # drawing and swapping
        self.lit.append((self._clock.now + self._lag, picture))

    def poll(self):
        self.polls += 1
        if self.polls == self.ends_after:
            raise KeyboardInterrupt

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.closed = True


class SimulatedCamera(FrameSource):
    """Exposes row after row, and delivers every frame a while after its last row.

    Parameters are in seconds; `noise` in grey levels. With `mirror`, it sees the screen in one.
    """

    intrinsics: Intrinsics | None = None
    live = True
    duration: float | None = None
    size = SIZE

    def __init__(
        self, clock, screen, *, rate=30.0, exposure=0.01, readout=0.015, delay=0.03, jitter=0.0,
        noise=3.0, mirror=False, blind=False,
    ):  # fmt: skip
        self._clock, self._screen, self.rate = clock, screen, rate
        self._exposure, self._readout, self._delay, self._jitter = exposure, readout, delay, jitter
        self._noise, self._mirror, self._blind = noise, mirror, blind
        self._random = np.random.default_rng(7)
        self._tile = self._random.standard_normal((SIZE[1] + 64, SIZE[0] + 64), np.float32)
        self._views = {}
        self._count = 0
        self._closed = False
        # Seen a little from the side.
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
        seen = np.array([(32, 24), (352, 10), (344, 200), (42, 192)], np.float32)
        drawn = corners * np.array(PATTERN_SIZE_PX, np.float32)
        self._view = cv2.getPerspectiveTransform(drawn, seen)
        middle = np.array([[PATTERN_SIZE_PX[0] / 2, 370.0]])
        self._row = cv2.perspectiveTransform(middle[None], self._view)[0, 0, 1] / SIZE[1]

    def age(self, lag):
        """Return how old the middle of the pattern is in a frame that arrives [s]."""
        return (
            lag + self._readout * (1 - self._row) + self._exposure / 2 + self._delay
            + self._jitter / 2
        )  # fmt: skip

    @property
    def health(self):
        return Health("simulated", "closed" if self._closed else "running", 0.0)

    def __iter__(self):
        while True:
            frame = self.wait(1.0)
            if frame is not None:
                yield frame

    def wait(self, timeout, patience=None):
        start = 0.0123 + self._count / self.rate
        arrival = (
            100.0 + start + self._exposure + self._readout + self._delay
            + self._jitter * self._random.uniform()
        )  # fmt: skip
        if arrival > self._clock.now + timeout:
            self._clock.now += timeout
            return None
        self._count += 1
        self._clock.now = max(self._clock.now, arrival)
        return Frame(self._picture(100.0 + start), arrival, self._count)

    def _picture(self, start):
        """Return the picture whose first row is exposed from `start` on."""
        lit = self._screen.lit
        opened = np.float64(start) + self._readout * np.arange(SIZE[1]) / SIZE[1]
        image = self._seen(len([at for at, _ in lit if at <= start]) - 1).copy()
        for number, (at, _) in enumerate(lit):
            if not start < at < start + self._readout + self._exposure:
                continue
            share = np.clip((opened + self._exposure - at) / self._exposure, 0, 1)[:, None]
            image += share.astype(np.float32) * (self._seen(number) - image)
        row, column = self._random.integers(0, 64, 2)
        image = image + self._noise * self._tile[row : row + SIZE[1], column : column + SIZE[0]]
        return cv2.cvtColor(cv2.convertScaleAbs(image), cv2.COLOR_GRAY2BGR)

    def _seen(self, number):
        """Return the screen as the lens draws it."""
        if self._blind or number < 0:
            return np.full(SIZE[::-1], 90, np.float32)
        if number not in self._views:
            # Half of it at a time, so that no pixel of the screen is left out.
            picture = cv2.resize(self._screen.lit[number][1][..., 1], None, fx=0.5, fy=0.5,
                                 interpolation=cv2.INTER_AREA)  # fmt: skip
            view = cv2.warpPerspective(picture, self._view @ np.diag([2, 2, 1]), SIZE)
            view = (cv2.GaussianBlur(view, (0, 0), 0.6) * 0.75 + 20.0).astype(np.float32)
            self._views = {number: view[:, ::-1] if self._mirror else view, **self._views}
        return self._views[number]

    def close(self):
        self._closed = True
