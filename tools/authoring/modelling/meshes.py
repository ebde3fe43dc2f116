"""Building skinned meshes from arrays: skin weights, joining, mirroring, normals, morph targets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Material, Mesh, Morph
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.shapes import Array, mirrored_name

Expression = TypeVar("Expression")

MIN_DISPLACEMENT_M = 2e-4
"""Vertices that move less are not part of a morph target."""
MIN_SKIN_WEIGHT = 0.01


def bound_mesh(
    points: Array,
    normals: Array,
    triangles: NDArray[np.int64],
    weights: Array,
    colors: Array,
    skeleton: Skeleton,
) -> Mesh:
    """Return a mesh of these arrays, with the four largest skin weights of each vertex.

    Parameters
    ----------
    points, normals : (n, 3)
    triangles : (m, 3)
    weights : of every joint on every vertex, (n, joints)
    colors : linear RGB, (n, 3)
    skeleton : the vertices are bound to its rest pose
    """
    joints, four = strongest_joints(weights)
    return Mesh(
        name="",
        positions=points.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        joints=joints,
        weights=four,
        inverse_bind=np.asarray(np.linalg.inv(skeleton.rest.globals(skeleton)), np.float64),
        colors=np.column_stack([colors, np.ones(len(points))]).astype(np.float32),
    )


def strongest_joints(weights: Array) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
    """Return the four joints with the largest weights, (n, 4), and their weights, (n, 4).

    Parameters
    ----------
    weights : of every joint on every vertex, (n, joints)
    """
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    four = np.take_along_axis(weights, joints, axis=1)
    four[four < MIN_SKIN_WEIGHT] = 0.0
    four /= four.sum(axis=1, keepdims=True)
    return np.where(four > 0, joints, 0).astype(np.uint16), four.astype(np.float32)


def join(name: str, meshes: Sequence[Mesh], material: Material | None = None) -> Mesh:
    """Return one mesh of several that are bound to the same skeleton."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    colors = [np.ones((len(m.positions), 4)) if m.colors is None else m.colors for m in meshes]
    uvs = [np.zeros((len(m.positions), 2)) if m.uvs is None else m.uvs for m in meshes]
    mapped = any(mesh.uvs is not None for mesh in meshes)
    return Mesh(
        name=name,
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        triangles=np.concatenate(
            [mesh.triangles + np.uint32(s) for mesh, s in zip(meshes, starts, strict=False)]
        ),
        joints=np.concatenate([mesh.joints for mesh in meshes]),
        weights=np.concatenate([mesh.weights for mesh in meshes]),
        inverse_bind=meshes[0].inverse_bind,
        colors=np.concatenate(colors).astype(np.float32),
        uvs=np.concatenate(uvs).astype(np.float32) if mapped else None,
        material=material or meshes[0].material,
        morphs=_joined_morphs(meshes, starts.tolist()),
    )


def _joined_morphs(meshes: Sequence[Mesh], starts: Sequence[int]) -> tuple[Morph, ...]:
    """Return the morphs of all meshes, those of one name as one, in order of appearance."""
    names = dict.fromkeys(morph.name for mesh in meshes for morph in mesh.morphs)
    joined = []
    for name in names:
        pieces = [
            (morph.vertices + np.uint32(start), morph)
            for mesh, start in zip(meshes, starts, strict=False)
            for morph in mesh.morphs
            if morph.name == name
        ]
        turns = [
            np.zeros_like(morph.displacements)
            if morph.normal_displacements is None
            else morph.normal_displacements
            for _, morph in pieces
        ]
        joined.append(
            Morph(
                name,
                np.concatenate([vertices for vertices, _ in pieces]),
                np.concatenate([morph.displacements for _, morph in pieces]),
                np.concatenate(turns),
            )
        )
    return tuple(joined)


def mirrored_mesh(mesh: Mesh, skeleton: Skeleton) -> Mesh:
    """Return the mirror image of a mesh in the plane x = 0, skinned to the other side's joints.

    Morph targets are not mirrored.
    """
    other = np.array([skeleton.names.index(mirrored_name(name)) for name in skeleton.names])
    flip = np.array([-1.0, 1.0, 1.0], np.float32)
    return replace(
        mesh,
        positions=mesh.positions * flip,
        normals=mesh.normals * flip,
        triangles=np.ascontiguousarray(mesh.triangles[:, ::-1]),
        joints=np.where(mesh.weights > 0, other[mesh.joints], 0).astype(np.uint16),
    )


def averaged_normals(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Return vertex normals, (n, 3): the area-weighted mean over the adjacent triangles."""
    corners = vertices[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    _, same = np.unique(vertices.round(7), axis=0, return_inverse=True)  # merges a pole
    total = np.zeros((same.max() + 1, 3))
    np.add.at(total, same[triangles.ravel()], np.repeat(flat, 3, axis=0))
    normal = total[same]
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15))


def blend_normals(mesh: Mesh, normals: Array, weight: Array) -> Mesh:
    """Return a mesh with normals blended towards others by a weight for each vertex, (n,)."""
    mixed = mesh.normals * (1 - weight[:, None]) + normals * weight[:, None]
    mixed /= np.maximum(np.linalg.norm(mixed, axis=1, keepdims=True), 1e-12)
    return replace(mesh, normals=mixed.astype(np.float32))


def morphed(
    build: Callable[[Expression], Mesh],
    neutral: Expression,
    expressions: Mapping[str, Expression],
) -> Mesh:
    """Return the neutral mesh with a morph target for each expression that changes it.

    Parameters
    ----------
    build : returns the mesh of an expression, always with the same vertices in the same order
    """
    mesh = build(neutral)
    made = ((name, build(expression)) for name, expression in expressions.items())
    morphs = [morph for name, other in made if (morph := morph_between(name, mesh, other))]
    return replace(mesh, morphs=tuple(morphs))


def morph_between(name: str, mesh: Mesh, other: Mesh) -> Morph | None:
    """Return the morph target from a mesh to another with the same triangles; None if equal."""
    displacements = other.positions - mesh.positions
    moved = np.flatnonzero(np.abs(displacements).max(axis=1) > MIN_DISPLACEMENT_M)
    if not len(moved):
        return None
    turned = (other.normals - mesh.normals)[moved]
    return Morph(
        name,
        moved.astype(np.uint32),
        displacements[moved].astype(np.float32),
        turned.astype(np.float32),
    )
