"""A host, a robot and a fault mix, from event to event in virtual time."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from cubeling.robot.contract.port import READ_TIMEOUT_S
from cubeling.robot.link.exchange import REOPEN_INTERVAL_S
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.wire import MAX_FRAME
from cubeling.robot.simulators.channel import MAX_IN_FLIGHT_BYTES
from cubeling.robot.simulators.faulty import MAX_INBOX_BYTES, FaultyRobot
from tests.campaigns.fault_mixes import FaultMix
from tests.campaigns.monitor import InvariantMonitor, InvariantViolationError
from tests.campaigns.monitored import LightRobot, MonitoredScheduler, monitored_host

ROBOT_STEP_S = 0.050
"""How often the robot looks at its clock [s]; the protocol allows no more."""

MAX_SIMULTANEOUS_EVENTS = 1000
"""Most events at one moment of virtual time; more are an endless loop."""

MEAN_QUIET_S = 0.3
"""Mean length of a stretch without requests [s]."""

NEVER = float("inf")


@dataclass
class Outcome:
    """The result of one run."""

    mix: str
    """Name of the fault mix."""

    seed: int
    """Seed of all random numbers."""

    seconds: float
    """Virtual time [s]."""

    counts: Counter[str]
    """Exchanges, heartbeats, faults and so on, by name."""

    recoveries: int
    """How often the last request took effect, at first or again, in a quiet stretch."""

    worst_recovery: float
    """Longest of them [s]."""

    worst_failsafe: float
    """Longest time from the last message to neutral, of a robot that did not hang [s]."""

    latencies: list[int]
    """Histogram of the time from request to body."""

    largest: dict[str, int] = field(default_factory=dict)
    """Largest size of everything that could grow."""

    violation: str | None = None
    """The violated guarantee, and when."""


class CampaignWorld:
    """Runs a number of exchanges, or until a guarantee is violated."""

    def __init__(self, mix: FaultMix, seed: int) -> None:
        self.mix, self.seed = mix, seed
        self.random = np.random.default_rng((seed, 3))
        self.monitor = InvariantMonitor()
        self.light = LightRobot(self.monitor)
        self.faulty = FaultyRobot(self.light, mix.faults, seed, ROBOT_STEP_S)
        self.monitor.faulty = self.faulty
        self.now = 0.0
        self.events_now = 0
        self.host_number = 0
        self.port_open = False
        self.unplug_count = 0
        self.tick_at = self.request_at = self.reopen_at = 0.0
        self.host_ends_at = NEVER
        self.host = monitored_host(self.monitor, 1)
        self.recoveries, self.worst_recovery = 0, 0.0
        self.largest: dict[str, int] = {}
        self.quiet = False
        self.quiet_ends = self.untrue_since = NEVER
        self._start_host()
        self._begin_stretch()

    def run(self, exchanges: int) -> Outcome:
        """Run, and return the result, which includes a violation."""
        violation = None
        try:
            while self.monitor.counts["exchanges"] < exchanges:
                self._step()
                if self.quiet:
                    self._watch_quiet()
        except InvariantViolationError as broken:
            violation = f"at {self.now:.6f} s: {broken}"
        except Exception as error:
            violation = f"at {self.now:.6f} s: {error!r}"
        return self._outcome(violation)

    # --- From event to event -------------------------------------------------------------------

    def _step(self) -> None:
        faulty = self.faulty
        now = max(self.now, min(faulty.due, self.tick_at, self.request_at, self.host_ends_at))
        self.events_now = self.events_now + 1 if now == self.now else 0
        if self.events_now > MAX_SIMULTANEOUS_EVENTS:
            raise InvariantViolationError("virtual time stands still")
        self.now = self.monitor.now = now
        if now >= self.host_ends_at:
            self._start_host()
        faulty.advance(now)
        self._watch_plug()
        if now >= self.request_at:
            self._request()
        arrived = faulty.bytes_to_send()  # lost if nobody has the port open
        if self.port_open:
            self._talk(arrived)
        self.tick_at = now + READ_TIMEOUT_S

    def _talk(self, data: bytes) -> None:
        now = self.now
        if data:
            self.host.receive(data, now)
            if self.chasing and self.scheduler.idle:
                self._request()
        self.host.tick(now)
        out = self.host.bytes_to_send()
        if out:
            self.monitor.sends_bytes("there", out)
            self.faulty.receive(out, now)

    def _watch_plug(self) -> None:
        """Do what the link's thread does when the port vanishes and comes back."""
        if self.port_open and self.faulty.unplug_count != self.unplug_count:
            self.host.port_lost()
            self.port_open, self.reopen_at = False, self.now + REOPEN_INTERVAL_S
        if not self.port_open and self.now >= self.reopen_at:
            self._open_port()

    def _open_port(self) -> None:
        self.port_open = self.faulty.plugged_in
        self.reopen_at = self.now + REOPEN_INTERVAL_S
        if self.port_open:
            self.unplug_count = self.faulty.unplug_count
            self.host.port_opened(self.now)

    def _start_host(self) -> None:
        """Start the host's program; if one runs, end it, politely or not."""
        if self.host_number:
            self.monitor.counts["restart"] += 1
            if self.random.random() < 0.5 and self.port_open:
                self.host.close()
                farewell = self.host.bytes_to_send()
                self.monitor.sends_bytes("there", farewell)
                self.faulty.receive(farewell, self.now)
        # Far apart, as `connect` numbers programs by the moment in which they begin.
        self.host_number += int(self.random.integers(10**5, 10**6))
        self.host = monitored_host(self.monitor, self.host_number)
        assert isinstance(self.host.scheduler, MonitoredScheduler)
        self.scheduler = self.host.scheduler
        lives = self.mix.host_lives
        self.host_ends_at = self.now + float(self.random.exponential(lives)) if lives else NEVER
        self.tick_at = self.now
        self._open_port()
        if self.quiet:
            self._fall_quiet()  # the new program knows nothing of the last request

    # --- Requests to the host --------------------------------------------------------------------

    def _begin_stretch(self) -> None:
        """Request for a while: the next when the last is acknowledged, or at any time."""
        self.quiet = False
        self.chasing = bool(self.random.random() < 0.8)
        self.stretch_ends = self.now + float(self.random.uniform(0.5, 5.0))
        self.request_at = self.now

    def _request(self) -> None:
        if self.now >= self.stretch_ends:
            self._fall_quiet()
            return
        draw = float(self.random.random())
        if draw < 0.04:
            self.host.play(m.ITEM_MOTION if draw < 0.02 else m.ITEM_SOUND, 0)
        elif draw < 0.045:
            self.host.stop()
        elif draw < 0.1:
            for _ in range(3):
                self.host.express(self.monitor.asks())
        self.host.express(self.monitor.asks())
        # While it chases, an acknowledgement triggers the next request; this is for a lost one.
        gap = 0.2 if self.chasing else 0.08
        self.request_at = self.now + float(self.random.uniform(0.0, gap))

    def _fall_quiet(self) -> None:
        """Make one last request, and then none."""
        self.chasing = False
        self.host.express(self.monitor.asks())
        self.last = self.host.scheduler.state.commanded
        self.quiet, self.request_at = True, NEVER
        self.quiet_ends = self.now + float(self.random.exponential(MEAN_QUIET_S))
        self.untrue_since = self.now

    def _watch_quiet(self) -> None:
        """Check that the last request takes effect, and again whenever the robot has lost it."""
        if self.light.link.light.target == self.last == self.scheduler.state.acknowledged:
            if self.untrue_since < NEVER:
                self.recoveries += 1
                self.worst_recovery = max(self.worst_recovery, self.now - self.untrue_since)
                self.untrue_since = NEVER
            if self.now >= self.quiet_ends:
                self._measure()
                self._begin_stretch()
            return
        self.untrue_since = min(self.untrue_since, self.now)
        took = self.now - self.untrue_since
        if took > self.mix.within:
            state = self.host.state(self.now)
            raise InvariantViolationError(
                f"the last request has no effect after {took:.1f} s; the link is {state}"
            )

    # --- What could grow -------------------------------------------------------------------------

    def _measure(self) -> None:
        host, link, faulty = self.host, self.light.link, self.faulty
        sizes = {
            "frame in host": (host.reader.buffered, MAX_FRAME + 1),
            "frame in robot": (link.reader.buffered, MAX_FRAME + 1),
            "actions": (len(self.scheduler.actions), timing.ACTIONS_MAX),
            "beats": (host.round_trip.pending, 16),
            "inbox": (len(faulty.inbox), MAX_INBOX_BYTES),
            "line": (
                max(faulty.to_robot.in_flight, faulty.from_robot.in_flight),
                MAX_IN_FLIGHT_BYTES,
            ),
            "unsent": (host.unsent + link.unsent, 0),
        }
        for name, (size, most) in sizes.items():
            self.largest[name] = max(size, self.largest.get(name, 0))
            if size > most:
                raise InvariantViolationError(f"{name} has grown to {size}; {most} is allowed")

    def _outcome(self, violation: str | None) -> Outcome:
        monitor, faulty = self.monitor, self.faulty
        counts = monitor.counts + faulty.counts + faulty.to_robot.counts + faulty.from_robot.counts
        return Outcome(
            self.mix.name, self.seed, self.now, counts, self.recoveries, self.worst_recovery,
            monitor.worst_failsafe, monitor.latencies, self.largest, violation,
        )  # fmt: skip
