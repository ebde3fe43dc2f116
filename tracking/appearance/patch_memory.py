"""What is remembered of the paper: the light on each orientation, and the picture's exposure."""

import numpy as np

from cubeling.tracking.appearance.appearance import MeasuredLight
from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB
from cubeling.tracking.appearance.light_fit import SHADOW_SHARE, fit_patches, sphere
from cubeling.tracking.appearance.patches import MAX_VALUE, Patches
from cubeling.tracking.geometry.arrays import Array, Image

ORIENTATIONS = sphere(192)
"""Orientations that are remembered apart, (192, 3)."""

SETTLING_S, DARKENING_S, MEMORY_S = 0.2, 1.5, 60.0
"""Time in which the mean of an orientation settles, in which it does where that is darker, as in
the shadow of a hand that passes, and in which it is forgotten."""

MIN_WEIGHT = 0.02
"""Weight below which an orientation is forgotten."""


class PatchMemory:
    """The light on each orientation of paper seen so far."""

    def __init__(self) -> None:
        self.weights = np.zeros(len(ORIENTATIONS))
        self._normals = np.zeros((len(ORIENTATIONS), 3))
        self._irradiance = np.zeros((len(ORIENTATIONS), 3))

    def age(self, seconds: float) -> None:
        """Forget a little: weights fall by a factor of e in `MEMORY_S`."""
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


class ExposureGain:
    """How much brighter the still parts of the picture are than at first, in each colour.

    Automatic exposure and white balance scale everything; the median of many places ignores what
    moves.
    """

    ROWS, COLUMNS = 12, 20
    """Cells of the grid over the picture whose brightness is compared."""

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
