"""The faults of a simulated robot: repeatable, and the same in a port and in a link."""

import pytest
import serial

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol import timing
from cubeling.robot.simulators import SIMULATORS
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.faults import Faults, Outage
from cubeling.robot.simulators.faulty import MAX_INBOX_BYTES, FaultyRobot
from cubeling.robot.simulators.memory import open_simulated, simulator_of
from cubeling.robot.simulators.port import SimulatedPort

HAPPY = Emotion(0.8, 0.5)
FRAME = b"\0frame 12\0"


class Clock:
    """Virtual time."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


EVERYTHING = (
    "drop=0.05&flip=0.001&dup=0.02&split=0.1&babble=50&delay=20ms~5ms&stall=300ms/2s"
    "&unplug=3s/500ms&reboot=4s"
)


@pytest.mark.parametrize("name", SIMULATORS)
def test_the_same_seed_and_times_give_the_same_bytes(name):
    def heard(seed: int) -> list[bytes]:
        faulty = simulator_of(f"sim:{name}?{EVERYTHING}&seed={seed}")
        host, answers = HostLink(7), []
        host.port_opened(0.0)
        for step in range(1500):
            now = 0.01 * step
            host.tick(now)
            faulty.receive(host.bytes_to_send() + b"j\n" * (step % 100 == 0), now)
            answers.append(faulty.bytes_to_send())
        assert isinstance(faulty, FaultyRobot)
        assert all(faulty.counts[kind] for kind in ("stall", "unplug", "reboot"))
        return answers

    assert heard(5) == heard(5)
    assert heard(5) != heard(6)


def stalled(seconds: float) -> tuple[FaultyRobot, HostLink, float]:
    """Return a robot in the first moment of such a stall, its host, and the time."""
    faulty = FaultyRobot(Simulator(), Faults(stall=Outage(seconds, 2.0)), 1)
    host, now = HostLink(7), 0.0
    host.port_opened(now)
    while faulty.stalled_until < now:
        now = round(now + 0.01, 3)
        host.receive(faulty.bytes_to_send(), now)
        host.tick(now)
        faulty.receive(host.bytes_to_send(), now)
    return faulty, host, now


def test_a_robot_that_hangs_says_nothing_and_then_reads_what_waited():
    faulty, host, now = stalled(0.3)
    faulty.bytes_to_send()
    host.express(HAPPY)
    host.tick(now + 0.01)
    faulty.receive(host.bytes_to_send(), now + 0.01)
    faulty.advance(now + 0.25)
    assert faulty.bytes_to_send() == b""
    faulty.advance(now + 0.32)
    assert isinstance(faulty.robot, Simulator)
    assert faulty.robot.body.target == HAPPY
    assert faulty.bytes_to_send() != b""


def test_a_robot_that_hung_too_long_is_neutral_as_soon_as_it_wakes():
    faulty, _, now = stalled(1.0)
    assert isinstance(faulty.robot, Simulator)
    session = faulty.robot.link.session
    assert session
    faulty.advance(now + 0.9)
    assert faulty.robot.link.session == session
    faulty.advance(now + 1.02)
    assert faulty.robot.link.session == 0


def test_what_waits_in_a_robot_that_hangs_is_bounded():
    faulty, _, now = stalled(5.0)
    for index in range(500):
        faulty.receive(bytes(100), now + 0.005 * index)
        assert len(faulty.inbox) <= MAX_INBOX_BYTES
    assert faulty.counts["lost"] > 40_000


def test_no_fault_occurs_during_a_sleep_of_the_computer():
    faulty = FaultyRobot(Simulator(), Faults(stall=Outage(1.0, 1.0), babble=1e5), 1)
    faulty.advance(0.0)
    faulty.advance(1e9)  # at once: not a billion stalls
    assert faulty.counts["stall"] == 0


def test_a_pulled_plug_ends_the_port_until_it_is_back():
    clock = Clock()
    open_port = open_simulated("sim:cubeling?unplug=5s/500ms&seed=2", clock)
    port, ended = open_port(), None
    for _ in range(3000):
        clock.now += 0.01
        try:
            port.write(b"")
        except serial.SerialException:
            ended = clock.now
            break
    assert ended is not None
    with pytest.raises(RobotError, match="its plug is out"):
        open_port()
    clock.now = ended + 0.6
    port = open_port()
    assert port.in_waiting == 0


def test_a_plug_that_was_out_between_two_calls_has_ended_the_port_too():
    clock = Clock()
    open_port = open_simulated("sim:cubeling?unplug=100ms/1ms&seed=1", clock)
    port = open_port()
    clock.now += 5.0
    with pytest.raises(serial.SerialException, match="the plug was pulled"):
        port.read(1)


def test_a_link_outlives_unplugging_and_reboots_and_restates_the_emotion(soon):
    with robot.connect("sim:cubeling?unplug=400ms/100ms&reboot=400ms&seed=3") as dino:
        dino.express(HAPPY)
        soon(lambda: dino.telemetry.counts.sessions >= 3)
        soon(lambda: dino.telemetry.acknowledged == HAPPY)


def test_a_robot_with_faults_stands_behind_a_real_port_too(soon):
    faulty = simulator_of("cubeling?drop=0.1&flip=0.002")
    with SimulatedPort(faulty) as port, robot.connect(port.url, answer_within=5.0) as dino:
        dino.express(HAPPY)
        soon(lambda: dino.telemetry.acknowledged == HAPPY)
        soon(lambda: dino.telemetry.counts.retries > 0 or dino.telemetry.counts.crc_errors > 0)
    assert faulty.portrait()[1] in ("neutral", "happy")


def test_a_robot_whose_host_is_cut_off_is_neutral_in_time():
    faulty = FaultyRobot(Simulator(), Faults(unplug=Outage(2.0, 3.0)), 1)
    simulator, host, now = faulty.robot, HostLink(7), 0.0
    assert isinstance(simulator, Simulator)
    host.port_opened(now)
    host.express(HAPPY)
    while faulty.plugged_in:
        now += 0.001
        host.receive(faulty.bytes_to_send(), now)
        host.tick(now)
        faulty.receive(host.bytes_to_send(), now)
    assert simulator.body.target == HAPPY
    faulty.advance(now + timing.FAILSAFE_PROMISE)
    assert simulator.body.target == Emotion(0.0, 0.0)


def test_a_pulled_plug_loses_what_is_on_the_line_and_what_is_sent():
    faulty = FaultyRobot(Simulator(), Faults(delay=0.2, unplug=Outage(2.0, 3.0)), 1)
    host, now, on_the_line = HostLink(7), 0.0, 0
    host.port_opened(now)
    while True:
        now += 0.001
        faulty.advance(now)
        if not faulty.plugged_in:
            break
        host.receive(faulty.bytes_to_send(), now)
        host.tick(now)
        faulty.receive(host.bytes_to_send(), now)
        on_the_line = faulty.to_robot.in_flight
    assert on_the_line > 0
    assert faulty.to_robot.in_flight == faulty.from_robot.in_flight == 0
    faulty.receive(FRAME, now + 0.01)
    faulty.advance(now + 0.5)
    assert faulty.to_robot.in_flight == 0
    assert faulty.bytes_to_send() == b""
