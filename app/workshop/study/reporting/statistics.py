"""The statistics of a report: ordinal tests with their effect sizes, and intervals.

The only module that needs SciPy (extra `[study]`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Array = NDArray[np.float64]

RESAMPLES = 2000
"""Samples of a bootstrap."""


@dataclass(frozen=True)
class Described:
    """A sample in figures."""

    count: int
    mean: float
    deviation: float
    """The sample's standard deviation; NaN for a single value."""

    median: float
    interval: tuple[float, float]
    """95 % of the mean, by the bootstrap (bias-corrected and accelerated where it can be)."""


@dataclass(frozen=True)
class SampleComparison:
    """How two samples differ: a test, its effect, and the difference of their means."""

    test: str
    """Name of the test."""

    statistic: float
    p: float
    """Two-sided; 1 where nothing differs."""

    effect: float
    """Rank-biserial correlation, −1…1: 1 where all of the first are greater."""

    difference: float
    """Mean of the first less that of the second."""

    interval: tuple[float, float]
    """95 % of the difference, by the percentile bootstrap."""


def describe(values: Sequence[float] | Array, seed: int = 0) -> Described:
    """Return a sample in figures; there is at least one value."""
    sample = np.asarray(values, float)
    spread = float(sample.std(ddof=1)) if len(sample) > 1 else math.nan
    mean = float(sample.mean())
    interval = (mean, mean)
    if len(sample) > 1 and np.ptp(sample) > 0:
        found = stats.bootstrap(
            (sample,), np.mean, n_resamples=RESAMPLES, rng=np.random.default_rng(seed)
        ).confidence_interval
        interval = float(found.low), float(found.high)
    return Described(len(sample), mean, spread, float(np.median(sample)), interval)


def compare_paired(
    first: Sequence[float] | Array, second: Sequence[float] | Array, seed: int = 0
) -> SampleComparison:
    """Compare two values of each participant by Wilcoxon's signed ranks; ties are left out.

    The effect is the matched-pairs rank-biserial correlation (D. S. Kerby, 2014).
    """
    change = np.asarray(first, float) - np.asarray(second, float)
    low, high = _resampled(change, seed)
    kept = change[change != 0]
    if not len(kept):
        return SampleComparison(
            "Wilcoxon signed-rank", 0.0, 1.0, 0.0, float(change.mean()), (low, high)
        )
    ranks = stats.rankdata(np.abs(kept))
    effect = float((ranks[kept > 0].sum() - ranks[kept < 0].sum()) / ranks.sum())
    found = stats.wilcoxon(kept)
    return SampleComparison(
        "Wilcoxon signed-rank",
        float(found.statistic),
        float(found.pvalue),
        effect,
        float(change.mean()),
        (low, high),
    )


def compare_unpaired(
    first: Sequence[float] | Array, second: Sequence[float] | Array, seed: int = 0
) -> SampleComparison:
    """Compare two samples by Mann and Whitney's U; the effect is Cliff's delta."""
    one, other = np.asarray(first, float), np.asarray(second, float)
    found = stats.mannwhitneyu(one, other)
    same = len(np.unique(np.concatenate([one, other]))) == 1
    effect = float(2.0 * found.statistic / (len(one) * len(other)) - 1.0)
    rng = np.random.default_rng(seed)
    means = [
        each[rng.integers(0, len(each), (RESAMPLES, len(each)))].mean(1) for each in (one, other)
    ]
    low, high = np.quantile(means[0] - means[1], (0.025, 0.975))
    return SampleComparison(
        "Mann–Whitney U",
        float(found.statistic),
        1.0 if same else float(found.pvalue),
        effect,
        float(one.mean() - other.mean()),
        (float(low), float(high)),
    )


def compare_several(
    samples: Sequence[Sequence[float]], *, paired: bool
) -> tuple[str, float, float]:
    """Return the test, its statistic and p for three samples or more: Friedman, Kruskal–Wallis."""
    name = "Friedman" if paired else "Kruskal–Wallis"
    values = [np.asarray(each, float) for each in samples]
    spread = np.ptp(np.stack(values), axis=0) if paired else np.ptp(np.concatenate(values))
    if not np.any(spread):  # nobody's answers differ
        return name, 0.0, 1.0
    found = (stats.friedmanchisquare if paired else stats.kruskal)(*samples)
    return name, float(found.statistic), float(found.pvalue)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p-values corrected for their number, by S. Holm (1979).

    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    """
    order = np.argsort(p_values)
    corrected, largest = [0.0] * len(p_values), 0.0
    for rank, index in enumerate(order):
        largest = max(largest, (len(p_values) - rank) * p_values[int(index)])
        corrected[int(index)] = min(1.0, largest)
    return corrected


def share_interval(count: int, total: int) -> tuple[float, float]:
    """Return the 95 % interval of a share, by E. B. Wilson (1927)."""
    found = stats.binomtest(count, total).proportion_ci(method="wilson")
    return float(found.low), float(found.high)


def sensitivity(hits: float, false_alarms: float) -> float:
    """Return d′ from the rates of hits and of false alarms, both within 0…1.

    >>> round(sensitivity(0.73, 0.46), 2)
    0.71
    """
    return float(stats.norm.ppf(hits) - stats.norm.ppf(false_alarms))


def sides_p(first_left: int, total: int) -> float:
    """Return p of the χ² test that the first of each pair was on the left in half of them."""
    return float(stats.chisquare([first_left, total - first_left]).pvalue)


def _resampled(change: Array, seed: int) -> tuple[float, float]:
    rng = np.random.default_rng(seed)
    means = change[rng.integers(0, len(change), (RESAMPLES, len(change)))].mean(1)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(low), float(high)
