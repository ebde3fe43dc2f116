"""Vleo's skin as a mesh, finer at the face, with skin weights and colours."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.sculpt import skin_weights
from tools.authoring.modelling.shapes import Array, Ellipsoid, Vector
from tools.authoring.modelling.surface import normals_of, polygonise
from tools.authoring.vleo.body import (
    BACK_TEAL,
    CREAM,
    MAROON,
    TEAL,
    body_shape,
    skin_shape,
    spine_line,
)
from tools.authoring.vleo.head import EYE_RADIUS_M, MouthCavity, azimuth, lip_line
from tools.authoring.vleo.rig import EYE_CENTRE_M

TRUNK_CELL_M, FACE_CELL_M = (0.0084, 0.0101, 0.0100), (0.0056, 0.0044, 0.0047)
"""Edges of a grid cell far from and near the mouth, along x, y, z [m]."""
FORWARD_AXIS, THIN_TAIL_Z_M = 2, -0.19
"""The axis of the tail, and the z [m] behind which the tail is thin and its cells are short."""
FINE_BOX_M = ((-0.044, 0.044), (0.192, 0.246), (0.134, 0.300))
"""Box with small cells, along x, y, z [m]."""


@dataclass(frozen=True)
class SkinSurface:
    """The skin as a mesh, in arrays."""

    points: Array
    """(n, 3) [m]."""

    normals: Array
    """(n, 3)."""

    triangles: NDArray[np.int64]
    """(m, 3)."""

    weights: Array
    """Skin weights, (n, joints)."""

    colors: Array
    """Linear RGB, (n, 3)."""


def body(bound: Skeleton) -> SkinSurface:
    """Return the skin with its weights and colours."""
    points, triangles = _surface()
    solids = list(skin_shape().solids())
    distances = np.stack([solid.distance(points) for solid in solids], axis=1)
    weights = skin_weights(points, triangles, solids, distances, bound, 0.022)
    weights = _with_face(points, _with_firm_feet(points, weights, bound), bound)
    normals = normals_of(skin_shape().distance, points, 0.003)
    eye = np.linalg.norm(np.abs(points) * [1, 0, 0] + points * [0, 1, 1] - EYE_CENTRE_M, axis=1)
    # Rims hidden under lids and lips do not affect the shading.
    outside = (body_shape().distance(points) > -0.0012) | (eye < 1.5 * EYE_RADIUS_M)
    normals[outside] = normals_of(body_shape().distance, points[outside], 0.003)
    return SkinSurface(points, normals, triangles, weights, skin_colors(points, normals))


def _surface() -> tuple[Array, NDArray[np.int64]]:
    """Return the mesh, from a grid stretched to have small cells on the face."""
    spans = {0: (-0.09, 0.09), 1: (-0.012, 0.32), 2: (-0.285, 0.215)}
    lines = []
    for axis, (low, high) in spans.items():
        line = np.linspace(low, high, 2000)
        near_low, near_high = FINE_BOX_M[axis]
        small = smoothstep((line - near_low) / 0.02 + 1) * smoothstep((near_high - line) / 0.02 + 1)
        edge = TRUNK_CELL_M[axis] + (FACE_CELL_M[axis] - TRUNK_CELL_M[axis]) * small
        if axis == FORWARD_AXIS:
            edge = edge * (1 - 0.42 * smoothstep((THIN_TAIL_Z_M - line) / 0.03))
        lines.append((line, np.concatenate([[0.0], np.cumsum(np.diff(line) / edge[1:])])))

    def unstretched(cells: Array) -> Array:
        columns = [np.interp(cells[:, i], lines[i][1], lines[i][0]) for i in range(3)]
        return np.stack(columns, axis=1)

    end = np.array([counted[-1] for _, counted in lines])
    points, triangles = polygonise(
        lambda cells: skin_shape().distance(unstretched(cells)), np.zeros(3), end, 1.0
    )
    return unstretched(points), triangles


def _with_firm_feet(points: Array, weights: Array, bound: Skeleton) -> Array:
    """Return the weights with soles that follow only their feet, so that they do not slide."""
    sole = smoothstep((0.034 - points[:, 1]) / 0.020)[:, None]
    own = np.zeros_like(weights)
    front, left = points[:, 2] > 0.0, points[:, 0] > 0
    for which, is_front in (("Front", True), ("Hind", False)):
        for side, is_left in (("Left", True), ("Right", False)):
            mine = (front == is_front) & (left == is_left)
            own[mine, bound.index(f"{side}{which}Foot")] = 1.0
    return weights * (1 - sole) + own * sole


def jaw_share(points: Array) -> Array:
    """Return the jaw's share of the head's weight on points (n, 3), (n,), 0…1."""
    side = azimuth(points)
    below = lip_line(side) - points[:, 1]
    soft = 0.0022 + 0.016 * np.clip((np.abs(side) - 0.68) / 0.45, 0, 1)
    ahead = (points[:, 2] - 0.096 + 0.35 * (points[:, 1] - 0.2235)) / 0.036
    return smoothstep(0.5 + 0.5 * below / soft) * smoothstep(ahead)


def _with_face(points: Array, weights: Array, bound: Skeleton) -> Array:
    """Return the weights with the head's part divided between head and jaw."""
    head, jaw = bound.index("head"), bound.index("jaw")
    both, share = weights[:, head] + weights[:, jaw], jaw_share(points)
    weights = weights.copy()
    weights[:, head], weights[:, jaw] = both * (1 - share), both * share
    return weights


def skin_colors(points: Array, normals: Array) -> Array:
    """Return the colours of the skin, (n, 3): teal, darker above, cream below, and a red mouth."""
    colors = np.tile(TEAL, (len(points), 1))
    colors = _coat(colors, BACK_TEAL, 0.7 * smoothstep((normals[:, 1] - 0.1) / 0.8))
    legs = body_shape().solids()
    leg = np.min([s.distance(points) for s in legs if s.bones[0][-3:] in ("Leg", "oot")], axis=0)
    under = smoothstep((_underside(points) - 0.26) / 0.30) * smoothstep(
        (0.208 - points[:, 1]) / 0.012
    )
    under = under * smoothstep((points[:, 2] + 0.215) / 0.08)  # not on the tip of the tail
    colors = _coat(colors, CREAM, under * smoothstep((leg + 0.001) / 0.014))
    chin = Ellipsoid((0.0, 0.200, 0.150), (0.052, 0.030, 0.046)).distance(points)
    lower = smoothstep((lip_line(azimuth(points)) - 0.0035 - points[:, 1]) / 0.005)
    lower = lower * smoothstep((0.85 - np.abs(azimuth(points))) / 0.35)  # not around its corners
    colors = _coat(colors, CREAM, lower * smoothstep(0.5 - chin / 0.012))
    inside = -np.maximum(
        body_shape().distance(points) + 0.0007, MouthCavity().distance(points) - 0.0020
    )
    return _coat(colors, MAROON, smoothstep(0.5 + inside / 0.0010))


def _underside(points: Array) -> Array:
    """Return the cosine between the direction from the spine and straight down, (n,)."""
    line = spine_line(160)[:, :3]
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    nearest = np.argmin(np.linalg.norm(points[:, None] - line, axis=2), axis=1)
    out = points - line[nearest]
    down = np.stack([np.zeros(160), -along[:, 2], along[:, 1]], axis=1)[nearest]
    return np.asarray(np.sum(out * down, axis=1) / np.linalg.norm(out, axis=1))


def _coat(colors: Array, color: Vector, cover: Array) -> Array:
    return colors + (np.array(color) - colors) * cover[:, None]
