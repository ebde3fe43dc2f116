"""Cards are drawn in two steps: what stays, kept, and what moves, each time."""

from dataclasses import replace

import numpy as np

from app.pipeline.step import RobotView
from app.ui.overlay import overlay
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
