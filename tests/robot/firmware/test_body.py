"""The firmware's body: limited servo speeds, emotions at a bounded rate, and rest."""

from itertools import pairwise
from math import radians
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_args

import pytest
from hypothesis import given, settings, strategies as st

from cubeling.affect.hysteresis import Label, next_label
from cubeling.robot.firmware.dino import body, motions, servos, sounds
from cubeling.robot.firmware.dino.joints import POWER_ON_EVERY_MS, RETRY_EVERY_MS
from cubeling.robot.firmware.dino.log import LogQueue
from cubeling.robot.firmware.dino.robot import run, run_until_exit
from cubeling.robot.firmware.dino.table import ServoTable
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.cubeling import dinosaur
from tests.examples import examples
from tests.robot.firmware.conftest import Dino, FailingBoard, Pulse, VirtualBoard
from tools import firmware_tables as generate, wiring

SERVOS = {servo.pin: servo for servo in ServoTable(servos).servos}

COMMANDS = st.lists(
    st.tuples(
        st.one_of(
            st.builds(m.Express, st.just(1), st.floats(-1, 1), st.floats(-1, 1),
                      st.sampled_from([0, 1, 2, 255])),
            st.builds(m.Play, st.just(1), st.just(1), st.integers(0, 7)),
            st.builds(m.Stop, st.just(1)),
            st.builds(m.Move, st.just(1), st.sampled_from([0.0, 0.1, 1.0, 5.0]),
                      st.integers(0, 31), st.integers(0, 31),
                      st.tuples(*[st.floats(-0.6, 0.6)] * 16)),
            st.none(),
        ),
        st.sampled_from([5, 20, 33, 150, 600, 3000]),
        st.sampled_from([1, 5, 7, 30, 90]),
    ),
    max_size=12,
)  # fmt: skip
"""Commands, the time after each [ms], and the period of the main loop then [ms]."""


def obey(dino: Dino, commands: list[tuple[Any, int, int]]) -> None:
    """Send commands to the robot."""
    dino.send(m.Hello(2, 9))
    number = 0
    for command, lasts, step in commands:
        if command is not None:
            number += 1
            dino.send(type(command)(number, *list(vars(command).values())[1:]))
        dino.run(lasts, step)


@given(COMMANDS)
@settings(max_examples=examples(60))
def test_no_servo_exceeds_its_top_speed_or_its_limits(commands):
    dino = Dino()
    obey(dino, commands)
    last: dict[int, Pulse] = {}
    for pulse in dino.board.pulses:
        servo = SERVOS[pulse.pin]
        per_degree = (servo.longest - servo.shortest) / 180
        angle = ((pulse.us - servo.shortest) / per_degree - servo.neutral) * servo.direction
        assert servo.low - 0.1 <= angle <= servo.high + 0.1
        before = last.get(pulse.pin)
        if before is not None:
            degrees = abs(pulse.us - before.us) / per_degree
            # A pulse is a whole microsecond, a tenth of a degree.
            assert degrees <= servo.speed * (pulse.time - before.time) / 1000 + 0.1
        last[pulse.pin] = pulse


def test_a_joint_stops_at_its_limit_in_a_motion_beyond_it():
    rows = [(*row[:2], -5, 5, *row[4:]) for row in servos.SERVOS]
    dino = Dino(SimpleNamespace(**(vars(servos) | {"SERVOS": rows})))
    obey(dino, [(m.Express(1, 1.0, 1.0, 1), 400, 5)] * 8)
    assert max(dino.joints.angles) <= 500
    dino.send(m.Beat(1))
    assert max(dino.sent()[-1][1].joints) == pytest.approx(radians(5), abs=1e-3)


def test_after_a_hang_no_joint_jumps(dino):
    obey(dino, [(m.Express(1, 1.0, 1.0, 1), 400, 5)] * 5)
    before = list(dino.joints.angles)
    dino.run(400, step=400)
    for servo, one, other in zip(dino.table.servos, before, dino.joints.angles, strict=True):
        assert abs(one - other) <= 100 * servo.speed * body.MAX_STEP_MS / 1000


def test_servos_get_their_first_pulse_at_neutral_and_one_after_the_other(dino):
    dino.run(2000, step=1)
    first: dict[int, Pulse] = {}
    for pulse in dino.board.pulses:
        first.setdefault(pulse.pin, pulse)
    assert list(first) == list(SERVOS)
    times = [pulse.time for pulse in first.values()]
    assert all(after - before >= POWER_ON_EVERY_MS for before, after in pairwise(times))
    for pin, pulse in first.items():
        servo = SERVOS[pin]
        share = (pulse.us - servo.shortest) / (servo.longest - servo.shortest)
        assert share == pytest.approx(servo.neutral / 180, abs=1e-3)


def test_without_a_host_it_rests_with_limp_servos_and_wakes_for_a_host(dino):
    dino.run(30_000)
    assert len({pulse.us for pulse in dino.board.pulses}) > 50, "it should breathe"
    dino.run(40_000)
    assert [pulse.us for pulse in dino.board.pulses[-5:]] == [0] * 5
    assert dino.joints.neutral
    assert dino.joints.limp
    count = len(dino.board.pulses)
    dino.run(60_000)
    assert len(dino.board.pulses) == count
    dino.send(m.Hello(2, 9))
    dino.send(m.Beat(1))
    flags = dino.sent()[-1][1].flags
    assert flags & m.FLAG_LIMP
    dino.run(100)
    dino.send(m.Beat(2))
    flags = dino.sent()[-1][1].flags
    assert not flags & m.FLAG_LIMP
    assert flags & m.FLAG_RECKONED


def test_an_unplugged_servo_driver_is_reported_as_limp(dino):
    dino.send(m.Hello(2, 9))
    dino.run(400)
    dino.board.dead = True
    dino.run(40)
    dino.send(m.Beat(1))
    assert dino.sent()[-1][1].flags & m.FLAG_LIMP
    where = list(dino.joints.angles)
    dino.run(300)
    assert dino.joints.angles == where, "what has no power does not move"
    dino.board.dead = False
    dino.board.pulses.clear()
    dino.run(RETRY_EVERY_MS + 5 * POWER_ON_EVERY_MS + 100)
    dino.send(m.Beat(2))
    assert {pulse.pin for pulse in dino.board.pulses} == set(SERVOS)
    assert all(dino.joints.powered)


def test_an_emotion_changes_at_a_bounded_rate_in_any_direction():
    for valence, arousal in ((1.0, 0.0), (0.6, -0.8), (0.001, 1.0), (-1.0, 1.0)):
        dino = Dino()
        dino.send(m.Hello(2, 9))
        dino.send(m.Express(1, valence, arousal))
        dino.run(400)
        shown = (dino.robot.body.valence**2 + dino.robot.body.arousal**2) ** 0.5
        assert 3900 <= shown <= 4020
        for _ in range(5):
            dino.send(m.Beat(0))
            dino.run(300)
        assert dino.robot.body.valence == round(1e4 * valence)
        assert dino.robot.body.arousal == round(1e4 * arousal)


@given(st.lists(st.sampled_from([-1.0, -0.4, -0.3, -0.2, 0.0, 0.2, 0.3, 0.4, 1.0]), max_size=6))
@settings(max_examples=examples(40))
def test_without_a_named_mood_it_chooses_the_mood_of_the_simulated_robot(valences):
    dino = Dino()
    dino.send(m.Hello(2, 9))
    label: Label = "neutral"
    for number, valence in enumerate(valences, 1):
        dino.send(m.Express(number, valence, 0.0))
        for _ in range(22):
            dino.send(m.Beat(0))
            dino.run(100, step=20)
            # 100 ms hold five steps; the words on the way may change in each of them.
            for _ in range(3):
                label = next_label(label, dino.robot.body.valence / 1e4)
        assert dino.portrait() == (valence, label)


def test_after_an_error_the_servos_are_limp_and_the_firmware_restarts():
    class LimpBoard(FailingBoard):
        errors: list[BaseException] = []  # noqa: RUF012 # one board, one test

        def log_error(self, error: BaseException) -> None:
            self.errors.append(error)
            self.limp = [pulse.us for pulse in self.pulses[-5:]]

    board = LimpBoard()
    run(board, ServoTable(servos))
    assert [str(error) for error in board.errors] == ["on purpose"]
    assert board.limp == [0] * 5
    after = [pulse for pulse in board.pulses if pulse.time > 1000 and pulse.us]
    assert after, "it should be back"
    # It begins where it was, and not at neutral: no jump.
    before = {pulse.pin: pulse.us for pulse in board.pulses if pulse.time < 1000 and pulse.us}
    assert {pulse.pin: pulse.us for pulse in reversed(after)} == before
    assert board.pulses[-1].us == 0, "nothing is left under power for the developer"


def test_the_watchdog_waits_for_the_first_host(dino):
    dino.run(100)
    assert dino.board.watched == 0
    dino.send(m.Hello(2, 9))
    dino.run(100)
    assert dino.board.watched == 1


def test_the_program_ends_at_a_developers_request_without_a_host():
    class Left(VirtualBoard):
        def elapsed(self) -> int:
            return 5

        def exit_requested(self) -> bool:
            return True

    board = Left()
    table = ServoTable(servos)
    run_until_exit(board, table, Dino().joints, LogQueue())


def test_sounds_glide_and_end(dino):
    dino.send(m.Hello(2, 9))
    dino.send(m.Play(1, m.ITEM_SOUND, 3))
    dino.run(400)
    assert dino.robot.body.sound == 3
    assert 1800 in dino.board.tones
    dino.send(m.Beat(1))
    dino.run(200)
    assert (dino.robot.body.sound, dino.board.tones[-1]) == (m.NOTHING, 0)


def test_sounds_last_as_long_as_those_of_the_simulated_robot():
    for name, glides in sounds.SOUNDS:
        length = sum(glide[2] for glide in glides) / 1000
        assert length == pytest.approx(dinosaur.SOUND_LENGTHS_S[name], abs=0.05), name
    assert [name for name, _ in sounds.SOUNDS] == list(dinosaur.SOUND_LENGTHS_S)


def test_generated_files_are_current():
    here = Path(generate.BOARD)
    assert (here / "messages.py").read_text("utf-8") == generate.messages()
    assert (here / "motions.py").read_text("utf-8") == generate.motions()
    assert wiring.PICTURE.read_text("utf-8") == wiring.wiring(ServoTable(servos))


@pytest.mark.parametrize("value", [-1.0, -0.34, -0.3, -0.27, 0.0, 0.27, 0.3, 0.34, 1.0])
def test_hysteresis_is_that_of_the_moods(value):
    for label in get_args(Label):
        shown = Dino().robot.body
        shown.mood = shown.moods.index(label)
        shown.valence = round(1e4 * value)
        shown.express(shown.valence, 0, m.NOTHING)
        for now in (0, body.STEP_MS):
            shown.advance(now, attended=True)
        assert shown.moods[shown.mood] == next_label(label, value)
    assert body.STEP_MS == 20
    assert motions.HYSTERESIS == 500
