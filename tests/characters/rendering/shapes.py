"""Shapes that stand still, to measure light on, and a path."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.rendering import FloorPath, SceneCharacter
from cubeling.characters.skeleton.pose import Pose, Skeleton

LOOP = FloorPath(
    np.stack([0.13 * np.cos(np.arange(8) * 0.7854), 0.08 * np.sin(np.arange(8) * 0.7854)], axis=1),
    closed=True,
    highlight=2,
)
"""A closed path of eight points around the pawn's place, the third of them highlighted."""

JOINT = Skeleton(("middle",), (-1,), Pose(np.zeros((1, 3)), np.eye(4)[3:]))


@dataclass(frozen=True)
class Still:
    """Meshes that do not move, in the table frame."""

    meshes: tuple[Mesh, ...]
    skeleton: Skeleton = JOINT
    morphs: tuple[str, ...] = ()

    def posed(self):
        pose = self.skeleton.rest
        return SceneCharacter(
            self, PosedCharacter(pose, np.eye(4), True, "idle", 0.0, 0.0, 0.0, 0.0)
        )


def plate(material: Material, at=(0.0, 0.0, 0.0), side=0.12):
    """Return a level square around a point of the table frame [m]."""
    corners = np.array([(-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)]) * side / 2
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return mesh(corners + at, np.tile([0.0, 1.0, 0.0], (4, 1)), triangles, material)


def ball(material: Material, at=(0.0, 0.06, 0.0), radius=0.06, rings=48):
    """Return a sphere around a point of the table frame [m]."""
    polar, around = np.meshgrid(
        np.linspace(0.0, np.pi, rings + 1), np.linspace(0.0, 2.0 * np.pi, 2 * rings + 1)
    )
    out = np.stack(
        [np.sin(polar) * np.cos(around), np.cos(polar), np.sin(polar) * np.sin(around)], axis=-1
    ).reshape(-1, 3)
    row, column = np.divmod(np.arange(2 * rings * rings), rings)
    corner = row * (rings + 1) + column
    quads = np.stack([corner, corner + rings + 1, corner + rings + 2, corner + 1], axis=-1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return mesh(radius * out + at, out, triangles, material)


def mesh(positions, normals, triangles, material: Material):
    """Return a mesh that the only joint moves."""
    count = len(positions)
    return Mesh(
        name="shape",
        positions=np.asarray(positions, np.float32),
        normals=np.asarray(normals, np.float32),
        triangles=np.asarray(triangles, np.uint32),
        joints=np.zeros((count, 4), np.uint16),
        weights=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)).astype(np.float32),
        inverse_bind=np.eye(4)[None],
        uvs=np.full((count, 2), 0.5, np.float32),  # skin has texture coordinates
        material=material,
    )
