"""The two ends of the wire in a campaign: the product's own, which report to the monitor."""

from typing import Any

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue, JointLimits
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.drivers.cubeling.scheduler import CommandScheduler, RoundTrip
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling.device import DeviceLink
from tests.campaigns.monitor import InvariantMonitor, InvariantViolationError

NEUTRAL = Emotion(0.0, 0.0)


class MonitoredReader(FrameReader):
    """Counts the frames that pass the check and were never sent."""

    def __init__(self, monitor: InvariantMonitor, way: str) -> None:
        super().__init__()
        self._monitor, self._sent = monitor, monitor.frames[way]

    def feed(self, data: bytes) -> list[bytes]:
        errors_before = self.errors
        bodies = super().feed(data)
        frames = [encode_frame(body).strip(b"\0") for body in bodies]
        self._monitor.counts["detected"] += self.errors - errors_before
        self._monitor.counts["undetected"] += sum(frame not in self._sent for frame in frames)
        return bodies


class MonitoredScheduler(CommandScheduler):
    """Reports which command is sent, and counts those that are acknowledged."""

    def __init__(self, monitor: InvariantMonitor, host: int) -> None:
        super().__init__()
        self.monitor, self.host = monitor, host
        self.idle = True

    def next(self, now: float, retry_after: float) -> m.Command | None:
        command = super().next(now, retry_after)
        if command is not None:
            self.idle = False
            self.monitor.sends(self.host, command)
        return command

    def acknowledge(self, number: int, result: int = m.RESULT_TAKEN) -> None:
        waiting = self.pending is not None
        super().acknowledge(number, result)
        if waiting and self.pending is None:
            self.idle = True
            self.monitor.counts["exchanges"] += 1


class MonitoredRoundTrip(RoundTrip):
    """Counts the heartbeats that were answered."""

    def __init__(self, monitor: InvariantMonitor) -> None:
        super().__init__()
        self.monitor = monitor

    def stop(self, count: int, now: float) -> float | None:
        waiting = self.pending
        sent = super().stop(count, now)
        self.monitor.counts["heartbeats"] += waiting - self.pending
        return sent


def monitored_host(monitor: InvariantMonitor, host: int) -> HostLink:
    """Make the host side of a link whose commands, heartbeats and frames are monitored.

    It is made as `connect` makes it, so that a restart is like that of the program.
    """
    link = DRIVERS["cubeling"].make(host, None)
    assert isinstance(link, HostLink)
    link.scheduler = MonitoredScheduler(monitor, host)
    link.round_trip = MonitoredRoundTrip(monitor)
    link.reader = MonitoredReader(monitor, "back")
    return link


class LightBody:
    """A body without physics."""

    catalogue = Catalogue(
        "Light", "campaign 1", (JointLimits("neck", -1.0, 1.0, 1.0),), ("nod", "bow"), ("purr",),
        ("neutral", "happy", "angry"),
    )  # fmt: skip

    def __init__(self, monitor: InvariantMonitor) -> None:
        self.monitor = monitor
        self.target = NEUTRAL

    def express(self, emotion: Emotion, mood: int) -> None:
        self.target = emotion

    def play(self, item: int, index: int) -> None:
        pass

    def move(self, command: m.Move) -> None:
        pass

    def refusal(self) -> int:
        return m.RESULT_TAKEN

    def stop(self) -> None:
        self.neutral()

    def neutral(self) -> None:
        self.target = NEUTRAL
        self.monitor.goes_neutral()

    def state(self) -> m.State:
        valence, arousal = self.target.valence, self.target.arousal
        nothing, joints = m.NOTHING, (0.0,) * m.JOINTS_MAX
        return m.State(0, 0, 0, valence, arousal, 1.0, 0, nothing, nothing, joints)


class MonitoredLink(DeviceLink):
    """The robot side of a link, which reports what takes effect and when it last heard its host."""

    def __init__(self, monitor: InvariantMonitor) -> None:
        self.light = LightBody(monitor)
        super().__init__(self.light)
        self.monitor = monitor
        self.heard = monitor.now
        self.reader = MonitoredReader(monitor, "there")

    def tick(self, now: float) -> None:
        session = self.session
        super().tick(now)
        if session and not self.session:
            self.monitor.falls_silent(self.heard, now)
            if self.light.target != NEUTRAL:
                raise InvariantViolationError("the failsafe does not lead to neutral")

    def process(self, session: int, message: Any, now: float) -> None:
        if isinstance(message, m.Hello) or (session and session == self.session):
            self.heard = now
        super().process(session, message, now)

    def execute(self, command: m.Command) -> int:
        self.monitor.carries_out(self.host, command)
        return super().execute(command)


class LightRobot:
    """The campaign's robot: a `Simulated`."""

    edge = b"\0"

    def __init__(self, monitor: InvariantMonitor) -> None:
        self.monitor = monitor
        self.link = MonitoredLink(monitor)

    def receive(self, data: bytes, now: float) -> None:
        self.monitor.now = now
        self.link.receive(data, now)
        self.monitor.looks(self.link, now)

    def advance(self, now: float) -> None:
        self.monitor.now = now
        self.link.tick(now)
        self.monitor.looks(self.link, now)

    def bytes_to_send(self) -> bytes:
        data = self.link.bytes_to_send()
        if data:
            self.monitor.sends_bytes("back", data)
        return data

    def reboot(self) -> None:
        self.monitor.reboots()
        self.link = MonitoredLink(self.monitor)

    def portrait(self) -> tuple[float, str]:
        return self.link.light.target.valence, "light"
