"""Foot lock: a coarser grid of `tests.bench.feet`, and side effects of the lock."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Animator, Character, CharacterCommand, LocomotionIntent
from cubeling.characters.control.layers import FootLockLayer
from cubeling.characters.locomotion.steering import SteeringOutput
from cubeling.characters.motion.motion import RootDelta
from tests.bench.feet import (
    BODY_HEIGHT_M,
    FRAME_RATE,
    MAX_SLIDE_MM_S,
    SCRIPTS,
    Walking,
    at_point,
    film,
    measure,
    points,
)
from tests.examples import some

GRID = points((0.6, 2.0, 2.9, 4.5), (-80, 0, 40), (1.0,)) | points((1.2,), (60,), (0.0, 0.5))
SPREAD = dict.fromkeys([*list(GRID)[::5], *GRID])
"""The same points; the first lie apart."""


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


@pytest.mark.parametrize("point", some([(point,) for point in SPREAD], 3), ids=str)
def test_planted_feet_do_not_slide_in_the_locomotion_space(human, point):
    slide = at_point(human, GRID[point], 1.0)
    assert slide.planted > 0.1
    assert slide.mean < MAX_SLIDE_MM_S
    assert slide.strict < 120.0  # with the frames of landing and leaving: see the benchmark
    assert slide.dip < 1.0  # [mm]


@pytest.mark.parametrize("name", some(SCRIPTS, 2))
def test_planted_feet_do_not_slide_during_starts_stops_and_turns(human, name):
    slide = measure(film(human, SCRIPTS[name], 230))
    assert slide.mean < MAX_SLIDE_MM_S
    assert slide.dip < 1.0


def test_planted_feet_slide_without_the_foot_lock(human):
    script = SCRIPTS["start and stop"]
    assert measure(film(human, script, 200, hold=False)).mean > 3 * MAX_SLIDE_MM_S


def test_the_foot_lock_adds_little_joint_acceleration(human):
    course = SteeringOutput(1.5, math.radians(-75), 1.0)
    free, held = (at_point(human, course, 1.5, hold).jerk for hold in (False, True))
    assert held < 1.5 * free + 100.0


def test_the_pelvis_is_not_lowered_at_once(human):
    """A runner stops with one foot far behind."""
    walker, hips = Walking(human), human.anatomy.joints["hips"]
    heights = []
    for number in range(107):
        course = SteeringOutput(4.5 if number < 47 else 0.0, 0.0, 1.0)
        pose = walker.step(course, 1 / FRAME_RATE if number else 0.0)
        heights.append(pose.globals(human.skeleton)[hips, 1, 3])
    changes = np.abs(np.diff(heights, 2)) * FRAME_RATE * BODY_HEIGHT_M / human.height
    assert changes.max() < 1.0  # [m/s a frame]; 2.3 if it is lowered at once


def test_feet_stay_in_place_after_a_stop(human):
    walker = Walking(human, 0.1)
    for number in range(60):
        walker.step(SteeringOutput(2.0, 1.0, 1.0), 1 / FRAME_RATE if number else 0.0)
    for _ in range(120):
        walker.step(SteeringOutput(0.0, 0.0, 1.0), 1 / FRAME_RATE)
    lock = walker.feet.lock
    assert lock is not None
    assert all(foot.held for foot in lock.feet)
    assert max(foot.offset.length for foot in lock.feet) < 0.03 * human.height
    anchors = [foot.anchor for foot in lock.feet]
    for _ in range(60):
        walker.step(SteeringOutput(0.0, 0.0, 1.0), 1 / FRAME_RATE)
    assert anchors == [foot.anchor for foot in lock.feet]


@pytest.mark.parametrize("rate", some([24, 120]))
def test_planted_feet_do_not_slide_at_any_frame_rate(human, rate):
    animator = Animator(human)
    toes = [human.skeleton.index("LeftToe"), human.skeleton.index("RightToe")]
    level = human.skeleton.rest.globals(human.skeleton)[toes, 1, 3]
    places = []
    for number in range(2 * rate):
        posed = animator.update(
            CharacterCommand(number / rate, LocomotionIntent(2.0, np.array([9.0, 9.0])))
        )
        seen = posed.table_from_character @ posed.pose.globals(human.skeleton)[toes]
        places.append(seen[:, :3, 3] / animator.scale)
    feet = np.array(places)
    speeds = np.linalg.norm(np.diff(feet[..., [0, 2]], axis=0), axis=-1) * rate
    low = (feet[..., 1] - level < 0.004)[1:] & (feet[..., 1] - level < 0.004)[:-1]
    assert low.mean() > 0.3
    assert np.median(speeds[low]) < 2e-3  # [m/s]


@pytest.mark.parametrize(("speed", "held"), [(0.5, True), (3.5, False)])
def test_a_foot_that_still_swings_is_not_stopped_dead(human, speed, held):
    """Its motion calls it down, as while a jump to a clip in which it stands passes over."""
    lock = FootLockLayer(human).lock
    assert lock is not None
    for number in range(30):  # the first frame holds both
        place = RootDelta(z=speed * number / FRAME_RATE)
        lock.apply(human.skeleton.rest, place, [number == 29] * 2, False, 1 / FRAME_RATE)
    assert lock.feet[0].held == held


def test_only_a_foot_that_bends_at_its_toes_is_lowered_to_their_joint(human):
    """A stiff foot stands on its tip when the joint of its toes is above the ground."""
    joints = np.arange(len(human.skeleton))
    for side in ("Left", "Right"):
        joints[human.skeleton.index(f"{side}Toe")] = human.skeleton.index(f"{side}Foot")
    stiff = replace(
        human, meshes=tuple(replace(mesh, joints=joints[mesh.joints]) for mesh in human.meshes)
    )
    raised, rest = 0.01 * human.height, human.skeleton.rest
    pose = replace(rest, translations=rest.translations.copy())
    pose.translations[0, 1] += raised

    def lowered(character):
        lock = FootLockLayer(character).lock
        assert lock is not None
        for _ in range(12):
            lock.apply(pose, RootDelta(), [True, True], False, 1 / 30)
        return [-foot.offset.y for foot in lock.feet]

    assert lowered(human) == pytest.approx([raised] * 2)
    assert lowered(stiff) == [0.0, 0.0]


def test_a_character_without_knees_has_no_foot_lock(walker):
    assert FootLockLayer(walker).lock is None
