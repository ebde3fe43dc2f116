"""What the tables of several choices of clips come to: means with intervals, beside the thesis."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.app.workshop.reproduction.motion_graphs.measuring import Key, Measurement, Value
from cubeling.app.workshop.reproduction.motion_graphs.printed import (
    CRITICAL,
    SHORTER_AND_SOONER,
    TABLE_3_2,
    TABLE_3_3,
    TABLE_3_4,
)
from cubeling.characters.motion import Array

TITLES = {
    "3.2": "Table 3.2: time between frames (TBF) and response, by threshold [frames]",
    "3.3": "Table 3.3: duration and response from clip to clip [frames]",
    "3.4": "Table 3.4: the best split profile from clip (down) to clip (across)",
}


@dataclass(frozen=True)
class Estimate:
    """A value over several choices of clips."""

    value: Value
    """Their mean, or the most frequent name; None if none has one."""

    low: float | None = None
    """Lower end of the 95 % interval of the mean; None for a single choice, and for names."""

    high: float | None = None
    """Upper end of the 95 % interval; None as for the lower one."""

    count: tuple[int, int] | None = None
    """How many choices have that name, and of how many."""

    joined: int | None = None
    """How many clips are joined, in the mean: the colour of a cell of table 3.2."""

    @property
    def text(self) -> str:
        """The value as it is printed."""
        if self.value is None:
            return "–"
        return self.value if isinstance(self.value, str) else f"{self.value:.2f}"

    @property
    def spread(self) -> str:
        """How certain it is, as it is printed; empty for a single choice."""
        if self.low is not None and self.high is not None:
            return f"{self.low:.2f} … {self.high:.2f}"
        return f"{self.count[0]} of {self.count[1]}" if self.count and self.count[1] > 1 else ""


@dataclass(frozen=True)
class TablesSummary:
    """The tables of several choices of clips."""

    choices: tuple[Measurement, ...]

    cells: dict[Key, dict[str, Estimate]]
    """What each way comes to, by its name, for each table, row and column."""

    @property
    def ways(self) -> tuple[str, ...]:
        """Names of the ways."""
        return tuple(self.choices[0].values)

    def pairs(self, way: str) -> tuple[int, int, int]:
        """Return in how many pairs parts are shorter, and sooner, and of how many."""
        shorter, sooner, count = np.sum([each.pairs[way] for each in self.choices], axis=0)
        return int(shorter), int(sooner), int(count)

    def order(self, way: str) -> str:
        """Return how often the order of table 3.3 comes out, as a sentence."""
        shorter, sooner, count = self.pairs(way)
        printed = SHORTER_AND_SOONER
        return (
            f"{way}: parts are shorter in {shorter} of {count} pairs (printed {printed[0]} of 12), "
            f"sooner in {sooner} of {count} (printed {printed[1]} of 12)"
        )


def summarize(choices: Sequence[Measurement]) -> TablesSummary:
    """Return the tables of some choices of clips, all measured in the same ways."""
    cells = {
        key: {
            way: _estimate(
                [each.values[way].get(key) for each in choices],
                [each.joined[way][key] for each in choices if key in each.joined[way]],
            )
            for way in choices[0].values
        }
        for key in next(iter(choices[0].values.values()))
    }
    return TablesSummary(tuple(choices), cells)


def printed_value(key: Key) -> str:
    """Return what the thesis prints in a cell; empty where it prints nothing."""
    table, row, column = key
    method, _, what = column.partition(" ")
    if table == "3.4":
        return TABLE_3_4[int(row[1]) - 1][int(column[1]) - 1]
    if table == "3.3" and what in ("duration", "response"):
        pair = int(row[1]) - 1, int(row[-1]) - 1
        return f"{TABLE_3_3[method][pair][what == 'response']:.2f}"
    if table == "3.2" and what in ("TBF", "response"):
        return f"{TABLE_3_2[float(row)][method == 'BPMG'][what == 'response']:.2f}"
    if table == "3.2" and what == "st":
        return row
    if table == "3.2" and what == "clips":  # the other colours are lost
        return "4" if float(row) >= CRITICAL[method] else "2 or 3"
    return ""


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


def _estimate(values: Sequence[Value], joined: Sequence[int]) -> Estimate:
    """Return what some values come to."""
    clips = round(float(np.mean(joined))) if joined else None
    names = [value for value in values if isinstance(value, str)]
    if names:
        name, often = Counter(names).most_common(1)[0]
        return Estimate(name, count=(often, len(values)))
    numbers = np.array([value for value in values if isinstance(value, float)])
    if not len(numbers):
        return Estimate(None, joined=clips)
    mean = float(numbers.mean())
    if len(numbers) == 1:
        return Estimate(mean, joined=clips)
    return Estimate(mean, *bootstrap_interval(numbers), joined=clips)
