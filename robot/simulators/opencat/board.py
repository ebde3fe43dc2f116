"""The board: reads one line after the other, does what it says, and echoes its token when done.

It has the habits that the facts report: echoes that come late, text in between, lines that run
together while it is busy, skills broken off by the next byte, brown-outs, and nothing to tell a
wrong line from a right one. Everything is drawn from a seed, and no clock is read.
"""

from collections import deque
from collections.abc import Callable

import numpy as np

from robot.simulators.opencat.habits import Habits
from robot.simulators.opencat.interpreter import Interpreter, Job
from robot.simulators.opencat.skills import SKILLS
from robot.simulators.opencat.startup import QUESTION, Spoken, startup

LINE_TIMEOUT = 0.010
"""A line that does not end is taken after so long a pause [s]."""

UNREAD_MAX = 65536
"""Most bytes that wait to be read; a board says more to nobody."""

Event = tuple[float, Callable[[float], None]]
"""When something happens [s], and what."""

LOG_KEPT = 500
"""How many of the lines taken are remembered."""


class Board:
    """A simulated OpenCat board with its robot.

    Parameters
    ----------
    random
        Draws what happens.
    model, version
        What "?" is answered with.
    habits
        How ugly it is.
    new_board
        Whether it asks, at its first start, whether to erase its calibration.
    """

    def __init__(
        self,
        random: np.random.Generator,
        model: str = "Bittle X",
        version: str = "B10_241013",
        habits: Habits | None = None,
        new_board: bool = False,
    ) -> None:
        self.habits = habits or Habits()
        """How ugly it is."""
        self.log: deque[tuple[float, str]] = deque(maxlen=LOG_KEPT)
        """When which line was taken, as it was read."""
        self.lost = 0
        """Bytes that came while too many waited."""
        self.starts = 0
        """How often it has started."""
        self._random, self._model, self._version = random, model, version
        self._interpreter = Interpreter(random, (model, version), self.habits, self._say)
        self.body = self._interpreter.body
        """The robot."""
        self.disasters = self._interpreter.disasters
        """Lines that calibrate, write memory or the like."""
        self._new_board = new_board
        self._now: float | None = None
        self._lived = 0.0
        self._out = bytearray()
        self._forget()

    def _forget(self) -> None:
        self._startup: deque[Spoken] = deque()
        self._speaks_at = 0.0
        self._asks = False
        self._input = bytearray()
        self._input_at = 0.0
        self._job: Job | None = None
        self._interpreter.rested, self._interpreter.low_power = True, False
        self._noise_at = self._low_at = self._warn_at = float("inf")
        self._low_until = 0.0

    # --- Its ends --------------------------------------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line."""
        self.advance(now)
        if not data:
            return
        if self._asks:
            self._be_answered(data, now)
            return
        room = self.habits.buffer - len(self._input)
        self.lost += max(0, len(data) - room)
        self._input += data[:room]
        self._input_at = now
        if self._job is not None and self._job.skill and self.habits.merges:
            self._job = None  # broken off, and never echoed
        self.advance(now)

    def bytes_to_send(self) -> bytes:
        """Return what it has said, once."""
        data = bytes(self._out)
        self._out.clear()
        return data

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""
        if self._now is None:
            self._lived = now
            self._start(now)
        while True:
            at, happens = min(self._coming(), key=lambda event: event[0])
            if at > now:
                break
            self._lived = max(at, self._lived)  # what had to wait happens later than it was due
            happens(self._lived)
        self._now = now

    def start_again(self) -> None:
        """Lose power and come back."""
        self.body.let_go(self._now or 0.0)
        self._now = None

    # --- What happens next -----------------------------------------------------------------------

    def _coming(self) -> list[Event]:
        if self._asks:
            return [(float("inf"), self._start)]
        if self._startup:
            return [(self._speaks_at, self._speak)]
        coming: list[Event] = [(self._low_at, self._run_low), (self._warn_at, self._warn)]
        if self._job is not None:
            coming.append((self._job.ends, self._finish))
            return coming
        if self._input:
            whole = self._input.endswith(b"\n")
            coming.append((self._input_at + (0.0 if whole else LINE_TIMEOUT), self._read))
        coming.append((self._noise_at, self._be_restless))
        return coming

    def _start(self, now: float) -> None:
        self._forget()
        self.starts += 1
        self.body.let_go(now)
        asks = self._new_board and self.starts == 1
        self._startup.extend(startup(self._random, self._model, self._version, asks))
        self._speaks_at = now + self._startup[0].after

    def _speak(self, now: float) -> None:
        spoken = self._startup.popleft()
        self._out += spoken.text.encode("latin-1")
        self._asks = QUESTION in spoken.text
        if self._startup:
            self._speaks_at = now + self._startup[0].after
        else:
            self._low_at = now + self.habits.battery_lasts
            self._noise_at = now + self._pause()

    def _be_answered(self, data: bytes, now: float) -> None:
        if data[:1] in b"Yy":
            self.disasters.append("Y")
        self._asks = False
        self._speaks_at = now + 0.1

    def _pause(self) -> float:
        restless = self.habits.restless
        return float(self._random.exponential(restless)) if restless else float("inf")

    def _be_restless(self, now: float) -> None:
        """Say something about sensors; now and then fall over and get up."""
        self._noise_at = now + self._pause()
        if self._interpreter.rested or self._random.random() < 0.9:
            yaw, pitch, roll = self._random.normal(0.0, 20.0, 3).tolist()
            self._say(f"{yaw:.2f}\t{pitch:.2f}\t{roll:.2f}")
            return
        self._say("EXCEPTION: Fall over")
        seconds = self.body.take(SKILLS["up"], now) + 1.5
        self._job = Job(now + seconds, lambda _: self._say("k"), skill=True)

    def _run_low(self, now: float) -> None:
        self._low_at, self._low_until, self._warn_at = float("inf"), now + 600.0, now

    def _warn(self, now: float) -> None:
        self._interpreter.low_power = now < self._low_until
        if self._interpreter.low_power:
            self._say("Low power: 6.71V. The robot won't move.")
            self.body.let_go(now)
            self._warn_at = now + 10.0
        else:
            self._say("Got 8.10 V power")
            self._warn_at, self._low_at = float("inf"), now + self.habits.battery_lasts

    def _finish(self, now: float) -> None:
        assert self._job is not None
        job, self._job = self._job, None
        job.finish(now)

    # --- Lines -----------------------------------------------------------------------------------

    def _read(self, now: float) -> None:
        """Take a line, or all that has run together, and begin what it says."""
        end = len(self._input)
        if not self.habits.merges:
            end = self._input.find(b"\n") + 1 or end
        text = self._input[:end].decode("latin-1").removesuffix("\n")
        del self._input[:end]
        if not text:
            return
        self.log.append((now, text))
        late = float(self._random.uniform(0.002, 0.030))
        if self._random.random() < self.habits.slow:
            late += float(self._random.uniform(0.5, 1.5))
        self._job = Job(now + late, lambda at: self._do(text, at))

    def _do(self, text: str, now: float) -> None:
        self._job = self._interpreter.do(text, now, brown_out=self._start)

    def _say(self, text: str) -> None:
        if len(self._out) < UNREAD_MAX:
            self._out += f"{text}\r\n".encode("latin-1")
