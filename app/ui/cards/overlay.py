"""Cards over the picture: the hint, the character's action, the robot's mood."""

import math
from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.affect import OCC_FACES
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.pipeline.step import Rect, RobotView, Step, speech_start
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Canvas, Card, text_width
from cubeling.app.ui.cards.faces import draw_face
from cubeling.app.ui.cards.labels import label, readable
from cubeling.app.ui.cards.layout import (
    CARD_GAP,
    CARD_MARGIN,
    HINT_HEIGHT,
    HINT_ROOM,
    HINT_TOP,
    CardLayout,
    Corner,
)
from cubeling.app.ui.cards.subtitles import draw_subtitle, subtitle, subtitle_place, subtitle_room
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.notice import Notice
from cubeling.app.ui.palette import (
    ACTION_COLORS,
    ANGRY,
    INK,
    PAPER,
    QUIET,
    RULE,
    Color,
    between,
    mood_color,
)
from cubeling.tracking import OTHER_ACTION, has_icon

HALF_CAPITAL = 8.5 / 24.0
"""Half the height of capital letters, as a share of the size of a text."""

CARD_HEIGHT = 108.0
BAR_Y = 70.0
"""Distance of a bar from its card's top edge."""

ACTION_BAR_X, ACTION_BAR_WIDTH = 108.0, 160.0
"""Left end and length of the bar of speed or intensity."""

ACTION_CARD_WIDTH, ROBOT_CARD_WIDTH = 292.0, 316.0
MOOD_BAR_X, MOOD_BAR_WIDTH = 116.0, 176.0
"""Left end and length of the bar of the robot's mood."""

VIRTUAL_ROBOT_SIDE, VIRTUAL_ROBOT_FRAME = 180.0, 8.0
"""Side of the virtual robot's picture, and width of its card's frame."""

CLOSE_UP_SIDE = 256.0
"""Side of the look into the cube from near by."""

VIRTUAL_ROBOT_TEXT_Y = VIRTUAL_ROBOT_SIDE + VIRTUAL_ROBOT_FRAME + 4.0
"""Top of the text below the picture."""

VIRTUAL_ROBOT_CARD_WIDTH = VIRTUAL_ROBOT_SIDE + 2 * VIRTUAL_ROBOT_FRAME
VIRTUAL_ROBOT_CARD_HEIGHT = VIRTUAL_ROBOT_TEXT_Y + 106
MIN_VIRTUAL_ROBOT_WIDTH = 2 * CARD_MARGIN + VIRTUAL_ROBOT_CARD_WIDTH + CARD_GAP + ACTION_CARD_WIDTH
"""Width of the narrowest picture with the virtual robot, beside the action: in an upright one, so
high a card would hide the cube wherever it lies."""

VIRTUAL_ROBOT_BAR = ((VIRTUAL_ROBOT_CARD_WIDTH - 156.0) / 2, VIRTUAL_ROBOT_TEXT_Y + 65, 156.0)
"""Left end, height on the card, and length of the bar of its mood."""


def overlay(
    picture: NDArray[np.uint8],
    step: Step,
    robot: RobotView,
    virtual_robot: VirtualRobot | None = None,
    layout: CardLayout | None = None,
) -> NDArray[np.uint8]:
    """Return the picture (H, W, 3) with all cards blended over it, in place.

    Without a real robot, the virtual robot shows the mood; without both, or in a narrow picture, a
    drawn face does. `layout` remembers where the cards were in the pictures before; None for a
    single picture.
    """
    height, width = picture.shape[:2]
    for card in cards_over(step, robot, (width, height), virtual_robot, layout):
        card.blend_over(picture)
    return picture


def cards_over(
    step: Step,
    robot: RobotView,
    size: tuple[int, int],
    virtual_robot: VirtualRobot | None = None,
    layout: CardLayout | None = None,
) -> list[Card]:
    """Return the cards over a picture of a size [px]: those that stay the same are the same object.

    The subjects of the step are places in a picture of that size; the rest is as for `overlay`.
    """
    scale = size[1] / PICTURE_HEIGHT
    width = size[0] / scale
    hint = step.outcome.hint
    finished = [_hint(hint, width, scale)] if hint else []
    cards = _robots(step, robot, virtual_robot if width >= MIN_VIRTUAL_ROBOT_WIDTH else None, scale)
    if step.controls.camera_from_table is not None:
        name, command = step.outcome.icon, step.command
        moves = command.activity == "move" or name in ("stand", "walk", "run", "hop")
        weight = command.weight if name == "idle" or step.has_intensity else None
        strength = command.speed if moves else weight
        # The value changes in every frame: drawn again is what moves the bar by a pixel.
        strength = None if strength is None else round(strength, 2)
        icon = "stand" if name == "idle" and step.stands_upright else name
        cards["bottom left"] = _action(name, icon, moves, strength, scale)
    if step.close_up is not None and width >= MIN_VIRTUAL_ROBOT_WIDTH:
        cards["top left"] = _close_up(step.close_up, scale)
    sizes = {home: canvas.size for home, canvas in cards.items()}
    subjects = [
        (left / scale, top / scale, right / scale, bottom / scale)
        for left, top, right, bottom in step.subjects
    ]
    layout = layout or CardLayout()
    now = step.frame.timestamp
    corners = layout.update(sizes, subjects, width, now)
    boxes = []
    for home, corner in corners.items():
        boxes.append(layout.box(corner, sizes[home], width))
        finished.append(cards[home].card(*layout.slide(home, boxes[-1], now, subjects)))
    speaker = max(step.cast, key=speech_start)
    said = subtitle(speaker.command.speech, now)
    if said:
        words = f"{readable(speaker.name)}: {said}" if step.others else said
        room = subtitle_room(width, max(card_width for card_width, _ in sizes.values()))
        canvas = draw_subtitle(words, room, scale)
        finished.append(canvas.card(*subtitle_place(canvas.size, width, boxes)))
    if step.others:
        taken = [*subjects, *boxes, *(card.box(scale) for card in finished)]
        finished += _labels(step, layout, taken, width, scale)
    return finished


def _robots(
    step: Step, robot: RobotView, virtual_robot: VirtualRobot | None, scale: float
) -> dict[Corner, Canvas]:
    """Return the cards of the players' robots by their first corner."""
    cards: dict[Corner, Canvas] = {"bottom right": _mood(robot, step.emotion, virtual_robot, scale)}
    if robot.second is not None and step.players:
        twin = None if virtual_robot is None else virtual_robot.twin
        cards["top right"] = _mood(robot.second, step.others[0].emotion, twin, scale)
    return cards


def _mood(
    robot: RobotView, emotion: EmotionTarget, virtual_robot: VirtualRobot | None, scale: float
) -> Canvas:
    """Return the card of a robot: as a picture, unless it is a real one, or as a drawn face."""
    if virtual_robot is None or robot.real:
        return _robot(robot.name, robot.link, robot.label, _finite(robot.mood), scale)
    portrait = virtual_robot.portrait(emotion)
    # The knob of the mood moves with the portrait, so that the card is drawn as seldom.
    content = robot.name, robot.link, robot.label, scale
    return virtual_robot.card(content, lambda: _virtual_robot(robot, portrait, scale))


def _labels(
    step: Step, layout: CardLayout, taken: Sequence[Rect], width: float, scale: float
) -> list[Card]:
    """Return the labels of the cast."""
    canvases, figures = {}, {}
    for seen, figure in zip(step.cast, step.figures, strict=False):
        if figure is not None:
            left, top, right, bottom = figure
            figures[seen.name] = left / scale, top / scale, right / scale, bottom / scale
            mood = seen.emotion.emotion.valence
            canvases[seen.name] = label(seen.name, mood, seen.command.speaks, scale)
    sizes = {name: canvas.size for name, canvas in canvases.items()}
    places = layout.labels.update(figures, sizes, taken, width, step.frame.timestamp)
    return [canvases[name].card(*box[:2]) for name, box in places.items()]


def virtual_robot_side(height: int) -> int:
    """Return the side of the virtual robot's picture in pictures of a height [px]."""
    return round(VIRTUAL_ROBOT_SIDE * height / PICTURE_HEIGHT)


def notice_card(notice: Notice, size: tuple[int, int]) -> Card:
    """Return the card of a notice in the middle of a picture of a size [px]."""
    scale = size[1] / PICTURE_HEIGHT
    return _notice(notice, size[0] / scale, scale)


@lru_cache(maxsize=4)
def _notice(notice: Notice, width: float, scale: float) -> Card:
    card_width = max(text_width(notice.title, 30), text_width(notice.advice, 20)) + 152
    canvas = Canvas(card_width, 116, scale)
    canvas.disc(58, 58, 34, ANGRY)
    canvas.line([[58, 41], [58, 61]], PAPER, 8)
    canvas.disc(58, 75, 4.6, PAPER)
    canvas.text(112, 54, notice.title, 30, INK)
    canvas.text(112, 86, notice.advice, 20, QUIET)
    return canvas.card((width - card_width) / 2, (PICTURE_HEIGHT - 116) / 2)


@lru_cache(maxsize=16)
def _hint(words: str, width: float, scale: float) -> Card:
    room = min(width - 44, HINT_ROOM) - 56
    size = min(24.0, 24.0 * room / text_width(words, 24))  # a cube's name may be long
    card_width = text_width(words, size) + 56
    canvas = Canvas(card_width, HINT_HEIGHT, scale)
    baseline = HINT_HEIGHT / 2 + HALF_CAPITAL * size
    canvas.text(card_width / 2, baseline, words, size, INK, "middle")
    return canvas.card((width - card_width) / 2, HINT_TOP)


@lru_cache(maxsize=8)
def _action(name: str, icon: str, moves: bool, strength: float | None, scale: float) -> Canvas:
    """Draw an action with its speed if it moves, else with its weight; None if it has none."""
    if strength is None:
        return _plain_action(name, icon, scale)
    canvas = _action_background(name, icon, moves, scale).copy()
    if moves:
        _speed(canvas, strength, ACTION_COLORS.get(name, INK))
    elif name != "idle":
        _intensity(canvas, strength, ACTION_COLORS.get(name, INK))
    return canvas


@lru_cache(maxsize=16)
def _action_background(name: str, icon: str, moves: bool, scale: float) -> Canvas:
    """Draw what does not change during an action."""
    canvas = _action_icon(name, icon, scale)
    canvas.text(108, 42, "Idle" if name == "stand" else name.title(), 28, INK)
    canvas.bar(ACTION_BAR_X, BAR_Y, ACTION_BAR_WIDTH, 10, RULE)
    if moves:
        canvas.text(ACTION_BAR_X, 95, "speed", 15, QUIET)
    elif name == "idle":
        canvas.text(ACTION_BAR_X, 95, "resting", 15, QUIET)
    else:
        canvas.text(ACTION_BAR_X, 95, "a little", 15, QUIET)
        canvas.text(ACTION_BAR_X + ACTION_BAR_WIDTH, 95, "a lot", 15, QUIET, "right")
    return canvas


@lru_cache(maxsize=16)
def _plain_action(name: str, icon: str, scale: float) -> Canvas:
    """Draw an action without intensity."""
    canvas = _action_icon(name, icon, scale)
    canvas.text(108, 65, name.title(), 30, INK)
    return canvas


def _action_icon(name: str, icon: str, scale: float) -> Canvas:
    """Return the card of an action, with its icon only; others' actions share one."""
    canvas = Canvas(ACTION_CARD_WIDTH, CARD_HEIGHT, scale)
    canvas.disc(54, 54, 38, ACTION_COLORS.get(name, INK))
    canvas.icon(32, 32, 44, icon if has_icon(icon) else OTHER_ACTION, PAPER)
    return canvas


def _speed(canvas: Canvas, speed: float, color: Color) -> None:
    length = max(10.0, ACTION_BAR_WIDTH * min(speed, 5.0) / 5.0)
    canvas.bar(ACTION_BAR_X, BAR_Y, length, 10, color)
    for mark in (0.5, 3.0):
        canvas.disc(ACTION_BAR_X + ACTION_BAR_WIDTH * mark / 5.0, BAR_Y, 2.2, PAPER)
    canvas.text(ACTION_BAR_X + ACTION_BAR_WIDTH, 95, f"{speed:.1f}", 15, QUIET, "right")


def _intensity(canvas: Canvas, weight: float, color: Color) -> None:
    middle = ACTION_BAR_X + ACTION_BAR_WIDTH / 2
    knob = ACTION_BAR_X + 7 + (ACTION_BAR_WIDTH - 14) * (weight + 1) / 2
    canvas.line([[middle, BAR_Y], [knob, BAR_Y]], between(color, PAPER, 0.35), 10)
    canvas.disc(middle, BAR_Y, 2.5, QUIET)
    canvas.disc(knob, BAR_Y, 11, PAPER)
    canvas.disc(knob, BAR_Y, 8.5, color)


def _close_up(picture: NDArray[np.uint8], scale: float) -> Canvas:
    side = CLOSE_UP_SIDE + 2 * VIRTUAL_ROBOT_FRAME
    canvas = Canvas(side, side, scale)
    size = round(CLOSE_UP_SIDE * scale)
    enlarged = cv2.resize(picture, (size, size), interpolation=cv2.INTER_CUBIC)
    image = np.asarray(enlarged, np.uint8)
    canvas.picture(VIRTUAL_ROBOT_FRAME, VIRTUAL_ROBOT_FRAME, image, 12)
    return canvas


def _finite(mood: float) -> float:
    return mood if math.isfinite(mood) else 0.0


@lru_cache(maxsize=8)
def _robot(name: str, link: str, label: str, mood: float, scale: float) -> Canvas:
    named = name.replace("_", " ")
    words = {"none": "no robot", "ready": _feeling(name, label)}.get(link, f"{named} {link}")
    canvas = _robot_background(words, scale).copy()
    draw_face(canvas, 56, 54, 38, mood, crest=True)
    _mood_knob(canvas, MOOD_BAR_X, BAR_Y, MOOD_BAR_WIDTH, mood)
    return canvas


def _feeling(name: str, label: str) -> str:
    """Return what a robot feels; the 24 emotions are nouns, other labels adjectives."""
    return f"{name.replace('_', ' ')} {'feels' if label in OCC_FACES else 'is'} {label}"


def _virtual_robot(robot: RobotView, portrait: NDArray[np.uint8], scale: float) -> Canvas:
    caption = {"none": "no robot connected", "ready": "simulated robot"}.get(
        robot.link, f"simulated robot {robot.link}"
    )
    words = _feeling(robot.name, robot.label)
    canvas = _virtual_robot_background(words, caption, scale).copy()
    canvas.picture(VIRTUAL_ROBOT_FRAME, VIRTUAL_ROBOT_FRAME, portrait, 12)
    _mood_knob(canvas, *VIRTUAL_ROBOT_BAR, _finite(robot.mood))
    return canvas


def _mood_knob(canvas: Canvas, x: float, y: float, length: float, mood: float) -> None:
    knob = x + length * (mood + 1) / 2
    canvas.disc(knob, y, 12, PAPER)
    canvas.disc(knob, y, 9.0, INK)


@lru_cache(maxsize=16)
def _robot_background(words: str, scale: float) -> Canvas:
    """Draw what does not change with the robot's mood."""
    canvas = Canvas(ROBOT_CARD_WIDTH, CARD_HEIGHT, scale)
    canvas.text(112, 42, words, _fitting_size(words, 25, ROBOT_CARD_WIDTH - 112 - 28), INK)
    _mood_scale(canvas, MOOD_BAR_X, BAR_Y, MOOD_BAR_WIDTH)
    return canvas


@lru_cache(maxsize=16)
def _virtual_robot_background(words: str, caption: str, scale: float) -> Canvas:
    """Draw what does not change below the virtual robot."""
    canvas = Canvas(VIRTUAL_ROBOT_CARD_WIDTH, VIRTUAL_ROBOT_CARD_HEIGHT, scale)
    size = _fitting_size(words, 23, VIRTUAL_ROBOT_SIDE - 12)
    middle, top = VIRTUAL_ROBOT_CARD_WIDTH / 2, VIRTUAL_ROBOT_TEXT_Y
    canvas.text(middle, top + 24, words, size, INK, "middle")
    canvas.text(middle, top + 44, caption, 14, QUIET, "middle")
    _mood_scale(canvas, *VIRTUAL_ROBOT_BAR)
    return canvas


def _fitting_size(words: str, size: float, width: float) -> float:
    """Return the font size, at most `size`, at which a text fits into a width."""
    return size * min(1.0, width / text_width(words, size))


def _mood_scale(canvas: Canvas, x: float, y: float, length: float) -> None:
    """Draw the bar from angry over neutral to happy, with the labels below it."""
    for share in np.linspace(0.0, 1.0, 64):
        canvas.disc(x + length * share, y, 5.0, mood_color(2 * share - 1))
    for name, share, align in (
        ("angry", 0.0, "left"),
        ("neutral", 0.5, "middle"),
        ("happy", 1.0, "right"),
    ):
        canvas.text(x + length * share, y + 27, name, 14, QUIET, align)
