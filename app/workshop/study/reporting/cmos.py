"""Comparison mean opinion scores: which of two videos suits the speech better.

ITU-T P.800 (1996), annex E, comparison category rating, with five levels instead of seven;
A. Fernández-Baena (2015), section 4.4.5.
"""

from collections.abc import Mapping
from dataclasses import astuple, dataclass
from statistics import fmean, median

ANSWER_SCORES = (2, 1, 0, -1, -2)
"""Scores of the answers, in the order of the fields of `Votes`."""

PUBLISHED_THREE_LEVEL = {
    "Fernández-Baena 2015": -0.44,
    "Gesture Controllers 2010": -0.46,
    "Levine 2009": -0.71,
}
"""Three-level scores of synthesised against captured gestures. Other clips, viewers and corpora:
they can be set side by side, but not tested against each other."""


@dataclass(frozen=True)
class Votes:
    """How often a first video was found better or worse than a second one."""

    much_better: int
    """Answers that score 2."""

    better: int
    """Answers that score 1."""

    same: int
    """Answers that score 0."""

    worse: int
    """Answers that score −1."""

    much_worse: int
    """Answers that score −2."""

    def __post_init__(self) -> None:
        if min(astuple(self)) < 0 or self.total == 0:
            raise ValueError("votes are counts, and there is at least one")

    @property
    def total(self) -> int:
        """Number of answers, those for neither video too."""
        return sum(astuple(self))

    @property
    def scores(self) -> list[int]:
        """The score of each answer, the best ones first."""
        return [s for s, n in zip(ANSWER_SCORES, astuple(self), strict=True) for _ in range(n)]

    @property
    def better_share(self) -> float:
        """Share of answers that found the first video better, 0…1."""
        return (self.much_better + self.better) / self.total

    @property
    def worse_share(self) -> float:
        """Share of answers that found it worse, 0…1."""
        return (self.worse + self.much_worse) / self.total

    @property
    def mean(self) -> float:
        """The five-level score, −2…2."""
        return fmean(self.scores)

    @property
    def three_level(self) -> float:
        """The score with "much better" as "better", −1…1; for `PUBLISHED_THREE_LEVEL`."""
        return self.better_share - self.worse_share

    @property
    def median(self) -> float:
        """The median of the scores, −2…2."""
        return median(self.scores)


def ranking(comparisons: Mapping[tuple[str, str], Votes]) -> list[tuple[str, float]]:
    """Return the kinds of video with their mean score over all comparisons, the best first."""
    scores: dict[str, list[float]] = {}
    for (first, second), votes in comparisons.items():
        scores.setdefault(first, []).append(votes.mean)
        scores.setdefault(second, []).append(-votes.mean)
    means = [(name, sum(own) / len(own)) for name, own in scores.items()]
    return sorted(means, key=lambda each: -each[1])
