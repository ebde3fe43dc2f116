"""The whole play of `reach`: a character, its body and the things on the table."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from cubeling.app.pipeline.scenario import Inputs, ScenarioSettings
from cubeling.app.pipeline.table.props import GRIP, BodyParts, PosedBody, Thing
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios.reach.behaviour import GESTURES
from cubeling.app.scenarios.reach.gifts import AT_HAND_M
from cubeling.app.scenarios.reach.intents import (
    LEAVE_S,
    Ongoing,
    bundled_gesture,
    gesture_times,
    leave,
)
from cubeling.app.scenarios.reach.places import nearest_point_of_cube, sides_of_cube
from cubeling.app.scenarios.reach.scenario import Reach
from cubeling.characters import Animator, Character
from cubeling.characters.behaviour.intents import ReachIntent, Times
from cubeling.characters.rendering.toys import TOYS, toy
from cubeling.tracking import CubeModel


class Play:
    """A character that reaches for a cube that the hand puts anywhere."""

    def __init__(self, hand, name="human"):
        self.hand = hand
        self.character = Character.load(name)
        self.reach = Reach(CubeModel.load("locomotion"), ScenarioSettings())
        self.animator = Animator(self.character, place=self.reach.start)
        self.parts = BodyParts.of(self.character, self.animator.scale)
        self.body: Any = None
        self.events: list[str] = []
        self.outcomes: list[Any] = []

    def on(self, seconds, x=0.02, y=0.03, z=0.02, **changes):
        """Play on with the cube at a place; return the titles of the cards that are shown."""
        cube = np.eye(4)
        cube[:3, 3] = x, y, z
        titles = []
        for _ in range(round(seconds * 30)):
            controls = self.hand.frame(position=cube[[0, 2], 3], **changes)
            situation = Situation(
                character=None if self.body is None else self.body.posed,
                body=self.body,
                actions=self.animator.actions,
                walks=self.animator.walks,
                body_length=self.animator.length,
                cube=cube if controls.visible else None,
            )
            outcome = self.reach.update(controls, situation, Inputs())
            self.body = PosedBody(self.character, self.parts, self.animator.update(outcome.command))
            self.events += outcome.events
            self.outcomes.append(outcome)
            titles.append(outcome.icon)
        return list(dict.fromkeys(titles))


@pytest.fixture
def play(hand):
    return Play(hand)


def test_it_stretches_in_vain_gives_up_walks_there_and_touches_the_cube(play):
    titles = play.on(8.0, x=0.08)
    order = [titles.index(title) for title in ("stretch", "shrug", "walk", "reach", "cheer")]
    assert order == sorted(order)
    assert play.events[:2] == ["unreachable", "reached"]


def test_what_it_cannot_reach_frustrates_it_and_what_it_reaches_delights_it(play):
    play.on(2.0, x=0.08)
    before = play.outcomes[-1].emotion.emotion.valence
    play.on(1.0, x=0.08)
    frustrated = play.outcomes[-1].emotion.emotion.valence
    assert frustrated < before - 0.1
    play.on(4.5, x=0.08)
    assert play.outcomes[-1].emotion.emotion.valence > frustrated + 0.1


def test_it_bends_down_for_a_cube_that_the_torso_alone_does_not_reach(play):
    """The cube is touched from where it stands, which needs hips and knees."""
    play.on(2.5, x=-0.03)
    touched = nearest_point_of_cube(np.eye(4), 0.06, play.body.chest - [-0.03, 0.03, 0.02])
    seen = (touched + [-0.03, 0.03, 0.02] - play.body.place) / play.animator.scale
    turn = play.body.posed.table_from_character[:3, :3] / play.animator.scale
    rest = play.character.skeleton.rest
    assert play.character.upper_body.effort(rest, seen @ turn) > 1.3
    assert play.events[:1] == ["reached"]
    start = np.array([play.reach.start.x, 0.0, play.reach.start.z])
    assert np.linalg.norm(play.body.place - start) < 0.02


def test_it_holds_a_cube_in_the_air_with_both_hands_and_moves_along(play):
    play.on(5.0, x=-0.05, y=0.085, resting=False)
    assert play.outcomes[-1].icon == "take"
    for step in range(30):
        y = 0.085 + 0.015 * np.sin(step / 8)
        play.on(1 / 30, x=-0.05, y=y, resting=False)
        cube = np.eye(4)
        cube[:3, 3] = -0.05, y, 0.02
        left = play.body.posed.table_from_character[:3, 0]
        sides = sides_of_cube(cube, CubeModel.load("locomotion").edge, left)
        for side, (place, _) in zip(("left", "right"), sides, strict=True):
            assert np.linalg.norm(play.body.palm(side) - place) < 0.004
    assert play.on(1.0, x=-0.05, y=0.03)[-1] != "take"


def test_it_brings_a_thing_in_its_hand_to_where_the_cube_rests(play):
    play.on(3.0)
    names: list[str] = []
    palms = []
    while "given" not in play.events:
        before = play.body
        play.on(1 / 30)
        held = [thing for thing in play.outcomes[-1].things if thing.hand]
        if held and not names:  # not through the air, because it has lost patience
            flower = play.outcomes[-2].things[0]
            away = before.palm(held[0].hand) - flower.place - GRIP
            assert np.linalg.norm(away) < AT_HAND_M
        names += [thing.name for thing in held]
        for thing in held:
            placed = play.body.place_thing(thing).posed.table_from_character[:3, 3]
            palms.append(placed - thing.place + GRIP - play.body.palm(thing.hand))
        assert len(play.outcomes) < 30 * 25
    assert set(names) == {"flower"}
    np.testing.assert_allclose(palms, 0.0, atol=1e-12)
    play.on(1.0)
    flower = next(each for each in play.outcomes[-1].things if each.name == "flower")
    assert flower.place[1] == 0.0
    assert np.linalg.norm(flower.place - [0.02, 0.0, 0.02]) < 0.08


def test_a_cube_out_of_sight_makes_it_shade_its_eyes_and_look_about(play):
    play.on(1.0)
    assert play.on(5.0, visible=False)[-1] == "search"
    command = play.outcomes[-1].command
    assert command.visible
    (gesture,) = command.behaviour.gestures
    assert gesture.gesture.name == "SHADE_EYES"
    looks = [each.command.behaviour.gazes[-1].target for each in play.outcomes[-90:]]
    assert np.ptp(looks, axis=0).max() > 0.2
    for _ in range(30):  # fewer frames than a camera has
        play.hand.frames += 10
        play.on(1 / 30, visible=False)
    assert not play.outcomes[-1].command.visible


def test_a_shaken_cube_lets_things_hop_and_changes_the_mood(play):
    play.on(2.0)
    before = play.outcomes[-1].emotion.emotion.arousal
    play.on(0.4, gestures=("shaken",))
    assert max(thing.place[1] for thing in play.outcomes[-1].things) > 0.02
    assert play.outcomes[-1].emotion.emotion.arousal > before + 0.1


def test_it_steps_out_of_a_cube_that_is_put_down_on_it(play):
    play.on(1.0)
    x, _, z = play.body.place
    play.on(4.0, x=x, z=z)
    assert np.linalg.norm(play.body.place - [x, 0.0, z]) > 0.04


@pytest.mark.full  # eighteen seconds are played
def test_no_title_flashes(play):
    """Whatever is shown stays for a moment, or the player cannot read it."""
    play.on(13.0)
    play.on(2.0, x=0.10, y=0.12, resting=False, lifted=True)
    play.on(3.0, x=0.10, z=-0.05, resting=True, lifted=False)
    titles = [outcome.icon for outcome in play.outcomes[3:]]
    changes = [number for number, (a, b) in enumerate(pairwise(titles)) if a != b]
    assert min(b - a for a, b in pairwise(changes)) >= 4


def test_a_character_on_four_legs_plays_too(hand):
    play = Play(hand, "vleo")
    play.on(7.0)
    assert "reached" in play.events


def test_every_gesture_exists():
    assert all(bundled_gesture(name).name == name for name in GESTURES.values())


@pytest.mark.parametrize("name", TOYS)
def test_a_toy_stands_on_the_table_and_has_a_stick_to_hold(name):
    (mesh,) = toy(name).meshes
    assert mesh.positions[:, 1].min() == pytest.approx(0.0, abs=1e-6)
    corners = mesh.positions[mesh.triangles]
    at_grip = (corners[..., 1].min(1) < GRIP[1]) & (corners[..., 1].max(1) > GRIP[1])
    assert np.abs(corners[at_grip][..., [0, 2]]).max() < 0.003
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", faces, mesh.normals[mesh.triangles[:, 0]]) > -1e-12).all()
    assert toy(name) is toy(name)


def test_a_character_without_hands_leaves_things_where_they_are(hand):
    play = Play(hand)
    play.parts = replace(play.parts, hands={})
    play.on(9.0)
    assert "reached" in play.events
    assert "taken" not in play.events
    where = play.body.place_thing(Thing("flag", np.array([0.1, 0.0, 0.0]), "left"))
    assert where.posed.table_from_character[0, 3] == 0.1


def test_an_intent_goes_on_with_its_first_times_and_a_new_target():
    hands: Ongoing[ReachIntent] = Ongoing()
    (first,) = hands.update(0.0, ReachIntent("cube", np.zeros(3), Times(0.0, 0.6)))
    (later,) = hands.update(1.0, ReachIntent("cube", np.ones(3), Times(1.0, 1.6)))
    assert (later.key, later.times) == (first.key, first.times)
    assert later.target[0] == 1.0


def test_an_intent_that_is_no_longer_wanted_ends_while_the_next_one_begins():
    hands: Ongoing[ReachIntent] = Ongoing()
    hands.update(0.0, ReachIntent("cube", np.zeros(3), Times(0.0, 0.6)))
    old, new = hands.update(0.3, ReachIntent("thing", np.zeros(3), Times(0.3, 0.9)))
    assert (old.times.relax, old.times.end) == (0.3, 0.3 + LEAVE_S)
    assert (new.times.relax, new.times.end) == (None, None)
    assert len({old.key, new.key}) == 2
    assert len(hands.update(0.3 + LEAVE_S, None)) == 1
    assert hands.update(2.0, None) == ()


def test_a_gesture_that_is_cut_short_keeps_the_order_of_its_phases():
    whole: Any = gesture_times(bundled_gesture("SHRUG"), 1.0)
    for now in np.arange(1.0, whole.end, 0.05):
        cut: Any = leave(whole, float(now))
        times = [cut.start, cut.ready, cut.stroke_start, cut.stroke, cut.stroke_end, cut.relax]
        assert times == sorted(times)
        assert cut.end <= now + LEAVE_S
