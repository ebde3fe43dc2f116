"""The supersampled character layer, filtered down onto the picture.

This is done in memory: a software driver takes several times as long for it as OpenCV does.
"""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.camera_picture.haze import hazy
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.resources import FrameResources

Image = NDArray[np.uint8]

OWN_BLUR_PX = 0.35
"""Standard deviation of the blur of what is drawn: a pixel is the mean of four texels."""

MAX_BLUR_PX = 1.5
"""More blur would be that of a picture in which nothing is sharp."""

GRAIN_SIDE, GRAIN_SEED = 128, 1
"""Pixels along a side of the noise, which is repeated; and its seed."""

GRAIN_STEP = np.array([53, 97])
"""Shift of the noise from picture to picture [px], so that it does not stand still."""


class ResolvePass(RenderPass):
    """Blends the character layer over the picture, as soft, noisy and hazy as the picture is."""

    def __init__(self) -> None:
        side = GRAIN_SIDE
        grain = np.random.default_rng(GRAIN_SEED).standard_normal((side, side, 3))
        self._grain = grain.astype(np.float32)
        self._tiled = self._grain  # again and again, as far as a layer was large
        self._pictures = 0

    def composite(self, frame: FrameResources, cover: PictureCover | None) -> None:
        """Blend the characters over the picture."""
        layer, softness = frame.layer, frame.softness
        if layer is None:
            return
        area = layer.area
        pixels = layer.target.read(area.width, area.height)
        if layer.target.fineness > 1:
            size = (area.width, area.height)
            pixels = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
        if frame.haze is not None:
            pixels = hazy(pixels, frame.haze)
        if softness is not None:
            pixels = blur_picture(pixels, softness.blur * frame.scale)
        behind = frame.picture[area.slices]
        # OpenCV takes several times as long for channels that are not all next to each other.
        color = cv2.cvtColor(pixels, cv2.COLOR_BGRA2BGR)
        share = cv2.extractChannel(pixels, 3)
        drawn = cv2.cvtColor(cv2.bitwise_not(share), cv2.COLOR_GRAY2BGR)
        cv2.multiply(behind, drawn, dst=drawn, scale=1 / 255)
        cv2.add(drawn, color, dst=drawn)
        if softness is not None and softness.noise > 0.0:
            self._pictures += 1
            noise = cv2.multiply(
                self._noise(area.height, area.width),
                cv2.cvtColor(share, cv2.COLOR_GRAY2BGR),
                scale=softness.noise / 255.0,
                dtype=cv2.CV_16S,
            )
            cv2.add(drawn, noise, dst=drawn, dtype=cv2.CV_8U)
        behind[:] = drawn

    def _noise(self, height: int, width: int) -> NDArray[np.float32]:
        """Return noise of a standard deviation of 1, (height, width, 3)."""
        x, y = ((self._pictures * GRAIN_STEP) % GRAIN_SIDE).tolist()
        kept = self._tiled.shape
        if kept[0] < height + GRAIN_SIDE or kept[1] < width + GRAIN_SIDE:
            rows, columns = max(kept[0], height), max(kept[1], width)
            copies = rows // GRAIN_SIDE + 2, columns // GRAIN_SIDE + 2
            self._tiled = np.asarray(cv2.repeat(self._grain, *copies), np.float32)
        return self._tiled[y : y + height, x : x + width]


def blur_picture(pixels: Image, blur_px: float) -> Image:
    """Return what was drawn with the blur of a camera's picture, a standard deviation [px]."""
    variance = min(blur_px, MAX_BLUR_PX) ** 2 - OWN_BLUR_PX**2
    if variance <= 0.0:
        return pixels
    if variance >= 0.5:  # a Gaussian of three taps is narrower than it should be
        return np.asarray(cv2.GaussianBlur(pixels, (0, 0), math.sqrt(variance)), np.uint8)
    kernel = np.array([0.5 * variance, 1.0 - variance, 0.5 * variance])
    return np.asarray(cv2.sepFilter2D(pixels, -1, kernel, kernel), np.uint8)
