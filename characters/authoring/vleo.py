"""Vleo, a baby sauropod that throws kisses and shouts: its mesh, skeleton and clips."""

from dataclasses import replace

import numpy as np

from characters.authoring.sculpt import join
from characters.authoring.vleo_clips import clip
from characters.authoring.vleo_effects import effects
from characters.authoring.vleo_face import face
from characters.authoring.vleo_idle import idle
from characters.authoring.vleo_kiss import kiss
from characters.authoring.vleo_marks import marks
from characters.authoring.vleo_pieces import skin_mesh
from characters.authoring.vleo_rig import resting, skeleton
from characters.authoring.vleo_shout import shout
from characters.authoring.vleo_skin import body
from characters.character import Character
from characters.clip import Clip
from characters.mesh import Material, Mesh
from characters.pose import Skeleton

LEVELS = ("head", "legs", "tail")
"""What joins in at intensities −1, 0 and 1."""


def build_vleo() -> Character:
    """Return Vleo, 0.45 m from nose to tail, as it is shipped."""
    bound = skeleton()
    return Character("vleo", resting(bound), clips(bound), (mesh(bound),))


def clips(bound: Skeleton) -> dict[str, Clip]:
    """Return all clips by name."""
    made = [clip("idle", idle(), bound)]
    for level, name in enumerate(LEVELS):
        made.append(clip(f"kiss_{name}", kiss(level, bound), bound))
        made.append(clip(f"shout_{name}", shout(level, bound), bound))
    return {each.name: each for each in made}


def mesh(bound: Skeleton) -> Mesh:
    """Return Vleo's one mesh, bound to the skeleton's pose."""
    skin = body(bound)
    pieces = [skin_mesh(skin, bound), *face(skin, bound), *marks(skin, bound), *effects(bound)]
    return _welded(join("Vleo", pieces, Material(roughness=0.55)))


def _welded(mesh: Mesh) -> Mesh:
    """Return the mesh with equal vertices merged and triangles without area left out."""
    colors = np.ones((len(mesh.positions), 4)) if mesh.colors is None else mesh.colors
    columns = (mesh.positions, mesh.normals, mesh.joints, mesh.weights, colors)
    rows = np.hstack([np.asarray(column, np.float64) for column in columns])
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    order = np.sort(first)  # as they came
    rank = np.searchsorted(order, first)[number.reshape(-1)]
    triangles = rank[mesh.triangles].astype(np.uint32)
    a, b, c = triangles.T
    return replace(
        mesh,
        positions=mesh.positions[order],
        normals=mesh.normals[order],
        triangles=triangles[(a != b) & (b != c) & (c != a)],
        joints=mesh.joints[order],
        weights=mesh.weights[order],
        colors=colors[order].astype(np.float32),
    )
