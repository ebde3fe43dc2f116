"""A simulated robot with the faults that its URL names."""

from collections import Counter
from typing import Final

import numpy as np

from cubeling.robot.simulators import Simulated
from cubeling.robot.simulators.channel import FaultyChannel
from cubeling.robot.simulators.faults import Faults

POLL_INTERVAL_S: Final = 0.020
"""Longest time between two steps of the robot while it is not stalled [s]."""

MAX_INBOX_BYTES: Final = 4096
"""Bytes that wait for a stalled robot; further ones are lost, as in the buffer of a system."""

MAX_TIME_STEP_S: Final = 10.0
"""A longer time between two calls counts as sleep of the computer: no fault occurs in it [s]."""

NEVER: Final = float("inf")


class FaultyRobot:
    """A simulated robot with faults; it is itself a `Simulated`.

    All draws come from the seed: the same bytes at the same times get the same answers.
    """

    def __init__(
        self,
        robot: Simulated,
        faults: Faults,
        seed: int = 0,
        poll_interval: float = POLL_INTERVAL_S,
    ) -> None:
        self.robot = robot
        """The robot without faults."""
        self.edge = robot.edge
        self.to_robot = FaultyChannel(faults, robot.edge, (seed, 0))
        """The line to the robot."""
        self.from_robot = FaultyChannel(faults, robot.edge, (seed, 1))
        """The line from the robot."""
        self.counts: Counter[str] = Counter()
        """Number of stalls, unpluggings and reboots; bytes "lost" during stalls."""
        self.stalled_until = -NEVER
        """End of the current or the last stall [s]."""
        self._faults = faults
        self._poll_interval = poll_interval
        self._mean_intervals = [spell and spell.every for spell in (faults.stall, faults.unplug)]
        self._mean_intervals.append(faults.reboot)
        self._random = [np.random.default_rng((seed, 2, kind)) for kind in range(3)]
        self._now: float | None = None
        self.inbox = b""
        """The bytes that wait for the stalled robot."""

    @property
    def plugged_in(self) -> bool:
        """Whether the plug is in."""
        return self._replug_at == NEVER if self._now is not None else True

    @property
    def unplug_count(self) -> int:
        """How often the plug was pulled; a port opened before the last time is gone."""
        return self.counts["unplug"]

    @property
    def due(self) -> float:
        """Time of the next event if nothing is sent before [s]."""
        if self._now is None:
            return -NEVER
        return min(self._next_event(), self.from_robot.due)

    def receive(self, data: bytes, now: float) -> None:
        """Send bytes to the robot at time `now` [s]."""
        self.advance(now)
        if data:
            self.to_robot.send(data, now)
            self._advance_to(now)

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        if self._now is None or not 0 <= now - self._now <= MAX_TIME_STEP_S:
            self._restart_clock(now)
        self._advance_to(now)

    def bytes_to_send(self) -> bytes:
        """Return the bytes that have arrived from the robot, once."""
        return self.from_robot.receive(self._now) if self._now is not None else b""

    def reboot(self) -> None:
        """Restart the robot, as after a loss of power."""
        self.counts["reboot"] += 1
        self.inbox = b""
        self.stalled_until = -NEVER
        self.robot.reboot()

    def portrait(self) -> tuple[float, str]:
        """Return the mood that the robot shows, from −1 to 1, and its word."""
        return self.robot.portrait()

    def _restart_clock(self, now: float) -> None:
        """Start, or continue after a sleep of the computer: draw the times of the next events."""
        self.to_robot.clear()
        self.from_robot.clear()
        self.to_robot.cut = self.from_robot.cut = False
        self._now = now
        self.inbox = b""
        self.stalled_until = -NEVER
        self._poll_at = now
        self._stall_at = now + self._draw_interval(0)
        self._unplug_at = now + self._draw_interval(1)
        self._reboot_at = now + self._draw_interval(2)
        self._replug_at = NEVER

    def _draw_interval(self, kind: int) -> float:
        """Draw the time until the next stall (0), unplugging (1) or reboot (2) [s]."""
        mean = self._mean_intervals[kind]
        return NEVER if mean is None else float(self._random[kind].exponential(mean))

    def _next_event(self) -> float:
        return min(
            self.to_robot.due, self._poll_at, self._stall_at,
            self._unplug_at, self._replug_at, self._reboot_at,
        )  # fmt: skip

    def _advance_to(self, now: float) -> None:
        while (due := self._next_event()) <= now:
            self._process_events(due)
        self._now = now

    def _process_events(self, at: float) -> None:
        """Do everything that is due at time `at` [s]."""
        if self._unplug_at <= at or self._replug_at <= at:
            self._move_plug(at)
        if self._reboot_at <= at:
            self._reboot_at = at + self._draw_interval(2)
            self.reboot()
        if self._stall_at <= at:
            self._stall(at)
        arrived = self.to_robot.receive(at)
        if at >= self.stalled_until:
            self._poll(self.inbox + arrived, at)
            self.inbox = b""
        else:
            kept = arrived[: MAX_INBOX_BYTES - len(self.inbox)]
            self.counts["lost"] += len(arrived) - len(kept)
            self.inbox += kept
            self._poll_at = self.stalled_until

    def _poll(self, data: bytes, at: float) -> None:
        """Let the robot process its input and the time, and answer."""
        if data:
            self.robot.receive(data, at)
        else:
            self.robot.advance(at)
        answer = self.robot.bytes_to_send()
        if answer:
            self.from_robot.send(answer, at)
        self._poll_at = at + self._poll_interval

    def _stall(self, at: float) -> None:
        assert self._faults.stall is not None
        self.counts["stall"] += 1
        self.stalled_until = at + self._faults.stall.length
        self._stall_at = self.stalled_until + self._draw_interval(0)

    def _move_plug(self, at: float) -> None:
        """Pull the plug or put it in; either way the line is empty afterwards."""
        assert self._faults.unplug is not None
        pulled = self._unplug_at <= at
        if pulled:
            self.counts["unplug"] += 1
            self._replug_at, self._unplug_at = at + self._faults.unplug.length, NEVER
        else:
            self._replug_at, self._unplug_at = NEVER, at + self._draw_interval(1)
        for channel in (self.to_robot, self.from_robot):
            channel.clear()
            channel.cut = pulled
