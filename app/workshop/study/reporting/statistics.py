"""The statistics of a report: ordinal tests with their effect sizes, and intervals.

The only module that needs SciPy (extra `[study]`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from cubeling.app.workshop.pages.report_table import percent

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
    """95 % of the mean, by the bootstrap (bias-corrected and accelerated where it can be). NaN
    for a single value."""


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
    interval = (mean, mean) if len(sample) > 1 else (math.nan, math.nan)
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
    kept = change[change != 0]
    statistic, p, effect = 0.0, 1.0, 0.0
    if len(kept):
        found = stats.wilcoxon(kept)
        statistic, p = float(found.statistic), float(found.pvalue)
        ranks = stats.rankdata(np.abs(kept))
        effect = float((ranks[kept > 0].sum() - ranks[kept < 0].sum()) / ranks.sum())
    interval = _middle(_resampled_means(change, np.random.default_rng(seed)))
    test = "Wilcoxon signed-rank"
    return SampleComparison(test, statistic, p, effect, float(change.mean()), interval)


def compare_unpaired(
    first: Sequence[float] | Array, second: Sequence[float] | Array, seed: int = 0
) -> SampleComparison:
    """Compare two samples by Mann and Whitney's U; the effect is Cliff's delta."""
    one, other = np.asarray(first, float), np.asarray(second, float)
    found = stats.mannwhitneyu(one, other)
    same = len(np.unique(np.concatenate([one, other]))) == 1
    effect = float(2.0 * found.statistic / (len(one) * len(other)) - 1.0)
    rng = np.random.default_rng(seed)
    interval = _middle(_resampled_means(one, rng) - _resampled_means(other, rng))
    p = 1.0 if same else float(found.pvalue)
    difference = float(one.mean() - other.mean())
    return SampleComparison(
        "Mann–Whitney U", float(found.statistic), p, effect, difference, interval
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


def share_bounds(count: int, total: int) -> str:
    """Return the 95 % interval of a share, by E. B. Wilson (1927): "[39 %, 94 %]"."""
    if not total:
        return "–"
    found = stats.binomtest(count, total).proportion_ci(method="wilson")
    return f"[{percent(found.low, 0)}, {percent(found.high, 0)}]"


def sides_p(first_left: int, total: int) -> float:
    """Return p of the χ² test that the first of each pair was on the left in half of them."""
    return float(stats.chisquare([first_left, total - first_left]).pvalue)


def _resampled_means(values: Array, rng: np.random.Generator) -> Array:
    """Return the means of bootstrap samples, (RESAMPLES,)."""
    means: Array = values[rng.integers(0, len(values), (RESAMPLES, len(values)))].mean(1)
    return means


def _middle(values: Array) -> tuple[float, float]:
    """Return between which two the middle 95 % of some values lie."""
    low, high = np.quantile(values, (0.025, 0.975))
    return float(low), float(high)
