"""Small things are fetched, carried in the hand, and put down beside the cube."""

import itertools
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cubeling.app.pipeline.table.obstacles import view_of
from cubeling.app.pipeline.table.props import GRIP
from cubeling.app.scenarios.reach.gift import HOP_M, HOP_S, SETTLE_S
from cubeling.app.scenarios.reach.gifts import AT_HAND_M, HOMES, PATIENCE_S, REJOICE_S, Gifts
from cubeling.tracking.synthetic import SyntheticOptions
from cubeling.tracking.synthetic.source import EYE_M, LOOK_AT_M, look_at, webcam

FRAME = 1 / 30
EDGE = 0.06
CUBE = np.array([0.0, 0.03, 0.05])


class Hand:
    """A body whose palms are where they are told to be."""

    place, posed = np.zeros(3), SimpleNamespace(table_from_character=np.eye(4))

    def __init__(self):
        self.at = np.array([0.0, 0.08, 0.03])

    def palm(self, side):
        return self.at


class Play:
    def __init__(self):
        self.gifts, self.now, self.events = Gifts(EDGE), 0.0, []
        self.hand: Any = Hand()
        self.gifts.lay_out(np.zeros(3))

    def on(self, seconds, cube=CUBE, free=True, there=True):
        for _ in range(round(seconds / FRAME)):
            self.now += FRAME
            self.gifts.end_pauses(self.now)
            self.events += self.gifts.update(self.now, cube, self.hand, free=free, there=there)

    def bring(self, cube=CUBE):
        """Let the hand follow what is asked of it until it has put a thing down."""
        before = len(self.events)
        for _ in range(round(4 * PATIENCE_S / FRAME)):
            if {"given", "finished"} & set(self.events[before:]):
                return
            goal = self.gifts.goal(cube)
            if goal is not None:
                self.hand.at = goal + GRIP
            self.on(FRAME, cube)
        pytest.fail(f"nothing was brought: it {self.gifts.doing}s")

    def thing(self, name):
        return next(each for each in self.gifts.things(self.now) if each.name == name)


@pytest.fixture
def play():
    return Play()


def test_the_first_thing_is_taken_when_the_hand_is_there(play):
    play.on(0.1)
    assert play.gifts.doing == "grasp"
    first = next(iter(HOMES))
    assert play.gifts.named == first
    play.on(0.5)
    assert play.gifts.held == ""
    play.hand.at = play.gifts.goal(CUBE) + GRIP + [0.0, 0.0, 0.9 * AT_HAND_M]
    play.on(FRAME)
    assert (play.gifts.held, play.events) == (first, ["taken"])


def test_a_thing_in_the_hand_sticks_to_it(play):
    play.on(0.1)
    play.hand.at = play.gifts.goal(CUBE) + GRIP
    play.on(2 * FRAME)
    held = play.thing(play.gifts.held)
    assert held.hand == play.gifts.hand
    play.on(SETTLE_S, there=False)
    np.testing.assert_allclose(play.thing(play.gifts.held).place, 0.0, atol=1e-12)


def test_a_thing_moves_without_a_jump_when_it_is_taken_and_put(play):
    """Even if the hand has lost patience before it was there."""
    play.on(0.2)
    name, places = play.gifts.named, []
    for _ in range(round((2 * PATIENCE_S + 1.0) / FRAME)):
        play.on(FRAME)
        thing = play.thing(name)
        places.append(thing.place if thing.hand is None else play.hand.at - GRIP + thing.place)
        if "given" in play.events and play.gifts.named != name:
            break
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    way = float(np.linalg.norm(play.hand.at - GRIP - [HOMES[name][0], 0.0, HOMES[name][1]]))
    assert play.events[:2] == ["taken", "given"]
    assert steps.max() < 1.6 * way * FRAME / SETTLE_S


def test_all_things_are_brought_beside_the_cube_and_apart_from_each_other(play):
    for _ in HOMES:
        play.bring()
    assert [each for each in play.events if each != "taken"] == ["given", "given", "finished"]
    play.on(REJOICE_S + 0.1)
    assert play.gifts.doing == "wait"
    places = [thing.place for thing in play.gifts.things(play.now)]
    for number, place in enumerate(places):
        assert place[1] == 0.0
        assert EDGE / 2 * math.sqrt(2) + 0.01 < math.dist(place[[0, 2]], CUBE[[0, 2]]) < 0.09
        assert all(math.dist(place, other) > 0.03 for other in places[:number])


def test_things_are_brought_again_when_the_cube_rests_elsewhere(play):
    for _ in HOMES:
        play.bring()
    play.on(REJOICE_S + 0.1, CUBE + [0.02, 0.0, 0.0])
    assert play.gifts.doing == "wait"
    play.on(0.1, CUBE - [0.2, 0.0, 0.1])
    assert play.gifts.doing == "grasp"


def test_it_keeps_a_thing_while_the_cube_is_moved_and_brings_it_to_where_it_is_put(play):
    play.on(0.1)
    play.hand.at = play.gifts.goal(CUBE) + GRIP
    play.on(0.1)
    name = play.gifts.held
    play.on(2.0, free=False)
    assert play.gifts.held == name
    elsewhere = CUBE - [0.25, 0.0, 0.1]
    play.bring(elsewhere)
    play.on(SETTLE_S, elsewhere, free=False)
    assert math.dist(play.thing(name).place, elsewhere - [0.0, elsewhere[1], 0.0]) < 0.08


def test_nothing_is_fetched_while_the_cube_is_played_with(play):
    play.on(1.0, free=False)
    assert play.gifts.doing == "wait"
    play.on(0.1)
    play.on(0.1, free=False)
    assert play.gifts.doing == "wait"
    assert play.events == []


def test_a_shake_lets_all_things_hop_home(play):
    play.bring()
    play.on(0.1)
    play.gifts.scatter(play.hand, play.now)
    play.on(HOP_S / 2, free=False)
    assert max(thing.place[1] for thing in play.gifts.things(play.now)) > 0.8 * HOP_M
    play.on(HOP_S, free=False)
    for thing in play.gifts.things(play.now):
        x, z = HOMES[thing.name]
        np.testing.assert_allclose(thing.place, [x, 0.0, z], atol=1e-12)
        assert thing.hand is None


def test_a_thing_hops_aside_when_the_cube_is_put_down_on_it(play):
    x, z = HOMES["flag"]
    play.gifts.make_way(np.array([x, 0.2, z]), play.now)
    np.testing.assert_allclose(play.thing("flag").place, [x, 0.0, z])
    under = np.array([x + 0.01, EDGE / 2, z])
    for _ in range(round(1.0 / FRAME)):
        play.gifts.make_way(under, play.now)
        play.on(FRAME, under, free=False)
    assert math.dist(play.thing("flag").place[[0, 2]], under[[0, 2]]) > EDGE / 2 * math.sqrt(2)


def seen_by(width, height):
    """Return how a camera that is near sees the table, with the cube in the middle."""
    camera = webcam(SyntheticOptions(width=width, height=height))
    controls: Any = SimpleNamespace(camera_from_table=look_at(0.65 * EYE_M, LOOK_AT_M))
    return view_of(controls, camera)


def places(view):
    gifts = Gifts(EDGE)
    gifts.lay_out(np.zeros(3), view)
    return {each.name: each.place for each in gifts.things(0.0)}


def test_all_things_lie_in_the_picture_of_a_phone_that_is_held_upright():
    wide, upright = places(seen_by(1280, 720)), places(seen_by(720, 1280))
    assert {name: tuple(place[[0, 2]]) for name, place in wide.items()} == HOMES
    view = seen_by(720, 1280)
    assert view.misses(np.array([*wide.values()]), ()).any(), "they would not"
    assert not view.misses(np.array([*upright.values()]), ()).any()
    for name, place in upright.items():
        assert np.hypot(*place[[0, 2]]) == pytest.approx(np.hypot(*HOMES[name]))
    apart = [np.linalg.norm(a - b) for a, b in itertools.combinations(upright.values(), 2)]
    assert min(apart) > 0.1
