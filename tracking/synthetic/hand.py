"""A hand that holds the cube: capsules of skin with soft light."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.synthetic.lens import Lens, Region, averaged

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

SKIN = np.array([132.0, 164.0, 222.0])
"""Colour of the skin, BGR."""

SLEEVE = np.array([120.0, 86.0, 62.0])
"""Colour of the sleeve, BGR."""

AWAY = np.array([0.34, 0.16, -0.06])
"""Where the hand comes from and goes to, from the cube [m]."""


@dataclass(frozen=True)
class _Bone:
    """A capsule between two points with a radius at each end [m]."""

    start: Array
    end: Array
    radii: tuple[float, float]
    sleeve: bool = False


def bones(position: Array, edge: float, grip: float) -> list[_Bone]:
    """Return the hand at the cube's right and far side, fingers on its upper edges.

    Parameters
    ----------
    position
        Centre of the cube in the table frame, (3,) [m].
    edge
        Edge of the cube [m].
    grip
        0 away, 1 holding.
    """
    at = position + AWAY * (1.0 - grip)
    half = edge / 2
    open_hand = 0.018 * (1.0 - grip)
    knuckles = at + (half + 0.040, half + 0.034, -half - 0.004)
    wrist = knuckles + (0.078, 0.012, 0.004)
    elbow = wrist + (0.62, 0.10, 0.07)
    parts = [
        _Bone(wrist, elbow, (0.033, 0.050), sleeve=True),
        _Bone(knuckles + (0.005, 0, 0.022), wrist, (0.025, 0.026)),
        _Bone(knuckles + (0, 0, -0.018), wrist, (0.023, 0.025)),
        _Bone(knuckles, wrist, (0.026, 0.027)),
    ]
    # Fingers reach over the top's far edge, the thumb lies on the right face.
    for along, lift in ((0.50, 0.0), (0.18, 0.004), (-0.14, 0.003), (-0.42, -0.001)):
        tip = at + (along * half, half * 0.72, -half - 0.007 - open_hand)
        root = knuckles + (-0.006, 0.004, 0.020 - 0.016 * (0.5 - along))
        bend = (tip + root) / 2 + (0.0, 0.028 + lift + open_hand, -0.010)
        parts += [_Bone(root, bend, (0.0105, 0.0095)), _Bone(bend, tip, (0.0095, 0.0078))]
    thumb = at + (half + 0.008 + open_hand, half * 0.50, half * 0.10)
    middle = thumb + (0.030, 0.022, 0.006)
    parts += [
        _Bone(wrist + (-0.022, -0.006, 0.020), middle, (0.017, 0.0125)),
        _Bone(middle, thumb, (0.0120, 0.0092)),
    ]
    return parts


def draw_hand(
    lens: Lens, region: Region, parts: list[_Bone], camera_from_table: Array, to_light: Array
) -> tuple[Picture, Picture]:
    """Draw the hand: colour (h, w, 3) times coverage, and coverage (h, w, 1)."""
    finer = 2
    rays = lens.rays(region, finer)
    depth = np.full(rays.shape[:2], np.inf, np.float32)
    color = np.zeros((*rays.shape[:2], 4), np.float32)
    for part in parts:
        _capsule(rays, depth, color, part, camera_from_table, to_light)
    shown = averaged(color, finer)
    return shown[..., :3], shown[..., 3:]


def hand_region(lens: Lens, parts: list[_Bone], camera_from_table: Array) -> Region:
    """Return the part of the picture that the hand covers."""
    points = np.array([point for part in parts for point in (part.start, part.end)])
    there = points @ camera_from_table[:3, :3].T + camera_from_table[:3, 3]
    if (there[:, 2] < 0.05).any():
        return Region(0, 0, 0, 0)
    reach = 0.046 * lens.intrinsics.matrix[0, 0] / float(there[:, 2].min())
    return lens.around(lens.pixels(there), reach)


def _capsule(
    rays: Picture, depth: Picture, color: Picture, part: _Bone, pose: Array, light: Array
) -> None:
    """Draw one capsule as a cone of discs that face the camera: round where it matters."""
    ends = np.array([part.start, part.end]) @ pose[:3, :3].T + pose[:3, 3]
    flat = ends[:, :2] / ends[:, 2:]
    radii = np.array(part.radii) / ends[:, 2]
    step = flat[1] - flat[0]
    length = max(float(step @ step), 1e-12)
    low, high = (flat - radii[:, None]).min(axis=0), (flat + radii[:, None]).max(axis=0)
    columns = np.flatnonzero((rays[0, :, 0] >= low[0] - 0.01) & (rays[0, :, 0] <= high[0] + 0.01))
    rows = np.flatnonzero((rays[:, 0, 1] >= low[1] - 0.01) & (rays[:, 0, 1] <= high[1] + 0.01))
    if not len(rows) or not len(columns):
        return
    box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    offset = rays[box] - flat[0].astype(np.float32)
    share = np.clip(offset @ step.astype(np.float32) / np.float32(length), 0.0, 1.0)
    radius = radii[0] + share * (radii[1] - radii[0])
    aside = (offset - share[..., None] * step.astype(np.float32)) / radius[..., None]
    square = np.einsum("ijk,ijk->ij", aside, aside)
    rise = np.sqrt(np.maximum(1.0 - square, 0.0))
    near = ends[0, 2] + share * (ends[1, 2] - ends[0, 2])
    surface = near - rise * radius * near
    front = (square < 1.0) & (surface < depth[box])
    normal = np.stack([aside[..., 0], aside[..., 1], -rise], axis=-1)
    shine = np.clip(normal @ light.astype(np.float32), 0.0, 1.0)
    base = SLEEVE if part.sleeve else SKIN
    lit = (0.50 + 0.50 * shine)[..., None] * base.astype(np.float32)
    # Skin lets light through at its rims: they are redder, not just darker.
    rim = (1.0 - rise)[..., None] ** 2 * (0.0 if part.sleeve else 1.0)
    lit = lit * (1.0 - rim * np.float32([0.26, 0.22, 0.10]))
    color[box][front] = np.concatenate([lit, np.ones_like(lit[..., :1])], axis=-1)[front]
    depth[box][front] = surface[front]
