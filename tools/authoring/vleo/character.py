"""Vleo, a baby sauropod that throws kisses and shouts: mesh, skeleton and clips."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material, Mesh, Morph
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.meshes import join
from tools.authoring.vleo.clips import clip
from tools.authoring.vleo.effects import effects
from tools.authoring.vleo.expressions import EXPRESSIONS
from tools.authoring.vleo.face import face, with_expressions
from tools.authoring.vleo.gestures import gestures
from tools.authoring.vleo.idle import idle
from tools.authoring.vleo.kiss import kiss
from tools.authoring.vleo.marks import markings
from tools.authoring.vleo.pieces import skin_mesh
from tools.authoring.vleo.rig import shipped_skeleton, skeleton
from tools.authoring.vleo.shout import shout
from tools.authoring.vleo.skin import body

LEVELS = ("head", "legs", "tail")
"""Names of the intensities −1, 0 and 1, after the part of the body that joins in."""


def build_vleo() -> Character:
    """Return the bundled Vleo, 0.45 m from nose to tail."""
    bound = skeleton()
    rest = shipped_skeleton(bound)
    return Character("vleo", rest, clips(rest), (mesh(bound),), morphs=tuple(EXPRESSIONS))


def clips(bound: Skeleton) -> dict[str, Clip]:
    """Return all clips by name."""
    made = [clip("idle", idle(), bound)]
    for level, name in enumerate(LEVELS):
        made.append(clip(f"kiss_{name}", kiss(level, bound), bound))
        made.append(clip(f"shout_{name}", shout(level, bound), bound))
    made += gestures(bound)
    return {each.name: each for each in made}


def mesh(bound: Skeleton) -> Mesh:
    """Return Vleo's one mesh, bound to the skeleton's pose."""
    skin = body(bound)
    outside = [with_expressions(m, bound) for m in (skin_mesh(skin, bound), *markings(skin, bound))]
    pieces = [*outside, *face(bound), *effects(bound)]
    return _welded(join("Vleo", pieces, Material(roughness=0.55)))


def _welded(mesh: Mesh) -> Mesh:
    """Return the mesh with equal vertices merged, without degenerate triangles."""
    colors = np.ones((len(mesh.positions), 4)) if mesh.colors is None else mesh.colors
    displacements = np.zeros((len(mesh.morphs), len(mesh.positions), 3))
    for row, morph in zip(displacements, mesh.morphs, strict=True):
        row[morph.vertices] = morph.displacements
    moved = displacements.swapaxes(0, 1).reshape(len(mesh.positions), -1)
    columns = (mesh.positions, mesh.normals, mesh.joints, mesh.weights, colors, moved)
    rows = np.hstack([np.asarray(column, np.float64) for column in columns])
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    order = np.sort(first)  # of first appearance
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
        morphs=tuple(_kept(morph, order) for morph in mesh.morphs),
    )


def _kept(morph: Morph, order: NDArray[np.intp]) -> Morph:
    """Return the morph target of the remaining vertices, in their order."""
    there = np.isin(morph.vertices, order)
    turned = morph.normal_displacements
    return replace(
        morph,
        vertices=np.searchsorted(order, morph.vertices[there]).astype(np.uint32),
        displacements=morph.displacements[there],
        normal_displacements=None if turned is None else turned[there],
    )
