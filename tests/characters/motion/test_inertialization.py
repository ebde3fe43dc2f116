import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import CharacterError, Clip, Motion, Pose, StateMachine
from cubeling.characters.motion.inertialization import OffsetDecay
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations

LENGTH_S = 0.25
STEP_S = 1e-4


class Spin:
    """Turns and slides at constant speed; a motion with exact velocities."""

    duration = 1.0

    def __init__(self, axis, speed, start, slide):
        self.axis, self.speed, self.start, self.slide = axis, speed, start, slide

    def sample(self, time):
        turn = rotations.about(self.axis, [self.start + self.speed * time])
        return Pose(np.array([[self.slide * time, 1.0, 0.0]]), turn)

    def travel(self, start, end):
        return RootDelta(0.0, self.slide * (end - start), 0.0)


numbers = st.floats(-3, 3)
spins = st.builds(Spin, st.sampled_from("xyz"), numbers, st.floats(-1.2, 1.2), numbers)


def velocity(motion, time):
    """Angular velocity, velocity of the joint and of the root, by differences before a time."""
    a, b = motion.sample(time - STEP_S), motion.sample(time)
    turn = rotations.multiply(b.rotations, rotations.conjugate(a.rotations))
    step = motion.travel(time - STEP_S, time)
    return np.concatenate(
        [
            rotations.to_rotation_vector(turn)[0] / STEP_S,
            (b.translations - a.translations)[0] / STEP_S,
            [step.x / STEP_S, step.z / STEP_S, step.yaw / STEP_S],
        ]
    )


def switched(old, new, at=1.0):
    machine = StateMachine({"old": old, "new": new}, "old", LENGTH_S)
    machine.request("new", at)
    return machine


@given(spins, spins)
def test_a_switch_is_continuous_in_position_and_velocity(old, new):
    machine = switched(old, new)
    before, after = machine.sample(1.0 - 1e-9), machine.sample(1.0)
    aligned = rotations.align(after.rotations, before.rotations)
    assert np.allclose(aligned, before.rotations, atol=1e-6)
    assert np.allclose(after.translations, before.translations, atol=1e-6)
    ahead = velocity(machine, 1.0 + 2 * STEP_S)
    # The machine measures velocities over 1 ms, which bends turning ones by a little.
    assert np.allclose(ahead, velocity(machine, 1.0 - STEP_S), atol=0.06)


@given(spins, spins)
def test_after_the_transition_only_the_new_motion_is_left(old, new):
    machine = switched(old, new)
    end, expected = machine.sample(1.0 + LENGTH_S), new.sample(LENGTH_S)
    assert np.allclose(end.rotations, expected.rotations, atol=1e-9)
    just_before = velocity(machine, 1.0 + LENGTH_S - STEP_S)
    assert np.allclose(just_before, velocity(new, LENGTH_S - STEP_S), atol=1e-2)


@given(spins, spins, spins, st.floats(0.001, 0.3))
def test_a_switch_within_a_transition_is_continuous(first, second, third, later):
    machine = StateMachine({"a": first, "b": second, "c": third}, "a", LENGTH_S)
    machine.request("b", 1.0)
    before, speed = machine.sample(1.0 + later), velocity(machine, 1.0 + later)
    machine.request("c", 1.0 + later)
    after = machine.sample(1.0 + later)
    assert np.allclose(rotations.align(after.rotations, before.rotations), before.rotations)
    ahead = velocity(machine, 1.0 + later + 2 * STEP_S)
    assert np.allclose(ahead, speed, atol=0.3)  # of velocities up to 10, over 0.2 ms


@given(numbers, numbers)
def test_an_offset_decay_starts_and_ends_as_specified(offset, speed):
    fade = OffsetDecay(np.array([offset]), np.array([speed]), LENGTH_S)
    assert fade.at(0.0)[0] == pytest.approx(offset)
    assert (fade.at(STEP_S) - fade.at(0.0))[0] / STEP_S == pytest.approx(speed, abs=0.05)
    assert fade.at(LENGTH_S)[0] == fade.at(9.0)[0] == pytest.approx(0, abs=1e-9)
    times = np.linspace(0, LENGTH_S, 2001)
    total = np.trapezoid([fade.at(t)[0] for t in times], times)
    assert fade.integral(0.0, LENGTH_S)[0] == pytest.approx(total, abs=1e-6)


@given(numbers, numbers)
def test_an_offset_decay_overshoots_by_little(offset, speed):
    fade = OffsetDecay(np.array([offset]), np.array([speed]), LENGTH_S)
    largest = max(abs(fade.at(t)[0]) for t in np.linspace(0, LENGTH_S, 50))
    assert largest <= abs(offset) + 0.2 * abs(speed) * LENGTH_S + 1e-9


def test_travel_across_a_switch_is_composed_of_its_parts():
    machine = switched(Spin("y", 0, 0, 1.0), Spin("y", 0, 0, 3.0))
    parts = RootDelta()
    for start in np.arange(0.5, 1.5, 0.01):
        parts = parts.then(machine.travel(start, start + 0.01))
    assert parts.z == pytest.approx(machine.travel(0.5, 1.5).z)


def test_a_state_machine_is_a_motion_with_named_states():
    machine = switched(Spin("y", 0, 0, 0), Spin("x", 1, 0, 0))
    motion: Motion = machine
    assert isinstance(motion, Motion)
    assert (machine.state, machine.entered) == ("new", 1.0)
    machine.request("new", 5.0)
    assert machine.entered == 1.0
    with pytest.raises(CharacterError, match="no state 'fly'; there are old, new"):
        machine.request("fly", 6.0)
    with pytest.raises(CharacterError, match="come in order"):
        machine.request("old", 0.5)


def test_entering_a_loop_with_a_gap_is_smooth():
    turns = rotations.about("x", np.linspace(0.0, 0.1, 31)[:, None])
    open_loop = Clip("open", 30.0, Pose(np.zeros((31, 1, 3)), turns), loop=True)
    machine = StateMachine({"old": Spin("x", 0, 0, 0), "new": open_loop}, "old", LENGTH_S)
    machine.request("new", 1.0)
    shown = [machine.sample(1.0 + t).rotations for t in np.linspace(0, LENGTH_S, 30)]
    assert np.abs(rotations.to_rotation_vector(np.array(shown))).max() < 0.05
