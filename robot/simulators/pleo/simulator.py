"""The simulated Pleo on its console, with the quirks of the real one."""

import heapq
from collections import deque

import numpy as np

from cubeling.affect.words import WORD_PLACES
from cubeling.robot.simulators.pleo.body import PleoBody
from cubeling.robot.simulators.pleo.monitor import Monitor

MAX_TIME_STEP_S = 2.0
"""A longer time between two calls counts as sleep of the computer and is skipped [s]."""

BOOT_RANGE_S = (2.0, 4.0)
"""Shortest and longest silence after a start [s]."""

BOOT_TEXTS = (
    "Booting ...\r\nself test: ok\r\n",
    "\r\nPleo Monitor v1.1 (simulated)\r\nType help\r\n",
    "\r\nLife OS\r\n3 files on a:\r\nready\r\n",
)
"""The text after a start; the seed chooses one."""

MONITOR_INTERVAL_S = 3.0
"""Mean time between unsolicited monitor lines [s]."""

APPLICATION_INTERVAL_S = 0.4
"""The same while Pleo's own behaviour is running [s]."""

SLOW_PROBABILITY = 0.01
"""Probability that an answer takes `SLOW_RANGE_S` longer; never the answer to an empty line."""

SLOW_RANGE_S = (0.5, 4.0)
"""Shortest and longest additional time of a slow answer [s]."""

ERROR_PROBABILITY = 0.02
"""Probability that an answer contains the text of an unrelated error."""

MAX_LINE_CHARS = 128
"""Longest line that the console accepts [characters]."""

MAX_UNREAD_BYTES = 65536
"""Most bytes that wait for the host; further ones are lost."""


class PleoSimulator:
    """A simulated Pleo with the protocol "pleo"; a `Simulated`.

    At first it shows its prompt, and its own behaviour is running.
    """

    body: PleoBody
    """The body, for inspection."""

    monitor: Monitor
    """The commands of the console."""

    _unsolicited_at: float
    _done_at: float

    edge = b"\n"
    """Every command and every line of an answer ends with it."""

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)
        self.slow_probability = SLOW_PROBABILITY
        """Probability that an answer is slow."""
        self.error_probability = ERROR_PROBABILITY
        """Probability that an answer contains an unrelated error."""
        self.echo = bool(self._random.random() < 0.5)
        """Whether it echoes its input."""
        self._boot_text = BOOT_TEXTS[int(self._random.integers(len(BOOT_TEXTS)))]
        self.violations: deque[tuple[float, str]] = deque(maxlen=1000)
        """The texts received before the prompt, each with its time [s]; empty lines are allowed."""
        self.executed: deque[str] = deque(maxlen=1000)
        """The lines that it has executed, except empty ones."""
        self._last: float | None = None  # the caller's time
        self._now = 0.0  # its own
        self._power_up(float(self._random.uniform(0.5, 1.0)))
        self._send("> ", 0.0)

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        self.advance(now)
        self._take_input(data.decode("latin-1").replace("\r", ""))

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        data = b""
        while self._queue and self._queue[0][0] <= self._now:
            data += heapq.heappop(self._queue)[2]
        self._waiting -= len(data)
        return data

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        passed = 0.0 if self._last is None else min(max(now - self._last, 0.0), MAX_TIME_STEP_S)
        self._last = now
        end = self._now + passed
        while (due := min(self._unsolicited_at, self._done_at)) <= end:
            self._now = max(self._now, due)
            self.body.advance(self._now)
            if self._unsolicited_at <= self._done_at:
                self._send_unsolicited()
            else:
                self._done_at, self._booting = float("inf"), False
                self._execute_line()
        self._now = end
        self.body.advance(end)

    def reboot(self) -> None:
        """Restart, as after a loss of power: silence, the boot text, and Pleo's own behaviour."""
        self._power_up(self.body.battery)
        self._booting = True
        self._answer(self._boot_text, float(self._random.uniform(*BOOT_RANGE_S)))

    def _power_up(self, battery: float) -> None:
        self.body = PleoBody(battery, self._now)
        self.monitor = Monitor(self.body, self._random)
        self.input_line = ""
        """The line that is being received, at most `MAX_LINE_CHARS`."""
        self._queue: list[tuple[float, int, bytes]] = []
        self._waiting = self._sequence = 0
        self._done_at = float("inf")  # when the answer ends; never, if none is on its way
        self._booting = False
        self._unsolicited_at = self._now

    def portrait(self) -> tuple[float, str]:
        """Return the mood that it shows, from −1, angry, to 1, happy, and its word."""
        word = self.body.mood
        return WORD_PLACES[word][0], word

    @property
    def busy(self) -> bool:
        """Whether the prompt after an answer, or after the boot, is still to come."""
        return self._done_at < float("inf")

    def _take_input(self, text: str) -> None:
        """Process input; a busy console loses half of its characters."""
        if self._booting:
            return
        if self.busy:
            if text.strip():
                self.violations.append((self._now, text[:MAX_LINE_CHARS]))
            text = "".join(char for char in text if self._random.random() < 0.5)
        self.input_line = (self.input_line + text)[:MAX_LINE_CHARS]
        if not self.busy:
            self._execute_line()

    def _execute_line(self) -> None:
        """Execute the first line of the input, if it is complete."""
        line, end, rest = self.input_line.partition("\n")
        if not end:
            if len(line) == MAX_LINE_CHARS:
                self.input_line = ""  # longer than any command
            return
        self.input_line = ""
        if line.strip():
            self.executed.append(line)
        self._send(f"{line if self.echo else ''}\r\n", self._now)  # off the prompt's line
        lines, took = self.monitor.execute(line)
        if line.strip() and self._random.random() < self.slow_probability:
            took += float(self._random.uniform(*SLOW_RANGE_S))
        self._answer("".join(f"{text}\r\n" for text in lines), took)
        self._take_input(rest)

    def _answer(self, text: str, took: float) -> None:
        """Send a text in pieces, and the prompt after `took` [s]."""
        if self._random.random() < self.error_probability:
            cut = int(self._random.integers(len(text) + 1))
            text = f"{text[:cut]}MC_GetMotorStatus Failed: joint 14\r\n{text[cut:]}"
        cuts = sorted(self._random.integers(len(text) + 1, size=3).tolist())
        times = sorted(self._random.uniform(0.7 * took, took, size=5).tolist())
        ends = [*cuts, len(text)]
        for start, end, time in zip([0, *cuts], ends, times, strict=False):
            self._send(text[start:end], self._now + time)
        self._send(">", self._now + times[-1])
        self._send(" ", self._now + took)
        self._done_at = self._now + took

    def _send(self, text: str, time: float) -> None:
        data = text.encode("latin-1", "replace")
        if data and self._waiting + len(data) <= MAX_UNREAD_BYTES:
            self._waiting += len(data)
            self._sequence += 1
            heapq.heappush(self._queue, (time, self._sequence, data))

    def _send_unsolicited(self) -> None:
        """Send an unsolicited line."""
        running = self.monitor.application
        every = APPLICATION_INTERVAL_S if running else MONITOR_INTERVAL_S
        self._unsolicited_at = self._now + float(self._random.exponential(every))
        if self._booting:
            return
        kind = int(self._random.integers(3 if running else 2))
        number = int(self._random.integers(16))
        if kind == 2:
            self.body.move(number % len(self.body.angles), float(self._random.uniform(-90, 90)))
            self._send(f"app: drive {number} satisfied\r\n", self._now)
        else:
            self._send(f"mu: {('sensor', 'joint')[kind]} {number} = {self._now:.0f}\r\n", self._now)
