import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import CharacterError, Clip, Motion, Pose
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations

steps = st.builds(RootDelta, st.floats(-2, 2), st.floats(-2, 2), st.floats(-7, 7))


def close(a: RootDelta, b: RootDelta) -> bool:
    return np.allclose((a.x, a.z, a.yaw), (b.x, b.z, b.yaw), atol=1e-6)


@given(steps, steps, steps)
def test_root_deltas_form_a_group(a, b, c):
    assert close(a.then(b).then(c), a.then(b.then(c)))
    assert close(a.then(a.inverse()), RootDelta())


@given(steps, st.integers(0, 12))
def test_a_repeated_delta_equals_repeated_composition(step, times):
    walked = RootDelta()
    for _ in range(times):
        walked = walked.then(step)
    assert close(step.repeat(times), walked)


def test_a_clip_is_a_motion(walker):
    assert isinstance(walker.clips["Walk"], Motion)


def test_a_sample_at_a_frame_is_that_frame(walker):
    clip = walker.clips["WalkLeftShort"]
    pose = clip.sample(7 / clip.rate)
    assert np.allclose(pose.translations[1:], clip.poses.translations[7, 1:])
    assert np.allclose(pose.rotations[2], clip.poses.rotations[7, 2])


def test_root_motion_is_in_travel_only(walker):
    clip = walker.clips["WalkLeftShort"]
    pose = clip.sample(0.37)
    assert np.allclose(pose.translations[0], 0, atol=1e-9)
    assert np.allclose(np.abs(pose.rotations[0]), rotations.IDENTITY, atol=1e-9)
    whole = clip.travel(0.0, clip.duration)
    assert whole.yaw == pytest.approx(math.radians(135) * clip.duration)


@given(st.floats(0, 9), st.floats(0, 9), st.floats(0, 9))
def test_travel_adds_up_over_loops(walker, a, b, c):
    clip = walker.clips["RunRightMedium"]
    a, b, c = sorted((a, b, c))
    assert close(clip.travel(a, b).then(clip.travel(b, c)), clip.travel(a, c))


@pytest.mark.parametrize("begin", [0.0, 0.1, 0.3, 0.7])
def test_no_cycle_is_lost_where_a_frame_falls_on_the_end_of_a_loop(begin):
    steps = np.zeros((47, 1, 3))
    steps[:, 0, 2] = np.linspace(0.0, 1.0, 47)
    clip = Clip("c", 60.0, Pose(steps, np.tile(rotations.IDENTITY, (47, 1, 1))), root_motion=True)
    times = [begin + frame / 60 for frame in range(300)]
    travelled = [clip.travel(time, time + 1e-4).z for time in times]
    assert np.allclose(travelled, 60 / 46 * 1e-4)


def test_sample_and_travel_together_plant_the_foot(walker, skeleton):
    clip = walker.clips["WalkRightMedium"]
    lands = (0.1 * 1 - 0.05) * clip.duration  # the lead of this clip in conftest
    places = []
    for time in lands + np.linspace(0.03, 0.57, 30) * clip.duration:
        foot = clip.sample(time).globals(skeleton)[3, :3, 3]
        at = clip.travel(0.0, time).then(RootDelta(foot[0], foot[2]))
        places.append([at.x, at.z])
    assert np.ptp(places, axis=0).max() < 2e-3


def test_a_clip_that_does_not_loop_holds_its_ends():
    turns = rotations.about("y", [[0.0], [1.0]])
    clip = Clip("turn", 1.0, Pose(np.zeros((2, 1, 3)), turns), loop=False)
    assert np.allclose(clip.sample(-3.0).rotations, turns[0])
    assert np.allclose(clip.sample(9.0).rotations, turns[1])
    assert clip.travel(0.0, 9.0) == RootDelta()


def test_a_clip_without_frames_is_refused():
    with pytest.raises(CharacterError, match="'empty'"):
        Clip("empty", 30.0, Pose(np.zeros((0, 1, 3)), np.zeros((0, 1, 4))))
