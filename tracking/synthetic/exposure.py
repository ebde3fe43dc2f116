"""One exposure: cube, hand and shadows over the desk, through lens and sensor."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.synthetic.choreography import Moment
from tracking.synthetic.desk import add_things, desk_picture, seen_through
from tracking.synthetic.hand import Hand, draw_hand, hand_at, hand_region
from tracking.synthetic.lens import Lens, Region
from tracking.synthetic.options import SyntheticOptions
from tracking.synthetic.paper_cube import TO_LIGHT, PaperCube

Array = NDArray[np.float64]
Picture = NDArray[np.float32]
Sensed = NDArray[np.uint8]

STEP = 0.6
"""How far a corner may move between two moments of one exposure [px]."""

MOST_MOMENTS = 24
"""Moments that an exposure is made of at most."""


class Exposure:
    """Draws the pictures of one camera that does not move.

    Parameters
    ----------
    lens
        The camera.
    cube
        The cube.
    camera_from_table
        Where the desk is, (4, 4).
    options
        How the camera sees.
    """

    def __init__(
        self, lens: Lens, cube: PaperCube, camera_from_table: Array, options: SyntheticOptions
    ) -> None:
        self._lens = lens
        self._cube = cube
        self._pose = camera_from_table
        self._options = options
        self._to_light = camera_from_table[:3, :3] @ (TO_LIGHT / np.linalg.norm(TO_LIGHT))
        random = np.random.default_rng(options.seed)
        self._desk = seen_through(lens, camera_from_table, desk_picture(random, options.clutter))
        if options.clutter:
            add_things(self._desk, lens, camera_from_table)
        self._vignette = _vignette(lens)
        # One tile of noise, cut at another place for each frame, costs a tenth of fresh noise.
        size = (lens.size[1] + 128, lens.size[0] + 128, 3)
        self._noise = random.standard_normal(size, dtype=np.float32)

    def draw(self, moments: list[Moment], poses: list[Array], index: int, loose: bool) -> Sensed:
        """Return the picture of one exposure, (H, W, 3) uint8 BGR.

        Parameters
        ----------
        moments
            Cube and hand, evenly over the time that the shutter is open; the middle one is the
            frame's truth.
        poses
            `camera_from_cube` at the same times.
        index
            Number of the frame: seeds its noise.
        loose
            Whether the cube is in the air, where it throws no shadow on the desk.
        """
        picture = self._desk.copy()
        options = self._options
        middle = moments[len(moments) // 2]
        hand = None
        if options.hand and not loose and middle.grip > 0.01:
            hand = hand_at(middle.table_from_cube[:3, 3], self._cube.cube.edge, middle.grip)
        if options.shadow and not loose:
            self._passing_shadow(picture, index / options.rate)
            if hand is not None:
                self._hand_shadow(picture, hand)
            self._cube_shadow(picture, middle.table_from_cube)
        self._add_cube(picture, poses)
        if hand is not None:
            self._add_hand(picture, hand, poses[len(poses) // 2])
        picture *= self._vignette
        return self._sensed(picture, index)

    def _add_cube(self, picture: Picture, poses: list[Array]) -> None:
        regions = [self._cube.region(pose) for pose in (poses[0], poses[-1])]
        if any(region.empty for region in regions):
            return
        region = _union(regions)
        finer = 4 if len(poses) == 1 else 3 if len(poses) < 6 else 2  # blur hides what is coarse
        color, cover = self._cube.draw(region, poses, self._to_light, finer)
        part = picture[region.of]
        part *= 1.0 - cover
        part += color

    def _add_hand(self, picture: Picture, hand: Hand, camera_from_cube: Array) -> None:
        region = hand_region(self._lens, hand, self._pose)
        if region.empty:
            return
        color, cover, depth = draw_hand(self._lens, region, hand, self._pose, self._to_light)
        # Fingertips behind the cube are hidden by it.
        behind = depth - self._cube.depth(region, camera_from_cube)
        cover *= 1.0 - np.clip(behind / 0.0015, 0.0, 1.0)
        part = picture[region.of]
        part += (color - part) * cover[..., None]

    def _hand_shadow(self, picture: Picture, hand: Hand) -> None:
        """Throw the hand's shadow on the desk: wide strokes, drawn small, made soft."""
        coarse = 4
        width, height = (side // coarse for side in self._lens.size)
        dark = np.zeros((height, width), np.float32)
        away = TO_LIGHT / TO_LIGHT[1]
        for bone in hand.skin + hand.sleeve[:1]:
            ends = np.linspace(bone.start, bone.end, 2)
            foot = ends - away * ends[:, 1:2]
            there = foot @ self._pose[:3, :3].T + self._pose[:3, 3]
            if (there[:, 2] < 0.05).any():
                continue
            span = 2 * bone.radii[0] * self._lens.intrinsics.matrix[0, 0] / there[0, 2] / coarse
            (x, y), (u, v) = np.rint(self._lens.pixels(there) / coarse * 16).astype(int).tolist()
            cv2.line(dark, (x, y), (u, v), 1.0, max(1, round(float(span))), cv2.LINE_8, 4)
        height_of_tip = float(hand.skin[0].start[1])
        soft = cv2.GaussianBlur(dark, (0, 0), 2.0 + 45.0 * max(0.0, height_of_tip))
        shade = cv2.resize(1.0 - 0.34 * soft, self._lens.size)
        picture *= shade[..., None]

    def _cube_shadow(self, picture: Picture, table_from_cube: Array) -> None:
        half = self._cube.cube.edge / 2
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        corners = half * signs @ table_from_cube[:3, :3].T + table_from_cube[:3, 3]
        height = max(0.0, float(corners[:, 1].min()))
        away = -TO_LIGHT[[0, 2]] / TO_LIGHT[1]
        foot = corners * (1.0, 0.0, 1.0)
        cast = foot.copy()
        cast[:, [0, 2]] += 0.55 * np.maximum(corners[:, 1:2], 0.0) * away
        soft = 5.0 + 260.0 * height
        self._darken(picture, cast, 0.40 / (1.0 + 9.0 * height), soft)
        self._darken(picture, foot, 0.42 / (1.0 + 60.0 * height), 2.5 + 120.0 * height)

    def _darken(self, picture: Picture, points: Array, depth: float, soft: float) -> None:
        there = points @ self._pose[:3, :3].T + self._pose[:3, 3]
        if (there[:, 2] < 0.05).any():
            return
        pixels = self._lens.pixels(there)
        region = self._lens.around(pixels, 3.2 * soft)
        if region.empty:
            return
        hull = cv2.convexHull(np.round((pixels - (region.x, region.y)) * 16).astype(np.int32))
        mask = np.zeros((region.height, region.width), np.float32)
        cv2.fillConvexPoly(mask, hull, 1.0, cv2.LINE_AA, 4)
        picture[region.of] *= (1.0 - depth * cv2.GaussianBlur(mask, (0, 0), soft))[..., None]

    def _passing_shadow(self, picture: Picture, time: float) -> None:
        """Somebody leans in and out: a wide soft shadow wanders along the near edge."""
        width, height = self._lens.size
        small = np.indices((height // 16 + 1, width // 16 + 1), np.float32) * 16
        x = width * (0.22 + 0.10 * np.sin(0.45 * time + self._options.seed))
        away = ((small[1] - x) / (0.34 * width)) ** 2 + ((small[0] - 1.1 * height) / height) ** 2
        shade = 1.0 - 0.22 * np.exp(-2.2 * away) * (0.75 + 0.25 * np.sin(0.6 * time))
        picture *= cv2.resize(shade.astype(np.float32), (width, height))[..., None]

    def _sensed(self, picture: Picture, index: int) -> Sensed:
        options = self._options
        if options.defocus > 0:
            picture = np.asarray(cv2.GaussianBlur(picture, (0, 0), options.defocus), np.float32)
        if options.noise > 0:
            random = np.random.default_rng([options.seed, index, 7])
            top, left = random.integers(0, 128, 2)
            width, height = self._lens.size
            tile = self._noise[top : top + height, left : left + width]
            # Shot noise grows with the root of the light; the rest is the sensor's own.
            strength = np.sqrt(np.maximum(picture, 0.0) * (0.75 / 128.0) + 0.25)
            picture = picture + np.float32(options.noise) * strength * tile
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def moments_of(lens: Lens, corners: list[Array]) -> int:
    """Return how many moments an exposure needs so that no corner leaps between them."""
    first, last = (lens.pixels(points) for points in (corners[0], corners[-1]))
    moved = float(np.linalg.norm(last - first, axis=1).max())
    return int(np.clip(np.ceil(moved / STEP), 1, MOST_MOMENTS)) | 1


def _union(regions: list[Region]) -> Region:
    x, y = min(r.x for r in regions), min(r.y for r in regions)
    right, bottom = max(r.right for r in regions), max(r.bottom for r in regions)
    return Region(x, y, right - x, bottom - y)


def _vignette(lens: Lens) -> Picture:
    width, height = lens.size
    x = np.linspace(-1, 1, width, dtype=np.float32)
    y = np.linspace(-height / width, height / width, height, dtype=np.float32)
    return (1.0 - 0.14 * (x[None, :] ** 2 + y[:, None] ** 2))[..., None]
