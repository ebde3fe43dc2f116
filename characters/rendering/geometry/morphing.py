"""The vertices that morphs move, mixed on the processor before the card skins them.

A face is some hundreds of vertices of tens of thousands, and few of its morphs are on at once: to
mix just those and send them costs less than to let the card look at every morph of every vertex.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.model.mesh import Mesh, Morph

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Run:
    """A morph spread over all vertices from the first to the last that it moves.

    To add rows that lie together is some ten times as fast as to pick them.
    """

    first: int
    shifts: NDArray[np.float32]
    """Of position and normal, (n, 6)."""

    @classmethod
    def of(cls, morph: Morph) -> Self:
        first = int(morph.vertices[0])
        shifts = np.zeros((int(morph.vertices[-1]) + 1 - first, 6), np.float32)
        shifts[morph.vertices - first] = _both_shifts(morph)
        return cls(first, shifts)


class Morphing:
    """Mixes the shapes of a character.

    Parameters
    ----------
    still
        Position and normal of every vertex that some morph moves, (moved, 6).
    morphs
        Of these vertices.
    names
        Of the character's morphs, in the order of the weights.
    """

    def __init__(
        self, still: NDArray[np.float32], morphs: Sequence[Morph], names: Sequence[str]
    ) -> None:
        self._still = still
        self._mixed = still.copy()
        known = {morph.name: _Run.of(morph) for morph in morphs}
        self._runs = [known.get(name) for name in names]
        self._weights = np.zeros(len(names))

    def mix(self, weights: Array | None) -> NDArray[np.float32] | None:
        """Return position and normal of the vertices that move, (moved, 6).

        Parameters
        ----------
        weights
            How far each morph is on, (morphs,) and finite; None for not at all.

        Returns
        -------
        NDArray or None
            None where nothing changed since the last call. Normals are not of unit length.

        Raises
        ------
        CharacterError
            The weights are those of another character.
        """
        if weights is None:
            if not self._weights.any():
                return None
            weights = np.zeros_like(self._weights)
        if np.shape(weights) != self._weights.shape:
            raise CharacterError(
                f"a pose with morphs of shape {np.shape(weights)} for a character that has "
                f"{len(self._runs)}: give one weight for each"
            )
        if np.array_equal(weights, self._weights):
            return None
        self._weights = np.array(weights, float)
        np.copyto(self._mixed, self._still)
        for number in np.flatnonzero(self._weights):
            run = self._runs[number]
            if run is not None:  # else no mesh that is drawn has it
                self._mixed[run.first : run.first + len(run.shifts)] += (
                    np.float32(self._weights[number]) * run.shifts
                )
        return self._mixed


def joined(meshes: Sequence[Mesh], starts: Sequence[int]) -> tuple[Morph, ...]:
    """Return the morphs of meshes that lie one after the other; those of one name become one.

    Parameters
    ----------
    meshes
        Some that are drawn together.
    starts
        Number that the first vertex of each has among all of them.
    """
    found: dict[str, list[tuple[Morph, int]]] = {}
    for mesh, start in zip(meshes, starts, strict=True):
        for morph in mesh.morphs:
            if morph.vertices.size:
                found.setdefault(morph.name, []).append((morph, start))
    return tuple(_sum(name, parts) for name, parts in found.items())


def _sum(name: str, parts: Sequence[tuple[Morph, int]]) -> Morph:
    numbers = np.concatenate([morph.vertices.astype(np.uint32) + start for morph, start in parts])
    rows = np.concatenate([_both_shifts(morph) for morph, _ in parts])
    vertices, which = np.unique(numbers, return_inverse=True)
    total = np.zeros((len(vertices), 6), np.float32)
    np.add.at(total, which, rows)  # a mesh may have two morphs of one name
    return Morph(name, vertices, total[:, :3], total[:, 3:] if total[:, 3:].any() else None)


def _both_shifts(morph: Morph) -> NDArray[np.float32]:
    """Return what positions and normals change by, (n, 6)."""
    normals = np.zeros_like(morph.shifts) if morph.normal_shifts is None else morph.normal_shifts
    return np.hstack([morph.shifts, normals]).astype(np.float32)
