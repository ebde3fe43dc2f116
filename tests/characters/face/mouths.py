"""Measuring the mouths of the bundled characters on their meshes."""

from dataclasses import dataclass
from unittest import mock

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Array
from tools.authoring.human import mouth as human_mouth, teeth as human_teeth
from tools.authoring.human.rig import build_human_skeleton
from tools.authoring.vleo import mouth as vleo_mouth
from tools.authoring.vleo.rig import skeleton as vleo_skeleton

RIM_FROM_END = 6
"""The ring of the lips' inner edge in a mouth's mesh, from its last."""


def _pieces(name: str) -> tuple[Mesh, Mesh, int]:
    """Return the mouth and the upper teeth of a character, and how many points a ring has.

    They are at rest: their morphs take seconds to make, and the character has them.
    """
    if name == "human":
        bound = build_human_skeleton()
        with (
            mock.patch.object(human_mouth, "EXPRESSIONS", {}),
            mock.patch.object(human_teeth, "EXPRESSIONS", {}),
        ):
            mouth, (teeth, *_) = human_mouth.mouth(bound), human_teeth.teeth_and_tongue(bound)
        return mouth, teeth, human_mouth.POINTS_PER_RING
    with mock.patch.object(vleo_mouth, "EXPRESSIONS", {}):
        mouth, teeth, _ = vleo_mouth.mouth(vleo_skeleton())
    return mouth, teeth, vleo_mouth.POINTS_PER_RING


def _numbers_in(mesh: Mesh, points: Array) -> NDArray[np.intp]:
    """Return the vertices of a mesh at points (n, 3)."""
    off = np.linalg.norm(mesh.positions[None] - points[:, None], axis=2)
    assert off.min(axis=1).max() < 1e-5
    return np.asarray(off.argmin(axis=1))


@dataclass(frozen=True)
class MeasuredMouth:
    """The inner edges of the lips, and the upper teeth, under morph weights."""

    upper: Array
    """Heights of points of the upper lip at rest and by each morph, (morphs + 1, points) [m]."""

    lower: Array
    """Those of the lower lip below them."""

    teeth: Array
    """Those of the lower edge of the upper teeth, (morphs + 1, points) [m]."""

    widths: Array
    """x of both corners of the mouth at rest and by each morph, (morphs + 1, 2) [m]."""

    @staticmethod
    def of(character: Character) -> "MeasuredMouth":
        """Find them on a bundled character."""
        mesh = character.meshes[0]
        mouth, teeth, points = _pieces(character.name)
        ring = mouth.positions.astype(float).reshape(-1, points, 3)[-RIM_FROM_END]
        half = np.arange(1, points // 2)
        front = teeth.positions.astype(float).reshape(-1, 4, 3)
        tip = front[len(front) // 2 - 2 : len(front) // 2 + 3, 1]

        def moved(vertices: NDArray[np.intp], axis: int) -> Array:
            rows = np.zeros((len(character.morphs) + 1, len(vertices)))
            rows[0] = mesh.positions[vertices, axis]
            for morph in mesh.morphs:
                whole = np.zeros(len(mesh.positions))
                whole[morph.vertices] = morph.displacements[:, axis]
                rows[character.morphs.index(morph.name) + 1] = whole[vertices]
            return rows

        return MeasuredMouth(
            moved(_numbers_in(mesh, ring[half]), 1),
            moved(_numbers_in(mesh, ring[points - half]), 1),
            moved(_numbers_in(mesh, tip), 1),
            moved(_numbers_in(mesh, ring[[points // 2, 0]]), 0),
        )

    def gap(self, weights: Array) -> Array:
        """Return the largest gap between the lips [m] for weights (…, morphs), (…,)."""
        return np.asarray((_with(self.upper, weights) - _with(self.lower, weights)).max(axis=-1))

    def teeth_over_lip(self, weights: Array) -> Array:
        """Return the gap from the lower lip up to the teeth [m]; negative if they are over it."""
        middle = self.lower.shape[1] // 2
        lip = _with(self.lower[:, middle : middle + 1], weights)
        return np.asarray((_with(self.teeth, weights) - lip).mean(axis=-1))

    def width(self, weights: Array) -> Array:
        """Return the width of the mouth [m], (…,)."""
        corners = _with(self.widths, weights)
        return np.asarray(corners[..., 1] - corners[..., 0])


def _with(rows: Array, weights: Array) -> Array:
    return np.asarray(rows[0] + weights @ rows[1:])
