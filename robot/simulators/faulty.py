"""A simulated robot whose line, plug, program and power fail as its URL says."""

from collections import Counter
from typing import Final

import numpy as np

from robot.simulators.base import Simulated
from robot.simulators.faults import Faults
from robot.simulators.line import Line

LOOK_EVERY: Final = 0.020
"""The robot looks at its clock at least this often while it does not hang [s]."""

INBOX_MAX: Final = 4096
"""Bytes that wait in a robot that hangs; later ones are lost, as in an operating system's buffer
[bytes]."""

GAP_MAX: Final = 10.0
"""A longer time between two calls is taken for sleep: nothing befell the robot meanwhile [s]."""

NEVER: Final = float("inf")


class FaultyRobot:
    """A simulated robot to which things happen; itself a `Simulated`.

    All that is drawn comes from the seed, so the same bytes at the same times have the same answer.

    Parameters
    ----------
    robot
        The robot itself.
    faults
        What goes wrong.
    seed
        Of what is drawn.
    look_every
        How often the robot looks at its clock, at least [s].
    """

    def __init__(
        self, robot: Simulated, faults: Faults, seed: int = 0, look_every: float = LOOK_EVERY
    ) -> None:
        self.robot = robot
        """The robot itself."""
        self.edge = robot.edge
        self.there = Line(faults, robot.edge, (seed, 0))
        """The line to the robot."""
        self.back = Line(faults, robot.edge, (seed, 1))
        """The line from the robot."""
        self.counts: Counter[str] = Counter()
        """How often it was stalled, unplugged and rebooted; bytes "lost" while it hung."""
        self.stalled_until = -NEVER
        """When it has hung long enough, or did [s]."""
        self._faults = faults
        self._every = [spell and spell.every for spell in (faults.stall, faults.unplug)]
        self._every.append(faults.reboot)
        self._look_every = look_every
        self._random = [np.random.default_rng((seed, 2, kind)) for kind in range(3)]
        self._now: float | None = None
        self._out = b""
        self._inbox = b""

    @property
    def plugged_in(self) -> bool:
        """Whether the plug is in."""
        return self._back_in_at == NEVER if self._now is not None else True

    @property
    def pulls(self) -> int:
        """How often the plug was pulled; a port that was opened before the last is gone."""
        return self.counts["unplug"]

    @property
    def due(self) -> float:
        """When something happens next [s], if nothing is sent before."""
        if self._now is None:
            return -NEVER
        return min(self._next(), self.back.due)

    # --- What it is to those who hold it ---------------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Send it bytes at time `now` [s]."""
        self.advance(now)
        if data:
            self.there.send(data, now)
            self._live_until(now)

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""
        if self._now is None or not 0 <= now - self._now <= GAP_MAX:
            self._wake_up(now)
        self._live_until(now)

    def bytes_to_send(self) -> bytes:
        """Return what has arrived from the robot, once."""
        return self.back.receive(self._now) if self._now is not None else b""

    def reboot(self) -> None:
        """Let it lose power and come back."""
        self.counts["reboot"] += 1
        self._inbox = b""
        self.stalled_until = -NEVER
        self.robot.reboot()

    def portrait(self) -> tuple[float, str]:
        """Return what the robot shows now, and the word for it."""
        return self.robot.portrait()

    # --- What happens to it ----------------------------------------------------------------------

    def _wake_up(self, now: float) -> None:
        """Begin to live, or begin again after a sleep: draw when things will happen."""
        self.there.clear()
        self.back.clear()
        self.there.cut = self.back.cut = False
        self._now = now
        self._inbox = b""
        self.stalled_until = -NEVER
        self._look_at = now
        self._stall_at = now + self._until(0)
        self._pull_at = now + self._until(1)
        self._reboot_at = now + self._until(2)
        self._back_in_at = NEVER

    def _until(self, kind: int) -> float:
        """Draw how long it is until the next stall, unplugging or reboot [s]."""
        every = self._every[kind]
        return NEVER if every is None else float(self._random[kind].exponential(every))

    def _next(self) -> float:
        return min(
            self.there.due, self._look_at, self._stall_at,
            self._pull_at, self._back_in_at, self._reboot_at,
        )  # fmt: skip

    def _live_until(self, now: float) -> None:
        while (due := self._next()) <= now:
            self._happen(due)
        self._now = now

    def _happen(self, at: float) -> None:
        """Do all that is due at this moment [s]."""
        if self._pull_at <= at or self._back_in_at <= at:
            self._move_plug(at)
        if self._reboot_at <= at:
            self._reboot_at = at + self._until(2)
            self.reboot()
        if self._stall_at <= at:
            self._stall(at)
        arrived = self.there.receive(at)
        if at >= self.stalled_until:
            self._look(self._inbox + arrived, at)
            self._inbox = b""
        else:
            kept = arrived[: INBOX_MAX - len(self._inbox)]
            self.counts["lost"] += len(arrived) - len(kept)
            self._inbox += kept
            self._look_at = self.stalled_until

    def _look(self, data: bytes, at: float) -> None:
        """Let the robot read its line and its clock, and answer."""
        if data:
            self.robot.receive(data, at)
        else:
            self.robot.advance(at)
        answer = self.robot.bytes_to_send()
        if answer:
            self.back.send(answer, at)
        self._look_at = at + self._look_every

    def _stall(self, at: float) -> None:
        assert self._faults.stall is not None
        self.counts["stall"] += 1
        self.stalled_until = at + self._faults.stall.length
        self._stall_at = self.stalled_until + self._until(0)

    def _move_plug(self, at: float) -> None:
        """Pull the plug, or put it in again; either way, nothing is on the line then."""
        assert self._faults.unplug is not None
        pulled = self._pull_at <= at
        if pulled:
            self.counts["unplug"] += 1
            self._back_in_at, self._pull_at = at + self._faults.unplug.length, NEVER
        else:
            self._back_in_at, self._pull_at = NEVER, at + self._until(1)
        for line in (self.there, self.back):
            line.clear()
            line.cut = pulled
