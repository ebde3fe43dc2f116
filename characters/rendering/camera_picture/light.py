"""How the scene is lit, estimated from the camera's own picture."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.projection import (
    NEAR_M,
    is_invertible,
    is_pinhole,
    project,
    usable_distortion,
)
from cubeling.characters.rendering.scene import Box, CameraView, RoomLight
from cubeling.characters.skeleton.pose import Array

TO_LIGHT = np.array([-0.42, 1.0, 0.34]) / np.linalg.norm([-0.42, 1.0, 0.34])
"""Direction to the key light in the table frame where none was measured: from above, from the left,
and from the camera's side, as most desks are lit. The shadow falls to the right and to the back,
where it is visible."""

MIN_RISE = 0.6
"""Least height of the direction to a measured light: shadows are at most 1.3 times as long as what
casts them."""

DIRECTION_CERTAINTIES = 0.6, 0.8
"""Certainties of a measured light's direction from which on it is used at all, and fully."""

LUMA_WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
"""Weights of red, green and blue in luminance (Rec. 709)."""

LINEAR_FROM_SRGB = np.where(
    np.arange(256) <= 10, np.arange(256) / 3294.6, ((np.arange(256) / 255 + 0.055) / 1.055) ** 2.4
)
"""Linear light of each 8-bit sRGB value (IEC 61966-2-1)."""

SAMPLES_PER_SIDE = 12
"""Sample points along each side of a cube's face."""

PICTURES_PER_LOOK = 4
"""Only one picture of so many is looked at."""

PAPER_QUANTILE = 0.9
"""Quantile of a face's brightness that is its paper: most of a face is a black marker."""

_AXIS = (np.arange(SAMPLES_PER_SIDE) + 0.5) / SAMPLES_PER_SIDE - 0.5
_FRONT = np.stack(
    [*np.meshgrid(_AXIS, _AXIS), np.full((SAMPLES_PER_SIDE, SAMPLES_PER_SIDE), 0.5)], axis=-1
).reshape(-1, 3)
FACE_SAMPLES = np.stack(
    [sign * np.roll(_FRONT, axis, axis=1) for axis in range(3) for sign in (1, -1)]
)
"""Sample points on the six faces of a unit cube, (6, points, 3)."""

FACE_CENTERS = FACE_SAMPLES.mean(axis=1)
"""Centres of its faces, (6, 3)."""


@dataclass(frozen=True)
class Light:
    """The light on a character, in linear RGB; 1 makes a white surface just white."""

    key: Array
    """Key light, (3,)."""

    sky: Array
    """Ambient light from the upper hemisphere, (3,)."""

    ground: Array
    """Light reflected by the table, (3,)."""

    to_light: Array
    """Direction to the key light in the table frame, a unit vector, (3,)."""

    @property
    def white(self) -> Array:
        """Light that a white sheet on the table reflects, (3,)."""
        return np.asarray(self.key * self.to_light[1] + self.sky)

    def mix(self, other: "Light", share: float) -> "Light":
        """Return this light with a share of another one."""
        if share <= 0.0:
            return self
        key, sky, ground, to_light = (
            own + share * (theirs - own)
            for own, theirs in zip(self._values, other._values, strict=True)
        )
        return Light(key, sky, ground, to_light / np.linalg.norm(to_light))

    @property
    def _values(self) -> tuple[Array, Array, Array, Array]:
        return self.key, self.sky, self.ground, self.to_light


class LightEstimator:
    """Tracks the exposure and the colour of the light from picture to picture.

    A real cube of white paper in the picture is the best light meter. Before there is one, the
    illuminant is the Minkowski mean of the picture, between grey world and brightest patch
    (Finlayson and Trezzi, "Shades of gray and colour constancy", 2004, with p = 6), drawn towards
    the value that automatic exposure gives to white; afterwards, the light changes as that mean
    does. The result depends only on the sequence of pictures.
    """

    MINKOWSKI_P = 6.0
    _POWERS = LINEAR_FROM_SRGB**MINKOWSKI_P
    BRIGHT_ALBEDO = 0.6
    """Albedo of the surfaces that dominate the Minkowski mean: light ones, seldom white ones."""

    EXPOSED_WHITE = 0.85
    """Linear value to which automatic exposure tends to bring white."""

    PAPER_ALBEDO = 0.82
    """Albedo of printing paper."""

    MIN_PAPER = 0.005
    """Luminance below which what is seen there is no paper in the light."""

    PICTURE_CAST_SHARE = 0.45
    """Share of the picture's colour cast that is ascribed to the light, not to the surfaces."""

    PAPER_CAST_SHARE = 0.8
    """Share of the paper's colour cast that is ascribed to the light, not to the paper."""

    SMOOTHING_SHARE = 0.08
    """Share of the way to the new estimate in each picture: half of it after eight pictures."""

    LUMINANCE_RANGE = (0.02, 1.1)
    """Limits of the light's luminance: a character is as dark as a room in which the cube can be
    seen, and not burnt out."""

    def __init__(self) -> None:
        self._white: Array | None = None
        self._ground: Array | None = None
        self._seen_white, self._seen_ground = np.ones(3), np.ones(3)
        self._metered: tuple[Array, NDArray[np.uint8]] | None = None  # white, and the picture then
        self._pictures = 0
        self._measured: Light | None = None
        self._share = 0.0  # of the measured light

    def update(
        self,
        picture: NDArray[np.uint8],
        find_paper: Callable[[], Array | None] | None = None,
        measured: RoomLight | None = None,
        camera_from_table: Array | None = None,
    ) -> Light:
        """Take a picture (height, width, 3) BGR into account and return the light.

        Parameters
        ----------
        picture
            The camera's frame, (height, width, 3) BGR: that it is bent does not matter here.
        find_paper
            Returns the linear RGB of white paper in the picture, (3,), if some is found. Only one
            picture of `PICTURES_PER_LOOK` is looked at, as the light changes slowly.
        measured
            The light in the room, if it was measured; the light changes to it smoothly.
        camera_from_table
            Pose of the table, (4, 4), which a measured light needs.
        """
        if self._pictures % PICTURES_PER_LOOK == 0:
            self._look(picture, None if find_paper is None else find_paper())
        self._pictures += 1
        if self._white is None or self._ground is None:
            self._white, self._ground = self._seen_white, self._seen_ground
        self._white = self._white + self.SMOOTHING_SHARE * (self._seen_white - self._white)
        self._ground = self._ground + self.SMOOTHING_SHARE * (self._seen_ground - self._ground)
        light = Light(0.72 * self._white, 0.36 * self._white, 0.6 * self._ground, TO_LIGHT)
        target = 0.0
        if measured is not None and camera_from_table is not None:
            self._measured = self._on_table(measured, camera_from_table)
            target = float(np.interp(measured.certainty, DIRECTION_CERTAINTIES, (0.0, 1.0)))
        if self._measured is None:
            return light
        self._share += self.SMOOTHING_SHARE * (target - self._share)
        return light.mix(replace(self._measured, ground=light.ground), self._share)

    def _look(self, picture: NDArray[np.uint8], paper: Array | None) -> None:
        """Estimate the light in a picture, in which white paper has a colour if some was found."""
        step = max(1, picture.shape[1] // 64)
        samples = picture[step // 2 :: step, step // 2 :: step, ::-1].reshape(-1, 3)
        if paper is not None and float(paper @ LUMA_WEIGHTS) > self.MIN_PAPER:
            white = _reduce_cast(paper / self.PAPER_ALBEDO, self.PAPER_CAST_SHARE)
            self._metered = white, samples
        elif self._metered is not None:
            metered, then = self._metered
            white = metered * self._minkowski_mean(samples) / self._minkowski_mean(then)
        else:
            white = self._white_from_picture(samples)
        white = np.maximum(white, 1e-3)
        luminance = white @ LUMA_WEIGHTS
        self._seen_white = white * np.clip(luminance, *self.LUMINANCE_RANGE) / luminance
        mean = LINEAR_FROM_SRGB[samples].mean(axis=0)
        self._seen_ground = np.maximum(mean, 0.25 * self.LUMINANCE_RANGE[0])

    def _on_table(self, measured: RoomLight, camera_from_table: Array) -> Light:
        """Return a measured light in the table frame, no darker or brighter than can be drawn."""
        to_light = camera_from_table[:3, :3].T @ measured.to_light
        to_light = to_light / np.linalg.norm(to_light)
        if to_light[1] < MIN_RISE:
            level = to_light[[0, 2]] / max(float(np.hypot(*to_light[[0, 2]])), 1e-9)
            x, z = np.sqrt(1.0 - MIN_RISE**2) * level
            to_light = np.array([x, MIN_RISE, z])
        light = Light(measured.key, measured.ambient, np.zeros(3), to_light)
        white = np.maximum(light.white, 1e-3)
        luminance = float(white @ LUMA_WEIGHTS)
        share = np.clip(luminance, *self.LUMINANCE_RANGE) / luminance
        share = share * _reduce_cast(white, self.PAPER_CAST_SHARE) / white
        return replace(light, key=share * light.key, sky=share * light.sky)

    def _white_from_picture(self, samples: NDArray[np.uint8]) -> Array:
        """Return the colour of a white sheet, estimated from pixels (n, 3) RGB of the picture."""
        bright = self._minkowski_mean(samples) / self.BRIGHT_ALBEDO
        gain = float(np.sqrt(self.EXPOSED_WHITE / float(bright @ LUMA_WEIGHTS)))
        return _reduce_cast(bright, self.PICTURE_CAST_SHARE) * gain

    def _minkowski_mean(self, samples: NDArray[np.uint8]) -> Array:
        """Return the Minkowski mean of pixels, (n, 3) → (3,), in linear light, and not 0.

        Two hundred and fifty-six powers take less time than those of all samples.
        """
        mean = self._POWERS[samples].mean(axis=0) ** (1 / self.MINKOWSKI_P)
        return np.asarray(np.maximum(mean, 1e-4))


def paper_color(view: CameraView) -> Array | None:
    """Return the linear RGB (3,) of the paper of the brightest visible cube face, or None."""
    papers = [paper for box in view.occluders for paper in _face_papers(view, box)]
    return max(papers, key=lambda paper: float(paper @ LUMA_WEIGHTS), default=None)


def _face_papers(view: CameraView, box: Box) -> Array:
    """Return the paper colours (n, 3) of the faces that the camera sees completely."""
    if view.image is None or not is_invertible(box.camera_from_box) or not np.isfinite(box.edge):
        return np.zeros((0, 3))
    pose = np.asarray(box.camera_from_box, float)
    outward = box.edge * FACE_CENTERS @ pose[:3, :3].T
    facing = np.einsum("ij,ij->i", outward, outward + pose[:3, 3]) < 0.0
    points = box.edge * FACE_SAMPLES[facing] @ pose[:3, :3].T + pose[:3, 3]
    visible = points[points[:, :, 2].min(axis=1) > NEAR_M]
    if not len(visible) or not is_pinhole(view.matrix):
        return np.zeros((0, 3))
    matrix, lens = np.asarray(view.matrix, float), usable_distortion(view.distortion)
    bent = cv2.projectPoints(visible.reshape(-1, 3), np.zeros(3), np.zeros(3), matrix, lens)[0]
    pixels = np.rint(bent.reshape(len(visible), -1, 2)).astype(int)
    # A polynomial of a lens may bend what is far outside of the frame into it.
    straight = project(visible, matrix)
    inside = np.ones(len(visible), bool)
    for each in (pixels, straight):
        inside &= ((each >= 0) & (each < view.image.shape[1::-1])).all(axis=(1, 2))
    columns, rows = pixels[inside].transpose(2, 0, 1)
    colors = LINEAR_FROM_SRGB[view.image[rows, columns, ::-1]]
    luminance = colors @ LUMA_WEIGHTS
    # `numpy.quantile` takes five times as long for so few.
    rank = math.ceil(PAPER_QUANTILE * (luminance.shape[1] - 1))
    bright = luminance >= np.sort(luminance, axis=1)[:, rank, None]
    return np.asarray(np.einsum("fp,fpc->fc", bright / bright.sum(axis=1, keepdims=True), colors))


def _reduce_cast(color: Array, share: float) -> Array:
    """Return a colour of the same luminance with only a share of its colour cast."""
    return np.asarray(share * color + (1.0 - share) * (color @ LUMA_WEIGHTS))
