"""A hand that holds the cube: capsules of skin that flow into each other, and a sleeve."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.synthetic.lens import Lens, Region

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

Coloring = Callable[[Picture, Picture, Picture, Picture], Picture]
"""From light, rise towards the camera, blush and place along the bone to a colour, BGR."""

SKIN = np.array([128.0, 162.0, 224.0], np.float32)
"""Colour of the skin, BGR."""

SLEEVE = np.array([118.0, 84.0, 60.0], np.float32)
"""Colour of the sleeve, BGR."""

AWAY = np.array([0.34, 0.16, -0.06])
"""Where the hand comes from and goes to, from the cube [m]."""

SOFTNESS = 0.0035
"""Over how much depth two capsules of skin flow into each other [m]."""


NOTHING = np.float32(1e-36)
"""A weight that keeps an empty sum from being divided by zero."""


@dataclass(frozen=True)
class Bone:
    """A capsule between two points with a radius at each end [m]."""

    start: Array
    end: Array
    radii: tuple[float, float]

    cut: bool = False
    """Whether it ends square at its start, as a sleeve does, and not round."""

    blush: tuple[float, float] = (0.0, 0.0)
    """How much redder than the rest the skin is at each end, 0…1."""


@dataclass(frozen=True)
class Hand:
    """Skin and sleeve, in the table frame."""

    skin: tuple[Bone, ...]
    """Fingers, thumb, back and wrist."""

    sleeve: tuple[Bone, ...]
    """Cuff and forearm, which always lie before the wrist as the camera sees it."""


def hand_at(position: Array, edge: float, grip: float) -> Hand:
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
    half = edge / 2
    at = position + AWAY * (1.0 - grip)
    open_hand = 0.018 * (1.0 - grip)
    knuckles = _off(at, half + 0.036, half + 0.030, -half - 0.002)
    wrist = _off(knuckles, 0.080, 0.014, 0.006)
    elbow = _off(wrist, 0.62, 0.10, 0.07)
    skin = [
        Bone(_off(knuckles, 0.004, -0.004, 0.020), wrist, (0.019, 0.024), blush=(0.25, 0.0)),
        Bone(_off(knuckles, 0, 0, 0.006), wrist, (0.021, 0.026), blush=(0.25, 0.0)),
        Bone(_off(knuckles, 0, -0.002, -0.010), wrist, (0.021, 0.025), blush=(0.25, 0.0)),
        Bone(_off(knuckles, 0.004, -0.008, -0.024), wrist, (0.018, 0.023), blush=(0.25, 0.0)),
        Bone(wrist, _off(wrist, 0.05, 0.008, 0.006), (0.025, 0.027)),
    ]
    # Fingers reach over the top's far edge, the thumb lies on the right face.
    for along, lift in ((0.62, 0.000), (0.22, 0.004), (-0.18, 0.003), (-0.54, -0.002)):
        tip = _off(at, along * half, half * 0.62, -half - 0.006 - open_hand)
        root = _off(knuckles, -0.004, 0.003, 0.022 - 0.032 * (0.62 - along))
        bend = _off((tip + root) / 2, 0.004, 0.026 + lift + open_hand, -0.008)
        last = _off(0.42 * bend + 0.58 * tip, -0.002, 0.005, -0.004)
        skin += [
            Bone(root, bend, (0.0112, 0.0096), blush=(0.3, 0.35)),
            Bone(bend, last, (0.0096, 0.0086), blush=(0.35, 0.2)),
            Bone(last, tip, (0.0086, 0.0072), blush=(0.2, 0.7)),
        ]
    thumb = _off(at, half + 0.007 + open_hand, half * 0.42, half * 0.15)
    middle = _off(thumb, 0.026, 0.016, 0.004)
    skin += [
        Bone(_off(wrist, -0.026, -0.008, 0.016), middle, (0.019, 0.0125), blush=(0.0, 0.3)),
        Bone(middle, thumb, (0.0125, 0.0088), blush=(0.3, 0.7)),
    ]
    cuff = _off(wrist, 0.012, 0.002, 0.001)
    hem = _off(wrist, 0.036, 0.0058, 0.0041)
    sleeve = (
        Bone(hem, elbow, (0.034, 0.054), cut=True),
        Bone(cuff, hem, (0.0335, 0.0345), cut=True),
    )
    return Hand(tuple(skin), sleeve)


def _off(point: Array, x: float, y: float, z: float) -> Array:
    return np.asarray(point + np.array([x, y, z]))


def hand_region(lens: Lens, hand: Hand, camera_from_table: Array) -> Region:
    """Return the part of the picture that the hand covers."""
    parts = hand.skin + hand.sleeve
    points = np.array([point for part in parts for point in (part.start, part.end)])
    there = points @ camera_from_table[:3, :3].T + camera_from_table[:3, 3]
    if (there[:, 2] < 0.05).any():
        return Region(0, 0, 0, 0)
    focal = lens.intrinsics.matrix[0, 0]
    reach = max(max(part.radii) for part in parts) * focal / float(there[:, 2].min()) + 3
    return lens.around(lens.pixels(there), reach)


def draw_hand(
    lens: Lens, region: Region, hand: Hand, camera_from_table: Array, to_light: Array
) -> tuple[Picture, Picture, Picture]:
    """Draw the hand.

    Returns
    -------
    Colour (h, w, 3) BGR; coverage (h, w), 0…1; and depth (h, w) [m].
    """
    skin = _Layer(lens, region, camera_from_table)
    for part in hand.skin:
        skin.add(part)
    cloth = _Layer(lens, region, camera_from_table)
    for part in hand.sleeve:
        cloth.add(part)
    over = cloth.cover[..., None]
    color = skin.shaded(_skin_color, to_light) * (1 - over)
    color += cloth.shaded(_cloth_color, to_light) * over
    depth = np.where(cloth.cover > 0.5, cloth.depth(), skin.depth())
    return color, np.maximum(skin.cover, cloth.cover), depth


def _skin_color(light: Picture, rise: Picture, blush: Picture, along: Picture) -> Picture:
    """Light bleeds round the form of skin, and its rims are redder, not just darker."""
    rim = np.clip(1.0 - rise, 0.0, 1.0) ** 2
    color = SKIN * (0.40 + 0.62 * light)[..., None]
    color *= 1.0 - rim[..., None] * np.array([0.34, 0.28, 0.12], np.float32)
    color *= 1.0 - blush[..., None] * np.array([0.15, 0.11, 0.0], np.float32)
    return np.asarray(color + 16.0 * (light**6)[..., None], np.float32)


def _cloth_color(light: Picture, rise: Picture, blush: Picture, along: Picture) -> Picture:
    """Shade wool: it has soft folds across the arm and no gloss."""
    folds = 0.05 * np.sin(34 * along + 3.0 * rise) + 0.035 * np.sin(81 * along - 5.0 * rise)
    shade = 0.42 + 0.60 * light + folds * rise
    return np.asarray(SLEEVE * shade[..., None], np.float32)


class _Layer:
    """Capsules that flow into each other: where they meet, their normals are mixed by depth."""

    def __init__(self, lens: Lens, region: Region, camera_from_table: Array) -> None:
        self._lens, self._region, self._pose = lens, region, camera_from_table
        self._rays = lens.rays(region, 1)
        self._focal = float(lens.intrinsics.matrix[0, 0])
        self.cover = np.zeros((region.height, region.width), np.float32)
        # Sums, weighted: normal x, y, rise; blush; place along; depth; weight.
        self._sums = np.zeros((*self.cover.shape, 7), np.float32)

    def add(self, part: Bone) -> None:
        """Draw one capsule as a cone of discs that face the camera: round where it matters."""
        ends = np.array([part.start, part.end]) @ self._pose[:3, :3].T + self._pose[:3, 3]
        flat = (ends[:, :2] / ends[:, 2:]).astype(np.float32)
        radii = (np.array(part.radii) / ends[:, 2]).astype(np.float32)
        box = self._box(ends, part.radii)
        offset = self._rays[box] - flat[0]
        step = flat[1] - flat[0]
        length = max(float(np.hypot(*step)), 1e-9)
        beyond = offset @ step / length**2
        share = np.clip(beyond, 0.0, 1.0)
        radius = radii[0] + share * (radii[1] - radii[0])
        x = (offset[..., 0] - share * step[0]) / radius
        y = (offset[..., 1] - share * step[1]) / radius
        distance = np.sqrt(x * x + y * y)
        cover = np.clip((1.0 - distance) * radius * self._focal + 0.5, 0.0, 1.0)
        if part.cut:  # the rim of an open sleeve bulges towards who sees it from aside
            bulge = 0.22 * radius / length * np.sqrt(np.maximum(1.0 - distance**2, 0.0))
            cover *= np.clip((beyond + bulge) * length * self._focal + 0.5, 0.0, 1.0)
        rise = np.sqrt(np.maximum(1.0 - distance * distance, 0.0))
        near = np.float32(ends[0, 2]) + share * np.float32(ends[1, 2] - ends[0, 2])
        depth = near * (1.0 - rise * radius)
        # 0.7 m is about where hands are: it keeps the exponential within what a float32 holds.
        weight = cover * np.exp(np.clip((0.7 - depth) / SOFTNESS, -80.0, 80.0)) + NOTHING
        blush = part.blush[0] + share * (part.blush[1] - part.blush[0])
        sums = self._sums[box]
        for layer, value in enumerate((x, y, rise, blush, share, depth)):
            sums[..., layer] += weight * value
        sums[..., 6] += weight
        np.maximum(self.cover[box], cover, out=self.cover[box])

    def depth(self) -> Picture:
        """Return the depth of the surface (h, w) [m], and 0 where there is none."""
        return np.asarray(self._sums[..., 5] / np.maximum(self._sums[..., 6], NOTHING), np.float32)

    def shaded(self, color: Coloring, to_light: Array) -> Picture:
        """Return the layer's colour (h, w, 3) BGR, black where there is none."""
        shown = np.zeros((*self.cover.shape, 3), np.float32)
        covered = self.cover > 0
        rows, columns = (np.flatnonzero(covered.any(axis=axis)) for axis in (1, 0))
        if not len(rows):
            return shown
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        sums = self._sums[box]
        mean = sums[..., :5] / np.maximum(sums[..., 6:], NOTHING)
        x, y, rise, blush, along = np.moveaxis(np.asarray(mean, np.float32), -1, 0)
        light = np.float32(to_light[0]) * x + np.float32(to_light[1]) * y
        light = 0.25 + 0.75 * (light - np.float32(to_light[2]) * rise)
        light = np.asarray(np.clip(light, 0.0, 1.0), np.float32)
        shown[box] = color(light, rise, blush, along)
        return shown

    def _box(self, ends: Array, radii: tuple[float, float]) -> tuple[slice, slice]:
        margin = max(radii) * self._focal / float(ends[:, 2].min()) + 2
        part, whole = self._lens.around(self._lens.pixels(ends), margin), self._region
        height, width = self.cover.shape
        rows = np.clip((part.y - whole.y, part.bottom - whole.y), 0, height).tolist()
        columns = np.clip((part.x - whole.x, part.right - whole.x), 0, width).tolist()
        return slice(*rows), slice(*columns)
