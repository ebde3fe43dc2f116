"""What the study of gesture and speech prints, and the same from counts (specification M8)."""

from collections.abc import Mapping, Sequence

import numpy as np

from cubeling.app.workshop.pages.report_table import (
    ReportTable,
    figure,
    interval,
    p_value,
    percent,
)
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import pair_members
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item
from cubeling.app.workshop.study.reporting.cmos import (
    ANSWER_SCORES,
    PUBLISHED_THREE_LEVEL,
    Votes,
    ranking,
)
from cubeling.app.workshop.study.reporting.tables import Row, StudyData

COUNTS: Mapping[tuple[str, str], Votes] = {
    ("intensity", "random"): Votes(16, 65, 33, 9, 1),
    ("intensity", "time"): Votes(21, 63, 16, 21, 3),
    ("time", "random"): Votes(8, 46, 41, 24, 5),
    ("intensity", "original"): Votes(3, 17, 30, 44, 30),
    ("time", "original"): Votes(1, 6, 14, 50, 53),
    ("random", "original"): Votes(1, 5, 13, 53, 52),
}
"""124 answers each. The thesis prints percentages, means and medians; these counts have them."""

PRINTED: Mapping[tuple[str, str], tuple[str, str, str, str, str]] = {
    ("intensity", "random"): ("65.3", "8.0", "+0.69", "1", "< .001"),
    ("intensity", "time"): ("67.7", "19.4", "+0.63", "1", "< .001"),
    ("time", "random"): ("43.5", "23.4", "+0.23", "0", "< .01"),
    ("intensity", "original"): ("–", "–", "−0.65", "−1", "< .001"),
    ("time", "original"): ("–", "–", "−1.19", "−1", "< .001"),
    ("random", "original"): ("–", "–", "−1.21", "−1", "< .001"),
}
"""Better and worse [%], mean, median, and p of the printed t-test."""

NOT_BELOW = {"intensity": 40.3, "time": 16.9, "random": 15.3}
"""How often each is printed as not rated below the original [%]."""

COLUMNS = ("first / second", "n", "better", "worse", "mean", "median", "three levels")


def simulated_answer(rng: np.random.Generator, step: PlannedStep, item: Item) -> Answer:
    """Return a vote drawn from the counts, turned round where the first is on the left."""
    votes = COUNTS[pair_members(step.stimulus["pair"])]
    shares = np.array([votes.much_better, votes.better, votes.same, votes.worse, votes.much_worse])
    score = float(rng.choice(ANSWER_SCORES, p=shares / votes.total))
    return -score if step.first_left else score


def votes_of(rows: Sequence[Row]) -> dict[tuple[str, str], list[tuple[str, int]]]:
    """Return the participants and scores of each pair: positive where its first one is better."""
    found: dict[tuple[str, str], list[tuple[str, int]]] = {}
    for row in rows:
        if row["item"] == "suits" and row["answer"] is not None:
            score = int(-row["answer"] if row["first_left"] else row["answer"])
            pair = pair_members(row["stimulus"]["pair"])
            found.setdefault(pair, []).append((row["participant"], score))
    return {pair: found[pair] for pair in COUNTS if pair in found}


def printed_tables() -> tuple[ReportTable, ...]:
    """Return the printed table beside the figures of its counts."""
    from cubeling.app.workshop.study.reporting.statistics import compare_paired

    rows: list[tuple[str, ...]] = []
    for pair, votes in COUNTS.items():
        better, worse, mean, median, p = PRINTED[pair]
        rows.append((" / ".join(pair), "printed", better, worse, mean, median, "", p))
        counted = p_value(compare_paired(votes.scores, np.zeros(votes.total)).p)
        rows.append(("", "from counts", *_cells(votes, sign=True), counted))
    others = ", ".join(f"{name} {figure(s)}" for name, s in PUBLISHED_THREE_LEVEL.items())
    below = ", ".join(
        f"{name} {percent(1 - COUNTS[name, 'original'].worse_share)} (printed {share} %)"
        for name, share in NOT_BELOW.items()
    )
    return (
        ReportTable(
            "Printed (A. Fernández-Baena, 2015, section 4.4.6): 62 evaluators, 124 answers each",
            (
                *("first / second", "", "better %", "worse %", "mean", "median", "three levels"),
                "p",
            ),
            tuple(rows),
            "The counts are ours, such that they have the printed figures: 10 of 124 are 8.1 %, "
            "printed as 8.0. The printed p is that of t-tests, ours of signed ranks. Not rated "
            f"below the original: {below}. Three levels against the original, of studies with "
            f"other clips and viewers: {others}.",
        ),
    )


def own_tables(data: StudyData) -> tuple[ReportTable, ...]:
    """Return the same table of a study, with the statistics that its answers allow.

    An evaluator gives several answers of a kind: their means are compared, not the answers.
    """
    from cubeling.app.workshop.study.reporting.statistics import compare_paired, describe

    scores = votes_of(data.tables["answers"])
    rows, counted = [], {}
    for pair, given in scores.items():
        votes = counted[pair] = _votes([score for _, score in given])
        people: dict[str, list[int]] = {}
        for code, score in given:
            people.setdefault(code, []).append(score)
        means = [sum(each) / len(each) for each in people.values()]
        result = compare_paired(means, [0.0] * len(means))
        bounds = interval(describe(means).interval)
        test = (bounds, figure(result.effect), p_value(result.p))
        rows.append((" / ".join(pair), f"{votes.total}", *_cells(votes), *test))
    order = " > ".join(name for name, _ in ranking(counted)) if len(counted) == len(COUNTS) else "–"
    return (
        ReportTable(
            "The same table of this study",
            (*COLUMNS, "95 % interval of raters' means", "effect", "p (signed-rank)"),
            tuple(rows),
            f"Mean scores over all comparisons: {order}.",
        ),
    )


def _cells(votes: Votes, sign: bool = False) -> tuple[str, ...]:
    plus = "+" if sign and votes.mean > 0 else ""
    return (
        percent(votes.better_share).removesuffix(" %"),
        percent(votes.worse_share).removesuffix(" %"),
        plus + figure(votes.mean),
        figure(votes.median, 0 if votes.median == int(votes.median) else 1),
        figure(votes.three_level),
    )


def _votes(scores: Sequence[int]) -> Votes:
    return Votes(*(list(scores).count(score) for score in ANSWER_SCORES))
