"""What the experiment with single facial actions prints, and simulated raters (specification S7).

Raters answer by an ordinal threshold model: a latent judgement with normal noise falls between
fixed thresholds. The latent means are such that the means of the answers are the printed ones.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from cubeling.app.workshop.pages.report_table import ReportTable, figure, p_value
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item
from cubeling.app.workshop.study.reporting.tables import Row, StudyData

Array = NDArray[np.float64]

SCALES = ("EXP", "NAT", "RE")
"""Identification (the scale that names the action), naturalness and realism, 1…5."""

INTENSITY: Mapping[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "AU1+2": ((4.23, 3.40, 3.32), (3.18, 3.46, 3.33)),
    "AU4": ((3.84, 3.75, 3.69), (3.31, 3.90, 3.82)),
    "AU1+4": ((3.03, 3.28, 3.23), (2.64, 3.33, 3.35)),
    "AU6": ((3.14, 3.03, 3.03), (2.46, 3.33, 3.34)),
    "AU20": ((4.33, 2.30, 2.34), (4.02, 3.21, 3.16)),
    "AU12": ((4.21, 2.67, 2.72), (3.77, 3.29, 3.36)),
}
"""Table 4.3: means of the three scales at high and at low intensity."""

PRESENTATION: Mapping[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "AU1+2": ((3.82, 3.68, 3.53), (3.55, 3.11, 3.07)),
    "AU4": ((3.86, 3.79, 3.74), (3.21, 3.87, 3.77)),
    "AU1+4": ((3.00, 3.48, 3.41), (2.63, 3.10, 3.15)),
    "AU6": ((3.46, 3.24, 3.24), (1.89, 3.10, 3.10)),
    "AU20": ((4.20, 3.07, 3.06), (4.15, 2.34, 2.35)),
    "AU12": ((4.22, 3.14, 3.18), (3.70, 2.80, 2.87)),
}
"""Table 4.4: the same for animations and for pictures."""

FIRST_CHOICE: Mapping[str, tuple[float, float]] = {
    "AU4": (0.73, 0.50),
    "AU1+4": (0.29, 0.47),
    "AU1+2": (0.57, 0.68),
    "AU20": (0.56, 0.52),
    "AU12": (0.74, 0.77),
    "AU6": (0.47, 0.45),
}
"""Table 4.5: how often the right label scored higher than all others, with and without wrinkles."""

LABELS = {"upper": ("AU1+2", "AU4", "AU1+4"), "lower": ("AU6", "AU12", "AU20")}

LATENT_DEVIATION = 1.7
"""Of the latent judgement: the printed p of two differences implies a standard error of 0.21."""

THRESHOLDS = (1.5, 2.5, 3.5, 4.5)

DISTRACTOR_MEAN = 2.2
"""Mean of all labels for a stimulus that shows another action; nothing is printed of these."""

FACTORS = (
    ("intensity", ("high", "low"), "4.3", INTENSITY),
    ("mode", ("animation", "picture"), "4.4", PRESENTATION),
)
"""Factor, its levels, and the printed table."""


def shares(latent: float, deviation: float = LATENT_DEVIATION) -> Array:
    """Return the chances of the answers 1…5 at a latent mean."""
    normal = NormalDist(latent, deviation)
    below = [0.0, *(normal.cdf(each) for each in THRESHOLDS), 1.0]
    return np.diff(below)


@cache
def latent_of(mean: float, deviation: float = LATENT_DEVIATION) -> float:
    """Return the latent mean at which the answers have a mean.

    >>> round(float(shares(latent_of(3.4)) @ np.arange(1, 6)), 3)
    3.4
    """
    return _bisect(lambda latent: float(shares(latent, deviation) @ np.arange(1, 6)) - mean)


def cell_mean(action: str, scale: str, intensity: str, mode: str) -> float:
    """Return the mean of a scale at an intensity and in a mode, from both printed tables.

    The modes differ from their middle by as much at either intensity: no interaction is printed.
    """
    index = SCALES.index(scale)
    strong, weak = (each[index] for each in INTENSITY[action])
    moving, still = (each[index] for each in PRESENTATION[action])
    base = strong if intensity == "high" else weak
    shift = (moving - still) / 2.0
    return float(np.clip(base + (shift if mode == "animation" else -shift), 1.1, 4.9))


@cache
def other_mean(action: str, wrinkles: str) -> float:
    """Return the mean of the other labels at which the right one is chosen as often as printed."""
    rate = FIRST_CHOICE[action][0 if wrinkles == "with" else 1]
    right = np.mean(
        [
            shares(latent_of(cell_mean(action, "EXP", intensity, mode)))
            for intensity in ("high", "low")
            for mode in ("animation", "picture")
        ],
        axis=0,
    )

    def missing(latent: float) -> float:
        below = np.concatenate([[0.0], np.cumsum(shares(latent))[:-1]])
        return rate - float(right @ below**2)  # both others are below

    return float(shares(_bisect(missing)) @ np.arange(1, 6))


def answer_mean(stimulus: Mapping[str, str], item: str) -> float:
    """Return the mean answer of a simulated rater to a question about a stimulus."""
    action, intensity, mode = (stimulus[name] for name in ("action", "intensity", "mode"))
    scale = {"natural": "NAT", "realistic": "RE"}.get(item, "EXP")
    if action not in INTENSITY:
        return 3.2 if scale != "EXP" else DISTRACTOR_MEAN
    if scale != "EXP" or item == action:
        return cell_mean(action, scale, intensity, mode)
    return other_mean(action, stimulus["wrinkles"])


def simulated_answer(rng: np.random.Generator, step: PlannedStep, item: Item) -> Answer:
    """Return the answer of a simulated rater."""
    chances = shares(latent_of(round(answer_mean(step.stimulus, item.name), 6)))
    return float(rng.choice(5, p=chances / chances.sum()) + 1)


def identified(rows: Sequence[Row], scale: str) -> Iterator[Row]:
    """Yield the answers on a scale to stimuli that are analysed."""
    named = {"NAT": "natural", "RE": "realistic"}
    for row in rows:
        stimulus = row["stimulus"]
        if not stimulus or stimulus["action"] not in INTENSITY or row["answer"] is None:
            continue
        if row["item"] == named.get(scale, stimulus["action"]):
            yield row


def first_choices(rows: Sequence[Row]) -> dict[tuple[str, str], list[bool]]:
    """Return for each action and wrinkles whether the right label scored highest, alone."""
    shown: dict[tuple[str, int], dict[str, float]] = {}
    about: dict[tuple[str, int], Mapping[str, str]] = {}
    for row in rows:
        if row["stimulus"] and row["stimulus"]["action"] in INTENSITY:
            place = (row["participant"], row["place"])
            about[place] = row["stimulus"]
            if row["item"].startswith("AU") and row["answer"] is not None:
                shown.setdefault(place, {})[row["item"]] = row["answer"]
    found: dict[tuple[str, str], list[bool]] = {}
    for place, scores in shown.items():
        stimulus = about[place]
        if set(scores) == set(LABELS[stimulus["half"]]):
            others = [score for label, score in scores.items() if label != stimulus["action"]]
            best = scores[stimulus["action"]] > max(others)
            found.setdefault((stimulus["action"], stimulus["wrinkles"]), []).append(best)
    return found


def printed_tables() -> tuple[ReportTable, ...]:
    """Return the printed tables."""
    tables = []
    for factor, levels, number, printed in FACTORS:
        rows = tuple(
            (action, *(figure(value) for level in means for value in level))
            for action, means in printed.items()
        )
        columns = tuple(f"{level} {scale}" for level in levels for scale in SCALES)
        title = f"Printed (J. Huang, 2013, table {number}): means by {factor}"
        tables.append(ReportTable(title, ("action", *columns), rows))
    rates = tuple((action, *map(figure, each)) for action, each in FIRST_CHOICE.items())
    columns = ("action", "with wrinkles", "without")
    note = (
        "2,092 answers of 92 participants. By Mann–Whitney: all but AU1+4 (p = .065) are "
        "identified better at high intensity; AU4, AU6 and AU12 better animated; only AU4 better "
        "with wrinkles."
    )
    tables.append(ReportTable("Printed (table 4.5): right label first", columns, rates, note))
    return tuple(tables)


def own_tables(data: StudyData) -> tuple[ReportTable, ...]:
    """Return the same tables of a study, with the tests of each action."""
    from cubeling.app.workshop.study.reporting.statistics import compare_unpaired

    answers, tables = data.tables["answers"], []
    for factor, levels, _, _ in (*FACTORS, ("wrinkles", ("with", "without"), "", {})):
        rows = []
        for action in INTENSITY:
            cells: list[str] = []
            for scale in SCALES:
                own = [r for r in identified(answers, scale) if r["stimulus"]["action"] == action]
                one, other = (
                    [float(r["answer"]) for r in own if r["stimulus"][factor] == level]
                    for level in levels
                )
                if not one or not other:
                    cells += ["–"] * 3
                    continue
                p = compare_unpaired(one, other).p
                cells += [figure(float(np.mean(one))), figure(float(np.mean(other))), p_value(p)]
            rows.append((action, *cells))
        heads = tuple(f"{scale} {words}" for scale in SCALES for words in (*levels, "p"))
        title = f"This study: means by {factor}, Mann–Whitney"
        note = "Each answer is a value, as printed: several of one participant are not independent."
        tables.append(ReportTable(title, ("action", *heads), tuple(rows), note))
    chosen = first_choices(answers)
    rates = tuple(
        (action, *(figure(_mean(chosen.get((action, each), []))) for each in ("with", "without")))
        for action in FIRST_CHOICE
    )
    columns = ("action", "with wrinkles", "without")
    return (*tables, ReportTable("This study: right label first", columns, rates))


def _mean(values: Sequence[bool]) -> float | None:
    return sum(values) / len(values) if values else None


def _bisect(rising: Callable[[float], float], low: float = -15.0, high: float = 21.0) -> float:
    """Return where a function that rises, or falls, passes zero."""
    falls = rising(low) > 0.0
    for _ in range(60):
        middle = (low + high) / 2.0
        if (rising(middle) > 0.0) != falls:
            high = middle
        else:
            low = middle
    return (low + high) / 2.0
