"""Draws the picture of a step: who is on the table, who is in the cube, and their things."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.cube_window import Interior
from cubeling.app.pipeline.resident import MIN_SIZE
from cubeling.app.pipeline.scenario import Outcome
from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.props import PosedBody
from cubeling.characters import PosedCharacter
from cubeling.characters.rendering import FULL, Box, CameraView, Focus, Quality, SceneCharacter
from cubeling.tracking import CubeModel, CubeState, Frame, Intrinsics, PlainRoom

if TYPE_CHECKING:
    import moderngl

    from cubeling.characters.rendering import Stage


APERTURE_M = 0.002
"""Diameter of the opening of a webcam's lens [m]: a focal length of 4 mm at f/2."""

FOCUSING_S = 0.5
"""Time constant with which the camera's focus follows the cube [s]."""


CLOSE_UP_PX, CLOSE_UP_EDGES = 256, 0.95
"""Side of the look into the cube from near by, and how far around the cube's centre it reaches, in
edges of it."""

MAX_CUBE_SHARE = 0.5
"""A cube that fills more of the picture's height is seen well enough without it."""


class FocusDistance:
    """Follows the distance of the cube, on which a camera focuses."""

    def __init__(self) -> None:
        self._distance = 0.0
        self._time = 0.0

    def update(self, state: CubeState) -> Focus | None:
        """Return what is sharp while the cube is where it is; None before it was seen."""
        pose = state.camera_from_cube
        if pose is not None:
            elapsed = state.timestamp - self._time
            share = 1.0 - math.exp(-max(elapsed, 0.0) / FOCUSING_S) if self._distance else 1.0
            self._distance += share * (float(pose[2, 3]) - self._distance)
        self._time = state.timestamp
        return Focus(self._distance, self._distance, APERTURE_M) if self._distance else None


@dataclass(frozen=True)
class DrawnBody:
    """A body of the cast, and how it looks."""

    body: PosedBody

    blood: float
    """That of its `Complexion`."""


class StepRenderer:
    """Draws characters into the pictures of one camera. `play` must follow before the first one.

    Parameters
    ----------
    context
        Where to draw, from `create_context`; the caller releases it. None for no pictures.
    intrinsics
        Of the camera; the pictures have their size.
    realism
        What makes the characters look real, of `REALISM_CHOICES`.
    plain
        Whether a plain room is drawn with the cubes in it, as the frames hold no pictures.

    Raises
    ------
    CharacterError
        Pictures of this size cannot be drawn.
    """

    def __init__(
        self,
        context: "moderngl.Context | None",
        intrinsics: Intrinsics,
        realism: Sequence[str],
        *,
        plain: bool = False,
    ) -> None:
        self._context, self._intrinsics, self._realism = context, intrinsics, tuple(realism)
        self._plain = plain and context is not None
        self._room: PlainRoom | None = None
        self._cubes: tuple[CubeModel, ...] = ()
        self._stage = None if context is None else _stage(context, intrinsics.size)
        self._close: Stage | None = None
        self._quality = FULL
        self._focus_distance = FocusDistance()

    def play(self, cubes: Sequence[CubeModel]) -> None:
        """Begin with other cubes of the players: what the pictures have shown is forgotten."""
        self._focus_distance = FocusDistance()
        if self._plain and [*map(id, cubes)] != [*map(id, self._cubes)]:
            self._room = PlainRoom(self._intrinsics, cubes)
        self._cubes = tuple(cubes)
        if self._stage is not None:
            self._stage.forget()

    def look_through(self, intrinsics: Intrinsics) -> None:
        """Take another camera; `play` must follow."""
        if self._context is not None and intrinsics.size != self._intrinsics.size:
            self.close()
            self._stage = _stage(self._context, intrinsics.size)
            self._stage.quality = self._quality
        self._intrinsics = intrinsics
        if self._room is not None:
            self._room.look_through(intrinsics)

    @property
    def in_software(self) -> bool:
        """Whether pictures are drawn on the processor, not on a graphics card."""
        if self._context is None:
            return False
        from cubeling.characters.rendering import draws_in_software

        return draws_in_software(self._context)

    @property
    def quality(self) -> Quality:
        """How finely characters are drawn."""
        return self._quality

    @quality.setter
    def quality(self, quality: Quality) -> None:
        self._quality = quality
        if self._stage is not None:
            self._stage.quality = quality

    def expect(self, frame: Frame) -> None:
        """Begin to draw a frame, as far as nothing of what is in it is known."""
        if self._stage is not None and not self._plain:
            matrix, distortion = self._intrinsics.matrix, self._intrinsics.distortion
            self._stage.expect(frame.image, matrix, distortion)

    def draw(self, step: Step, cast: Sequence[DrawnBody]) -> NDArray[np.uint8] | None:
        """Draw the picture of a step; return None without a graphics context."""
        if self._stage is None:
            return None
        focused = "focus" in self._realism and not self._plain
        focus = self._focus_distance.update(step.state) if focused else None
        lead, *others = cast
        on_table = step.controls.camera_from_table is not None
        seen = lead.body.posed.visible and on_table
        characters = self._characters(step.outcome, lead, step.interior) if seen else []
        characters += [
            self._with_skin(each, each.body.posed)
            for each in others
            if each.body.posed.visible and on_table
        ]
        floor = step.outcome.floor if seen else ()
        return self._stage.draw(self._view(step, focus), characters, floor)

    def close_up(self, step: Step, lead: DrawnBody) -> NDArray[np.uint8] | None:
        """Draw a look into the open cube; return None if none is seen, or if it fills the picture.

        The camera stays where it is: what is in the cube is seen in the same way, only larger.
        """
        interior = step.interior
        if self._context is None or interior is None or interior.box is None:
            return None
        part = self._part_around(interior.box)
        if interior.resident is None or part is None:
            return None
        if self._close is None:
            self._close = _stage(self._context, (CLOSE_UP_PX, CLOSE_UP_PX))
        self._close.quality = self._quality
        # It is drawn sharper than the camera sees, as one looks more closely.
        view = replace(self._view(step, None), part=part, softness=None)
        return self._close.draw(view, self._characters(step.outcome, lead, interior))

    def _part_around(self, box: Box) -> tuple[float, float, float, float] | None:
        """Return the square of the frame around a cube [px]; None if that is not worth it."""
        matrix, center = self._intrinsics.matrix, box.camera_from_box[:3, 3]
        if center[2] <= box.edge:
            return None
        reach = CLOSE_UP_EDGES * box.edge * float(matrix[1, 1] / center[2])
        x, y = (matrix[:2] @ (center / center[2])).tolist()
        width, height = self._intrinsics.size
        outside = not (0.0 <= x < width and 0.0 <= y < height)
        if outside or 2 * reach > MAX_CUBE_SHARE * height or reach < 1.0:
            return None
        # Pixel centres have integer coordinates, and pixels begin half a pixel before them.
        return x - reach + 0.5, y - reach + 0.5, x + reach + 0.5, y + reach + 0.5

    def _view(self, step: Step, focus: Focus | None) -> CameraView:
        """Return the camera's picture with all that is known of the scene in it."""
        pose = step.state.camera_from_cube
        box = None if step.interior is None else step.interior.box
        if box is None and pose is not None:
            box = Box(pose, self._cubes[0].edge)
        others = (
            Box(each.state.camera_from_cube, each.edge)
            for each in step.players
            if each.state.camera_from_cube is not None
        )
        view = CameraView(
            self._picture(step),
            self._intrinsics.matrix,
            self._intrinsics.distortion,
            step.controls.camera_from_table,
            (*(() if box is None else (box,)), *others),
            focus=focus,
        )
        known = step.appearance
        if known is None or self._plain:
            return view
        return replace(
            view,
            hand=known.hand,
            light=known.light,
            softness=known.softness,
            room=known.room,
            timestamp=known.timestamp,
        )

    def _picture(self, step: Step) -> NDArray[np.uint8]:
        """Return what the characters are drawn into: the frame, or a plain room in its place."""
        if self._room is None:
            return step.frame.image
        poses = [state.camera_from_cube for state in (step.state, *(p.state for p in step.players))]
        return self._room.draw(step.controls.camera_from_table, poses)

    def _with_skin(self, drawn: DrawnBody, posed: PosedCharacter) -> SceneCharacter:
        shown = drawn.blood if "blush" in self._realism else 0.0
        return SceneCharacter(drawn.body.character, posed, "wrinkles" in self._realism, shown)

    def _characters(
        self, outcome: Outcome, lead: DrawnBody, interior: Interior | None
    ) -> list[SceneCharacter]:
        """Return the character that the cube leads, on the table or in the cube, and its things."""
        body = lead.body
        if interior is None:
            things = (body.place_thing(thing) for thing in outcome.things)
            return [self._with_skin(lead, body.posed), *things]
        characters = [body.place_thing(thing) for thing in outcome.things if thing.hand is None]
        if interior.left_on_table > MIN_SIZE:
            shrunk = np.diag([*[interior.left_on_table] * 3, 1.0])
            placed = body.posed.table_from_character @ shrunk
            on_table = replace(body.posed, table_from_character=placed)
            characters.append(self._with_skin(lead, on_table))
        if interior.resident is not None:
            inside = replace(self._with_skin(lead, interior.resident), inside=interior.box)
            characters.append(inside)
        return characters

    def close(self) -> None:
        """Release the graphics; a second call does nothing."""
        if self._stage is not None:
            self._stage.release()
            self._stage = None
        if self._close is not None:
            self._close.release()
            self._close = None


def _stage(context: "moderngl.Context", size: tuple[int, int]) -> "Stage":
    """Return a stage for pictures; the renderer is loaded only where it draws."""
    from cubeling.characters.rendering import Stage

    return Stage(context, size)
