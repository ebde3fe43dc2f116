"""What a simulator's URL says goes wrong, goes wrong: so often, so long, and the same each time."""

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import serial
from hypothesis import given
from hypothesis import strategies as st

import robot
from robot.drivers.cubeling.host import HostLink
from robot.emotion import Emotion
from robot.errors import RobotError
from robot.protocol import timing
from robot.simulators import SIMULATORS
from robot.simulators.cubeling.simulator import Simulator
from robot.simulators.faults import OPTIONS, Faults, Spell, faults_of
from robot.simulators.faulty import INBOX_MAX, FaultyRobot
from robot.simulators.line import IN_FLIGHT_MAX, SPLIT_GAP, Line
from robot.simulators.memory import SimulatedWire, simulator_of
from robot.simulators.port import SimulatedPort

HAPPY = Emotion(0.8, 0.5)
FRAME = b"\0frame 12\0"


def line(**faults) -> Line:
    return Line(Faults(**faults), b"\0", (3, 0))


class Clock:
    """Virtual time."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


# --- What may be written -------------------------------------------------------------------------


def test_every_option_is_read_in_its_unit():
    options = {
        "drop": "0.05", "flip": ".001", "dup": "0", "split": "1", "babble": "200",
        "delay": "20ms~5ms", "stall": "1s/10s", "unplug": "30s/500ms", "reboot": "60s",
    }  # fmt: skip
    assert faults_of("sim:cubeling", options) == Faults(
        drop=0.05, flip=0.001, dup=0.0, split=1.0, babble=200.0, delay=0.02, jitter=0.005,
        stall=Spell(1.0, 10.0), unplug=Spell(0.5, 30.0), reboot=60.0,
    )  # fmt: skip
    assert set(options) == set(OPTIONS)


def test_what_is_not_said_has_its_default():
    faults = faults_of("sim:cubeling", {"stall": "1s", "unplug": "30s", "delay": "5ms"})
    assert faults == Faults(delay=0.005, stall=Spell(1.0, 20.0), unplug=Spell(1.0, 30.0))


@pytest.mark.parametrize(
    "query",
    [
        "drop=2", "drop=-0.1", "drop=", "drop=5%25", "flip=nan", "dup=inf", "split=x", "babble=-1",
        "babble=1e9", "delay=20", "delay=20m", "delay=11s", "delay=5ms~6ms", "delay=5ms~",
        "stall=0s", "stall=1s/", "stall=/5s", "unplug=1ms", "unplug=30s/2", "reboot=soon",
        "reboot=0s",
    ],
)  # fmt: skip
def test_a_wrong_value_is_refused_in_one_line_that_says_what_is_allowed(query):
    name, _, _ = query.partition("=")
    with pytest.raises(RobotError) as refused:
        simulator_of(f"sim:cubeling?{query}")
    text = str(refused.value)
    assert "\n" not in text
    assert f"{name} must be {OPTIONS[name].allowed}" in text


def test_an_unknown_option_is_refused_with_those_there_are():
    with pytest.raises(RobotError, match="'fly' is no option of a simulator; there are seed, drop"):
        simulator_of("sim:cubeling?fly=1")


def test_an_option_that_is_given_twice_is_refused():
    with pytest.raises(RobotError, match="drop is given twice"):
        simulator_of("sim:cubeling?drop=0.1&drop=0.2")


def test_without_faults_there_is_nothing_between_the_robot_and_its_port():
    assert isinstance(simulator_of("sim:cubeling?seed=3"), Simulator)
    assert isinstance(simulator_of("cubeling?drop=0"), Simulator)
    assert isinstance(simulator_of("cubeling?drop=0.1"), FaultyRobot)


def test_the_document_explains_every_option():
    text = (Path(__file__).parents[2] / "docs" / "faults.md").read_text("utf-8")
    for option in (*OPTIONS, "seed"):
        assert re.search(rf"^\| `{option}=", text, re.MULTILINE), f"{option} is not explained"


# --- The line ------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["drop", "dup", "split"])
def test_so_many_frames_are_struck(kind):
    struck = line(**{kind: 0.1})
    for index in range(5000):
        struck.send(FRAME, 0.01 * index)
    assert struck.counts[kind] == pytest.approx(500, abs=5 * np.sqrt(450))


def test_so_many_bytes_have_one_wrong_bit():
    wrong, sent = line(flip=0.01), FRAME * 2000
    wrong.send(sent, 0.0)
    arrived = wrong.receive(1.0)
    bits = [(a ^ b).bit_count() for a, b in zip(sent, arrived, strict=True)]
    assert max(bits) == 1
    assert sum(bits) == wrong.counts["flip"] == pytest.approx(200, abs=5 * np.sqrt(200))


def test_a_frame_is_lost_whole_and_its_neighbours_are_not():
    lossy = line(drop=0.5)
    frames = [b"\0" + bytes([65 + index % 26]) * 9 + b"\0" for index in range(100)]
    lossy.send(b"".join(frames), 0.0)
    arrived = [piece for piece in lossy.receive(0.0).split(b"\0") if piece]
    assert 20 < len(arrived) < 80
    assert all(b"\0" + piece + b"\0" in frames for piece in arrived)


def test_a_frame_that_is_doubled_comes_straight_behind_itself():
    double = line(dup=1.0)
    double.send(b"\0a\0", 0.0)
    double.send(b"\0b\0", 0.0)
    assert double.receive(0.0) == b"\0a\0\0a\0\0b\0\0b\0"


def test_a_text_without_an_edge_does_not_wait_for_one():
    prompt = Line(Faults(dup=1.0), b"\n", (1, 0))
    prompt.send(b"ok\n> ", 0.0)
    assert prompt.receive(0.0) == b"ok\nok\n> "


def test_everything_is_late_and_in_order():
    late, now = line(delay=0.020, jitter=0.005), 0.0
    for index in range(200):
        late.send(b"\0%d\0" % index, 0.01 * index)
    arrived, when = b"", []
    while late.due < 99:
        now = late.due
        when.append(now)
        arrived += late.receive(now)
    assert arrived == b"".join(b"\0%d\0" % index for index in range(200))
    lateness = np.array(when) - 0.01 * np.arange(200)
    assert lateness.min() < 0.017
    assert lateness.max() > 0.023
    assert lateness.min() >= 0.0149
    assert lateness.max() <= 0.0251


def test_a_split_frame_comes_in_two_pieces():
    halves = line(split=1.0)
    halves.send(FRAME, 0.0)
    first = halves.receive(0.0)
    assert 0 < len(first) < len(FRAME)
    assert first + halves.receive(SPLIT_GAP) == FRAME


def test_a_line_that_babbles_says_so_many_bytes_a_second():
    noisy = line(babble=2000.0)
    count = sum(len(noisy.receive(0.01 * step)) for step in range(2001))
    assert count == pytest.approx(40_000, rel=0.1)


def test_what_nobody_takes_is_lost_in_the_end():
    full = line(delay=5.0, babble=1e5)
    for index in range(20_000):
        full.send(FRAME, 0.0001 * index)
        assert full.in_flight <= IN_FLIGHT_MAX
    assert full.counts["lost"] > 0


harms = st.fixed_dictionaries(
    {"split": st.floats(0, 1), "delay": st.floats(0.02, 0.1), "jitter": st.floats(0, 0.02)}
)


@given(harms, st.lists(st.binary(max_size=40), max_size=20))
def test_a_line_that_only_delays_and_splits_loses_nothing_and_keeps_the_order(harm, written):
    slow = line(**harm)
    for index, data in enumerate(written):
        slow.send(data, 0.001 * index)
    assert slow.receive(1e3) == b"".join(written)


@given(st.binary(max_size=200), st.lists(st.integers(0, 200), max_size=6))
def test_it_does_not_matter_how_the_bytes_are_cut(data, places):
    whole, parts = line(drop=0.3, flip=0.05), line(drop=0.3, flip=0.05)
    whole.send(data, 0.0)
    edges = [0, *sorted(min(place, len(data)) for place in places), len(data)]
    for start, end in pairwise(edges):
        parts.send(data[start:end], 0.0)
    assert parts.receive(0.0) == whole.receive(0.0)


# --- The robot -----------------------------------------------------------------------------------

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
    faulty = FaultyRobot(Simulator(), Faults(stall=Spell(seconds, 2.0)), 1)
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
        assert len(faulty._inbox) <= INBOX_MAX
    assert faulty.counts["lost"] > 40_000


def test_after_a_sleep_nothing_has_befallen_the_robot():
    faulty = FaultyRobot(Simulator(), Faults(stall=Spell(1.0, 1.0), babble=1e5), 1)
    faulty.advance(0.0)
    faulty.advance(1e9)  # at once: not a billion stalls
    assert faulty.counts["stall"] == 0


def test_a_pulled_plug_ends_the_port_until_it_is_back():
    clock = Clock()
    wire = SimulatedWire("sim:cubeling?unplug=5s/500ms&seed=2", clock)
    port, ended = wire.open(), None
    for _ in range(3000):
        clock.now += 0.01
        try:
            port.write(b"")
        except serial.SerialException:
            ended = clock.now
            break
    assert ended is not None
    with pytest.raises(RobotError, match="its plug is out"):
        wire.open()
    clock.now = ended + 0.6
    port = wire.open()
    assert port.in_waiting == 0


def test_a_plug_that_was_out_between_two_calls_has_ended_the_port_too():
    clock = Clock()
    wire = SimulatedWire("sim:cubeling?unplug=100ms/1ms&seed=1", clock)
    port = wire.open()
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
    faulty = FaultyRobot(Simulator(), Faults(unplug=Spell(2.0, 3.0)), 1)
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
