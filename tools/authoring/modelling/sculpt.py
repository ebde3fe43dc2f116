"""From coloured volumes on a skeleton to skinned, painted meshes."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from characters.model.mesh import Material, Mesh, Morph
from characters.skeleton.pose import Skeleton
from tools.authoring.modelling.shapes import Array, Shape, Solid, Vector
from tools.authoring.modelling.surface import neighbour_mean, normals_of, polygonise


@dataclass(frozen=True)
class Paint:
    """A coat of colour on everything inside a volume: a belly, a cheek, a stripe."""

    shape: Shape
    """Where."""

    color: Vector
    """Linear RGB."""

    soft: float = 0.0
    """Width of the border [m]; 0 for a crisp one."""

    strength: float = 1.0
    """Opacity, 0…1."""


@dataclass(frozen=True)
class Part:
    """One piece with one skin: a jacket, a head, a body."""

    shape: Shape
    """Its volume; its solids carry the bones and colours."""

    cell: float
    """Edge of a triangle, about [m]."""

    paints: tuple[Paint, ...] = ()
    """Coats over the colours of the solids, in order."""

    soft_skin: float = 0.03
    """Distance over which one bone hands over to the next along the surface [m]; 0 for rigid."""

    soft_color: float = 0.0
    """Width of the border between the colours of two solids [m]."""


def sculpt(
    name: str, parts: Sequence[Part], skeleton: Skeleton, material: Material | None = None
) -> Mesh:
    """Return one mesh of all parts, bound to the rest pose of the skeleton.

    Each part is a closed surface of its own, so where two parts meet the border is as crisp as
    the picture, whatever the size of the triangles.
    """
    return join(name, [_sculpt_part(part, skeleton) for part in parts], material)


def join(name: str, meshes: Sequence[Mesh], material: Material | None = None) -> Mesh:
    """Return one mesh of several that are bound to the same skeleton."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    colors = [np.ones((len(m.positions), 4)) if m.colors is None else m.colors for m in meshes]
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


def lathe(
    rings: Array,
    colors: Sequence[Vector],
    place: Array,
    joint: str,
    skeleton: Skeleton,
    segments: int = 24,
) -> Mesh:
    """Return a rigid solid of revolution with crisp rings of colour: an eye, a button, a tooth.

    Parameters
    ----------
    rings : (n, 2), radius and height from the first pole to the last [m]; both radii are zero
    colors : n − 1 linear RGB, one a band between two rings
    place : (3, 4) or (4, 4), character frame from the lathe's, whose axis is +z; the last ring
        is at the top
    joint : the joint that moves it
    """
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    axis = np.array([0.0, 0.0, 1.0])
    border = [below != above for below, above in pairwise(colors)]
    copies = np.array([1, *(1 + np.array(border, dtype=int)), 1])  # two rims where colours meet
    profile = np.repeat(np.column_stack([rings, _ring_normals(np.asarray(rings))]), copies, axis=0)
    points = profile[:, :1, None] * circle + profile[:, 1:2, None] * axis
    normals = profile[:, 2:3, None] * circle + profile[:, 3:, None] * axis
    turn, shift = np.asarray(place)[:3, :3], np.asarray(place)[:3, 3]
    normals = normals.reshape(-1, 3) @ np.linalg.inv(turn)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    starts = np.cumsum(copies)[:-1] - 1
    band = np.searchsorted(starts, np.arange(len(profile)), side="right") - 1
    paint = np.array(colors)[np.minimum(band, len(colors) - 1)]
    bones = np.zeros((len(points) * segments, len(skeleton.names)))
    bones[:, skeleton.names.index(joint)] = 1.0
    return bound_mesh(
        points.reshape(-1, 3) @ turn.T + shift,
        normals,
        bands(starts, segments),
        bones,
        np.repeat(paint, segments, axis=0),
        skeleton,
    )


def _ring_normals(rings: Array) -> Array:
    """Return the normals of a profile at its rings, averaged over the bands beside them."""
    across = np.diff(rings, axis=0)
    slope = np.stack([across[:, 1], -across[:, 0]], axis=1)
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    both = np.vstack([[0.0, -2.0], slope[:-1] + slope[1:], [0.0, 2.0]])
    return np.asarray(both / np.linalg.norm(both, axis=1, keepdims=True))


def bands(starts: ArrayLike, segments: int) -> NDArray[np.int64]:
    """Return the triangles between rings of vertices, the first and last of which are poles.

    Parameters
    ----------
    starts : number of the ring at which each band begins; it ends at the next ring
    segments : vertices a ring
    """
    i = np.arange(segments)
    j = (i + 1) % segments
    lower = np.stack([i, j, j + segments], axis=1)  # empty in the first band
    upper = np.stack([i, j + segments, i + segments], axis=1)  # empty in the last
    first = segments * np.asarray(starts)
    return np.concatenate([lower + s for s in first[1:]] + [upper + s for s in first[:-1]])


def _sculpt_part(part: Part, skeleton: Skeleton) -> Mesh:
    field = part.shape.distance
    low, high = _bounds(part.shape, skeleton, part.cell)
    points, triangles = polygonise(field, low, high, part.cell)
    solids = list(part.shape.solids())
    distances = np.stack([solid.distance(points) for solid in solids], axis=1)
    weights = skin_weights(points, triangles, solids, distances, skeleton, part.soft_skin)
    colors = coated(points, _painted(points, solids, distances, part), part.paints)
    normals = normals_of(field, points, part.cell)
    return bound_mesh(points, normals, triangles, weights, colors, skeleton)


def _bounds(shape: Shape, skeleton: Skeleton, cell: float) -> tuple[Array, Array]:
    """Return a tight box: the coarse grid's inside points, one coarse cell wider."""
    joints = skeleton.rest.globals(skeleton)[:, :3, 3]
    low, high = joints.min(axis=0) - 0.6, joints.max(axis=0) + 0.6
    coarse = max(2.5 * cell, 0.02)
    axes = [np.arange(low[i], high[i], coarse) for i in range(3)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    near = grid[shape.distance(grid) < coarse]
    return near.min(axis=0) - coarse, near.max(axis=0) + coarse


def skin_weights(
    points: Array,
    triangles: NDArray[np.int64],
    solids: Sequence[Solid],
    distances: Array,
    skeleton: Skeleton,
    soft: float,
) -> Array:
    """Return the weight of every joint on every vertex, (n, joints); rows sum to one.

    Every vertex starts with the bone of its nearest solid; the borders are then softened by
    diffusion along the edges of the mesh. So weights travel over the skin only: never from one
    leg to the other through the air, nor from an arm to the flank.
    """
    joints = skeleton.rest.globals(skeleton)[:, :3, 3]
    owner = np.argmin(distances + 1e-6 * np.arange(len(solids)), axis=1)  # no ties
    weights = np.zeros((len(points), len(skeleton.names)))
    for number, solid in enumerate(solids):
        mine = np.flatnonzero(owner == number)
        bones = np.array([skeleton.names.index(bone) for bone in solid.bones])
        reach = np.stack([_bone_distance(points[mine], b, joints, skeleton) for b in bones])
        reach += 1e-6 * np.arange(len(bones))[:, None]  # where two end in one joint: the first
        weights[mine, bones[np.argmin(reach, axis=0)]] = 1.0
    edges = points[triangles] - points[np.roll(triangles, 1, axis=1)]
    edge = float(np.mean(np.linalg.norm(edges, axis=-1)))
    for _ in range(round(4 * (soft / edge) ** 2)):  # each round adds edge² / 4 of variance
        weights = 0.5 * (weights + neighbour_mean(weights, triangles))
    return weights


def _bone_distance(points: Array, bone: int, joints: Array, skeleton: Skeleton) -> Array:
    """Return the distance to the nearest of a joint's segments to its children, (n,) [m]."""
    ends = [joints[c] for c, parent in enumerate(skeleton.parents) if parent == bone]
    start, best = joints[bone], np.linalg.norm(points - joints[bone], axis=1)
    for end in ends:
        along = end - start
        t = np.clip((points - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - start - t[:, None] * along, axis=1))
    return np.asarray(best)


def _painted(points: Array, solids: Sequence[Solid], distances: Array, part: Part) -> Array:
    """Return the linear RGB of every vertex, (n, 3)."""
    far = distances - distances.min(axis=1, keepdims=True)
    share = np.exp(-far / max(part.soft_color, 1e-6))
    share /= share.sum(axis=1, keepdims=True)
    return np.asarray(share @ np.array([solid.color for solid in solids]))


def coated(points: Array, colors: Array, paints: Sequence[Paint]) -> Array:
    """Return linear RGB (n, 3) of points (n, 3) under coats of paint."""
    for paint in paints:
        depth = 0.5 - paint.shape.distance(points) / max(paint.soft, 1e-6)
        t = np.clip(depth, 0.0, 1.0)
        cover = paint.strength * (t * t * (3 - 2 * t))[:, None]
        colors = colors * (1 - cover) + cover * np.array(paint.color)
    return np.asarray(colors)


def bound_mesh(
    points: Array,
    normals: Array,
    triangles: NDArray[np.int64],
    weights: Array,
    colors: Array,
    skeleton: Skeleton,
) -> Mesh:
    """Return the arrays as the graphics card wants them, with the four largest weights.

    Parameters
    ----------
    points, normals : (n, 3)
    triangles : (m, 3)
    weights : of every joint on every vertex, (n, joints)
    colors : linear RGB, (n, 3)
    skeleton : the vertices are bound to its rest pose
    """
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    four = np.take_along_axis(weights, joints, axis=1)
    four[four < 0.01] = 0.0
    four /= four.sum(axis=1, keepdims=True)
    return Mesh(
        name="",
        positions=points.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        joints=np.where(four > 0, joints, 0).astype(np.uint16),
        weights=four.astype(np.float32),
        inverse_bind=np.asarray(np.linalg.inv(skeleton.rest.globals(skeleton)), np.float64),
        colors=np.column_stack([colors, np.ones(len(points))]).astype(np.float32),
    )
