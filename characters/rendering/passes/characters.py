"""The characters of a picture, with their shadows, on the graphics card."""

from collections import Counter, OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.geometry.skinning import SkinnedCharacter
from characters.rendering.light import TO_LIGHT, Light
from characters.rendering.passes.shadow import Shadow
from characters.rendering.programs import Programs, assign
from characters.rendering.projection import is_rigid
from characters.rendering.scene import Drawable, SceneCharacter

Array = NDArray[np.float64]

KEPT = 8
"""How many characters stay on the graphics card, those in the picture among them; the one not drawn
for longest leaves first, but none that is in the picture."""


@dataclass(frozen=True)
class Cast:
    """A character that is posed on the graphics card, with its shadow."""

    character: SkinnedCharacter
    """Skinned in the table frame."""

    shadow: Shadow
    """Its map is ready."""

    height: float
    """On the table [m]."""


class Figures:
    """Poses and draws characters, and keeps those that it has seen.

    Parameters
    ----------
    context, programs
        Where to draw.
    """

    def __init__(self, context: moderngl.Context, programs: Programs) -> None:
        self._context = context
        self._programs = programs
        self._shadows: list[Shadow] = []
        # By which character, and which of its copies in the picture: each has vertices of its own.
        self._characters: OrderedDict[tuple[int, int], tuple[Drawable, SkinnedCharacter]]
        self._characters = OrderedDict()

    def pose(
        self, actors: Sequence[SceneCharacter], light: Light
    ) -> tuple[list[Cast], Array, Array]:
        """Skin the actors that are visible and cast their shadows.

        Some framebuffer must be in use: transform feedback asks for one, though it draws nothing.

        Returns
        -------
        casts
            One for each visible actor whose pose is finite.
        bodies, shadows
            Points of the table frame around them and around their shadows, (n, 3).
        """
        casts: list[Cast] = []
        copies: Counter[int] = Counter()
        key_share = light.key * TO_LIGHT[1] / light.white
        bodies, shadows = [np.zeros((0, 3))], [np.zeros((0, 3))]
        for actor in actors:
            place = np.asarray(actor.posed.table_from_character, float)
            if not actor.posed.visible or not is_rigid(place):
                continue
            character = self._skinned(actor.character, copies[id(actor.character)])
            copies[id(actor.character)] += 1
            with np.errstate(invalid="ignore", over="ignore"):  # `pose` tells such numbers
                joints = actor.posed.pose.globals(actor.character.skeleton)
                enclosing = character.pose(joints, place, actor.posed.pose.morphs)
            if enclosing is None:
                continue
            if len(casts) == len(self._shadows):
                self._shadows.append(Shadow(self._context, self._programs))
            shadow = self._shadows[len(casts)]
            height = character.height * float(np.linalg.norm(place[:3, 1]))
            bodies.append(enclosing)
            shadows.append(shadow.cast(character, enclosing, height, key_share))
            casts.append(Cast(character, shadow, height))
        self._forget(copies.total())
        return casts, np.concatenate(bodies), np.concatenate(shadows)

    def draw(self, casts: Sequence[Cast], clip_from_table: Array, eye: Array, light: Light) -> None:
        """Draw posed characters into the framebuffer in use; `eye` (3,) is in the table frame."""
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST)
        for cast in casts:
            lit: set[int] = set()
            for part in cast.character.parts:
                program, material = part.array.program, part.material
                if program.glo not in lit:
                    lit.add(program.glo)
                    assign(program, clip_from_table=clip_from_table, eye=eye, to_light=TO_LIGHT)
                    assign(program, key=light.key, sky=light.sky, ground=light.ground)
                    assign(program, height=cast.height)
                assign(program, base_color=material.base_color[:3])
                assign(program, metallic=material.metallic, roughness=material.roughness)
                if part.looks:
                    assign(program, opacity=material.base_color[3], cutoff=material.cutoff or 0.0)
                    assign(program, bump_scale=material.bump_scale, glow=material.glow)
                for unit, texture in part.textures:
                    texture.use(unit)
                (context.disable if material.double_sided else context.enable)(moderngl.CULL_FACE)
                part.array.render(vertices=part.count, first=part.first)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        while self._characters:
            self._characters.popitem()[1][1].release()
        while self._shadows:
            self._shadows.pop().release()

    def _skinned(self, character: Drawable, copy: int) -> SkinnedCharacter:
        """Return the buffers of one copy of a character, made when it is first seen."""
        key = id(character), copy
        kept = self._characters.pop(key, None)
        if kept is None:
            kept = (character, SkinnedCharacter(self._context, self._programs, character))
        self._characters[key] = kept
        return kept[1]

    def _forget(self, drawn: int) -> None:
        """Give back what was not drawn for longest, but none of the last `drawn`."""
        while len(self._characters) > max(KEPT, drawn):
            self._characters.popitem(last=False)[1][1].release()
