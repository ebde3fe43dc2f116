"""The light in the room, measured on the white paper of a tracked cube."""

from dataclasses import dataclass

import numpy as np

from tracking.appearance.patches import LINEAR_FROM_SRGB, MAX_VALUE, PaperSampler, Patches
from tracking.cube.marker import cell_size
from tracking.cube.model import CubeModel
from tracking.geometry.arrays import Array, Image
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.state import CubeState

EXPOSURE_S, MAX_BLUR_CELLS = 0.015, 0.35
"""Expected exposure time, and how far a cube may move during it: beyond, paper and ink mix."""

DEFAULT_UP = np.array([0.0, -np.cos(0.55), -np.sin(0.55)])
"""Up in the axes of a camera that looks down on a desk as most do, (3,)."""

PRIOR_CONCENTRATION = 1.5
"""How much likelier light comes from above than from elsewhere: as von Mises and Fisher's κ."""

CAMERA_SIDE = 0.34
"""How far the expected light leans to the camera's side, beside 1 upwards."""

EXPECTED_AMBIENT_SHARE, AMBIENT_SHARE_SPREAD = 0.5, 0.3
"""Share of the light from all around before anything is measured, and its standard deviation."""

IRRADIANCE_ERROR = 0.035
"""Standard deviation of a patch's light from the model, as a share of the mean light: light from
the table and the hand, vignetting, and paper that is not flat."""

INDEPENDENT_PATCHES = 8.0
"""How many independent measurements many patches make at most: neighbours share their errors."""

SHADOW_SHARE = 0.11
"""A patch darker than its model by this share of the mean light is in a shadow."""

MAX_REFITS, MIN_LIT_PATCHES = 2, 4
"""How often the light is fitted again without such patches; and fewer than this cannot tell that
another one is in a shadow."""

SETTLING_S, DARKENING_S, MEMORY_S, SMOOTHING_S = 0.2, 1.5, 60.0, 0.4
"""Time in which the mean of an orientation settles, in which it does where that is darker, as in
the shadow of a hand that passes, in which it is forgotten, and in which the light that is reported
follows the fit."""

CONTRADICTED_S, MIN_KNOWN, CONTRADICTION = 0.25, 0.6, 0.12
"""Time in which all is forgotten while the faces contradict a light whose direction is certain to
this degree, and by how much of all light half of them do so at least."""

MEASURING_INTERVAL_S, FIT_INTERVAL_S = 0.1, 0.3
"""Time from one measurement of the paper to the next, and from one fit to the next: never both in
the same picture."""

MAX_STEP_S = 0.2
"""A longer gap between two pictures counts as this long: one picture proves no more."""

MIN_WEIGHT = 0.02
"""Weight below which an orientation is forgotten."""


def sphere(count: int) -> Array:
    """Return directions that are spread evenly, (count, 3): a Fibonacci lattice.

    >>> bool(np.abs(sphere(100).mean(axis=0)).max() < 0.01)
    True
    """
    number = np.arange(count) + 0.5
    z, angle = 1 - 2 * number / count, np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def _disc() -> Array:
    """Return points in the unit disc: the middle and three rings, (37, 2)."""
    rings = [np.arange(6 * n) * np.pi / (3 * n) for n in (1, 2, 3)]
    points = [np.stack([np.cos(a), np.sin(a)], axis=1) * n / 3 for n, a in enumerate(rings, 1)]
    return np.concatenate([np.zeros((1, 2)), *points])


DIRECTIONS, ORIENTATIONS, DISC = sphere(128), sphere(192), _disc()
"""Directions that a light is searched in, orientations that are remembered apart, and how the best
direction is refined."""

REFINED_SPREADS, MIN_REFINED, MAX_REFINED = 2.5, np.radians(12.0), np.radians(50.0)
"""How far around the mean direction it is refined, in standard deviations, and the least and the
most of it [rad]: no less than the distance of two directions, and only where one is the best."""


@dataclass(frozen=True)
class MeasuredLight:
    """Light from one direction, and from all around."""

    to_light: Array
    """Unit vector towards the key light, in the camera's frame, (3,)."""

    key: Array
    """Irradiance from it on a surface that faces it, linear RGB, (3,); 1 makes a white surface just
    white."""

    ambient: Array
    """Irradiance from all around, linear RGB, (3,)."""

    certainty: float
    """How well the faces seen so far determine the direction, 0…1.

    One less the spread of the directions that explain the paper, as a share of the spread before
    anything was seen. At 0.5 that is about 30°, and `to_light` is half a guess.
    """


class LightMeter:
    """Measures the light on a tracked cube, from picture to picture; the camera stands still.

    Each face is a patch of known reflectance and orientation. The light on the orientations seen so
    far is remembered, relative to the picture's exposure, and explained by ambient light and one
    direction: irradiance = ambient + key · max(0, normal · to_light).
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._sampler = PaperSampler(cube, intrinsics)
        self._reach = cube.edge * 0.87
        self._max_travel = MAX_BLUR_CELLS * cell_size(cube)
        self._exposure = _ExposureGain()
        self._memory = _PatchMemory()
        self._light: MeasuredLight | None = None
        self._looked = self._fitted = self._measured = -np.inf
        self._gain = np.ones(3)

    def update(
        self, image: Image, state: CubeState, up: Array | None = None
    ) -> MeasuredLight | None:
        """Take a picture into account and return the light.

        Parameters
        ----------
        image
            The camera's picture, (H, W, 3) BGR.
        state
            Where the cube is in it.
        up
            Unit vector away from the ground in the camera's frame, (3,), if it is known: light
            comes from above more often than from below.

        Returns
        -------
        None until any paper was measured. See `MeasuredLight.certainty` for how far to trust it.
        """
        now = state.timestamp
        if self._measured > self._fitted and now - self._fitted >= FIT_INTERVAL_S - 1e-6:
            fitted = self._memory.fit(DEFAULT_UP if up is None else up)
            self._light = _blend(self._light, fitted, now - self._fitted)
            self._fitted = now
        elif now - self._looked >= MEASURING_INTERVAL_S - 1e-6:
            step = min(now - self._looked, MAX_STEP_S)
            self._looked = now
            self._gain = self._exposure.update(image, step)
            self._memory.age(step)
            self._measure(image, state)
        light = self._light
        if light is None:
            return None
        return MeasuredLight(
            light.to_light, light.key * self._gain, light.ambient * self._gain, light.certainty
        )

    def _measure(self, image: Image, state: CubeState) -> None:
        """Take the paper that is seen into the memory."""
        if not state.visible or state.camera_from_cube is None or not self._still(state):
            return
        patches = self._sampler.measure(image, state.camera_from_cube)
        if len(patches.normals):
            step = min(state.timestamp - self._measured, MAX_STEP_S)
            irradiance = patches.irradiance / self._gain
            if self._light is not None and _contradict(self._light, patches.normals, irradiance):
                self._memory.age(step * MEMORY_S / CONTRADICTED_S)
            self._memory.add(patches, irradiance, step)
            self._measured = state.timestamp

    def _still(self, state: CubeState) -> bool:
        """Whether paper and ink are apart in the picture in spite of the cube's motion."""
        moved, turned = state.velocity[:3], state.velocity[3:]
        speed = np.sqrt(moved @ moved) + self._reach * np.sqrt(turned @ turned)
        return state.source != "predicted" and bool(speed * EXPOSURE_S < self._max_travel)


def _contradict(light: MeasuredLight, normals: Array, irradiance: Array) -> bool:
    """Whether faces are lit otherwise than known: more than one of them, as hands shade one."""
    if light.certainty < MIN_KNOWN or len(normals) < 2:
        return False
    model = light.ambient + np.maximum(normals @ light.to_light, 0)[:, None] * light.key
    off = np.sort(np.abs(irradiance - model).sum(axis=1))
    return bool(off[(len(off) - 1) // 2] > CONTRADICTION * (light.ambient + light.key).sum())


def fit_patches(normals: Array, irradiance: Array, weights: Array, up: Array) -> MeasuredLight:
    """Fit the light to patches; those that turn out to be in a shadow count for nothing.

    Parameters
    ----------
    normals, irradiance, weights
        Of each patch: unit normal, (N, 3); linear RGB, (N, 3); and weight 0…1, (N,).
    up
        Unit vector away from the ground, (3,).
    """
    log_prior = _prior(up)
    light, darker = fit_light(normals, irradiance, weights, log_prior)
    for _ in range(MAX_REFITS):
        shadowed = darker > SHADOW_SHARE
        if not shadowed.any() or len(shadowed) - shadowed.sum() < MIN_LIT_PATCHES:
            break
        light, darker = fit_light(normals, irradiance, weights * ~shadowed, log_prior)
    return light


def fit_light(
    normals: Array, irradiance: Array, weights: Array, log_prior: Array
) -> tuple[MeasuredLight, Array]:
    """Fit ambient light and one direction to patches.

    The likelihood of each direction on a grid follows by non-negative least squares of ambient and
    key light; the result is the mean, first over the sphere, then around the best.

    Parameters
    ----------
    normals, irradiance, weights
        Of each patch: unit normal, (N, 3); linear RGB, (N, 3); and weight 0…1, (N,).
    log_prior
        Gradient of the log of the prior likelihood by the direction, (3,).

    Returns
    -------
    The light, and how much darker each patch is than its model, as a share of the mean light, (N,).
    """
    total = float(weights.sum())
    mean = max(float(weights @ irradiance.sum(axis=1)) / (3 * total), 1e-6)
    independent = min(1.0, INDEPENDENT_PATCHES / total)
    scaled = irradiance / mean
    directions = DIRECTIONS
    for _ in range(2):
        lit = np.maximum(normals @ directions.T, 0)
        cost, ambients, keys = _least_squares(lit, scaled, weights)
        variance = max(IRRADIANCE_ERROR**2, float(cost.min()) / (3 * max(total - 2, 1.0)))
        log = directions @ log_prior - cost * (independent / (2 * variance))
        likely = np.exp(log - log.max())
        likely /= likely.sum()
        centre = likely @ directions
        length = float(np.sqrt(centre @ centre))
        to_light = centre / max(length, 1e-9)
        ambient, key = likely @ ambients, likely @ keys
        spread = float(np.sqrt(2 * max(1 - length, 0)))
        radius = max(REFINED_SPREADS * spread, MIN_REFINED)
        if radius > MAX_REFINED:
            break
        directions = _around(to_light, radius)
    certainty = float(np.clip(1 - spread / _prior_spread(log_prior), 0, 1))
    model = ambient + lit @ (likely[:, None] * keys)
    darker = (model - scaled).mean(axis=1)
    return MeasuredLight(to_light, key * mean, ambient * mean, certainty), darker


def _least_squares(lit: Array, values: Array, weights: Array) -> tuple[Array, Array, Array]:
    """Fit ambient and key light, both at least 0, for each direction.

    `lit` are the cosines of patches and directions, at least 0, (N, G), `values` (N, 3), `weights`
    (N,).
    Returns the weighted sum of squares (G,), ambient and key light (G, 3).
    """
    weighted = weights[:, None] * values
    # What is expected of the ambient share is one more measurement, of a weight next to nothing.
    share, trust = EXPECTED_AMBIENT_SHARE, (IRRADIANCE_ERROR / (2 * AMBIENT_SHARE_SPREAD)) ** 2
    aa = float(weights.sum()) + trust * (1 - share) ** 2
    ak = (weights @ lit)[:, None] - trust * share * (1 - share)
    kk = (weights @ (lit * lit))[:, None] + trust * share**2
    a, k = weighted.sum(axis=0), lit.T @ weighted
    key = (aa * k - ak * a) / (aa * kk - ak * ak)
    key = np.where(ak * key > a, k / kk, np.maximum(key, 0))  # no negative ambient light
    ambient = np.maximum(a - ak * key, 0) / aa
    cost = aa * ambient**2 + 2 * ak * ambient * key + kk * key**2 - 2 * (ambient * a + key * k)
    return cost.sum(axis=1) + float((weighted * values).sum()), ambient, key


def _around(centre: Array, radius: float) -> Array:
    """Return directions around one, up to `radius` [rad] from it, (37, 3)."""
    side = np.eye(3)[np.abs(centre).argmin()]
    right = np.array(
        [
            centre[1] * side[2] - centre[2] * side[1],
            centre[2] * side[0] - centre[0] * side[2],
            centre[0] * side[1] - centre[1] * side[0],
        ]
    )
    right /= np.sqrt(right @ right)
    down = np.array(
        [
            centre[1] * right[2] - centre[2] * right[1],
            centre[2] * right[0] - centre[0] * right[2],
            centre[0] * right[1] - centre[1] * right[0],
        ]
    )
    around = centre + DISC * np.tan(radius) @ np.stack([right, down])
    return np.asarray(around / np.sqrt((around * around).sum(axis=1))[:, None], np.float64)


def _prior(up: Array) -> Array:
    """Gradient of the log of the prior likelihood by the direction, (3,)."""
    towards = np.array([0.0, 0.0, -1.0]) + up[2] * up  # horizontally to the camera
    lean = up + CAMERA_SIDE * towards / max(float(np.sqrt(towards @ towards)), 0.1)
    return np.asarray(PRIOR_CONCENTRATION * lean / np.sqrt(lean @ lean), np.float64)


def _prior_spread(log_prior: Array) -> float:
    """Spread of directions before anything is measured [rad]."""
    kappa = float(np.sqrt(log_prior @ log_prior))
    return float(np.sqrt(2 * (1 - (1 / np.tanh(kappa) - 1 / kappa))))


def _blend(last: MeasuredLight | None, new: MeasuredLight, since: float) -> MeasuredLight:
    """Follow a new fit smoothly."""
    if last is None:
        return new
    share = 1 - np.exp(-since / SMOOTHING_S)
    to_light, key, ambient = (
        a + share * (b - a)
        for a, b in (
            (last.to_light, new.to_light),
            (last.key, new.key),
            (last.ambient, new.ambient),
        )
    )
    certainty = last.certainty + share * (new.certainty - last.certainty)
    to_light = to_light / max(float(np.sqrt(to_light @ to_light)), 1e-9)
    return MeasuredLight(to_light, key, ambient, float(certainty))


class _PatchMemory:
    """The light on each orientation of paper seen so far."""

    def __init__(self) -> None:
        self.weights = np.zeros(len(ORIENTATIONS))
        self._normals = np.zeros((len(ORIENTATIONS), 3))
        self._irradiance = np.zeros((len(ORIENTATIONS), 3))

    def age(self, seconds: float) -> None:
        """Forget a little."""
        self.weights *= np.exp(-max(seconds, 0) / MEMORY_S)

    def add(self, patches: Patches, irradiance: Array, seconds: float) -> None:
        """Take patches into the means of their orientations."""
        if not len(irradiance):
            return
        near = (ORIENTATIONS @ patches.normals.T).argmax(axis=0)
        seconds = max(seconds, 1e-3)
        weights = self.weights[near]
        darker = irradiance.sum(axis=1) < (1 - SHADOW_SHARE) * self._irradiance[near].sum(axis=1)
        share = 1 - np.exp(-seconds / np.where(darker, DARKENING_S, SETTLING_S))
        weights += share * (1 - weights)
        self.weights[near] = weights
        gain = (share / weights)[:, None]
        self._normals[near] += gain * (patches.normals - self._normals[near])
        self._irradiance[near] += gain * (irradiance - self._irradiance[near])

    def fit(self, up: Array) -> MeasuredLight:
        """Fit the light to what is known."""
        known = np.flatnonzero(self.weights > MIN_WEIGHT)
        normals, irradiance = self._normals[known], self._irradiance[known]
        return fit_patches(normals, irradiance, self.weights[known], up)


class _ExposureGain:
    """How much brighter the still parts of the picture are than at first, in each colour.

    Automatic exposure and white balance scale everything; the median of many places ignores what
    moves.
    """

    ROWS, COLUMNS = 12, 20
    """Number of places."""

    ADAPTATION_S = 10.0
    """Time in which the reference follows what changes in the room."""

    def __init__(self) -> None:
        self._reference = np.empty(0)

    def update(self, image: Image, seconds: float) -> Array:
        """Return the gain of linear RGB since the first picture, (3,)."""
        height, width = image.shape[:2]
        row, column = max(height // self.ROWS, 1), max(width // self.COLUMNS, 1)
        values = image[row // 2 :: row, column // 2 :: column].reshape(-1, 3)
        light = LINEAR_FROM_SRGB[np.clip(values, 1, MAX_VALUE)]
        if self._reference.shape != light.shape:
            self._reference = light
        ratio = light / self._reference
        middle = len(ratio) // 2
        gain = np.partition(ratio, middle, axis=0)[middle]
        share = 1 - np.exp(-max(seconds, 0) / self.ADAPTATION_S)
        self._reference = self._reference + share * (light / gain - self._reference)
        return np.asarray(gain[::-1], np.float64)
