"""How hard the cube is to reach decides what the character does about it."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.app.scenarios.reach.catching import (
    EASIER,
    LOST_S,
    SHADE_S,
    SHRUG_S,
    STRETCH_S,
    SULK_S,
    Catching,
    Prospect,
)
from tests.examples import examples

FRAME = 1 / 30
EASY, HARD, FAR = 0.2, 1.6, 4.0
EASILY: dict[str, Any] = {
    "seen": True,
    "cube": np.zeros(3),
    "touch": np.zeros(3),
    "effort": EASY,
    "gap": 0.0,
    "height": 0.2,
    "touching": False,
}


class Play:
    """Frames of a cube that is as hard to reach as told."""

    def __init__(self):
        self.catching, self.frames, self.events = Catching(), 0, []

    def on(self, seconds, **facts):
        """Play on; return all that the character does in this time."""
        done = []
        for _ in range(round(seconds / FRAME)):
            known = {**EASILY, **facts}
            self.events += self.catching.update(Prospect(now=self.frames * FRAME, **known))
            done.append(self.catching.doing)
            self.frames += 1
        return list(dict.fromkeys(done))


@pytest.fixture
def play():
    play = Play()
    play.on(0.2)
    return play


def test_a_near_cube_is_touched_gladly(play):
    assert play.on(0.5)[-1] == "touch"
    assert play.on(0.1, touching=True) == ["cheer"]
    assert play.events == ["reached"]
    assert play.on(4.0)[-1] == "watch"
    assert play.catching.content


def test_a_cube_beyond_the_reach_is_stretched_for_in_vain_then_approached(play):
    assert play.on(STRETCH_S, effort=HARD, gap=0.05) == ["stretch"]
    assert play.on(SHRUG_S, effort=HARD, gap=0.05)[-1] == "shrug"
    assert play.events == ["unreachable"]
    assert play.on(0.2, effort=HARD, gap=0.05)[-1] == "come"
    assert play.on(0.1) == ["touch"]


def test_a_far_cube_is_pointed_at_before_it_goes_there(play):
    assert play.on(5.0, effort=FAR, gap=0.3) == ["point", "come"]
    assert play.events == []


def test_it_gives_up_where_going_does_not_help_and_tries_again_later(play):
    play.on(STRETCH_S + SHRUG_S + 0.1, effort=HARD)
    assert play.catching.doing == "sulk"
    assert play.on(SULK_S - 0.5, effort=HARD) == ["sulk"]
    assert play.on(0.7, effort=HARD)[-1] == "stretch"


def test_a_cube_that_comes_nearer_is_tried_again_at_once(play):
    play.on(STRETCH_S + SHRUG_S + 0.1, effort=HARD)
    assert play.on(0.1, effort=HARD - EASIER + 0.02) == ["sulk"]
    assert play.on(0.1, effort=HARD - EASIER - 0.02) == ["stretch"]


def test_a_cube_held_up_high_makes_it_shade_its_eyes_once(play):
    done = play.on(SHADE_S + STRETCH_S + SHRUG_S + 1.0, effort=FAR, height=1.4)
    assert done == ["shade", "stretch", "shrug", "sulk"]
    assert "shade" not in play.on(SULK_S, effort=FAR, height=1.4)
    play.on(0.2, effort=FAR, gap=0.2)
    assert "shade" in play.on(0.5, effort=FAR, height=1.4)


def test_a_cube_out_of_sight_is_looked_for_but_not_one_behind_fingers(play):
    play.on(0.5)
    assert play.on(LOST_S - 0.1, seen=False) == ["touch"]
    assert play.on(0.4, seen=False)[-1] == "search"
    assert play.on(9.0, seen=False) == ["search"]
    assert play.on(0.5)[-1] == "touch"


def test_a_caught_cube_is_caught_again_when_it_has_moved(play):
    play.on(0.2, touching=True)
    play.on(4.0, touching=True)
    assert play.on(1.0, cube=np.array([0.01, 0.0, 0.0])) == ["watch"]
    assert play.on(0.1, cube=np.array([0.05, 0.0, 0.0])) == ["touch"]


def test_nothing_flickers_where_the_cube_is_at_the_limit_of_its_reach(play):
    rng = np.random.default_rng(3)
    done = []
    for noise in rng.normal(0.0, 0.02, 240):
        done += play.on(FRAME, effort=1.10 + noise)
    changes = sum(one != other for one, other in pairwise(done))
    assert changes <= 4


@settings(max_examples=examples(30))
@given(
    st.lists(
        st.tuples(
            st.floats(0, 9), st.floats(0, 0.5), st.floats(0, 3), st.booleans(), st.booleans(),
            st.floats(0.03, 4),
        ),
        max_size=12,
    )
)  # fmt: skip
def test_whatever_the_hand_does_it_does_one_thing_at_a_time_and_comes_back(cases):
    play = Play()
    for effort, gap, height, seen, touching, seconds in cases:
        play.on(seconds, effort=effort, gap=gap, height=height, seen=seen, touching=touching)
    play.on(30.0, touching=True, cube=np.array([9.0, 0.0, 0.0]))
    assert play.catching.content
