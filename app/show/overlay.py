"""What lies over the picture: what to do now, what the character does, how the robot feels."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.playground import Step
from app.show.canvas import Canvas, Card, text_width
from app.show.palette import ACTION, INK, PAPER, QUIET, RULE, Color, between, mood_color
from app.show.robot_face import draw_face

HEIGHT = 720.0
"""Height of a picture in design units."""

WORDS = {
    "stand": "Stand",
    "idle": "Idle",
    "walk": "Walk",
    "run": "Run",
    "kiss": "Kiss",
    "shout": "Shout",
}


@dataclass(frozen=True)
class RobotView:
    """What is known of the robot when a frame is shown."""

    link: str
    """"ready", "connecting", "lost", "none" …"""

    mood: float
    """Valence that the robot itself reports, −1…1; the asked one where there is no robot."""

    label: str
    """Its word for it: "angry", "neutral", "happy"."""


def cards(step: Step, robot: RobotView, size: tuple[int, int]) -> list[Card]:
    """Draw all cards for one frame of `size` (width, height)."""
    scale = size[1] / HEIGHT
    width = size[0] / scale
    shown = [_hint(step.outcome.hint, width, scale), _robot(robot, width, scale)]
    if step.controls.camera_from_table is not None:
        shown.append(_action(step, scale))
    return shown


def overlay(picture: NDArray[np.uint8], step: Step, robot: RobotView) -> NDArray[np.uint8]:
    """Return the picture (H, W, 3) with all cards laid over it, in place."""
    for card in cards(step, robot, (picture.shape[1], picture.shape[0])):
        card.over(picture)
    return picture


def _hint(words: str, width: float, scale: float) -> Card:
    wide = text_width(words, 24) + 56
    canvas = Canvas(wide, 48, scale)
    canvas.text(wide / 2, 32.5, words, 24, INK, "middle")
    return canvas.card((width - wide) / 2, 22)


def _action(step: Step, scale: float) -> Card:
    canvas = Canvas(292, 108, scale)
    name = step.outcome.icon
    color = ACTION.get(name, INK)
    canvas.disc(54, 54, 38, color)
    canvas.icon(32, 32, 44, name, PAPER)
    canvas.text(108, 42, WORDS.get(name, name.title()), 28, INK)
    if step.command.action == "move" or name in ("stand", "walk", "run"):
        _speed(canvas, step.command.speed, color)
    else:
        _intensity(canvas, step.command.weight, color, name)
    return canvas.card(24, HEIGHT - 132)


def _speed(canvas: Canvas, speed: float, color: Color) -> None:
    left, wide, y = 108.0, 160.0, 70.0
    canvas.bar(left, y, wide, 10, RULE)
    canvas.bar(left, y, max(10.0, wide * min(speed, 5.0) / 5.0), 10, color)
    for mark in (0.5, 3.0):
        canvas.disc(left + wide * mark / 5.0, y, 2.2, PAPER)
    canvas.text(left, 95, "speed", 15, QUIET)
    canvas.text(left + wide, 95, f"{speed:.1f}", 15, QUIET, "right")


def _intensity(canvas: Canvas, weight: float, color: Color, name: str) -> None:
    left, wide, y = 108.0, 160.0, 70.0
    middle = left + wide / 2
    canvas.bar(left, y, wide, 10, RULE)
    if name == "idle":
        canvas.text(left, 95, "resting", 15, QUIET)
        return
    knob = left + 7 + (wide - 14) * (weight + 1) / 2
    canvas.line([[middle, y], [knob, y]], between(color, PAPER, 0.35), 10)
    canvas.disc(middle, y, 2.5, QUIET)
    canvas.disc(knob, y, 11, PAPER)
    canvas.disc(knob, y, 8.5, color)
    canvas.text(left, 95, "a little", 15, QUIET)
    canvas.text(left + wide, 95, "a lot", 15, QUIET, "right")


def _robot(robot: RobotView, width: float, scale: float) -> Card:
    canvas = Canvas(316, 108, scale)
    mood = robot.mood if math.isfinite(robot.mood) else 0.0
    draw_face(canvas, 56, 54, 38, mood)
    words = {"none": "no robot", "ready": f"robot is {robot.label}"}.get(
        robot.link, f"robot {robot.link}"
    )
    canvas.text(112, 42, words, 25, INK)
    left, wide, y = 116.0, 176.0, 70.0
    for share in np.linspace(0.0, 1.0, 64):
        canvas.disc(left + wide * share, y, 5.0, mood_color(2 * share - 1))
    knob = left + wide * (mood + 1) / 2
    canvas.disc(knob, y, 12, PAPER)
    canvas.disc(knob, y, 9.0, INK)
    for words, share in (("angry", 0.0), ("neutral", 0.5), ("happy", 1.0)):
        align = {0.0: "left", 0.5: "middle", 1.0: "right"}[share]
        canvas.text(left + wide * share, 97, words, 14, QUIET, align)
    return canvas.card(width - 316 - 24, HEIGHT - 132)
