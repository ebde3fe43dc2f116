"""Cards are drawn in two steps: what stays, kept, and what moves, each time."""

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from typing import Any

import numpy as np
from hypothesis import example, given, strategies as st

from cubeling.app.pipeline.step import RobotView
from cubeling.app.ui.canvas import Card
from cubeling.app.ui.cards.layout import CARD_MARGIN, SLIDING_S, CardLayout
from cubeling.app.ui.cards.overlay import CARD_HEIGHT, overlay, virtual_robot_side
from cubeling.characters import ActionIntent, LocomotionIntent
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.speech.speech import Utterance
from cubeling.tracking import has_icon


def test_what_was_drawn_before_leaves_nothing_on_the_cards(a_step):
    step = a_step(None)
    image = np.full((720, 1280, 3), 90, np.uint8)
    happy, angry = RobotView("ready", 0.9, "happy"), RobotView("ready", -0.9, "happy")
    first = overlay(image.copy(), step, happy)
    command = replace(
        step.command,
        locomotion=LocomotionIntent(step.command.speed + 1.0),
        action=ActionIntent("kiss", -0.5),
    )
    faster = replace(step, outcome=replace(step.outcome, command=command))
    between = overlay(image.copy(), faster, angry)
    again = overlay(image.copy(), step, happy)
    np.testing.assert_array_equal(first, again)
    assert (between != first).any()


def card_titles(a_step, *icons, left_px=100, **changes):
    """Return the part of the action's card that holds its title, for each icon."""
    step = replace(a_step(None), **changes)
    step = replace(step, controls=replace(step.controls, camera_from_table=np.eye(4)))
    top, left = round(720 - CARD_HEIGHT - CARD_MARGIN), round(CARD_MARGIN)
    for icon in icons:
        shown = replace(step, outcome=replace(step.outcome, icon=icon))
        picture = overlay(
            np.full((720, 1280, 3), 90, np.uint8), shown, RobotView("ready", 0.0, "neutral")
        )
        yield picture[top + 12 : top + 56, left + left_px : left + left_px + 180]


def test_a_character_that_stands_is_called_idle_in_every_scenario(a_step):
    stand, idle, walk = card_titles(a_step, "stand", "idle", "walk")
    np.testing.assert_array_equal(stand, idle)
    assert (walk != idle).any()


def test_an_action_without_an_icon_has_a_card_with_its_name(a_step):
    wiggle, idle = card_titles(a_step, "wiggle", "idle")
    assert (wiggle != idle).any()


def test_who_stands_upright_has_no_dinosaur_on_its_card(a_step):
    where = {"left_px": 20, "has_intensity": True}
    idle, stand = card_titles(a_step, "idle", "stand", stands_upright=True, **where)
    (vleo,) = card_titles(a_step, "idle", **where)
    icon = np.s_[:, :70]
    assert (idle[icon] != vleo[icon]).any()
    shapes = [
        np.abs(each[icon].astype(int) - each[2, 34]).max(axis=2) > 60 for each in (idle, stand)
    ]
    np.testing.assert_array_equal(*shapes)


def test_what_the_human_can_do_has_icons_and_others_share_one(a_step):
    assert [act for act in ("wave", "cheer", "jump", "nod", "shake") if not has_icon(act)] == []
    wiggle, twist = card_titles(a_step, "wiggle", "twist", left_px=20)
    np.testing.assert_array_equal(wiggle[:, :70], twist[:, :70])


def test_only_an_action_with_an_intensity_has_its_slider(a_step):
    """The knob of another would never move."""
    step = a_step(None)
    step = replace(step, controls=replace(step.controls, camera_from_table=np.eye(4)))

    def card(weight, has_intensity):
        command = replace(step.command, locomotion=None, action=ActionIntent("wave", weight))
        outcome = replace(step.outcome, icon="wave", command=command)
        shown = replace(step, outcome=outcome, has_intensity=has_intensity)
        image = np.full((720, 1280, 3), 90, np.uint8)
        return overlay(image, shown, RobotView("ready", 0.0, "neutral"))

    np.testing.assert_array_equal(card(-0.5, False), card(0.5, False))
    assert (card(-0.5, True) != card(0.5, True)).any()


texts = st.lists(st.text("iamWé", min_size=1, max_size=12), max_size=20).map(
    lambda words: " ".join(words)[:76]
)
corners = st.tuples(st.floats(-0.1, 0.9), st.floats(-0.1, 0.9))
FOLLOW = "Move the cube: I follow you"


def test_cards_that_do_not_move_never_lie_over_each_other(a_step, monkeypatch):
    step, drawn = a_step(None), []

    def note(card, picture):
        height, width = card.opacity.shape
        drawn.append((card.x, card.y, card.x + width, card.y + height))

    monkeypatch.setattr(Card, "blend_over", note)

    @given(
        st.integers(120, 1080),
        st.floats(0.45, 2.4),
        texts,
        texts,
        st.booleans(),
        st.lists(corners, min_size=1, max_size=4),
    )
    @example(720, 404 / 720, FOLLOW, "", False, [(0.2, 0.4)])
    @example(240, 4 / 3, FOLLOW, "I am walking to the place that you show me", True, [(0.8, 0.8)])
    def check(height, aspect, hint, said, is_real, subjects):
        picture = np.broadcast_to(np.uint8(0), (height, round(aspect * height), 3))
        side = virtual_robot_side(height)
        virtual: Any = SimpleNamespace(
            portrait=lambda _: np.zeros((side, side, 3), np.uint8), card=lambda _, draw: draw()
        )
        robot, layout = RobotView("ready", 0.0, "neutral", is_real), CardLayout()
        speech = SpeechIntent(Utterance(said, "en", 1.0), 0.0)
        outcome = replace(step.outcome, hint=hint, command=replace(step.command, speech=speech))
        for number, share in enumerate(subjects):
            left, top = np.multiply(share, picture.shape[1::-1]).tolist()
            shown = replace(
                step,
                frame=replace(step.frame, timestamp=3.0 * number),
                controls=replace(step.controls, camera_from_table=np.eye(4)),
                outcome=outcome,
                subjects=((left, top, left + 0.3 * height, top + 0.3 * height),),
            )
            overlay(picture, shown, robot, virtual, layout)
            drawn.clear()
            later = replace(shown, frame=replace(shown.frame, timestamp=3.0 * number + SLIDING_S))
            overlay(picture, later, robot, virtual, layout)
            assert len(drawn) == 2 + bool(hint) + bool(said)
            for a, b in combinations(drawn, 2):
                assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
            assert all(y >= 0 and bottom <= height for _, y, _, bottom in drawn)

    check()


def test_cards_leave_the_middle_of_an_upright_picture_free(a_step):
    step = a_step(None)
    subject = (66.0, 276.0, 349.0, 535.0)  # the cube and a hand at it
    step = replace(
        step, controls=replace(step.controls, camera_from_table=np.eye(4)), subjects=(subject,)
    )
    picture = np.zeros((720, 404, 3), np.uint8)
    virtual: Any = SimpleNamespace(
        portrait=lambda _: np.zeros((180, 180, 3), np.uint8), card=lambda _, draw: draw()
    )
    overlay(picture, step, RobotView("ready", 0.0, "neutral"), virtual)
    assert picture.any()
    assert not picture[276:535].any()
