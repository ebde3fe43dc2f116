"""What the meshes of a character are to the graphics card: the same for all its copies."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import FaceMaps
from cubeling.characters.rendering.geometry.detail_levels import (
    LEVEL_TOLERANCES,
    DetailLevel,
    shape_only,
    with_levels,
)
from cubeling.characters.rendering.geometry.edge_collapse import Tolerance
from cubeling.characters.rendering.geometry.face_split import FaceSplit, split_faces
from cubeling.characters.rendering.geometry.vertices import CasterRun, CharacterVertices
from cubeling.characters.rendering.scene import Drawable

SHADOW_CELLS = 44
"""Grid cells along a character's height to which the mesh for its shadow is simplified; a shadow
map is not much finer."""

HIDING_SCALE = 0.002
"""A joint that scales by less hides what it moves, as that of an effect does before it begins."""


@dataclass(frozen=True)
class CharacterGeometry:
    """Vertices in an order that suits all levels of detail, and the triangles of each level."""

    vertices: CharacterVertices
    """All vertices; their own indices are those of the mesh."""

    levels: tuple[DetailLevel, ...]
    """The levels of detail, the finest first."""

    dormant: NDArray[np.intp]
    """Rows of the palette that move what the rest pose hides, (n,)."""

    extreme: NDArray[np.intp]
    """Vertices that enclose the character in every pose, (n,)."""

    height: float
    """Height of the rest pose above the ground [m in the character frame]."""

    indices: NDArray[np.uint32]
    """Indices of all levels, each with those of its split faces behind it."""

    starts: tuple[int, ...]
    """Position in `indices` at which each level begins."""

    splits: tuple[tuple[FaceSplit, ...], ...]
    """Runs of triangles that have face maps, of each level."""

    face: FaceMaps | None
    """Wrinkles and blood, if its sidecar file has them."""

    caster_indices: NDArray[np.uint32]
    """Indices of the triangles that cast its shadow."""

    caster_runs: tuple[CasterRun, ...]
    """Runs of these triangles, by whether they are dormant and seen from both sides."""

    @classmethod
    def of(
        cls, character: Drawable, tolerances: Sequence[Tolerance] = LEVEL_TOLERANCES
    ) -> "CharacterGeometry":
        """Prepare a character, or return what was prepared while that same object lives.

        `tolerances` are those of its levels of detail, see `with_levels`.

        Raises
        ------
        CharacterError
            There is nothing to draw.
        """
        number = id(character)
        if number not in _prepared:
            _prepared[number] = {}
            finalize(character, _prepared.pop, number).atexit = False
        kept = _prepared[number]
        if tuple(tolerances) not in kept:
            kept[tuple(tolerances)] = cls._prepare(character, tolerances)
        return kept[tuple(tolerances)]

    @classmethod
    def _prepare(cls, character: Drawable, tolerances: Sequence[Tolerance]) -> "CharacterGeometry":
        given = CharacterVertices.of(character.meshes)
        rest = given.palette(character.skeleton.rest.globals(character.skeleton))
        hidden = are_vanished(rest)
        vertices, levels = with_levels(given, hidden, tolerances)
        heights = vertices.skin(rest, slice(None))[:, 1]
        leveled = [
            replace(vertices, indices=level.indices, materials=level.materials) for level in levels
        ]
        splits = [split_faces(each) for each in leveled]
        drawn = [
            np.concatenate([each.indices, again])
            for each, (_, again) in zip(leveled, splits, strict=True)
        ]
        finest = splits[0][0]
        caster_indices, caster_runs = shape_only(leveled[-1]).simplify(
            SHADOW_CELLS, levels[-1].awake
        )
        return cls(
            vertices=vertices,
            levels=levels,
            dormant=np.flatnonzero(hidden),
            extreme=vertices.extreme(),
            height=float(max(heights.max() - min(heights.min(), 0.0), 1e-6)),
            indices=np.concatenate(drawn),
            starts=tuple(np.cumsum([0, *(len(each) for each in drawn[:-1])]).tolist()),
            splits=tuple(runs for runs, _ in splits),
            face=leveled[0].materials[finest[0].run][0].face if finest else None,
            caster_indices=caster_indices,
            caster_runs=caster_runs,
        )


# By the identity of a character. To prepare one takes longer than ten pictures, and each copy of it
# asks for it, and each new stage: of a window that is made larger, of a sheet of pictures.
_prepared: dict[int, dict[tuple[Tolerance, ...], CharacterGeometry]] = {}


def are_vanished(palette: NDArray[np.floating[Any]], scale: float = 1.0) -> NDArray[np.bool_]:
    """Return which matrices (n, 3 or 4, 4) shrink what they move to nothing, (n,).

    `scale` is that of the character on the table.
    """
    return np.asarray(np.abs(palette[:, :3, :3]).max(axis=(1, 2)) < HIDING_SCALE * scale)
