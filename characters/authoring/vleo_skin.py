"""The skin of Vleo as a mesh: finer where the face is, held by its joints, and painted."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.authoring.sculpt import skin_weights
from characters.authoring.shapes import Array, Ellipsoid, Vector
from characters.authoring.surface import normals_of, polygonise
from characters.authoring.vleo_body import (
    BACK_TEAL,
    CREAM,
    MAROON,
    ROSE,
    TEAL,
    TONGUE,
    Smile,
    lip_line,
    skin,
    spine_line,
    whole,
)
from characters.pose import Skeleton

TRUNK_CELL, FACE_CELL = (0.0086, 0.0106, 0.0108), (0.0056, 0.0044, 0.0047)
"""Edges of a grid cell far from the mouth and about it, along x, y, z [m]."""
MOUTH_BOX = ((-0.044, 0.044), (0.192, 0.246), (0.134, 0.300))
"""Where the cells are small, along x, y, z [m]."""
CORNER_REACH = 0.018
"""How far a corner of the mouth pulls the skin about it [m]."""


@dataclass(frozen=True)
class Body:
    """The skin as a mesh, in arrays."""

    points: Array
    """(n, 3) [m]."""

    normals: Array
    """(n, 3)."""

    triangles: NDArray[np.int64]
    """(m, 3)."""

    weights: Array
    """Of every joint, (n, joints)."""

    colors: Array
    """Linear RGB, (n, 3)."""


def body(bound: Skeleton) -> Body:
    """Return the skin with its weights and colours."""
    points, triangles = _surface()
    solids = list(skin().solids())
    distances = np.stack([solid.distance(points) for solid in solids], axis=1)
    weights = skin_weights(points, triangles, solids, distances, bound, 0.022)
    weights = _with_face(points, _with_firm_feet(points, weights, bound), bound)
    normals = normals_of(skin().distance, points, 0.003)
    return Body(points, normals, triangles, weights, _painted(points, normals))


def _surface() -> tuple[Array, NDArray[np.int64]]:
    """Return the mesh, its grid stretched so that the cells are small on the face."""
    spans = {0: (-0.09, 0.09), 1: (-0.012, 0.32), 2: (-0.285, 0.215)}
    lines = []
    for axis, (low, high) in spans.items():
        line = np.linspace(low, high, 2000)
        near_low, near_high = MOUTH_BOX[axis]
        small = _ease((line - near_low) / 0.02 + 1) * _ease((near_high - line) / 0.02 + 1)
        edge = TRUNK_CELL[axis] + (FACE_CELL[axis] - TRUNK_CELL[axis]) * small
        lines.append((line, np.concatenate([[0.0], np.cumsum(np.diff(line) / edge[1:])])))

    def unstretched(cells: Array) -> Array:
        columns = [np.interp(cells[:, i], lines[i][1], lines[i][0]) for i in range(3)]
        return np.stack(columns, axis=1)

    end = np.array([counted[-1] for _, counted in lines])
    points, triangles = polygonise(
        lambda cells: skin().distance(unstretched(cells)), np.zeros(3), end, 1.0
    )
    return unstretched(points), triangles


def _with_firm_feet(points: Array, weights: Array, bound: Skeleton) -> Array:
    """Return the weights with soles that belong to their feet alone, so that they do not slide."""
    sole = _ease((0.034 - points[:, 1]) / 0.020)[:, None]
    own = np.zeros_like(weights)
    front, left = points[:, 2] > 0.0, points[:, 0] > 0
    for which, is_front in (("Front", True), ("Hind", False)):
        for side, is_left in (("Left", True), ("Right", False)):
            mine = (front == is_front) & (left == is_left)
            own[mine, bound.index(f"{side}{which}Foot")] = 1.0
    return weights * (1 - sole) + own * sole


def jaw_share(points: Array) -> Array:
    """Return how much of the head's hold on points (n, 3) is the jaw's, (n,), 0…1."""
    below = lip_line(points) - points[:, 1]
    soft = 0.0012 + 0.7 * np.maximum(0.0, 0.1535 - points[:, 2])
    ahead = (points[:, 2] - 0.100 + 0.35 * (points[:, 1] - 0.2235)) / 0.035
    return _ease(0.5 + 0.5 * below / soft) * _ease(ahead)


def face_weights(points: Array, bound: Skeleton) -> Array:
    """Return how head, jaw and corners of the mouth share points of the face, (n, joints)."""
    weights, jaw = np.zeros((len(points), len(bound))), jaw_share(points)
    weights[:, bound.index("head")], weights[:, bound.index("jaw")] = 1 - jaw, jaw
    for name in ("LeftMouthCorner", "RightMouthCorner"):
        joint = bound.index(name)
        away = points - bound.rest.globals(bound)[joint, :3, 3]
        hold = 0.9 * np.exp(-np.sum(away * away, axis=1) / CORNER_REACH**2)
        weights *= 1 - hold[:, None]
        weights[:, joint] += hold
    return weights


def _with_face(points: Array, weights: Array, bound: Skeleton) -> Array:
    """Return the weights with the head's share divided among the joints of the face."""
    face = weights[:, bound.index("head")] + weights[:, bound.index("jaw")]
    weights = weights.copy()
    weights[:, [bound.index("head"), bound.index("jaw")]] = 0.0
    return weights + face[:, None] * face_weights(points, bound)


def _painted(points: Array, normals: Array) -> Array:
    """Return the colours: teal, darker above, cream below, and a red mouth."""
    colors = np.tile(TEAL, (len(points), 1))
    colors = _coat(colors, BACK_TEAL, 0.7 * _ease((normals[:, 1] - 0.1) / 0.8))
    legs = whole().solids()
    leg = np.min([s.distance(points) for s in legs if s.bones[0][-3:] in ("Leg", "oot")], axis=0)
    under = _ease((_underside(points) - 0.34) / 0.14) * _ease((0.208 - points[:, 1]) / 0.012)
    colors = _coat(colors, CREAM, under * _ease((leg - 0.001) / 0.009))
    chin = Ellipsoid((0.0, 0.200, 0.150), (0.052, 0.030, 0.046)).distance(points)
    lower = _ease((lip_line(points) - 0.003 - points[:, 1]) / 0.004)
    colors = _coat(colors, CREAM, lower * _ease(0.5 - chin / 0.012))
    inside = -np.maximum(whole().distance(points) + 0.0004, Smile().distance(points) - 0.0018)
    colors = _coat(colors, MAROON, _ease(0.5 + inside / 0.0012))
    return _coat(colors, ROSE, _ease(1 - TONGUE.distance(points) / 0.0012))


def _underside(points: Array) -> Array:
    """Return the cosine between the direction from the spine and straight under it, (n,)."""
    line = spine_line(60)[:, :3]
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    nearest = np.argmin(np.linalg.norm(points[:, None] - line, axis=2), axis=1)
    out = points - line[nearest]
    down = np.stack([np.zeros(60), -along[:, 2], along[:, 1]], axis=1)[nearest]
    return np.asarray(np.sum(out * down, axis=1) / np.linalg.norm(out, axis=1))


def _coat(colors: Array, color: Vector, cover: Array) -> Array:
    return colors + (np.array(color) - colors) * cover[:, None]


def _ease(u: Array) -> Array:
    """Return a smooth step of u from 0 to 1."""
    u = np.clip(u, 0.0, 1.0)
    return u * u * (3 - 2 * u)
