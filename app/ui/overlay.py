"""What lies over the picture: what to do now, what the character does, how the robot feels."""

import math
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from app.pipeline.step import RobotView, Step
from app.ui.canvas import Canvas, Card, text_width
from app.ui.notice import Notice
from app.ui.palette import ACTION, ANGRY, INK, PAPER, QUIET, RULE, Color, between, mood_color
from app.ui.robot_face import draw_face
from app.ui.virtual_robot import VirtualRobot

HEIGHT = 720.0
"""Height of a picture in design units."""

LEFT, WIDE = 108.0, 160.0
"""Left end of the bar for speed or intensity on its card, and its length."""

MOODS_LEFT, MOODS_WIDE = 116.0, 176.0
"""The same of the bar for the robot's mood."""

SIDE, FRAME = 180.0, 8.0
"""Side of the virtual robot on its card, and the card's rim about it."""

NARROW = 156.0
"""Length of the bar under the virtual robot."""

UNDER = SIDE + FRAME + 4.0
"""Where the words under it begin."""

LEVEL = 70.0
"""How far below a card's top edge its bar is."""

WORDS = {
    "stand": "Stand",
    "idle": "Idle",
    "walk": "Walk",
    "run": "Run",
    "kiss": "Kiss",
    "shout": "Shout",
}


def cards(
    step: Step, robot: RobotView, size: tuple[int, int], virtual_robot: VirtualRobot | None = None
) -> list[Card]:
    """Draw all cards for one frame of `size` (width, height); see `overlay`."""
    scale = size[1] / HEIGHT
    width = size[0] / scale
    shown = [_hint(step.outcome.hint, width, scale)]
    if virtual_robot is None or robot.real:
        shown.append(_robot(robot, width, scale))
    else:
        shown.append(_absent_robot(robot, virtual_robot.portrait(step.emotion), width, scale))
    if step.controls.camera_from_table is not None:
        shown.append(_action(step, scale))
    return shown


def overlay(
    picture: NDArray[np.uint8],
    step: Step,
    robot: RobotView,
    virtual_robot: VirtualRobot | None = None,
) -> NDArray[np.uint8]:
    """Return the picture (H, W, 3) with all cards laid over it, in place.

    Where no real robot shows what it feels, the virtual robot does; without one, a drawn face.
    """
    for card in cards(step, robot, (picture.shape[1], picture.shape[0]), virtual_robot):
        card.over(picture)
    return picture


def virtual_robot_side(height: int) -> int:
    """Return the side of the virtual robot in pictures of a height, both in pixels."""
    return round(SIDE * height / HEIGHT)


DIMMED = 0.45
"""What is left of the last picture's brightness while no new one comes."""


def interrupted(picture: NDArray[np.uint8], notice: Notice) -> NDArray[np.uint8]:
    """Return the last picture (H, W, 3), dimmed, with a card that says why no new one comes."""
    dim = np.asarray(cv2.convertScaleAbs(picture, alpha=DIMMED), np.uint8)
    scale = picture.shape[0] / HEIGHT
    _notice(notice, picture.shape[1] / scale, scale).over(dim)
    return dim


@lru_cache(maxsize=4)
def _notice(notice: Notice, width: float, scale: float) -> Card:
    wide = max(text_width(notice.title, 30), text_width(notice.advice, 20)) + 152
    canvas = Canvas(wide, 116, scale)
    canvas.disc(58, 58, 34, ANGRY)
    canvas.line([[58, 41], [58, 61]], PAPER, 8)
    canvas.disc(58, 75, 4.6, PAPER)
    canvas.text(112, 54, notice.title, 30, INK)
    canvas.text(112, 86, notice.advice, 20, QUIET)
    return canvas.card((width - wide) / 2, (HEIGHT - 116) / 2)


@lru_cache(maxsize=16)
def _hint(words: str, width: float, scale: float) -> Card:
    wide = text_width(words, 24) + 56
    canvas = Canvas(wide, 48, scale)
    canvas.text(wide / 2, 32.5, words, 24, INK, "middle")
    return canvas.card((width - wide) / 2, 22)


def _action(step: Step, scale: float) -> Card:
    name = step.outcome.icon
    moves = step.command.activity == "move" or name in ("stand", "walk", "run")
    canvas = _action_blank(name, moves, scale).copy()
    if moves:
        _speed(canvas, step.command.speed, ACTION.get(name, INK))
    elif name != "idle":
        _intensity(canvas, step.command.weight, ACTION.get(name, INK))
    return canvas.card(24, HEIGHT - 132)


@lru_cache(maxsize=16)
def _action_blank(name: str, moves: bool, scale: float) -> Canvas:
    """Draw what stays as long as the action does."""
    canvas = Canvas(292, 108, scale)
    canvas.disc(54, 54, 38, ACTION.get(name, INK))
    canvas.icon(32, 32, 44, name, PAPER)
    canvas.text(108, 42, WORDS.get(name, name.title()), 28, INK)
    canvas.bar(LEFT, LEVEL, WIDE, 10, RULE)
    if moves:
        canvas.text(LEFT, 95, "speed", 15, QUIET)
    elif name == "idle":
        canvas.text(LEFT, 95, "resting", 15, QUIET)
    else:
        canvas.text(LEFT, 95, "a little", 15, QUIET)
        canvas.text(LEFT + WIDE, 95, "a lot", 15, QUIET, "right")
    return canvas


def _speed(canvas: Canvas, speed: float, color: Color) -> None:
    canvas.bar(LEFT, LEVEL, max(10.0, WIDE * min(speed, 5.0) / 5.0), 10, color)
    for mark in (0.5, 3.0):
        canvas.disc(LEFT + WIDE * mark / 5.0, LEVEL, 2.2, PAPER)
    canvas.text(LEFT + WIDE, 95, f"{speed:.1f}", 15, QUIET, "right")


def _intensity(canvas: Canvas, weight: float, color: Color) -> None:
    middle = LEFT + WIDE / 2
    knob = LEFT + 7 + (WIDE - 14) * (weight + 1) / 2
    canvas.line([[middle, LEVEL], [knob, LEVEL]], between(color, PAPER, 0.35), 10)
    canvas.disc(middle, LEVEL, 2.5, QUIET)
    canvas.disc(knob, LEVEL, 11, PAPER)
    canvas.disc(knob, LEVEL, 8.5, color)


def _robot(robot: RobotView, width: float, scale: float) -> Card:
    words = {"none": "no robot", "ready": f"robot is {robot.label}"}.get(
        robot.link, f"robot {robot.link}"
    )
    canvas = _robot_blank(words, scale).copy()
    mood = robot.mood if math.isfinite(robot.mood) else 0.0
    draw_face(canvas, 56, 54, 38, mood)
    _mood_knob(canvas, MOODS_LEFT, LEVEL, MOODS_WIDE, mood)
    return canvas.card(width - 316 - 24, HEIGHT - 132)


def _absent_robot(
    robot: RobotView, portrait: NDArray[np.uint8], width: float, scale: float
) -> Card:
    """Draw the card of the virtual robot."""
    caption = {"none": "no robot connected", "ready": "simulated robot"}.get(
        robot.link, f"simulated robot {robot.link}"
    )
    words = f"robot is {robot.label}"
    canvas = _absent_blank(words, caption, scale).copy()
    canvas.picture(FRAME, FRAME, portrait, 12)
    mood = robot.mood if math.isfinite(robot.mood) else 0.0
    _mood_knob(canvas, FRAME + (SIDE - NARROW) / 2, UNDER + 65, NARROW, mood)
    return canvas.card(width - SIDE - 2 * FRAME - 24, HEIGHT - UNDER - 106 - 24)


def _mood_knob(canvas: Canvas, left: float, level: float, wide: float, mood: float) -> None:
    knob = left + wide * (mood + 1) / 2
    canvas.disc(knob, level, 12, PAPER)
    canvas.disc(knob, level, 9.0, INK)


@lru_cache(maxsize=16)
def _robot_blank(words: str, scale: float) -> Canvas:
    """Draw what stays whatever the robot's mood is."""
    canvas = Canvas(316, 108, scale)
    canvas.text(112, 42, words, _fitting(words, 25, 316 - 112 - 28), INK)
    _mood_scale(canvas, MOODS_LEFT, LEVEL, MOODS_WIDE)
    return canvas


@lru_cache(maxsize=16)
def _absent_blank(words: str, caption: str, scale: float) -> Canvas:
    """Draw what stays under the virtual robot."""
    canvas = Canvas(SIDE + 2 * FRAME, UNDER + 106, scale)
    size = _fitting(words, 23, SIDE - 12)
    canvas.text(FRAME + SIDE / 2, UNDER + 24, words, size, INK, "middle")
    canvas.text(FRAME + SIDE / 2, UNDER + 44, caption, 14, QUIET, "middle")
    _mood_scale(canvas, FRAME + (SIDE - NARROW) / 2, UNDER + 65, NARROW)
    return canvas


def _fitting(words: str, size: float, wide: float) -> float:
    """Return a size of letters, at most `size`, in which words are no wider than `wide`."""
    return size * min(1.0, wide / text_width(words, size))


def _mood_scale(canvas: Canvas, left: float, level: float, wide: float) -> None:
    """Draw the bar from angry over neutral to happy, with its words under it."""
    for share in np.linspace(0.0, 1.0, 64):
        canvas.disc(left + wide * share, level, 5.0, mood_color(2 * share - 1))
    for name, share, align in (
        ("angry", 0.0, "left"),
        ("neutral", 0.5, "middle"),
        ("happy", 1.0, "right"),
    ):
        canvas.text(left + wide * share, level + 27, name, 14, QUIET, align)
