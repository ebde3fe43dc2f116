"""How certain a mean is."""

import numpy as np

from cubeling.characters.skeleton.pose import Array


def bootstrap_interval(values: Array, seed: int = 0) -> tuple[float, float]:
    """Return the 95 % interval of a mean, (n,) values, by the percentile bootstrap.

    >>> low, high = bootstrap_interval(np.array([1.0, 2.0, 3.0]))
    >>> 1.0 <= low < 2.0 < high <= 3.0
    True
    """
    rng = np.random.default_rng(seed)
    means = rng.choice(values, (2000, len(values))).mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return float(low), float(high)
