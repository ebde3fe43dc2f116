"""The simulated Bittle and Nybble: a board that executes lines and echoes their tokens when done.

It has the known quirks of real boards: late echoes, text in between, lines merged while it is busy,
skills interrupted by the next byte, brown-outs, and no checksum.
"""

from collections import deque
from collections.abc import Callable

import numpy as np

from cubeling.robot.contract.port import SendBuffer
from cubeling.robot.simulators.opencat.body import SKILLS
from cubeling.robot.simulators.opencat.interpreter import Interpreter, Job
from cubeling.robot.simulators.opencat.quirks import CALIBRATION_QUESTION, BoardQuirks, startup

LINE_TIMEOUT_S = 0.010
"""Pause after which a line without an end is read [s]."""

MAX_UNREAD_BYTES = 65536
"""Most bytes that wait for the host; further ones are lost."""

Event = tuple[float, Callable[[float], None]]
"""The time of an event [s], and its handler."""

MAX_LOG_LINES = 500
"""Number of lines that the log keeps."""


class OpenCatSimulator(SendBuffer):
    """A simulated robot with OpenCat, by default Petoi's dog Bittle on a BiBoard; a `Simulated`.

    It reports its model and version. A new board asks at its first start whether to erase its
    calibration.
    """

    edge = b"\n"
    """Every line ends with it."""

    def __init__(
        self,
        seed: int = 0,
        model: str = "Bittle X",
        version: str = "B10_241013",
        quirks: BoardQuirks | None = None,
        new_board: bool = False,
    ) -> None:
        super().__init__()
        random = np.random.default_rng(seed)
        self.quirks = quirks or BoardQuirks()
        """The quirks of the board."""
        self.log: deque[tuple[float, str]] = deque(maxlen=MAX_LOG_LINES)
        """The lines that were read, each with its time [s]."""
        self.lost = 0
        """Bytes lost because the input buffer was full."""
        self.starts = 0
        """Number of starts."""
        self._random, self._model, self._version = random, model, version
        self._interpreter = Interpreter(random, (model, version), self.quirks, self._send_line)
        self.body = self._interpreter.body
        """The body of the robot."""
        self.forbidden = self._interpreter.forbidden
        """The forbidden lines that were received."""
        self._new_board = new_board
        self._now: float | None = None
        self._event_time = 0.0
        self._forget()

    def _forget(self) -> None:
        self._startup: deque[tuple[float, str]] = deque()
        self._startup_at = 0.0
        self._asking = False
        self._input = bytearray()
        self._input_at = 0.0
        self._job: Job | None = None
        self._interpreter.rested, self._interpreter.low_power = True, False
        self._noise_at = self._low_at = self._warn_at = float("inf")
        self._low_until = 0.0

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        self.advance(now)
        if not data:
            return
        if self._asking:
            self._take_answer(data, now)
            return
        room = self.quirks.buffer - len(self._input)
        self.lost += max(0, len(data) - room)
        self._input += data[:room]
        self._input_at = now
        if self._job is not None and self._job.skill and self.quirks.merges:
            self._job = None  # interrupted, and never echoed
        self.advance(now)

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        if self._now is None:
            self._event_time = now
            self._start(now)
        while True:
            at, handle = min(self._next_events(), key=lambda event: event[0])
            if at > now:
                break
            self._event_time = max(at, self._event_time)  # an event that had to wait is late
            handle(self._event_time)
        self._now = now

    def reboot(self) -> None:
        """Restart, as after a loss of power."""
        self.body.power_off(self._now or 0.0)
        self._now = None

    def portrait(self) -> tuple[float, str]:
        """Return the mood that it shows, from −1, angry, to 1, happy, and its word."""
        return self.body.mood

    def _next_events(self) -> list[Event]:
        if self._asking:
            return [(float("inf"), self._start)]
        if self._startup:
            return [(self._startup_at, self._send_startup)]
        events: list[Event] = [(self._low_at, self._run_low), (self._warn_at, self._warn)]
        if self._job is not None:
            events.append((self._job.ends, self._finish))
            return events
        if self._input:
            whole = self._input.endswith(b"\n")
            events.append((self._input_at + (0.0 if whole else LINE_TIMEOUT_S), self._read))
        events.append((self._noise_at, self._make_noise))
        return events

    def _start(self, now: float) -> None:
        self._forget()
        self.starts += 1
        self.body.power_off(now)
        asks = self._new_board and self.starts == 1
        self._startup.extend(startup(self._random, self._model, self._version, asks))
        self._startup_at = now + self._startup[0][0]

    def _send_startup(self, now: float) -> None:
        _, text = self._startup.popleft()
        self._out += text.encode("latin-1")
        self._asking = CALIBRATION_QUESTION in text
        if self._startup:
            self._startup_at = now + self._startup[0][0]
        else:
            self._low_at = now + self.quirks.battery_lasts
            self._noise_at = now + self._pause()

    def _take_answer(self, data: bytes, now: float) -> None:
        if data[:1] in b"Yy":
            self.forbidden.append("Y")
        self._asking = False
        self._startup_at = now + 0.1

    def _pause(self) -> float:
        restless = self.quirks.restless
        return float(self._random.exponential(restless)) if restless else float("inf")

    def _make_noise(self, now: float) -> None:
        """Send a sensor text; sometimes fall over and get up."""
        self._noise_at = now + self._pause()
        if self._interpreter.rested or self._random.random() < 0.9:
            yaw, pitch, roll = self._random.normal(0.0, 20.0, 3).tolist()
            self._send_line(f"{yaw:.2f}\t{pitch:.2f}\t{roll:.2f}")
            return
        self._send_line("EXCEPTION: Fall over")
        seconds = self.body.perform(SKILLS["up"], now) + 1.5
        self._job = Job(now + seconds, lambda _: self._send_line("k"), skill=True)

    def _run_low(self, now: float) -> None:
        self._low_at, self._low_until, self._warn_at = float("inf"), now + 600.0, now

    def _warn(self, now: float) -> None:
        self._interpreter.low_power = now < self._low_until
        if self._interpreter.low_power:
            self._send_line("Low power: 6.71V. The robot won't move.")
            self.body.power_off(now)
            self._warn_at = now + 10.0
        else:
            self._send_line("Got 8.10 V power")
            self._warn_at, self._low_at = float("inf"), now + self.quirks.battery_lasts

    def _finish(self, now: float) -> None:
        assert self._job is not None
        job, self._job = self._job, None
        job.finish(now)

    def _read(self, now: float) -> None:
        """Read a line, or everything that was merged, and start executing it."""
        end = len(self._input)
        if not self.quirks.merges:
            end = self._input.find(b"\n") + 1 or end
        text = self._input[:end].decode("latin-1").removesuffix("\n")
        del self._input[:end]
        if not text:
            return
        self.log.append((now, text))
        late = float(self._random.uniform(0.002, 0.030))
        if self._random.random() < self.quirks.slow:
            late += float(self._random.uniform(0.5, 1.5))
        self._job = Job(now + late, lambda at: self._execute(text, at))

    def _execute(self, text: str, now: float) -> None:
        self._job = self._interpreter.execute(text, now, brown_out=self._start)

    def _send_line(self, text: str) -> None:
        if len(self._out) < MAX_UNREAD_BYTES:
            self._out += f"{text}\r\n".encode("latin-1")


def nybble(seed: int = 0) -> OpenCatSimulator:
    """Return a simulated cat Nybble on a NyBoard, whose lines wait in order in a small buffer."""
    quirks = BoardQuirks(merges=False, buffer=64)
    return OpenCatSimulator(seed, "Nybble", "N12_230306", quirks)
