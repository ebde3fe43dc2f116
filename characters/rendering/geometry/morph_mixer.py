"""Morph targets, mixed on the processor before the graphics card skins the vertices.

A face is a few hundred of tens of thousands of vertices, and few of its morphs are active at once.
To mix only those and to upload them costs less than to let the card read every morph of every
vertex.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import Mesh, Morph
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class _DenseMorph:
    """A morph for all vertices from the first to the last that it moves.

    To add a contiguous block is about ten times as fast as to add selected rows.
    """

    first: int
    displacements: NDArray[np.float32]
    """Of position and normal, (n, 6)."""

    @classmethod
    def of(cls, morph: Morph) -> Self:
        first = int(morph.vertices[0])
        displacements = np.zeros((int(morph.vertices[-1]) + 1 - first, 6), np.float32)
        displacements[morph.vertices - first] = _displacement_records(morph)
        return cls(first, displacements)


class MorphMixer:
    """Mixes the morphs of a character.

    `neutral` has the position and normal of every vertex that a morph moves, (moved, 6); `names`
    are those of the character's morphs, in the order of the weights.
    """

    def __init__(
        self, neutral: NDArray[np.float32], morphs: Sequence[Morph], names: Sequence[str]
    ) -> None:
        self._neutral = neutral
        self._mixed = neutral.copy()
        known = {morph.name: _DenseMorph.of(morph) for morph in morphs}
        self._morphs = [known.get(name) for name in names]
        self._weights = np.zeros(len(names))

    def mix(self, weights: Array | None) -> NDArray[np.float32] | None:
        """Return position and normal of the vertices that morphs move, (moved, 6).

        The weights are finite, (morphs,); None for all zero. The result is None if nothing has
        changed since the last call. Normals are not of unit length.

        Raises
        ------
        CharacterError
            The number of weights is not that of the character's morphs.
        """
        if weights is None:
            if not self._weights.any():
                return None
            weights = np.zeros_like(self._weights)
        if np.shape(weights) != self._weights.shape:
            raise CharacterError(
                f"a pose with morphs of shape {np.shape(weights)} for a character that has "
                f"{len(self._morphs)}: give one weight for each"
            )
        if np.array_equal(weights, self._weights):
            return None
        self._weights = np.array(weights, float)
        np.copyto(self._mixed, self._neutral)
        for number in np.flatnonzero(self._weights):
            morph = self._morphs[number]
            if morph is not None:  # None: no mesh that is drawn has it
                self._mixed[morph.first : morph.first + len(morph.displacements)] += (
                    np.float32(self._weights[number]) * morph.displacements
                )
        return self._mixed


def merge_morphs(meshes: Sequence[Mesh], starts: Sequence[int]) -> tuple[Morph, ...]:
    """Return the morphs of concatenated meshes; morphs of the same name become one.

    `starts` has the index of the first vertex of each mesh among all vertices.
    """
    found: dict[str, list[tuple[Morph, int]]] = {}
    for mesh, start in zip(meshes, starts, strict=True):
        for morph in mesh.morphs:
            if morph.vertices.size:
                found.setdefault(morph.name, []).append((morph, start))
    return tuple(_sum(name, parts) for name, parts in found.items())


def _sum(name: str, parts: Sequence[tuple[Morph, int]]) -> Morph:
    indices = np.concatenate([morph.vertices.astype(np.uint32) + start for morph, start in parts])
    records = np.concatenate([_displacement_records(morph) for morph, _ in parts])
    vertices, rows = np.unique(indices, return_inverse=True)
    total = np.zeros((len(vertices), 6), np.float32)
    np.add.at(total, rows, records)  # a mesh can have two morphs of one name
    return Morph(name, vertices, total[:, :3], total[:, 3:] if total[:, 3:].any() else None)


def _displacement_records(morph: Morph) -> NDArray[np.float32]:
    """Return the displacements of positions and normals, (n, 6)."""
    positions, normals = morph.displacements, morph.normal_displacements
    if normals is None:
        normals = np.zeros_like(positions)
    return np.hstack([positions, normals]).astype(np.float32)
