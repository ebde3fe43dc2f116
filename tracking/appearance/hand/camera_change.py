"""A change of the camera's exposure and white balance, seen on what it showed before."""

from collections.abc import Sequence

import numpy as np

from cubeling.tracking.geometry.arrays import Floats
from cubeling.tracking.geometry.robust_statistics import quantile

GAIN_TOLERANCE, STEP_TOLERANCE = 0.02, 0.004
"""Change of L + 16 as a share, and of chroma as a share of L + 16, that noise alone makes."""

MIN_SAMPLES, MAX_SAME, MIN_CHANGED = 30, 0.12, 0.35
"""Least pixels that tell a change of the camera; most of them that still look as before then, and
least that have changed alike, as shares."""


def camera_change(now: Floats, before: Floats) -> Floats | None:
    """Return what undoes a change of exposure and white balance, (3, 3); None without one.

    It multiplies `now`. Where the camera has changed, nothing looks as before, and most differs
    alike; a hand or a shadow leaves some of the desk as it was.

    Parameters
    ----------
    now, before
        L + 16, a and b of CIELab, in bytes, of the same things, (3, n).
    """
    if now.shape[1] < MIN_SAMPLES:
        return None
    light, a, b = now
    mean, mean_a, mean_b = before
    changes = light / mean, a / light - mean_a / mean, b / light - mean_b / mean
    gain, step_a, step_b = usual = [quantile(change, 0.5) for change in changes]
    if _share(changes, (1.0, 0.0, 0.0)) > MAX_SAME or _share(changes, usual) < MIN_CHANGED:
        return None
    balanced = np.array([[1, 0, 0], [-step_a, 1, 0], [-step_b, 0, 1]], np.float32)
    return balanced / np.float32(gain)


def _share(changes: Sequence[Floats], change: Sequence[float]) -> float:
    """Return the share of pixels that have changed by that gain and those steps of chroma."""
    alike = np.ones(len(changes[0]), bool)
    tolerances = GAIN_TOLERANCE, STEP_TOLERANCE, STEP_TOLERANCE
    for each, usual, tolerance in zip(changes, change, tolerances, strict=True):
        alike &= np.abs(each - np.float32(usual)) < tolerance
    return np.count_nonzero(alike) / len(alike)
