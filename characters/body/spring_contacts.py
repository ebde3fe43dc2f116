"""Keeping the tails of spring bones out of spheres and capsules."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.model.springs import SpringBone, SpringCollider
from characters.skeleton.pose import Array

_Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Contacts:
    """Which spring bones of a level may hit which colliders."""

    bones: _Indices
    """A bone of the level for each pair, (pairs,)."""

    colliders: _Indices
    """A collider for each pair, (pairs,)."""

    reach: Array
    """The least distance of the tail to the axis of the collider, (pairs,) [m]."""

    turns: tuple[slice, ...]
    """Pairs that are treated together: no bone is in one of them twice."""

    @staticmethod
    def of(bones: Sequence[SpringBone], shapes: Sequence[SpringCollider]) -> "Contacts | None":
        """Return the pairs of bones and colliders, numbered as in `shapes`; None without any."""
        pairs = sorted(
            (turn, number, shapes.index(shape), bone.radius + shape.radius)
            for number, bone in enumerate(bones)
            for turn, shape in enumerate(bone.colliders)
        )
        if not pairs:
            return None
        turns = [turn for turn, *_ in pairs]
        return Contacts(
            np.array([number for _, number, _, _ in pairs], np.intp),
            np.array([shape for _, _, shape, _ in pairs], np.intp),
            np.array([reach for *_, reach in pairs]),
            tuple(
                slice(turns.index(turn), turns.index(turn) + turns.count(turn))
                for turn in sorted(set(turns))
            ),
        )

    def pushed_out(self, way: Array, origins: Array, lengths: Array, ends: Array) -> Array:
        """Return the ways from joints to tails, (bones, 3), with the tails out of colliders."""
        tails = (origins + way)[self.bones]
        if (self._distances(slice(None), tails, ends)[1] >= self.reach).all():
            return way
        way = way.copy()
        for turn in self.turns:
            bones = self.bones[turn]
            heads = origins[bones]
            away, distances = self._distances(turn, heads + way[bones], ends)
            depth = np.maximum(self.reach[turn] - distances, 0.0)[:, None]
            pushed = way[bones] + away * (depth / np.maximum(distances, 1e-9)[:, None])
            way[bones] = np.where(depth > 0, with_length(pushed, lengths[bones]), way[bones])
        return way

    def _distances(self, which: slice, tails: Array, ends: Array) -> tuple[Array, Array]:
        """Return the ways from the axes of colliders to tails, (pairs, 3), and their lengths."""
        start, end = ends[self.colliders[which], 0], ends[self.colliders[which], 1]
        along, away = end - start, tails - start
        squared = np.vecdot(along, along)
        shares = np.vecdot(away, along) / np.maximum(squared, 1e-18)
        away -= np.clip(shares, 0.0, 1.0)[:, None] * along
        return away, np.sqrt(np.vecdot(away, away))


def with_length(vectors: Array, lengths: Array) -> Array:
    """Return vectors (n, 3) with these lengths (n, 1)."""
    own = np.sqrt(np.vecdot(vectors, vectors))[:, None]
    scaled: Array = vectors * (lengths / np.maximum(own, 1e-9))
    return scaled
