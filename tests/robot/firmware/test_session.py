"""The firmware's end of the protocol, in virtual time: against our host and our simulated robot."""

from types import SimpleNamespace

import pytest
from hypothesis import example, given, settings, strategies as st

from cubeling.affect import Emotion
from cubeling.robot.conformance import SimulatedChannel, all_checks, run_checks
from cubeling.robot.firmware.dino import servos
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.examples import examples
from tests.robot.firmware.conftest import Dino


@pytest.fixture
def dino_world(world):
    def make(**harm: float):
        made = world(seed=5, **harm)
        made.robot = Dino()
        return made

    return make


def told(dino: Dino) -> list[int]:
    """Write down every valence that the body is told."""
    valences: list[int] = []
    express = dino.robot.body.express

    def seen(valence: int, arousal: int, mood: int) -> None:
        valences.append(valence)
        express(valence, arousal, mood)

    dino.robot.body.express = seen  # type: ignore[method-assign] # a spy on this one body
    return valences


def test_it_conforms():
    report = run_checks(SimulatedChannel(Dino()), all_checks(), host=77)
    assert [one.check.name for one in report.results if one.verdict != "ok"] == []
    assert report.conforms


def test_our_host_reads_its_catalogue_and_controls_it(dino_world):
    w = dino_world()
    w.run_until(lambda: w.telemetry.state == "ready", within=0.5)
    catalogue = w.host.catalogue
    assert catalogue.name == "Dino"
    assert "eyes and mouth" in [joint.name for joint in catalogue.joints]
    w.host.express(Emotion(0.8, 0.5, "happy"))
    w.run(1.5)
    assert w.telemetry.observed == w.telemetry.acknowledged == Emotion(0.8, 0.5, "happy")
    assert (w.telemetry.label, w.telemetry.motion) == ("happy", "happy")
    assert w.telemetry.reckoned
    w.host.play(m.ITEM_MOTION, catalogue.motions.index("wag tail"))
    w.run(0.5)
    assert w.telemetry.motion == "wag tail"
    w.run(2.0)
    assert w.telemetry.motion == "happy"


def test_emotions_survive_a_bad_line_in_order(dino_world):
    w = dino_world(drop=0.1, flip=0.005, dup=0.1)
    valences = told(w.robot)
    for index in range(1, 60):
        w.host.express(Emotion(index / 10_000, 0.0))
        w.run(0.1)
    w.run_until(lambda: valences[-1:] == [59], within=3)
    assert valences == sorted(set(valences))


def test_a_cut_line_leads_to_neutral_in_time_and_the_host_restores_the_emotion(dino):
    dino.send(m.Hello(2, 9))
    dino.send(m.Express(1, 0.5, 0.5, 1))
    dino.run(445, step=1)
    assert dino.robot.session.number == 1
    dino.run(10, step=1)
    assert dino.robot.session.number == 0
    dino.run(1500)
    assert dino.portrait() == (0.0, "neutral")
    dino.sent()
    dino.send(m.Hello(2, 9), session=2)
    ((_, welcome),) = dino.sent()
    assert welcome.taken == 0


def test_bytes_that_waited_during_a_hang_belong_to_no_session(dino):
    dino.send(m.Hello(2, 9))
    dino.sent()
    dino.board.now += 700
    dino.send(m.Express(1, 0.5, 0.5))
    assert dino.sent() == [(1, m.Gone())]


def test_a_host_of_version_1_gets_version_1(dino):
    dino.send(m.Hello(1, 9))
    dino.send(m.Express(1, 0.9, 0.9), version=1)
    dino.send(m.Beat(4))
    welcome, ack, state = [message for _, message in dino.sent()]
    assert (welcome.version, ack.result, state.flags) == (1, m.RESULT_TAKEN, 0)
    dino.run(300)
    assert dino.robot.body.valence > 0


def test_the_catalogues_number_changes_when_the_catalogue_does():
    first, *others = servos.SERVOS
    further = (*first[:2], first[2] - 1, *first[3:])
    numbers = set()
    for change in ({}, {"BUZZER": None}, {"SERVOS": (further, *others)}, {"SERVOS": (first,)}):
        dino = Dino(SimpleNamespace(**(vars(servos) | change)))
        dino.send(m.Hello(2, 9))
        ((_, welcome),) = dino.sent()
        numbers.add(welcome.catalogue)
    assert len(numbers) == 4


def test_a_blocked_line_blocks_nothing_else(dino):
    dino.board.takes = 0
    dino.send(m.Hello(2, 9))
    for count in range(100):
        dino.send(m.Beat(count))
        dino.run(50)
    assert dino.robot.session.number == 1
    dino.board.takes = 7
    dino.run(1000)
    # What was whole in the queue comes out whole.
    assert [type(message) for _, message in dino.sent()][:2] == [m.Welcome, m.State]


_BITS = st.sampled_from([0, 1, 2, 3, 0x8000])
"""Joints that both robots have, and one that neither has."""


def _steps() -> st.SearchStrategy[list[tuple[int, int, object, int]]]:
    """(session, version, message or garbage, ms until the next)."""
    number = st.integers(1, 6)
    unit = st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0])
    message = st.one_of(
        st.builds(m.Hello, st.integers(1, 4), st.integers(1, 2)),
        st.builds(m.Ask, st.integers(1, 5), st.integers(0, 9)),
        st.builds(m.Beat, st.integers(0, 9)),
        st.builds(m.Express, number, unit, unit, st.sampled_from([0, 1, 2, 3, 255])),
        st.builds(m.Play, number, st.integers(1, 2), st.integers(0, 9)),
        st.builds(m.Stop, number),
        st.builds(m.Move, number, st.just(0.2), _BITS, _BITS, st.just((0.1,) * m.JOINTS_MAX)),
        st.just(m.Bye()),
        st.binary(max_size=30),
    )
    step = st.tuples(
        st.sampled_from([1, 1, 1, 1, 2, 0]),
        st.integers(1, 3),
        message,
        st.sampled_from([0, 1, 5, 19, 21, 60, 105, 440, 460]),
    )
    return st.lists(step, max_size=40)


@given(_steps())
@example([(1, 3, m.Bye(), 0), (1, 3, m.Hello(3, 1), 0), (1, 3, m.Play(1, 2, 6), 105)])
@settings(max_examples=examples(60))
def test_it_answers_any_input_like_the_simulated_robot(steps):
    """The same bytes at the same times; only what is their own may differ."""
    ours, simulated = Dino(), Simulator(3)
    now = told = 0

    def hear(data: bytes) -> None:
        ours.receive(data, now / 1000)
        # A hair faster, so that a tenth of a second is never a rounding less.
        simulated.receive(data, now / 1000 * (1 + 1e-9))
        said, expected = ours.bytes_to_send(), simulated.bytes_to_send()
        assert _gist(said) == _gist(expected)
        if now < told + 40:
            return  # their steps of 20 ms may begin one apart
        for (mood, valence), (other, other_valence) in zip(
            _moods(said), _moods(expected), strict=True
        ):
            # One reckons in whole numbers: within a step of a border a rounding decides.
            assert mood == other or min(map(_from_border, (valence, other_valence))) < 0.02

    hear(b"")
    for session, version, message, wait in [(1, 3, m.Hello(3, 1), 1), *steps]:
        raw = isinstance(message, bytes)
        hear(message if raw else encode_frame(pack(message, session, version)))
        told = now
        for _ in range(wait):
            now += 1
            hear(b"")


def _moods(data: bytes) -> list[tuple[int, float]]:
    """The mood and the valence of every STATE."""
    states = [unpack(body, "robot")[1] for body in FrameReader().feed(data)]
    return [(one.mood, one.valence) for one in states if isinstance(one, m.State)]


def _from_border(valence: float) -> float:
    """How far a valence is from where a mood begins or ends."""
    return min(abs(abs(valence) - border) for border in (0.33, 0.28))


def _gist(data: bytes) -> list[tuple[object, ...]]:
    """What two robots of the same dinosaur must say alike."""
    gist: list[tuple[object, ...]] = []
    for body in FrameReader().feed(data):
        session, said = unpack(body, "robot")
        kind = type(said).__name__
        match said:
            case m.Welcome():
                counts = (said.version, said.taken, said.motions, said.sounds, said.moods)
                gist.append((kind, session, *counts))
            case m.State():
                still = said.flags & m.FLAG_STILL
                known = (said.beat, said.taken, still, said.motion == m.NOTHING)
                gist.append((kind, session, *known, said.result, said.held, said.time))
            case _:
                gist.append((kind, session, said))
    return gist
