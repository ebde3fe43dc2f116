"""Cards are drawn in two steps: what stays, kept, and what moves, each time."""

from dataclasses import replace

import numpy as np

from app.pipeline.step import RobotView
from app.ui.cards.layout import CARD_MARGIN
from app.ui.cards.overlay import CARD_HEIGHT, overlay
from characters import ActionIntent, LocomotionIntent


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


def card_titles(a_step, *icons):
    """Return the part of the action's card that holds its title, for each icon."""
    step = a_step(None)
    step = replace(step, controls=replace(step.controls, camera_from_table=np.eye(4)))
    top, left = round(720 - CARD_HEIGHT - CARD_MARGIN), round(CARD_MARGIN)
    for icon in icons:
        shown = replace(step, outcome=replace(step.outcome, icon=icon))
        picture = overlay(
            np.full((720, 1280, 3), 90, np.uint8), shown, RobotView("ready", 0.0, "neutral")
        )
        yield picture[top + 12 : top + 56, left + 100 : left + 280]


def test_a_character_that_stands_is_called_idle_in_every_scenario(a_step):
    stand, idle, walk = card_titles(a_step, "stand", "idle", "walk")
    np.testing.assert_array_equal(stand, idle)
    assert (walk != idle).any()


def test_an_action_without_an_icon_has_a_card_with_its_name(a_step):
    wave, idle = card_titles(a_step, "wave", "idle")
    assert (wave != idle).any()
