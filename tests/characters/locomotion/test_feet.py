"""Feet that hold: the fast version of `tests.bench.feet`, and what holding them may not break."""

import math

import numpy as np
import pytest

from characters import Animator, Character, CharacterCommand, LocomotionIntent
from characters.control.walker import Walker
from characters.locomotion.steering import SteeringOutput
from tests.bench.feet import LIMIT, RATE, SCRIPTS, at_point, film, measure, points

GRID = points((0.6, 2.0, 2.9, 4.5), (-80, 0, 40), (1.0,)) | points((1.2,), (60,), (0.0, 0.5))


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


@pytest.mark.parametrize("point", GRID, ids=str)
def test_planted_feet_hold_everywhere_in_the_locomotion_space(human, point):
    slide = at_point(human, GRID[point], 1.0)
    assert slide.planted > 0.1
    assert slide.mean < LIMIT
    assert slide.strict < 120.0  # with the frames of landing and leaving: see the benchmark
    assert slide.dip < 1.0  # [mm]


@pytest.mark.parametrize("name", SCRIPTS)
def test_planted_feet_hold_through_starts_stops_and_turns(human, name):
    slide = measure(film(human, SCRIPTS[name], 230))
    assert slide.mean < LIMIT
    assert slide.dip < 1.0


def test_without_the_lock_they_would_slide(human):
    script = SCRIPTS["start and stop"]
    assert measure(film(human, script, 200, hold=False)).mean > 3 * LIMIT


def test_knees_bend_hardly_harder_for_it(human):
    course = SteeringOutput(1.5, math.radians(-75), 1.0)
    free, held = (at_point(human, course, 1.5, hold).jerk for hold in (False, True))
    assert held < 1.5 * free + 100.0


def test_who_has_stopped_comes_to_rest_and_stays(human):
    walker = Walker(human, 0.1, None)
    for number in range(60):
        walker.go(SteeringOutput(2.0, 1.0, 1.0), 1 / RATE if number else 0.0)
    for _ in range(120):
        walker.go(SteeringOutput(0.0, 0.0, 1.0), 1 / RATE)
    lock = walker.lock
    assert lock is not None
    assert all(foot.held for foot in lock.feet)
    assert max(foot.offset.length for foot in lock.feet) < 0.03 * human.height
    anchors = [foot.anchor for foot in lock.feet]
    for _ in range(60):
        walker.go(SteeringOutput(0.0, 0.0, 1.0), 1 / RATE)
    assert anchors == [foot.anchor for foot in lock.feet]


@pytest.mark.parametrize("rate", [24, 120])
def test_feet_hold_at_any_frame_rate(human, rate):
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


def test_a_character_without_knees_walks_as_before(walker):
    assert Walker(walker, 0.1, None).lock is None
