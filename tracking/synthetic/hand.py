"""A hand that holds the cube: capsules of skin that blend into each other, and a sleeve."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Floats
from cubeling.tracking.synthetic.camera_rays import CameraRays, PixelRegion

Shader = Callable[[Floats, Floats, Floats, Floats], Floats]
"""From light, slope towards the camera, blush and position along the capsule to a BGR colour."""

AWAY_OFFSET_M = np.array([0.34, 0.16, -0.06])
"""Position of the hand relative to the cube when it is away."""

BLEND_DEPTH_M = 0.0035
"""Depth over which two capsules of skin blend into each other."""

MIN_WEIGHT = np.float32(1e-36)
"""Added to weights, so that an empty sum can be divided by."""

AXIS_SHARES = np.linspace(0.0, 1.0, 25)[:, None]
"""Points along the axis of a capsule by which the region around it is found: a lens bends what is
far outside of the image into it, so that the ends alone do not do."""


@dataclass(frozen=True)
class Capsule:
    """A capsule between two points, with a radius at each end [m]."""

    start: Array
    end: Array
    radii: tuple[float, float]

    cut: bool = False
    """Whether its start is cut flat, as of a sleeve, instead of round."""

    blush: tuple[float, float] = (0.0, 0.0)
    """Extra redness of the skin at each end, 0…1."""


@dataclass(frozen=True)
class SyntheticHand:
    """Skin and sleeve, in the table frame."""

    skin: tuple[Capsule, ...]
    """Fingers, thumb, back and wrist."""

    sleeve: tuple[Capsule, ...]
    """Cuff and forearm, always drawn in front of the wrist."""

    skin_bgr: tuple[float, float, float] = (128.0, 162.0, 224.0)
    """Colour of the skin, or of a glove."""

    sleeve_bgr: tuple[float, float, float] = (118.0, 84.0, 60.0)
    """Colour of the sleeve."""


def hand_at(position: Array, edge: float, grip: float) -> SyntheticHand:
    """Return the hand on the far right of a cube [m], with fingers on its upper edges.

    `position` is the cube's centre in the table frame, (3,); `grip` is 0 away, 1 holding.
    """
    half = edge / 2
    at = position + AWAY_OFFSET_M * (1.0 - grip)
    open_hand = 0.018 * (1.0 - grip)
    knuckles = at + (half + 0.036, half + 0.030, -half - 0.002)
    wrist = knuckles + (0.080, 0.014, 0.006)
    elbow = wrist + (0.62, 0.10, 0.07)
    skin = [
        Capsule(knuckles + (0.004, -0.004, 0.020), wrist, (0.019, 0.024), blush=(0.25, 0.0)),
        Capsule(knuckles + (0, 0, 0.006), wrist, (0.021, 0.026), blush=(0.25, 0.0)),
        Capsule(knuckles + (0, -0.002, -0.010), wrist, (0.021, 0.025), blush=(0.25, 0.0)),
        Capsule(knuckles + (0.004, -0.008, -0.024), wrist, (0.018, 0.023), blush=(0.25, 0.0)),
        Capsule(wrist, wrist + (0.05, 0.008, 0.006), (0.025, 0.027)),
    ]
    # Fingers reach over the far edge of the top, the thumb is on the right face.
    for along, lift in ((0.62, 0.000), (0.22, 0.004), (-0.18, 0.003), (-0.54, -0.002)):
        tip = at + (along * half, half * 0.62, -half - 0.006 - open_hand)
        root = knuckles + (-0.004, 0.003, 0.022 - 0.032 * (0.62 - along))
        bend = (tip + root) / 2 + (0.004, 0.026 + lift + open_hand, -0.008)
        last = 0.42 * bend + 0.58 * tip + (-0.002, 0.005, -0.004)
        skin += [
            Capsule(root, bend, (0.0112, 0.0096), blush=(0.3, 0.35)),
            Capsule(bend, last, (0.0096, 0.0086), blush=(0.35, 0.2)),
            Capsule(last, tip, (0.0086, 0.0072), blush=(0.2, 0.7)),
        ]
    thumb = at + (half + 0.007 + open_hand, half * 0.42, half * 0.15)
    middle = thumb + (0.026, 0.016, 0.004)
    skin += [
        Capsule(wrist + (-0.026, -0.008, 0.016), middle, (0.019, 0.0125), blush=(0.0, 0.3)),
        Capsule(middle, thumb, (0.0125, 0.0088), blush=(0.3, 0.7)),
    ]
    cuff = wrist + (0.012, 0.002, 0.001)
    hem = wrist + (0.036, 0.0058, 0.0041)
    sleeve = (
        Capsule(hem, elbow, (0.034, 0.054), cut=True),
        Capsule(cuff, hem, (0.0335, 0.0345), cut=True),
    )
    return SyntheticHand(tuple(skin), sleeve)


def hand_region(camera: CameraRays, hand: SyntheticHand) -> PixelRegion:
    """Return the region of the image that the hand covers."""
    parts = hand.skin + hand.sleeve
    points = np.concatenate([_axis(part.start, part.end) for part in parts])
    in_camera = camera.from_table(points)
    if (in_camera[:, 2] < 0.05).any():
        return PixelRegion(0, 0, 0, 0)
    focal = camera.intrinsics.matrix[0, 0]
    reach = max(max(part.radii) for part in parts) * focal / float(in_camera[:, 2].min()) + 3
    return camera.region_around(camera.pixels(in_camera), reach)


def _axis(start: Array, end: Array) -> Array:
    """Return points from one end of an axis to the other, both (3,), (n, 3)."""
    return np.asarray(start + AXIS_SHARES * (end - start))


def draw_hand(
    camera: CameraRays, region: PixelRegion, hand: SyntheticHand, to_light: Array
) -> tuple[Floats, Floats, Floats]:
    """Return colour (h, w, 3) BGR, coverage (h, w) 0…1, and depth (h, w) [m] of the hand."""
    skin = _CapsuleLayer(camera, region, hand.skin)
    cloth = _CapsuleLayer(camera, region, hand.sleeve)
    over = cloth.cover[..., None]
    colour = skin.shade(_skin_shader(hand.skin_bgr), to_light) * (1 - over)
    colour += cloth.shade(_cloth_shader(hand.sleeve_bgr), to_light) * over
    depth = np.where(cloth.cover > 0.5, cloth.depth(), skin.depth())
    return colour, np.maximum(skin.cover, cloth.cover), depth


def _skin_shader(skin_bgr: tuple[float, float, float]) -> Shader:
    """Shade skin: light scatters round it, and its rims are redder, not only darker."""

    def shade(light: Floats, slope: Floats, blush: Floats, along: Floats) -> Floats:
        rim = np.clip(1.0 - slope, 0.0, 1.0) ** 2
        lit, gloss = 0.40 + 0.62 * light, 16.0 * light**6
        channels = [
            value * lit * (1.0 - paler * rim) * (1.0 - redder * blush) + gloss
            for value, paler, redder in zip(
                skin_bgr, (0.34, 0.28, 0.12), (0.15, 0.11, 0.0), strict=True
            )
        ]
        return np.asarray(cv2.merge(channels), np.float32)

    return shade


def _cloth_shader(sleeve_bgr: tuple[float, float, float]) -> Shader:
    """Shade wool: soft folds across the arm, and no gloss."""

    def shade(light: Floats, slope: Floats, blush: Floats, along: Floats) -> Floats:
        folds = 0.05 * np.sin(34 * along + 3.0 * slope) + 0.035 * np.sin(81 * along - 5.0 * slope)
        shade = 0.42 + 0.60 * light + folds * slope
        return np.asarray(cv2.merge([value * shade for value in sleeve_bgr]), np.float32)

    return shade


class _CapsuleLayer:
    """Capsules that blend into each other: where they meet, their normals are mixed by depth."""

    def __init__(self, camera: CameraRays, region: PixelRegion, parts: tuple[Capsule, ...]) -> None:
        self._camera, self._region = camera, region
        self._rays = camera.rays(region, 1)
        self._focal = float(camera.intrinsics.matrix[0, 0])
        self.cover = np.zeros((region.height, region.width), np.float32)
        # Weighted sums: normal x, y, slope; blush; position along the capsule; depth; weight.
        self._sums = np.zeros((7, *self.cover.shape), np.float32)
        for part in parts:
            self._add(part)

    def _add(self, part: Capsule) -> None:
        """Render one capsule as a cone of discs that face the camera."""
        ends = self._camera.from_table(np.array([part.start, part.end]))
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
        if part.cut:  # the rim of an open sleeve bulges if seen from the side
            bulge = 0.22 * radius / length * np.sqrt(np.maximum(1.0 - distance**2, 0.0))
            cover *= np.clip((beyond + bulge) * length * self._focal + 0.5, 0.0, 1.0)
        slope = np.sqrt(np.maximum(1.0 - distance * distance, 0.0))
        near = np.float32(ends[0, 2]) + share * np.float32(ends[1, 2] - ends[0, 2])
        depth = near * (1.0 - slope * radius)
        # Relative to a typical distance of 0.7 m, so that the exponential fits a float32.
        weight = cover * np.exp(np.clip((0.7 - depth) / BLEND_DEPTH_M, -80.0, 80.0)) + MIN_WEIGHT
        blush = part.blush[0] + share * (part.blush[1] - part.blush[0])
        for layer, value in zip(self._sums, (x, y, slope, blush, share, depth), strict=False):
            layer[box] += weight * value
        self._sums[6][box] += weight
        np.maximum(self.cover[box], cover, out=self.cover[box])

    def depth(self) -> Floats:
        """Return the depth of the surface (h, w) [m]; 0 where there is none."""
        weight = np.maximum(self._sums[6], MIN_WEIGHT)
        return np.asarray(self._sums[5] / weight, np.float32)

    def shade(self, colour: Shader, to_light: Array) -> Floats:
        """Return the colour (h, w, 3) BGR; black where there is nothing."""
        shown = np.zeros((*self.cover.shape, 3), np.float32)
        covered = self.cover > 0
        rows, columns = (np.flatnonzero(covered.any(axis=axis)) for axis in (1, 0))
        if not len(rows):
            return shown
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        weight = np.maximum(self._sums[6][box], MIN_WEIGHT)
        x, y, slope, blush, along = (each[box] / weight for each in self._sums[:5])
        light = np.float32(to_light[0]) * x + np.float32(to_light[1]) * y
        light = 0.25 + 0.75 * (light - np.float32(to_light[2]) * slope)
        light = np.asarray(np.clip(light, 0.0, 1.0), np.float32)
        shown[box] = colour(light, slope, blush, along)
        return shown

    def _box(self, ends: Array, radii: tuple[float, float]) -> tuple[slice, slice]:
        margin = max(radii) * self._focal / float(ends[:, 2].min()) + 2
        axis, whole = self._camera.pixels(_axis(*ends)), self._region
        part = self._camera.region_around(axis, margin)
        height, width = self.cover.shape
        rows = np.clip((part.y - whole.y, part.bottom - whole.y), 0, height).tolist()
        columns = np.clip((part.x - whole.x, part.right - whole.x), 0, width).tolist()
        return slice(*rows), slice(*columns)
