"""The sketch scenario: draw a path with the cube, then walk it."""

import numpy as np
import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios import make_scenario
from cubeling.app.scenarios.sketch import MAX_POINTS


@pytest.fixture
def sketch():
    return make_scenario("sketch")


def draw(sketch, hand, count, radius=0.15):
    """Rest at `count` places on a circle; return the last outcome."""
    for place in range(count):
        angle = 2 * np.pi * place / MAX_POINTS
        point = radius * np.array([np.cos(angle), np.sin(angle)])
        sketch.update(hand.frame(position=point, resting=False), Situation(), Inputs())
        outcome = sketch.update(hand.frame(position=point, resting=True), Situation(), Inputs())
    return outcome


def test_a_point_is_set_where_the_cube_rests(sketch, hand):
    draw(sketch, hand, 3)
    assert len(sketch.points) == 3


def test_resting_longer_or_nearby_sets_no_second_point(sketch, hand):
    draw(sketch, hand, 1)
    for shift in (0.0, 0.01, 0.04):
        sketch.update(hand.frame(position=np.array([0.15 + shift, 0.0])), Situation(), Inputs())
    assert len(sketch.points) == 1


def test_the_ninth_point_is_refused(sketch, hand):
    draw(sketch, hand, MAX_POINTS)
    sketch.update(hand.frame(position=np.array([0.5, 0.5])), Situation(), Inputs())
    assert len(sketch.points) == MAX_POINTS
    assert not sketch.may_add(np.array([0.5, 0.5]))


def test_eight_points_close_the_loop(sketch, hand):
    assert not draw(sketch, hand, MAX_POINTS - 1).floor[0].closed
    assert draw(sketch, hand, MAX_POINTS).floor[0].closed


def test_lifting_the_cube_closes_a_shorter_loop(sketch, hand):
    draw(sketch, hand, 4)
    outcome = sketch.update(hand.frame(lifted=True, resting=False), Situation(), Inputs())
    assert outcome.floor[0].closed


def test_a_shake_starts_over(sketch, hand):
    draw(sketch, hand, MAX_POINTS)
    outcome = sketch.update(hand.frame(gestures=("shaken",), resting=False), Situation(), Inputs())
    assert outcome.floor == ()


def test_the_cube_draws_while_the_path_is_open_and_only_then_moves_the_character(sketch, hand):
    hand.heading(180)
    assert draw(sketch, hand, 4).command.activity == "idle"
    sketch.update(hand.frame(lifted=True, resting=False), Situation(), Inputs())
    for _ in range(30):
        outcome = sketch.update(hand.frame(lifted=False), Situation(), Inputs())
    assert outcome.command.activity == "move"
    assert outcome.command.speed > 3
