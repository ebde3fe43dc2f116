"""A whole simulated Pleo on its console, with the ugly parts, in virtual or in real time."""

import heapq
from collections import deque
from typing import NamedTuple

import numpy as np

from affect.words import PLACES
from robot.simulators.pleo.body import PleoBody
from robot.simulators.pleo.monitor import Monitor

GAP_MAX = 2.0
"""A longer time between two calls is taken for sleep, and left out [s]."""

BOOT = (2.0, 4.0)
"""How long Pleo is silent after it got power [s]."""

BOOT_TEXTS = (
    "Booting ...\r\nself test: ok\r\n",
    "\r\nPleo Monitor v1.1 (simulated)\r\nType help\r\n",
    "\r\nLife OS\r\n3 files on a:\r\nready\r\n",
)
"""What it says then; which one, the seed says."""

CHATTER_EVERY = 3.0
"""Monitor lines come this often in the mean [s]."""

BABBLE_EVERY = 0.4
"""Pleo's own behaviour says something this often in the mean [s]."""

SLOW_CHANCE = 0.01
"""So many answers take `SLOW` longer; never that to an empty line, for there is nothing to do."""

SLOW = (0.5, 4.0)
"""How much longer [s]."""

FAULT_CHANCE = 0.02
"""So many answers hold the text of an error that has nothing to do with them."""

INPUT_MAX = 128
"""Longest line that the console takes [characters]."""

WAITING_MAX = 65536
"""Most bytes that wait to be read; a client that does not read loses the rest."""


class Violation(NamedTuple):
    """Something typed while the console was busy."""

    time: float
    """When [s], by the simulator's own clock."""

    text: str
    """What."""


class PleoSimulator:
    """A simulated Pleo that speaks the protocol "pleo".

    It has no clock: it lives until the time that it is told. At first it has been on for a while:
    its prompt stands, and its own behaviour runs.

    Parameters
    ----------
    seed
        Of everything in it that is drawn.
    """

    body: PleoBody
    """The body, for those who want to look inside."""

    monitor: Monitor
    """What obeys."""

    _chatters_at: float
    _done_at: float

    edge = b"\n"
    """Every command ends with it, and so does every line of an answer."""

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)
        self.slow_chance = SLOW_CHANCE
        """So many answers are slow."""
        self.fault_chance = FAULT_CHANCE
        """So many answers hold an error text."""
        self.echo = bool(self._random.random() < 0.5)
        """Whether it repeats what is typed."""
        self._boot_text = BOOT_TEXTS[int(self._random.integers(len(BOOT_TEXTS)))]
        self.violations: deque[Violation] = deque(maxlen=1000)
        """Everything but empty lines that was typed before the prompt."""
        self.obeyed: deque[str] = deque(maxlen=1000)
        """The lines that it was given, empty ones left out."""
        self._last: float | None = None  # the caller's time
        self._now = 0.0  # its own
        self._power_up(float(self._random.uniform(0.5, 1.0)))
        self._say("> ", 0.0)

    # --- The line ------------------------------------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        self.advance(now)
        self._type(data.decode("latin-1").replace("\r", ""))

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        data = b""
        while self._queue and self._queue[0][0] <= self._now:
            data += heapq.heappop(self._queue)[2]
        self._waiting -= len(data)
        return data

    # --- Time ----------------------------------------------------------------------------------

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""
        passed = 0.0 if self._last is None else min(max(now - self._last, 0.0), GAP_MAX)
        self._last = now
        end = self._now + passed
        while (due := min(self._chatters_at, self._done_at)) <= end:
            self._now = max(self._now, due)
            self.body.live(self._now)
            if self._chatters_at <= self._done_at:
                self._chatter()
            else:
                self._done_at, self._booting = float("inf"), False
                self._obey_line()
        self._now = end
        self.body.live(end)

    def reboot(self) -> None:
        """Lose power and come back: silence, the boot's text, and its own behaviour."""
        self._power_up(self.body.battery)
        self._booting = True
        self._answer(self._boot_text, float(self._random.uniform(*BOOT)))

    def _power_up(self, battery: float) -> None:
        self.body = PleoBody(battery, self._now)
        self.monitor = Monitor(self.body, self._random)
        self._input = ""
        self._queue: list[tuple[float, int, bytes]] = []
        self._waiting = self._count = 0
        self._done_at = float("inf")  # when the answer ends; never, if none is on its way
        self._booting = False
        self._chatters_at = self._now

    def portrait(self) -> tuple[float, str]:
        """Return what it shows now: the mood from angry, −1, to happy, 1, and the word for it."""
        word = self.body.mood
        return PLACES[word][0], word

    # --- The console ---------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether an answer, or the boot, has not ended with its prompt yet."""
        return self._done_at < float("inf")

    def _type(self, text: str) -> None:
        """Take what was typed; most of it is lost on a console that is busy."""
        if self._booting:
            return
        if self.busy:
            if text.strip():
                self.violations.append(Violation(self._now, text[:INPUT_MAX]))
            text = "".join(one for one in text if self._random.random() < 0.5)
        self._input = (self._input + text)[:INPUT_MAX]
        if not self.busy:
            self._obey_line()

    def _obey_line(self) -> None:
        """Carry out the first line that was typed, if there is a whole one."""
        line, end, rest = self._input.partition("\n")
        if not end:
            if len(line) == INPUT_MAX:
                self._input = ""  # no line is so long
            return
        self._input = ""
        if line.strip():
            self.obeyed.append(line)
        self._say(f"{line if self.echo else ''}\r\n", self._now)  # off the prompt's line
        lines, took = self.monitor.obey(line)
        if line.strip() and self._random.random() < self.slow_chance:
            took += float(self._random.uniform(*SLOW))
        self._answer("".join(f"{one}\r\n" for one in lines), took)
        self._type(rest)

    def _answer(self, text: str, took: float) -> None:
        """Say something, in pieces, and the prompt after `took` [s]."""
        if self._random.random() < self.fault_chance:
            cut = int(self._random.integers(len(text) + 1))
            text = f"{text[:cut]}MC_GetMotorStatus Failed: joint 14\r\n{text[cut:]}"
        cuts = sorted(self._random.integers(len(text) + 1, size=3).tolist())
        times = sorted(self._random.uniform(0.7 * took, took, size=5).tolist())
        ends = [*cuts, len(text)]
        for start, end, time in zip([0, *cuts], ends, times, strict=False):
            self._say(text[start:end], self._now + time)
        self._say(">", self._now + times[-1])
        self._say(" ", self._now + took)
        self._done_at = self._now + took

    def _say(self, text: str, time: float) -> None:
        data = text.encode("latin-1", "replace")
        if data and self._waiting + len(data) <= WAITING_MAX:
            self._waiting += len(data)
            self._count += 1
            heapq.heappush(self._queue, (time, self._count, data))

    def _chatter(self) -> None:
        """Say something that nobody asked for."""
        wild = self.monitor.application
        every = BABBLE_EVERY if wild else CHATTER_EVERY
        self._chatters_at = self._now + float(self._random.exponential(every))
        if self._booting:
            return
        kind = int(self._random.integers(3 if wild else 2))
        number = int(self._random.integers(16))
        if kind == 2:
            self.body.move(number % len(self.body.angles), float(self._random.uniform(-90, 90)))
            self._say(f"app: drive {number} satisfied\r\n", self._now)
        else:
            self._say(f"mu: {('sensor', 'joint')[kind]} {number} = {self._now:.0f}\r\n", self._now)
