"""Robust statistics that are fast on small arrays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry.arrays import Array


def quantile(values: NDArray[np.floating[Any]], share: float) -> float:
    """Return the value below which a share of all lies; eight times as fast as `np.quantile`.

    >>> quantile(np.array([3.0, 1.0, 2.0]), 0.5)
    2.0
    """
    index, ordered = int(share * (len(values) - 1)), values.copy()
    ordered.partition(index)
    return float(ordered[index])


def median(values: NDArray[np.floating[Any]]) -> float:
    """Return the same as `np.median`, in a fifth of the time where there are few values.

    >>> median(np.array([4.0, 1.0, 2.0, 3.0]))
    2.5
    """
    ordered, last = np.sort(values), len(values) - 1
    return float((ordered[last // 2] + ordered[last - last // 2]) / 2)


def tukey_weight(residual: Array, cut: float) -> Array:
    """Tukey's biweight: 1 at zero, 0 from `cut` on.

    >>> tukey_weight(np.array([0.0, 1.0, 2.0]), 2.0).tolist()
    [1.0, 0.5625, 0.0]
    """
    return np.square(np.maximum(1 - (residual / cut) ** 2, 0))


def robust_weight(residual: Array, least_cut: float) -> Array:
    """Tukey's biweight of residuals, by their own spread: outliers have 0.

    The median of absolute values is taken as a standard deviation (Gaussian), and the cut as
    Tukey's for 95 % efficiency, but at least `least_cut`.

    >>> robust_weight(np.array([-0.1, 0.0, 0.1, 9.0]), 0.5).round(2).tolist()
    [0.96, 1.0, 0.96, 0.0]
    """
    scale = 1.4826 * quantile(np.abs(residual), 0.5)
    return tukey_weight(residual, max(4.685 * scale, least_cut))


def median_with_error(values: Array) -> tuple[float, float]:
    """Return the median, and its standard error by the median of the distances from it.

    >>> median_with_error(np.array([1.0, 2.0, 3.0, 90.0]))
    (2.5, 0.925)
    """
    middle = median(values)
    # 1.48 makes the median of distances a standard deviation, 1.25 is the price of a median.
    spread = 1.48 * median(np.abs(values - middle))
    return middle, 1.25 * spread / float(np.sqrt(len(values)))
