"""Pictures of gestures: all of them, and one in several ways."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.contact_sheets import frame_sheet, save, stack
from cubeling.app.ui.palette import INK
from cubeling.characters import Character
from cubeling.characters.behaviour import (
    NEUTRAL,
    GestureCollection,
    GestureExpressivity,
    GestureMotion,
    GestureRealizer,
    SymbolicGesture,
    apex_share,
)
from cubeling.characters.rendering import PAPER_BGR, PortraitRenderer, create_context, side_by_side

Image = NDArray[np.uint8]

SETTINGS: Mapping[str, GestureExpressivity] = {
    "as it is written": NEUTRAL,
    "small and closed": GestureExpressivity(spatial=-0.5, openness=0.0),
    "wide and open": GestureExpressivity(spatial=0.5, openness=1.0),
    "powerful": GestureExpressivity(power=1.0),
    "all of it": GestureExpressivity(spatial=0.5, openness=1.0, power=1.0),
}
"""Five ways to perform a gesture."""

MOMENTS = 0.0, 0.35, 1.0
"""Times of the stroke that are drawn, 0…1."""

CELL_PX = 190, 200
"""Size of a picture [px]."""

UPPER_BODY, FOUR_LEGS = (0.6, 0.43), (0.58, 0.66)
"""Height of the middle of what is drawn, and its radius, over the height of the body."""

CAPTION_PX = 28
"""Height of a caption [px]."""

AZIMUTH_RAD = 0.25
"""The camera is a little to the character's left."""


def draw_settings(path: Path, gesture: str = "BEAT_BOTH", character: str = "human") -> None:
    """Draw one gesture in five settings side by side, at three moments of its stroke."""
    symbolic = GestureCollection.load_bundled().get(gesture)
    performer = GestureRealizer.of(Character.load(character))
    with ExitStack() as closing:
        renderer = _renderer(closing)
        columns = []
        for name, style in SETTINGS.items():
            motion = performer.plan(symbolic, "right", style)
            column = stack(*_pictures(renderer, performer, motion, MOMENTS))
            columns.append(stack(column, _caption(name, column.shape[1])))
    save(side_by_side(columns, len(columns)), path)


def draw_library(path: Path, characters: Sequence[str] = ("human", "vleo", "robot")) -> None:
    """Draw the end of the stroke of every bundled gesture, on several characters."""
    performers = [GestureRealizer.of(Character.load(name)) for name in characters]
    with ExitStack() as closing:
        renderer = _renderer(closing)
        cells = []
        for gesture in GestureCollection.load_bundled():
            shown = []
            for performer in performers:
                motion = performer.plan(gesture)
                shown += _pictures(renderer, performer, motion, (_telling_moment(gesture),))
            cells.append((gesture.name, side_by_side(shown, len(shown))))
    save(frame_sheet("Gestures", cells), path)


def _telling_moment(gesture: SymbolicGesture) -> float:
    """Return the moment that shows a gesture: its apex if it comes back, else its end."""
    hands = gesture.right or gesture.left
    turned = len(gesture.body) > 1 and gesture.body[0] == replace(gesture.body[-1], at=0.0)
    comes_back = len(hands) > 2 and hands[0].place == hands[-1].place
    return apex_share(gesture) if comes_back or turned else 1.0


def _pictures(
    renderer: PortraitRenderer,
    performer: GestureRealizer,
    motion: GestureMotion,
    moments: Sequence[float],
) -> list[Image]:
    """Return moments of a gesture."""
    character, height = performer.character, performer.character.height
    middle, radius = FOUR_LEGS if character.anatomy.kind == "quadruped" else UPPER_BODY
    focus = np.array([0.0, middle * height, 0.0]), radius * height
    return [
        renderer.portrait(
            character,
            motion.sample(motion.times.in_stroke(moment) - motion.times.start),
            azimuth=AZIMUTH_RAD,
            focus=focus,
        )
        for moment in moments
    ]


def _caption(text: str, width: int) -> Image:
    canvas = Canvas(width, CAPTION_PX, 1.0)
    canvas.color[:] = PAPER_BGR
    canvas.text(width / 2, CAPTION_PX / 2, text, 15, INK, "middle")
    return canvas.color


def _renderer(closing: ExitStack) -> PortraitRenderer:
    context = create_context()
    closing.callback(context.release)
    renderer = PortraitRenderer(context, CELL_PX)
    closing.callback(renderer.release)
    return renderer
