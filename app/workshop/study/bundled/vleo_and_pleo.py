"""What the study of Vleo and Pleo prints, and what follows from its counts (specification M12)."""

from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.app.workshop.study.reporting.tables import StudyData

HAPPY_COUNTS, ANGRY_COUNTS = (0, 0, 0, 1, 11), (0, 0, 0, 0, 12)
"""Answers of twelve children, from "not at all" to "very"."""

BOTH_COUNT, CHILDREN = 10, 12
"""How many like to play most with both, and how many there are."""

MEAN_S, DEVIATION_S = (22.0, 16.8), (10.2, 6.2)
"""Times of the first and of the second task: mean and standard deviation [s]."""

TASKS = ("make Pleo happy", "make Pleo angry")


def reduction(before: float, after: float) -> float:
    """Return by which share a value became less.

    >>> round(100 * reduction(22.0, 16.8), 1), round(100 * reduction(10.2, 6.2), 1)
    (23.6, 39.2)
    """
    return (before - after) / before


def printed_tables() -> tuple[ReportTable, ...]:
    """Return the printed table, with each figure computed again."""
    rows = (
        ("Pleo is very happy", "91.7 %", percent(HAPPY_COUNTS[-1] / CHILDREN)),
        ("Pleo is happy, not much", "8.3 %", percent(HAPPY_COUNTS[-2] / CHILDREN)),
        ("Pleo is very angry", "100 %", percent(ANGRY_COUNTS[-1] / CHILDREN)),
        ("Plays most with both", "83.3 %", percent(BOTH_COUNT / CHILDREN)),
        ("Plays most with Pleo only", "16.7 %", percent(1 - BOTH_COUNT / CHILDREN)),
        ("Second task is faster", "27 %", percent(reduction(*MEAN_S))),
        ("Its times vary less", "39 %", percent(reduction(*DEVIATION_S))),
    )
    return (
        ReportTable(
            "Printed (A. Fernández-Baena, 2015, table 5.1 and section 5.3.5)",
            ("figure", "printed", "from its counts"),
            rows,
            "12 children. 27 % does not follow from the printed means: (22 − 16.8) / 22 is 23.6 %. "
            "The tasks were always in the same order, so that learning and task are confounded.",
        ),
    )


def own_tables(data: StudyData) -> tuple[ReportTable, ...]:
    """Return the same figures of a study."""
    rows = []
    for item, words in (("is_happy", "Pleo is very happy"), ("is_angry", "Pleo is very angry")):
        rows.append((words, _share(data, item, 5.0)))
    rows.append(("Plays most with both", _share(data, "play_most", "Pleo and Vleo")))
    for task in TASKS:
        times = [row["time_s"] for row in data.tables["tasks"] if row["task"] == task]
        reached = [time for time in times if time is not None]
        mean = sum(reached) / len(reached) if reached else None
        rows.append((f"{task}: reached", f"{len(reached)} of {len(times)}"))
        rows.append((f"{task}: mean time [s]", figure(mean, 1)))
        rows.append((f"{task}: longest [s]", figure(max(reached, default=None), 1)))
    return (ReportTable("The same figures of this study", ("figure", data.kind), tuple(rows)),)


def _share(data: StudyData, item: str, answer: object) -> str:
    answers = [row["answer"] for row in data.tables["answers"] if row["item"] == item]
    if not answers:
        return "–"
    return (
        f"{percent(answers.count(answer) / len(answers))} ({answers.count(answer)}/{len(answers)})"
    )
