import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Character
from cubeling.characters.locomotion.gaits import MAX_ANGULAR_RAD, RUN_CLIPS, WALK_CLIPS, Gaits
from cubeling.characters.retargeting.locomotion.gait_cycle import ArcPath
from cubeling.characters.retargeting.root import move_to_trajectory

SPEEDS = np.linspace(0.5, 5.0, 91)


@pytest.fixture(scope="module", params=["walker", "human"])
def gaits(request, walker):
    character = walker if request.param == "walker" else Character.load("human")
    clips = character.clips
    return Gaits(clips, character.skeleton, clips["idle"].sample(0.0))


def velocity(gaits, speed, angular):
    motion = gaits.at(speed, angular)
    cycle = motion.between(0.0, 1.0)
    return cycle, motion.duration


def test_the_human_has_all_clips_of_the_tree():
    assert set(WALK_CLIPS.values()) | set(RUN_CLIPS.values()) <= set(Character.load("human").clips)


def test_ground_speed_rises_with_speed_without_a_jump(gaits):
    paces = [cycle.length / time for cycle, time in (velocity(gaits, s, 0.0) for s in SPEEDS)]
    assert np.allclose(paces, [gaits.pace(s) for s in SPEEDS], rtol=1e-6)
    steps = np.diff(paces)
    assert (steps > 0).all()
    assert steps.max() < 0.15  # [m/s] for a twentieth of Speed


def test_speed_is_the_inverse_of_pace(gaits):
    assert np.allclose([gaits.speed(gaits.pace(speed)) for speed in SPEEDS], SPEEDS)


def test_step_durations_are_natural(gaits):
    durations = [gaits.at(s, 0.0).duration for s in SPEEDS]
    assert min(durations) > 0.45
    assert max(durations) < 1.7


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("speed", [1.0, 2.5, 3.0, 4.5])
def test_a_sharper_angular_turns_faster_to_its_side(gaits, side, speed):
    rates = []
    for degrees in range(0, 91, 10):
        cycle, duration = velocity(gaits, speed, side * math.radians(degrees))
        rates.append(-side * cycle.yaw / duration)
    assert (np.diff(rates) > 0).all()
    assert rates[0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("degrees", [-90, -60, -30, 30, 60, 90])
def test_walking_turns_by_1_5_degrees_a_second_for_each_degree_of_angular(gaits, degrees):
    for speed in np.linspace(1.8, 2.2, 41):  # where the walk plays at the rate it was made for
        motion = gaits.at(speed, math.radians(degrees))
        if abs(motion.rate - 1) < 0.02:
            cycle = motion.between(0.0, 1.0)
            turned = -math.degrees(cycle.yaw) / motion.duration
            assert turned == pytest.approx(1.5 * degrees, rel=0.05)


@given(st.floats(0.5, 5.0), st.floats(-MAX_ANGULAR_RAD, MAX_ANGULAR_RAD), st.floats(0, 1))
def test_the_pose_changes_little_when_speed_and_angular_do(gaits, speed, angular, phase):
    here = gaits.at(speed, angular).at(phase)
    there = gaits.at(min(speed + 1e-3, 5.0), min(angular + 1e-3, MAX_ANGULAR_RAD)).at(phase)
    assert np.allclose(here.rotations, there.rotations, atol=0.01)
    assert np.allclose(here.translations, there.translations, atol=0.01)


def test_left_and_right_are_mirror_images(gaits):
    left, right = gaits.at(2.0, -1.0).between(0.0, 1.0), gaits.at(2.0, 1.0).between(0.0, 1.0)
    assert (left.x, left.z, left.yaw) == pytest.approx((-right.x, right.z, -right.yaw), abs=5e-3)


@pytest.mark.parametrize("turn", np.linspace(0.9, 1.5, 7) * 2 * math.pi)
def test_a_cycle_that_turns_a_whole_circle_has_the_radius_of_the_circle(walker, turn):
    clips = dict(walker.clips)
    for tree in (WALK_CLIPS, RUN_CLIPS):
        for knot in (min(tree), max(tree)):
            clip, side = clips[tree[knot]], -np.sign(knot)
            circle = ArcPath(clip.cycle.length / clip.duration, turn / clip.duration)
            path = circle.at(np.arange(len(clip)) / clip.rate) * [side, 1, side]
            clips[tree[knot]] = replace(clip, poses=move_to_trajectory(clip.in_place, path))
    gaits = Gaits(clips, walker.skeleton, clips["idle"].sample(0.0))
    for speed in (1.0, 2.0, 4.0):
        cycle = gaits.at(speed, MAX_ANGULAR_RAD)
        parts = [cycle.between(at, at + 0.01) for at in np.arange(0.0, 1.0, 0.01)]
        way, turned = (sum(abs(getattr(part, n)) for part in parts) for n in ("length", "yaw"))
        assert gaits.radius(speed) == pytest.approx(way / turned, rel=0.03)
