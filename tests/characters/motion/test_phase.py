import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Character, Clip, Pose
from cubeling.characters.motion.phase import PhasedMotion, with_phase
from cubeling.characters.skeleton import rotations


@pytest.mark.parametrize("lead", [0.0, 0.13, 0.5, 0.77])
@pytest.mark.parametrize("yaw_rate", [0.0, 1.5, -2.0])
def test_phase_0_is_the_left_footfall(gait, skeleton, lead, yaw_rate):
    clip = gait("walk", 1.3, yaw_rate, 1.0, lead)
    motion = with_phase(clip, skeleton)
    frame = 1.0 / clip.rate
    lands = [lead * clip.duration, (lead + 0.5) * clip.duration]
    for phase, time in zip((0.0, 0.5), lands, strict=True):
        apart = (motion.time(phase) - time + clip.duration / 2) % clip.duration - clip.duration / 2
        assert abs(apart) < 2.5 * frame


def test_a_clip_of_two_cycles_has_half_its_length_as_cycle(gait, skeleton):
    clip = gait("walk", 1.3, 0.0, 1.0, 0.2)
    once = clip.poses[np.arange(len(clip) - 1)]
    twice = Pose(*(np.concatenate([a, a, a[:1]]) for a in (once.translations, once.rotations)))
    double = Clip("twice", clip.rate, twice, loop=True)
    motion = with_phase(double, skeleton)
    assert len(motion.marks) == 4
    assert motion.duration == pytest.approx(clip.duration)


def test_a_clip_that_walks_in_place_has_footfalls_too(gait, skeleton):
    clip = gait("walk", 1.3, 0.0, 1.0, 0.4)
    in_place = Clip("in place", clip.rate, clip.in_place, loop=True)
    assert with_phase(in_place, skeleton).time(0.0) == pytest.approx(0.4, abs=0.05)


def test_a_clip_without_steps_has_no_marks(walker, skeleton):
    assert with_phase(walker.clips["idle"], skeleton).marks == ()


@given(st.lists(st.floats(0.05, 1.0), min_size=2, max_size=2), st.floats(-5, 5), st.floats(0, 1))
def test_time_runs_with_phase_and_hits_the_marks(gaps, phase, further):
    duration = sum(gaps)
    clip = Clip(
        "c", 1 / duration, Pose(np.zeros((2, 1, 3)), np.tile(rotations.IDENTITY, (2, 1, 1)))
    )
    motion = PhasedMotion(clip, (0.02, 0.02 + gaps[0]))
    assert motion.time(0.5) == pytest.approx(0.02 + gaps[0])
    assert motion.time(phase + 1) == pytest.approx(motion.time(phase) + duration)
    assert motion.time(phase + further) >= motion.time(phase) - 1e-9


def test_the_bundled_gaits_land_their_left_foot_at_phase_0():
    human = Character.load("human")
    for name, clip in human.clips.items():
        if name == "idle" or not clip.loop:
            continue
        motion = with_phase(clip, human.skeleton)
        assert np.allclose(np.array(motion.marks) / clip.duration, [0.0, 0.5], atol=0.03), name


def test_feet_that_land_together_make_one_mark(gait, skeleton):
    clip = gait("hop", 1.3, 0.0, 1.0)
    translations = clip.poses.translations.copy()
    left = translations[:-1, 3]  # the right foot does what the left does, five frames later
    late = np.roll(left, 5, axis=0) * [-1, 1, 1]
    translations[:, 4] = np.concatenate([late, late[:1]])
    hop = Clip("hop", clip.rate, Pose(translations, clip.poses.rotations), True, True)
    marks = np.array(with_phase(hop, skeleton).marks)
    assert np.diff(marks) == pytest.approx([clip.duration / 2])
