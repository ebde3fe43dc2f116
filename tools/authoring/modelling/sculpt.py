"""Sculpting: from coloured volumes on a skeleton to skinned, painted meshes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.meshes import bound_mesh, join
from tools.authoring.modelling.shapes import Array, Shape, Solid, Vector
from tools.authoring.modelling.surface import neighbour_mean, normals_of, polygonise


@dataclass(frozen=True)
class PaintCoat:
    """A coat of colour on all vertices inside a volume, such as a cheek or a stripe."""

    shape: Shape
    """The painted volume."""

    color: Vector
    """Linear RGB."""

    soft: float = 0.0
    """Width of the border [m]; 0 for a crisp one."""

    strength: float = 1.0
    """Opacity, 0…1."""


@dataclass(frozen=True)
class BodyPart:
    """One closed surface, such as a jacket or a head."""

    shape: Shape
    """Its volume, whose solids have bones and colours."""

    cell: float
    """Approximate edge of a triangle [m]."""

    paints: tuple[PaintCoat, ...] = ()
    """Coats over the colours of the solids, in order."""

    soft_skin: float = 0.03
    """Distance on the surface over which skin weights blend [m]; 0 for rigid."""

    soft_color: float = 0.0
    """Width of the border between the colours of two solids [m]."""


def sculpt(
    name: str, parts: Sequence[BodyPart], skeleton: Skeleton, material: Material | None = None
) -> Mesh:
    """Return one mesh of all parts, bound to the rest pose of the skeleton.

    Each part is a closed surface of its own, so the border between two parts is crisp whatever
    the size of the triangles.
    """
    return join(name, [_sculpt_part(part, skeleton) for part in parts], material)


def _sculpt_part(part: BodyPart, skeleton: Skeleton) -> Mesh:
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
    """Return a tight box: the inside points of a coarse grid, plus one coarse cell."""
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

    Every vertex starts with the bone of its nearest solid. The borders are then softened by
    diffusion along the edges of the mesh, so weights spread over the surface only, never through
    the air from one leg to the other.
    """
    joints = skeleton.rest.globals(skeleton)[:, :3, 3]
    owner = np.argmin(distances + 1e-6 * np.arange(len(solids)), axis=1)  # no ties
    weights = np.zeros((len(points), len(skeleton.names)))
    for number, solid in enumerate(solids):
        mine = np.flatnonzero(owner == number)
        bones = np.array([skeleton.names.index(bone) for bone in solid.bones])
        reach = np.stack([_bone_distance(points[mine], b, joints, skeleton) for b in bones])
        reach += 1e-6 * np.arange(len(bones))[:, None]  # the first of two equal ones
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


def _painted(points: Array, solids: Sequence[Solid], distances: Array, part: BodyPart) -> Array:
    """Return the linear RGB of every vertex, (n, 3)."""
    far = distances - distances.min(axis=1, keepdims=True)
    share = np.exp(-far / max(part.soft_color, 1e-6))
    share /= share.sum(axis=1, keepdims=True)
    return np.asarray(share @ np.array([solid.color for solid in solids]))


def coated(points: Array, colors: Array, paints: Sequence[PaintCoat]) -> Array:
    """Return the linear RGB, (n, 3), of points (n, 3) after coats of paint."""
    for paint in paints:
        depth = 0.5 - paint.shape.distance(points) / max(paint.soft, 1e-6)
        cover = paint.strength * smoothstep(depth)[:, None]
        colors = colors * (1 - cover) + cover * np.array(paint.color)
    return np.asarray(colors)
