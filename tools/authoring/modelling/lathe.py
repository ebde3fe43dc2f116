"""Closed surfaces from rings of points: solids of revolution and lofted surfaces."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.meshes import averaged_normals, bound_mesh
from tools.authoring.modelling.shapes import Array, Vector


def lathe(
    rings: Array,
    colors: Sequence[Vector],
    place: Array,
    joint: str,
    skeleton: Skeleton,
    segments: int = 24,
) -> Mesh:
    """Return a rigid solid of revolution with crisp bands of colour, such as an eye or a button.

    Parameters
    ----------
    rings : (n, 2), radius and height from the first pole to the last [m]; both radii are zero
    colors : n − 1 linear RGB, one for each band between two rings
    place : (3, 4) or (4, 4), character frame from the lathe's, whose axis is +z; the last ring
        is at the top
    joint : the joint that moves it
    """
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    axis = np.array([0.0, 0.0, 1.0])
    border = [below != above for below, above in pairwise(colors)]
    copies = np.array([1, *(1 + np.array(border, dtype=int)), 1])  # two rings where colours meet
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
    """Return the normals of a profile at its rings, averaged over the adjacent bands."""
    across = np.diff(rings, axis=0)
    slope = np.stack([across[:, 1], -across[:, 0]], axis=1)
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    both = np.vstack([[0.0, -2.0], slope[:-1] + slope[1:], [0.0, 2.0]])
    return np.asarray(both / np.linalg.norm(both, axis=1, keepdims=True))


def circle_profile(polar: Array) -> Array:
    """Return the profile of a unit sphere at polar angles [rad], (n, 2): radius and height."""
    return np.stack([np.sin(polar), np.cos(polar)], axis=1)


def loft(rings: Array, colors: Array, joint: "str | Array", skeleton: Skeleton) -> Mesh:
    """Return a closed surface through rings of points.

    Parameters
    ----------
    rings : (rings, points, 3), from one pole to the other; all points of the first and of the last
        ring are equal [m]. Two equal rings make a crisp border of colour. Seen from outside, the
        next ring lies to the left of the direction of the points.
    colors : linear RGB of each point, (rings, points, 3)
    joint : the joint that moves it, or skin weights, (rings, points, joints)
    """
    segments = rings.shape[1]
    points = np.asarray(rings, float).reshape(-1, 3)
    same = np.all(rings[1:] == rings[:-1], axis=(1, 2))
    triangles = bands(np.flatnonzero(~same), segments)
    if isinstance(joint, str):
        bones = np.zeros((len(points), len(skeleton.names)))
        bones[:, skeleton.names.index(joint)] = 1.0
    else:
        bones = joint.reshape(len(points), -1)
    normals = averaged_normals(points, triangles)
    return bound_mesh(points, normals, triangles, bones, colors.reshape(-1, 3), skeleton)


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


def frame_toward(axis: ArrayLike, origin: ArrayLike) -> Array:
    """Return the (4, 4) frame at a point with +z along an axis and +y as far up as possible."""
    z = np.asarray(axis, float) / np.linalg.norm(axis)
    hint = np.array([0.0, 1.0, 0.0]) if abs(z[1]) < 0.95 else np.array([0.0, 0.0, -1.0])
    x = np.cross(hint, z)
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    frame[:3, 3] = origin
    return frame
