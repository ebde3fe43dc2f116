"""The characters of a picture on the graphics card."""

import math
import operator
from collections import Counter, OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from cubeling.characters.rendering.camera_picture.occlusion import is_usable
from cubeling.characters.rendering.geometry.character_geometry import CharacterGeometry
from cubeling.characters.rendering.geometry.detail_levels import LEVEL_TOLERANCES
from cubeling.characters.rendering.geometry.skinned_character import SkinnedCharacter
from cubeling.characters.rendering.programs import ShaderPrograms
from cubeling.characters.rendering.projection import is_invertible
from cubeling.characters.rendering.scene import Box, Drawable, SceneCharacter
from cubeling.characters.skeleton.pose import Array

MAX_CHARACTERS = 8
"""Characters that stay on the graphics card; more only if one picture shows more."""

NEARER_SHARE = 0.2
"""How much nearer than its axis a character reaches, as a share of its height."""


@dataclass(frozen=True)
class CharacterInstance:
    """A character of the picture, skinned on the graphics card."""

    skinned: SkinnedCharacter
    """Its buffers, in the table frame."""

    enclosing: Array
    """Points of the table frame around it, (n, 3) [m]."""

    height: float
    """Its height on the table [m]."""

    place: Array
    """`table_from_character`, (4, 4) [m]; scaled."""

    inside: Box | None = None
    """The open cube that it stands in; None for the table."""


@dataclass(frozen=True)
class PictureFineness:
    """How finely the picture shows what is where on the table."""

    camera_from_table: Array
    """Pose of the table, (4, 4) [m]."""

    focal: float
    """Focal length of the picture [px]."""

    max_error_px: float
    """Largest error of a surface in the picture [px]; 0 for the finest triangles."""

    def error(self, table_from_character: Array, height: float) -> float:
        """Return the largest error of a character's surface [m in the character frame].

        `height` is the character's [m in the character frame].
        """
        return self.max_error_px * self.pixel(table_from_character, height)

    def detail(self, table_from_character: Array, height: float) -> float:
        """Return the size of what is seen of a surface, as `pixel`: its error may be larger."""
        return max(1.0, self.max_error_px) * self.pixel(table_from_character, height)

    def pixel(self, table_from_character: Array, height: float) -> float:
        """Return the size of a pixel at the nearest part, with parameters and unit of `error`."""
        # Plain numbers: numpy takes several times as long for so few.
        row = self.camera_from_table[2].tolist()
        up, origin = table_from_character[:3, 1].tolist(), table_from_character[:, 3].tolist()
        scale = math.hypot(*up)
        depth = sum(map(operator.mul, row, origin))
        lean = height * sum(map(operator.mul, row[:3], up))
        nearest = depth + min(lean, 0.0) - NEARER_SHARE * scale * height
        return float(max(nearest, 0.0) / (self.focal * scale))


class CharacterCache:
    """Skins characters, and keeps the buffers of the most recently drawn."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._programs = programs
        self.triangles = 0
        """Number of triangles of the characters that were skinned last."""
        # By character, by its number among its copies in the picture, as each has own vertices, and
        # by whether it has levels of detail.
        self._kept: OrderedDict[tuple[int, int, bool], tuple[Drawable, SkinnedCharacter]] = (
            OrderedDict()
        )

    def skin(
        self, characters: Sequence[SceneCharacter], fineness: PictureFineness
    ) -> tuple[CharacterInstance, ...]:
        """Skin the visible characters whose pose is finite, as finely as they are seen.

        One inside a cube without a pose or a size is not visible.

        A framebuffer must be bound: transform feedback needs one, although it draws nothing.
        """
        instances: list[CharacterInstance] = []
        copies: Counter[int] = Counter()
        for each in characters:
            place = np.asarray(each.posed.table_from_character, float)
            if not each.posed.visible or not is_invertible(place):
                continue
            if each.inside is not None and not is_usable(each.inside):
                continue
            skinned = self._buffers(
                each.character, copies[id(each.character)], fineness.max_error_px > 0.0
            )
            copies[id(each.character)] += 1
            with np.errstate(invalid="ignore", over="ignore"):  # `skin` checks the result
                joints = each.posed.pose.globals(each.character.skeleton)
                enclosing = skinned.skin(
                    joints,
                    place,
                    each.posed.pose.morphs,
                    fineness.error(place, skinned.geometry.height),
                )
            if enclosing is not None:
                pixel = fineness.detail(place, skinned.geometry.height)
                skinned.show_face(
                    each.posed.pose.morphs, each.blood, place, pixel if each.wrinkles else np.inf
                )
                height = skinned.geometry.height * float(np.linalg.norm(place[:3, 1]))
                instances.append(CharacterInstance(skinned, enclosing, height, place, each.inside))
        self._evict(copies.total())
        self.triangles = sum(each.skinned.triangles for each in instances)
        return tuple(instances)

    def release(self) -> None:
        """Release all buffers; a second call does nothing."""
        while self._kept:
            self._kept.popitem()[1][1].release()

    def _buffers(self, character: Drawable, copy: int, leveled: bool) -> SkinnedCharacter:
        """Return the buffers of one copy of a character, created when it is first drawn."""
        key = id(character), copy, leveled
        kept = self._kept.pop(key, None)
        if kept is None:
            geometry = CharacterGeometry.of(character, LEVEL_TOLERANCES if leveled else ())
            kept = character, SkinnedCharacter(self._context, self._programs, character, geometry)
        self._kept[key] = kept
        return kept[1]

    def _evict(self, drawn: int) -> None:
        """Release the least recently drawn, but none of the last `drawn`."""
        while len(self._kept) > max(MAX_CHARACTERS, drawn):
            self._kept.popitem(last=False)[1][1].release()
