"""Draws the picture of a step: who is on the table, who is in the cube, and their things."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.cube_window import Interior
from cubeling.app.pipeline.resident import MIN_SIZE
from cubeling.app.pipeline.scenario import Outcome
from cubeling.app.pipeline.things import PosedBody
from cubeling.characters import PosedCharacter
from cubeling.characters.rendering import FULL, Quality, SceneCharacter
from cubeling.tracking import CubeControls, CubeModel, CubeState, Frame, Intrinsics

if TYPE_CHECKING:
    import moderngl

    from cubeling.app.pipeline.surroundings import Surroundings
    from cubeling.characters.rendering import Stage


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

    Raises
    ------
    CharacterError
        Pictures of this size cannot be drawn.
    """

    def __init__(
        self, context: "moderngl.Context | None", intrinsics: Intrinsics, realism: Sequence[str]
    ) -> None:
        self._context, self._intrinsics, self._realism = context, intrinsics, tuple(realism)
        self._stage = None if context is None else _stage_of(context, intrinsics)
        self._surroundings: Surroundings | None = None
        self._quality = FULL

    def play(self, cube: CubeModel) -> None:
        """Begin with another cube: what the pictures have shown so far is forgotten."""
        if self._stage is not None:
            from cubeling.app.pipeline.surroundings import Surroundings

            self._surroundings = Surroundings(cube, self._intrinsics, self._realism)
            self._stage.forget()

    def look_through(self, intrinsics: Intrinsics) -> None:
        """Take another camera; `play` must follow."""
        if self._context is not None and intrinsics.size != self._intrinsics.size:
            self.close()
            self._stage = _stage_of(self._context, intrinsics)
            self._stage.quality = self._quality
        self._intrinsics = intrinsics

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
        if self._stage is not None:
            matrix, distortion = self._intrinsics.matrix, self._intrinsics.distortion
            self._stage.expect(frame.image, matrix, distortion)

    def draw(
        self,
        frame: Frame,
        state: CubeState,
        controls: CubeControls,
        outcome: Outcome,
        body: PosedBody,
        interior: Interior | None,
        blood: float,
    ) -> NDArray[np.uint8] | None:
        """Draw the picture; return None without a graphics context.

        `interior` is what is seen in the cube, None for a closed one, and `blood` that of
        `Complexion`.
        """
        if self._stage is None or self._surroundings is None:
            return None
        view = self._surroundings.view(frame, state, controls, self._quality.matched)
        seen = body.posed.visible and controls.camera_from_table is not None
        characters = self._characters(outcome, body, interior, blood) if seen else []
        if interior is not None and interior.box is not None:
            view = replace(view, occluders=(interior.box,))
        find_cover = partial(self._surroundings.cover, frame, state)
        return self._stage.draw(view, characters, outcome.floor if seen else (), find_cover)

    def _characters(
        self, outcome: Outcome, body: PosedBody, interior: Interior | None, blood: float
    ) -> list[SceneCharacter]:
        """Return all that is drawn: the character on the table or in the cube, and its things."""

        def with_skin(posed: PosedCharacter) -> SceneCharacter:
            shown = blood if "blush" in self._realism else 0.0
            return SceneCharacter(body.character, posed, "wrinkles" in self._realism, shown)

        if interior is None:
            return [with_skin(body.posed), *(body.placed(thing) for thing in outcome.things)]
        characters = [body.placed(thing) for thing in outcome.things if thing.hand is None]
        if interior.left_on_table > MIN_SIZE:
            shrunk = np.diag([*[interior.left_on_table] * 3, 1.0])
            placed = body.posed.table_from_character @ shrunk
            characters.append(with_skin(replace(body.posed, table_from_character=placed)))
        if interior.resident is not None:
            characters.append(replace(with_skin(interior.resident), inside=interior.box))
        return characters

    def close(self) -> None:
        """Release the graphics; a second call does nothing."""
        if self._stage is not None:
            self._stage.release()
            self._stage = None


def _stage_of(context: "moderngl.Context", intrinsics: Intrinsics) -> "Stage":
    """Return a stage for the pictures of a camera; the renderer is loaded only where it draws."""
    from cubeling.characters.rendering import Stage

    return Stage(context, intrinsics.size)
