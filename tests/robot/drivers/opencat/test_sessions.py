"""What holds over long sessions with a quirky board: random by seed, in virtual time."""

import itertools
import pickle
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.drivers.opencat import tokens
from cubeling.robot.drivers.opencat.host import OpenCatHost
from cubeling.robot.drivers.opencat.settings import load_settings
from cubeling.robot.errors import RobotError
from cubeling.robot.link.transport import SpacedPort
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.opencat.quirks import BoardQuirks
from cubeling.robot.simulators.opencat.simulator import OpenCatSimulator, nybble
from tests.examples import examples, some

QUIRKY = BoardQuirks(slow=0.1, mangled=0.03, brown_outs=0.05, restless=8.0, battery_lasts=900.0)
BOARDS = {
    "bittle": lambda seed: OpenCatSimulator(seed, quirks=QUIRKY),
    "nybble": lambda seed: OpenCatSimulator(
        seed, "Nybble", "N12_230306", replace(QUIRKY, merges=False, buffer=64)
    ),
}
WORDS = ("neutral", "happy", "angry", "sad")

SETTLED_WITHIN = 45.0
"""A board as quirky as these, with power and without a broken line, shows the last mood within this
[s]: a skill of 5 s, a start of 5 s, a question of 2 s asked three times, two falls, and dwells."""


class Watch:
    """Watches a desk, and fails if the telemetry reports what is not true."""

    def __init__(self, desk) -> None:
        self.desk = desk
        self.before: Emotion | None = None
        self.claims = 0

    def __call__(self) -> None:
        now = self.desk.telemetry
        if now.acknowledged not in (None, self.before):
            log = self.desk.robot.log
            skills = [text[1:] for at, text in log if text[0] == "k" and at < self.desk.now]
            postures = {
                mood.posture: word
                for word, mood in self.desk.settings.behaviours["bittle"].moods.items()
                if word in WORDS
            }
            taken = [postures[skill] for skill in skills if skill in postures]
            wanted = {Emotion(*place, word): word for word, place in PLACES.items()}
            assert taken[-1] == wanted[now.acknowledged], "acknowledged before it was taken"
            self.claims += 1
        self.before = now.acknowledged


PLACES = {"neutral": (0.0, 0.0), "happy": (0.7, 0.6), "angry": (-0.7, 0.6), "sad": (-0.6, -0.4)}


@pytest.mark.parametrize("kind", BOARDS)
@pytest.mark.parametrize("seed", some(range(2)))
def test_an_hour_with_a_quirky_board(kind, seed, desk):
    d = desk(BOARDS[kind](seed), step=0.2)
    random = np.random.default_rng(seed)
    watch = Watch(d)
    while d.now < 3700.0:
        act = random.random()
        if act < 0.80:
            d.feel(WORDS[random.integers(len(WORDS))])
        elif act < 0.85:
            d.host.stop()
        elif act < 0.95:
            d.host.play(m.ITEM_MOTION, int(random.integers(4)))
        elif act < 0.97:
            d.robot.reboot()
        elif act < 0.99:
            d.unplug()
            d.run(float(random.uniform(0.1, 5.0)), watch)
            d.plug()
        d.run(float(random.exponential(12.0)), watch)
    d.feel("happy")
    if d.telemetry.limp:
        d.run(700.0, watch)  # the battery may be low
        d.feel("sad")
    d.settle(SETTLED_WITHIN)
    assert d.shown == {"happy": "happy", "sad": "sad"}[_word(d.telemetry.commanded)]
    assert not d.robot.forbidden
    assert d.robot.lost == 0
    assert watch.claims > 50
    assert max(len(text) for _, text in d.robot.log) < tokens.MAX_LINE_BYTES


def _word(emotion) -> str:
    return next(word for word, place in PLACES.items() if Emotion(*place, word) == emotion)


@pytest.mark.parametrize("seed", some(range(4)))
def test_lost_and_flipped_bytes_only_delay(seed, desk):
    robot = OpenCatSimulator(seed, quirks=replace(QUIRKY, battery_lasts=1e9))
    d = desk(robot, step=0.05, seed=seed, flip=0.005, drop=0.005)
    d.ready()
    random = np.random.default_rng(seed)
    for _ in range(20):
        d.feel(WORDS[random.integers(len(WORDS))])
        d.settle(4 * SETTLED_WITHIN)
        d.run(2.0)
    assert not d.robot.forbidden


@pytest.mark.slow(reason="hours pass in virtual time")
@pytest.mark.parametrize("hours", some([6, 24]))
def test_nothing_grows_in_a_day(desk, hours):
    d = desk(OpenCatSimulator(3), step=1.0)
    random = np.random.default_rng(3)
    sizes = []
    for _ in range(hours):
        for _ in range(30):
            d.feel(WORDS[random.integers(len(WORDS))])
            d.host.play(m.ITEM_MOTION, 0)
            d.run(120.0)
        d.sent.clear()
        sizes.append(len(pickle.dumps(d.host)))
    assert max(sizes[4:]) <= max(sizes[:4]) + 64
    assert d.state in ("ready", "degraded", "lost")


@settings(max_examples=examples(60))
@given(st.lists(st.tuples(st.binary(max_size=60), st.floats(0.0, 3.0)), max_size=20))
def test_garbage_raises_nothing_sends_nothing_wrong_and_is_recovered_from(garbage):
    host = OpenCatHost()
    now = 0.0
    host.port_opened(now)
    host.express(Emotion(0.7, 0.6, "happy"))
    for data, pause in garbage:
        host.receive(data, now)
        now += pause
        host.tick(now)
        out = host.bytes_to_send()
        assert out == b"" or tokens.why_not(out) is None
        host.telemetry(now)
    host.receive(b"\n* Start *\nReady!\n", now)
    for _ in range(400):
        now += 0.1
        host.tick(now)
        out = host.bytes_to_send()
        host.receive(b"Bittle\r\nN11_230101\r\n" * (out == b"?\n") + out[:1] + b"\r\n", now)
    assert host.telemetry(now).acknowledged == Emotion(0.7, 0.6, "happy")


@settings(max_examples=examples(40))
@given(st.data())
def test_how_the_stream_is_cut_makes_no_difference(data):
    session = _session()
    whole, cut = OpenCatHost(), OpenCatHost()
    for host in (whole, cut):
        host.port_opened(0.0)
    for index, (now, heard) in enumerate(session):
        if index == 200:
            for host in (whole, cut):
                host.express(Emotion(0.7, 0.6, "happy"))
        whole.receive(heard, now)
        places = data.draw(st.lists(st.integers(0, len(heard)), max_size=4)) if heard else []
        ends = [0, *sorted(places), len(heard)]
        for begin, end in itertools.pairwise(ends):
            cut.receive(heard[begin:end], now)
        for host in (whole, cut):
            host.tick(now)
        assert whole.bytes_to_send() == cut.bytes_to_send()
    assert whole.telemetry(session[-1][0]) == cut.telemetry(session[-1][0])


def _session() -> list[tuple[float, bytes]]:
    """Record what a board says to a host in half a minute."""
    host, board, heard = OpenCatHost(), OpenCatSimulator(5), []
    host.port_opened(0.0)
    for index in range(1, 1500):
        now = index * 0.02
        if index == 200:
            host.express(Emotion(0.7, 0.6, "happy"))
        board.advance(now)
        data = board.bytes_to_send()
        if data or index % 10 == 0:
            heard.append((now, data))
            host.receive(data, now)
            host.tick(now)
            board.receive(host.bytes_to_send(), now)
    return heard


def test_a_line_without_end_is_not_kept():
    host = OpenCatHost()
    host.port_opened(0.0)
    for _ in range(100):
        host.receive(b"\x55" * 4096, 1.0)
    assert len(pickle.dumps(host)) < 10_000
    assert host.telemetry(1.0).counts.crc_errors == 1


def test_a_board_that_never_pauses_is_asked_too():
    host = OpenCatHost()
    host.port_opened(0.0)
    asked = None
    for index in range(2000):
        now = index * 0.01
        host.receive(b"12.3\t4.5\t6.7\r\n", now)
        host.tick(now)
        if asked is None and host.bytes_to_send():
            asked = now
    assert asked == pytest.approx(15.0, abs=0.1)


@pytest.mark.parametrize("maker", [OpenCatSimulator, nybble])
def test_a_simulator_is_deterministic_whatever_the_step(maker):
    def hear(step: float) -> bytearray:
        board = maker(9)
        heard = bytearray()
        for index in range(round(60.0 / step)):
            board.advance(index * step)
            heard += board.bytes_to_send()
        board.advance(60.0)
        heard += board.bytes_to_send()
        return heard

    assert hear(0.5) == hear(0.01)


def test_over_a_real_port(soon):
    import time

    def fast() -> float:
        return time.monotonic() * 20.0

    simulator = OpenCatSimulator(1)
    with robot.SimulatedPort(simulator, clock=fast) as port:
        with robot.connect(port.url, "opencat", clock=fast) as bittle:
            assert bittle.catalogue.name == "Bittle X"
            bittle.express(Emotion(0.7, 0.6, "happy"))
            soon(lambda: bittle.telemetry.acknowledged is not None)
            bittle.play("chirp")
            with pytest.raises(RobotError, match="cannot play 'calib'"):
                bittle.play("calib")
            with pytest.raises(RobotError, match="cannot play 'c'"):
                bittle.play("c")
            assert simulator.portrait() == (0.8, "happy")
            soon(lambda: [text for _, text in simulator.log][-1] == "b14 8 18 8 21 8")
        soon(lambda: not simulator.body.powered)
        soon(lambda: [text for _, text in simulator.log][-1] == "d")


@pytest.mark.parametrize(
    "url", ["sim:opencat?seed=4", "sim:nybble?seed=4", "opencat:sim:nybble?seed=4"]
)
def test_without_a_port(url):
    import time

    with robot.connect(url, clock=lambda: time.monotonic() * 20.0) as one:
        assert one.catalogue.name in ("Bittle X", "Nybble")


def test_settings_choose_the_baud_rate(tmp_path, monkeypatch):
    path = tmp_path / "old.toml"
    path.write_text("[opencat]\nbaud = 57600\n")
    asked = []

    def no_port(url, clock, baud):
        asked.append(baud)
        raise RobotError("no port")

    monkeypatch.setattr("cubeling.robot.link.connection.opener", no_port)
    for settings_file in (None, path):
        with pytest.raises(RobotError, match="no port"):
            robot.connect("/dev/nothing", "opencat", settings=settings_file)
    with pytest.raises(RobotError, match="no port"):
        robot.connect("/dev/nothing")
    assert asked == [115200, 57600, 115200]
    assert load_settings(path).dwell == load_settings().dwell


def test_a_file_that_is_no_settings_file_is_refused_in_one_line(tmp_path):
    for content in (b"[opencat", b"\xff\xfe", None):
        path = tmp_path / "x.toml"
        path.unlink(missing_ok=True)
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(RobotError, match=re.escape(str(path))) as refusal:
            load_settings(path)
        assert "\n" not in str(refusal.value)


def test_the_last_line_keeps_its_distance_from_a_command():
    import time

    class Wire:
        in_waiting = 0

        def __init__(self) -> None:
            self.written: list[tuple[float, bytes]] = []

        def write(self, data: bytes) -> None:
            self.written.append((time.monotonic(), data))

        def cancel_read(self) -> str:
            return "cancelled"

    wire = Wire()
    port = SpacedPort(wire, 0.1, time.monotonic)  # type: ignore[arg-type] # all that is used
    port.write(b"kpu\n")
    port.write(b"")
    port.write(b"d\n")
    (first, _), _, (last, goodbye) = wire.written
    assert goodbye == b"d\n"
    assert 0.09 <= last - first < 2.0
    assert port.cancel_read() == "cancelled"


@pytest.mark.parametrize("protocol", ["opencat", "nybble"])
def test_the_spacing_of_writes_is_below_the_rate_limit(protocol):
    kind = DRIVERS[protocol]
    assert kind.spacing >= 0.1
    assert kind.spacing <= 1.0 / load_settings().commands_per_s, (
        "a driver that keeps its rate never waits"
    )
