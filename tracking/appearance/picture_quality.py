"""How soft, noisy and hazy a camera's picture is, measured on the borders of a cube's markers."""

import math
from dataclasses import astuple, replace
from functools import cache

import cv2
import numpy as np

from cubeling.tracking.appearance.appearance import PictureQuality
from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.marker import cell_size
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.state import CubeState

LINES_PER_SIDE = 9
"""Lines that cross each side of a marker."""

REACH_PX, STEP_PX = 3.5, 0.5
"""How far a line reaches to each side of the border, and the distance of its samples [px]."""

MIN_CELL_PX = 6.0
"""Size of a cell from which on a line ends in flat black and in flat white [px]."""

MIN_COSINE = 0.5
"""Cosine between a face's normal and the line of sight, from which on it is measured."""

MAX_SPEED_PX_S = 10.0
"""Faster cubes are not measured: motion blurs them, and moves them from frame to frame."""

SATURATED, MIN_CONTRAST = 250.0, 40.0
"""Grey value from which on white is clipped, and least difference of white and black."""

MIN_FIT = 0.995
"""Correlation with a blurred step, from which on a side counts: fingers and shadows have less."""

INK_SHARE = 0.09
"""Most light of printed black beside that of its paper; what is beyond is haze. On 270 markers of
others it is 0.07 in the median and 0.085 in the lightest tenth: `tests.bench.photographs.ink`."""

TONE_EXPONENT = 2.2
"""Light is the grey value to this power in nearly every camera (sRGB)."""

INTERVAL_FRAMES = 4
"""Only one frame of so many is measured: a lens changes slowly."""

MAX_INTERVAL_S = 0.25
"""Frames further apart than this are not compared [s]: after a seek the cube lies elsewhere."""

SMOOTHING_SHARE = 0.2
"""Share of the way to a new measurement."""

_OFFSETS = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
_BLURS = np.arange(0.45, 2.8, 0.05)
_SHIFTS = np.arange(-1.0, 1.01, 0.1)
_INTERPOLATION_VARIANCE = 1 / 6  # of a linear interpolation between pixels [px²]
_INTERPOLATED_NOISE = 2 / 3  # share of the noise that such an interpolation leaves
_ROUNDING_VARIANCE = 1 / 12  # of samples, which are whole grey values
_STEP_QUANTILE = 0.97  # quantile of the steps, above which they are cut off
_FLAT = 4  # samples at each end of a line
_ALONG = np.linspace(0.12, 0.88, LINES_PER_SIDE)


@cache
def _blurred_steps() -> tuple[Array, Array]:
    """Return steps of each blur and shift, (blurs × shifts, samples).

    From −1 to 1, and the same with mean 0 and length 1.
    """
    blurs, shifts = (each.ravel() for each in np.meshgrid(_BLURS, _SHIFTS, indexing="ij"))
    erf = np.vectorize(math.erf, otypes=[float])
    steps = np.asarray(erf((_OFFSETS - shifts[:, None]) / blurs[:, None] / math.sqrt(2.0)))
    return steps, _normalize(steps)


def _normalize(profiles: Array) -> Array:
    centred = profiles - profiles.mean(-1, keepdims=True)
    return np.asarray(
        centred / np.maximum(np.linalg.norm(centred, axis=-1, keepdims=True), 1e-9), np.float64
    )


class QualityMeter:
    """Measures blur, noise and haze while the cube is still, smoothed over frames.

    `cube` is the cube as printed, `intrinsics` the camera.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._planes = FacePlanes(cube)
        self._corners = np.stack([face.corners for face in cube.faces])
        self._cell = cell_size(cube)
        self._projection = Projection(intrinsics)
        self._quality: PictureQuality | None = None
        self._last: Image | None = None
        self._last_time = 0.0
        self._frames = 0

    def update(self, image: Image, state: CubeState) -> PictureQuality | None:
        """Take a frame (height, width, 3) BGR into account; None until something was measured."""
        before, self._last = self._last, image
        interval, self._last_time = state.timestamp - self._last_time, state.timestamp
        self._frames += 1
        if self._quality is not None and self._frames % INTERVAL_FRAMES:
            return self._quality
        places = self._places(state, image)
        if before is None or before.shape != image.shape or places is None:
            return self._quality
        if abs(interval) > MAX_INTERVAL_S:
            return self._quality
        measured = _measure(*(_sample(each, places) for each in (before, image)))
        if measured is not None:
            if self._quality and not measured.noise and np.array_equal(before, image):
                # A camera sends a frame again: that tells nothing of noise, but the next one does.
                measured = replace(measured, noise=self._quality.noise)
                self._frames -= 1
            last, new = (astuple(each) for each in (self._quality or measured, measured))
            mixed = (a + SMOOTHING_SHARE * (b - a) for a, b in zip(last, new, strict=True))
            self._quality = PictureQuality(*mixed)
        return self._quality

    def _places(self, state: CubeState, image: Image) -> Floats | None:
        """Return pixels across the sides of markers, (sides, lines, samples, 2), black first."""
        pose = state.camera_from_cube
        if pose is None or not state.visible or self._moves(pose, state):
            return None
        faces = list(self._planes.faces_towards(pose, MIN_COSINE))
        if not faces:
            return None
        corners = self._corners[faces] @ pose[:3, :3].T + pose[:3, 3]
        after = np.roll(corners, -1, axis=1)
        sides = (after - corners)[:, :, None]
        points = np.asarray(corners[:, :, None] + sides * _ALONG[:, None], np.float64)
        outwards = (corners + after)[:, :, None] / 2 - corners.mean(1)[:, None, None]
        outwards *= self._cell / np.linalg.norm(outwards, axis=-1, keepdims=True)
        start, end = (
            self._projection.project(each.reshape(-1, 3)).reshape(-1, LINES_PER_SIDE, 2)
            for each in (points, points + outwards)
        )
        along = start[:, -1:] - start[:, :1]
        normal = np.stack([along[..., 1], -along[..., 0]], axis=-1)
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
        across = ((end - start) * normal).sum(-1)  # how wide a cell is seen [px]
        normal = normal * np.sign(across)[..., None]
        at = start[..., None, :] + normal[..., None, :] * _OFFSETS[:, None]
        height, width = image.shape[:2]
        inside = ((at > 1) & (at < [width - 2, height - 2])).all((1, 2, 3))
        usable = at[inside & (np.abs(across).min(1) > MIN_CELL_PX)]
        return np.asarray(usable, np.float32) if len(usable) else None

    def _moves(self, pose: Array, state: CubeState) -> bool:
        """Return whether the motion of a cube blurs it."""
        focal, depth = self._projection.matrix[0, 0], max(float(pose[2, 3]), 1e-3)
        arm = float(np.abs(self._corners).max())
        speed = np.linalg.norm(state.velocity[:3]) + arm * np.linalg.norm(state.velocity[3:])
        return bool(speed * focal / depth > MAX_SPEED_PX_S)


def _sample(image: Image, places: Floats) -> Floats:
    """Return the grey values at places (…, samples, 2)."""
    flat = places.reshape(-1, *places.shape[-2:])
    sampled = cv2.remap(image, flat[..., 0], flat[..., 1], cv2.INTER_LINEAR)
    grey = np.asarray(cv2.cvtColor(sampled, cv2.COLOR_BGR2GRAY), np.float32)
    return np.asarray(grey.reshape(places.shape[:-1]), np.float32)


def _measure(before: Floats, profiles: Floats) -> PictureQuality | None:
    """Return blur and noise of profiles (sides, lines, samples), or None if no side is clear.

    The noise is what differs from the profiles of the frame before.
    """
    means = profiles.mean(1)
    black, white = means[:, :_FLAT].mean(1), means[:, -_FLAT:].mean(1)
    # Lenses blur light, not grey values.
    light = (profiles / np.float32(255.0)) ** np.float32(TONE_EXPONENT)
    mean_light = np.asarray(light.mean(1), np.float64)
    steps, normalized_steps = _blurred_steps()
    fits = _normalize(mean_light) @ normalized_steps.T
    clear = (fits.max(1) > MIN_FIT) & (white < SATURATED) & (white - black > MIN_CONTRAST)
    if not clear.any():
        return None
    best = fits.argmax(1)[clear]
    blurs = _BLURS[best // len(_SHIFTS)]
    blur = math.sqrt(max(float(np.median(blurs)) ** 2 - _INTERPOLATION_VARIANCE, 0.0))
    change = np.abs(profiles - before)[clear]
    change = np.delete(change, np.s_[_FLAT:-_FLAT], axis=-1)
    mean = float(np.minimum(change, np.quantile(change, _STEP_QUANTILE)).mean())
    variance = max(math.pi / 2 * mean**2 / 2 - _ROUNDING_VARIANCE, 0.0)
    ink, paper = _ink_and_paper(mean_light[clear], steps[best])
    haze = max(ink / paper - INK_SHARE, 0.0) / (1.0 - INK_SHARE)
    return PictureQuality(blur, math.sqrt(variance) / _INTERPOLATED_NOISE, haze, paper)


def _ink_and_paper(light: Array, steps: Array) -> tuple[float, float]:
    """Return the light of both, far from the blurred steps that fit (sides, samples) of light."""
    off_mean = steps - steps.mean(1, keepdims=True)
    half = (light * off_mean).sum(1) / np.square(off_mean).sum(1)
    middle = light.mean(1) - half * steps.mean(1)
    ink, paper = np.median([np.maximum(middle - half, 0.0), middle + half], axis=1)
    return float(ink), float(paper)
