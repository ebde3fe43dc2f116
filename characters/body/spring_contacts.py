"""Keeping the tails of spring bones out of spheres and capsules."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.springs import SpringBone, SpringCollider
from cubeling.characters.skeleton.pose import Array

_Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Contacts:
    """Which spring bones of a level may hit which colliders, one after the other."""

    colliders: _Indices
    """A collider for each bone and turn, (bones, turns); any where there is none."""

    reach: Array
    """The least distance of the tail to the axis of the collider, (bones, turns) [m]; 0 where there
    is none."""

    squared_reach: Array
    """Its square, (bones, turns) [m²]."""

    are_spheres: bool
    """Whether all colliders are spheres."""

    @staticmethod
    def of(bones: Sequence[SpringBone], shapes: Sequence[SpringCollider]) -> "Contacts | None":
        """Return the pairs of bones and colliders, numbered as in `shapes`; None without any."""
        turns = max(len(bone.colliders) for bone in bones)
        if not turns:
            return None
        colliders = np.zeros((len(bones), turns), np.intp)
        reach = np.zeros((len(bones), turns))
        for number, bone in enumerate(bones):
            for turn, shape in enumerate(bone.colliders):
                colliders[number, turn] = shapes.index(shape)
                reach[number, turn] = max(bone.radius + shape.radius, 0.0)
        are_spheres = all(shape.start == shape.end for shape in shapes)
        return Contacts(colliders, reach, reach * reach, are_spheres)

    def push_out(self, tails: Array, origins: Array, lengths: Array, ends: Array) -> None:
        """Change tails of bones, (bones, 3), so that they leave colliders.

        `ends` are both ends of the axes of all colliders, (colliders, 2, 3). Each tail leaves its
        colliders in turn, and is put back to its distance from the joint, `origins`, each time.
        """
        # Also those without colliders: to pick the others and to put them back would take longer.
        turn, turns = 0, self.reach.shape[1]
        while turn < turns:
            away, squares = self._from_axes(tails, ends, turn)
            inside = squares < self.squared_reach[:, turn:]
            if not np.count_nonzero(inside):
                break
            # The first turn in which a tail is in a collider.
            first = int(inside.any(axis=0).argmax()) if turn + 1 < turns else 0
            distances = np.sqrt(np.maximum(squares[:, first], 1e-18))
            shares = np.maximum(self.reach[:, turn + first] / distances - 1.0, 0.0)
            way = tails - origins
            way += away[:, first] * shares[:, None]
            np.add(origins, with_length(way, lengths), out=tails)
            turn += first + 1

    def _from_axes(self, tails: Array, ends: Array, turn: int) -> tuple[Array, Array]:
        """Return the ways from the axes of the colliders from a turn on to tails, and squares.

        They are (bones, turns, 3) and (bones, turns).
        """
        colliders = self.colliders[:, turn:]
        start = ends[:, 0].take(colliders, 0)
        away = tails[:, None] - start
        if not self.are_spheres:
            along = ends[:, 1].take(colliders, 0) - start
            shares = np.vecdot(away, along) / np.maximum(np.vecdot(along, along), 1e-18)
            away -= np.clip(shares, 0.0, 1.0)[..., None] * along
        return away, np.vecdot(away, away)


def with_length(vectors: Array, lengths: Array) -> Array:
    """Return vectors (n, 3) with these lengths (n, 1)."""
    squares = np.maximum(np.vecdot(vectors, vectors), 1e-18)[:, None]
    scaled: Array = vectors * (lengths / np.sqrt(squares))
    return scaled
