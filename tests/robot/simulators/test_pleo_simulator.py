"""The simulated Pleo behaves as the sources describe, its quirks included."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.robot.drivers.pleo.joints import JOINTS
from cubeling.robot.simulators.pleo.simulator import MAX_UNREAD_BYTES, PleoSimulator


class Terminal:
    """A person who types at the simulated console, in virtual time."""

    def __init__(self, seed: int = 0) -> None:
        self.robot = PleoSimulator(seed)
        self.robot.slow_probability = self.robot.error_probability = 0.0
        self.now = 10.0
        self.robot.advance(self.now)
        self.text = self.robot.bytes_to_send().decode("latin-1")

    def wait(self, seconds: float) -> str:
        start = len(self.text)
        for _ in range(round(seconds / 0.01)):
            self.now += 0.01
            self.robot.advance(self.now)
            self.text += self.robot.bytes_to_send().decode("latin-1")
        return self.text[start:]

    def ask(self, line: str, seconds: float = 3.0) -> str:
        self.robot.receive(f"{line}\n".encode("latin-1"), self.now)
        return self.wait(seconds)


@pytest.fixture
def terminal() -> Terminal:
    """Give a terminal on a Pleo whose own behaviour has been ended."""
    terminal = Terminal(seed=3)
    terminal.ask("APP UNLOAD")
    return terminal


def test_its_own_behaviour_babbles_and_moves_until_it_is_unloaded():
    terminal = Terminal(seed=1)
    assert terminal.wait(20).count("app: ") > 5
    assert any(terminal.robot.body.angles)
    assert "application holds" in terminal.ask("MOTION PLAY a:happy.umf")
    assert "done" in terminal.ask("app unload")
    terminal.wait(2)
    assert "app: " not in terminal.wait(60)
    assert "mu: " in terminal.wait(60)


@pytest.mark.parametrize("line", ["joint neutral", "Joint Neutral", "  JOINT   NEUTRAL ", ""])
def test_commands_are_taken_in_any_case_and_answered_by_a_prompt(terminal, line):
    answer = terminal.ask(line)
    assert answer.rstrip("\r\n").endswith("> ") or "> mu:" in answer
    assert "Unknown" not in answer


def test_help_is_long_and_holds_the_prompts_characters(terminal):
    answer = terminal.ask("HELP")
    assert answer.count("\n") > 8
    assert "\n> is the prompt" in answer


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("FORMAT", "Unknown command"),
        ("JOINT MOVE 8 16", "invalid parameter"),
        ("JOINT MOVE 14 0", "invalid parameter"),
        ("JOINT MOVE -1 0", "invalid parameter"),
        ("JOINT MOVE 8", "invalid parameter"),
        ("JOINT MOVE 8 x", "invalid parameter"),
        ("SOUND VOLUME", "invalid parameter"),
        ("MOTION PLAY a:happy.txt", "not found"),
        ("SOUND PLAY a:happy.umf", "not found"),
    ],
)
def test_what_it_cannot_do_it_says(terminal, line, error):
    assert error in terminal.ask(line)


def test_joint_angle_answers_when_it_is_there_and_joint_move_at_once(terminal):
    terminal.ask("JOINT NEUTRAL", 10)
    terminal.ask("JOINT MOVE 8 -14", 0.2)
    assert not terminal.robot.busy
    assert -14 < terminal.robot.body.angles[8] < 0
    terminal.wait(2)
    assert terminal.robot.body.angles[8] == -14
    assert "> " not in terminal.ask("JOINT ANGLE 8 14", 1.3)
    assert terminal.robot.busy
    assert "> " in terminal.wait(0.3)  # 28° at 20 °/s
    assert terminal.robot.body.angles[8] == pytest.approx(14)


@given(st.lists(st.tuples(st.integers(0, 13), st.integers(-90, 90)), max_size=6))
def test_no_joint_leaves_its_limits_or_turns_faster_than_it_can(moves):
    terminal = Terminal(seed=4)
    before = np.array(terminal.robot.body.angles)
    for joint, degrees in moves:
        terminal.robot.receive(f"JOINT MOVE {joint} {degrees}\n".encode(), terminal.now)
        for _ in range(10):
            terminal.wait(0.01)
            angles = np.array(terminal.robot.body.angles)
            for one, angle, last in zip(JOINTS, angles, before, strict=True):
                assert one.low <= angle <= one.high
                assert abs(angle - last) <= one.speed * 0.01 + 1e-9
            before = angles


def test_what_is_typed_before_the_prompt_is_lost_or_garbled_and_written_down(terminal):
    terminal.robot.receive(b"MOTION PLAY a:happy.umf\n", terminal.now)
    terminal.robot.receive(b"MOTION PLAY a:angry.umf\n", terminal.now)
    assert [text for _, text in terminal.robot.violations] == ["MOTION PLAY a:angry.umf\n"]
    terminal.wait(3)
    assert [one.name for one in terminal.robot.body.played] == ["a:happy.umf"]


def test_a_motion_ends_and_the_mood_that_it_is_named_after_can_be_seen(terminal):
    terminal.ask("MOTION PLAY a:angry.umf", 1)
    assert terminal.robot.body.motion == "a:angry.umf"
    assert terminal.robot.portrait() == (-0.7, "angry")
    terminal.wait(6)
    assert terminal.robot.body.motion is None
    terminal.ask("JOINT NEUTRAL")
    assert terminal.robot.portrait() == (0.0, "neutral")


@pytest.mark.parametrize("seed", range(4))
def test_after_a_reboot_it_is_silent_then_says_so_and_runs_its_own_behaviour(seed):
    terminal = Terminal(seed)
    terminal.ask("APP UNLOAD")
    terminal.robot.reboot()
    assert terminal.ask("", 1.0) == ""
    text = terminal.wait(4)
    assert any(sign in text for sign in ("Booting", "Pleo Monitor", "Life OS"))
    assert "> " in text
    assert terminal.robot.monitor.application
    assert not terminal.robot.violations


@pytest.mark.parametrize("seed", range(3))
def test_a_seed_gives_the_same_bytes_again(seed):
    def life() -> str:
        terminal = Terminal(seed)
        terminal.robot.slow_probability = terminal.robot.error_probability = 0.2
        for line in ("APP UNLOAD", "STATS POWER", "MOTION PLAY a:happy.umf", "HELP"):
            terminal.ask(line)
        return terminal.text

    assert life() == life()
    assert len(life()) > 400


def test_a_client_that_does_not_read_does_not_make_it_grow():
    robot = PleoSimulator(1)
    for number in range(5000):
        robot.advance(number)
    assert len(robot.bytes_to_send()) <= MAX_UNREAD_BYTES


@given(st.lists(st.binary(max_size=400), max_size=10))
def test_no_bytes_are_too_strange_for_it(chunks):
    robot = PleoSimulator(2)
    for number, chunk in enumerate(chunks):
        robot.receive(chunk, float(number))
    robot.bytes_to_send()
    assert len(robot.input_line) <= 128
