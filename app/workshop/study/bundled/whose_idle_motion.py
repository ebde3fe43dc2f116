"""What the evaluation of idle motion prints, and d′ from its rates (specification S25)."""

from collections.abc import Mapping, Sequence
from statistics import NormalDist

import numpy as np

from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item
from cubeling.app.workshop.study.reporting.tables import Row, StudyData

RECORDED_RIGHT, GENERATED_RIGHT = 0.73, 0.54
"""How often recorded motion is called recorded, and generated motion generated."""

RECOGNISED, CHANCE = 1 / 3, 1 / 8
"""How often the person is named, and how often by chance among eight."""

GENDER_ADVANTAGE = 0.07
"""By how much more often the gender is recognised in recorded motion."""

SUBJECTS = 15

SIMULATED_GENDER_RIGHT = 0.70
"""How often simulated participants recognise it in generated motion: no rate is printed."""


def d_prime(recorded_right: float, generated_right: float) -> float:
    """Return d′ of telling recorded from generated motion.

    >>> round(d_prime(0.73, 0.54), 2)
    0.71
    """
    normal = NormalDist()
    return normal.inv_cdf(recorded_right) - normal.inv_cdf(1.0 - generated_right)


def simulated_answer(rng: np.random.Generator, step: PlannedStep, item: Item) -> Answer:
    """Return an answer that is right as often as the printed rates say."""
    recorded = step.stimulus["origin"] == "recorded"
    rates = {
        "gender": SIMULATED_GENDER_RIGHT + GENDER_ADVANTAGE * recorded,
        "who": RECOGNISED,
        "origin": RECORDED_RIGHT if recorded else GENERATED_RIGHT,
    }
    truth = _truth(step.stimulus, item.name)
    if rng.random() < rates[item.name]:
        return truth
    others = [option for option in item.options if option != truth]
    return others[int(rng.integers(len(others)))]


def printed_tables() -> tuple[ReportTable, ...]:
    """Return the printed rates, and what follows from them."""
    accuracy = (RECORDED_RIGHT + GENERATED_RIGHT) / 2
    rows = (
        ("recorded called recorded", "73 %", percent(RECORDED_RIGHT, 0)),
        ("generated called generated", "54 %", percent(GENERATED_RIGHT, 0)),
        ("generated called recorded", "almost 50 %", percent(1 - GENERATED_RIGHT, 0)),
        ("recorded called generated", "> 25 %", percent(1 - RECORDED_RIGHT, 0)),
        ("right in all", "", percent(accuracy)),
        ("d′", "", figure(d_prime(RECORDED_RIGHT, GENERATED_RIGHT))),
        ("person recognised", "about 1/3", percent(RECOGNISED)),
        ("by chance", "", percent(CHANCE)),
        ("gender: more often right in recorded", "about 7 points", "7 points"),
    )
    return (
        ReportTable(
            "Printed (A. Egges, 2006, section 3.3.2)",
            ("rate", "printed", "what follows"),
            rows,
            f"{SUBJECTS} subjects, films of 8 people. No counts are printed.",
        ),
    )


def own_tables(data: StudyData) -> tuple[ReportTable, ...]:
    """Return the same rates of a study, with their intervals."""
    from cubeling.app.workshop.study.reporting.statistics import share_bounds

    answers = [row for row in data.tables["answers"] if row["stimulus"]]
    rows, rates = [], {}
    for origin in ("recorded", "generated"):
        for item in ("origin", "who", "gender"):
            own = [
                row
                for row in answers
                if row["item"] == item and row["stimulus"]["origin"] == origin
            ]
            right = sum(row["answer"] == _truth(row["stimulus"], item) for row in own)
            rates[origin, item] = _smoothed(right, own)
            share = percent(right / len(own)) if own else "–"
            bounds = share_bounds(right, len(own))
            rows.append((f"{item} right, {origin} motion", f"{right}/{len(own)}", share, bounds))
    sensitivity = d_prime(rates["recorded", "origin"], rates["generated", "origin"])
    rows.append(("d′", "", figure(sensitivity), ""))
    return (
        ReportTable(
            "The same rates of this study",
            ("rate", "n", "share", "95 % interval"),
            tuple(rows),
            "Intervals take the answers as independent; with several a participant they are too "
            "narrow. For d′, half an answer is added to each side (M. J. Hautus, 1995).",
        ),
    )


def _smoothed(right: int, own: Sequence[Row]) -> float:
    return (right + 0.5) / (len(own) + 1)


def _truth(stimulus: Mapping[str, str], item: str) -> str:
    return stimulus["person" if item == "who" else item]
