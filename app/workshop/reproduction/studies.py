"""Tables of studies with people: as printed, and as our protocols give them with simulated people.

Nobody was asked anything for these. Simulated participants answer by the printed shares, so that
what comes out shows that protocol, counting and statistics work, and nothing about people.
"""

import tempfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cubeling.app.workshop.moods.colors import CURVE_STYLES, SECONDARY_COLOR
from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.app.workshop.study.bundled import (
    gesture_and_speech,
    single_facial_actions,
    vleo_and_pleo as children,
)
from cubeling.app.workshop.study.participants.running import run_simulated
from cubeling.app.workshop.study.participants.simulated import simulate_task
from cubeling.app.workshop.study.participants.study_log import StudyFolder, participants_in
from cubeling.app.workshop.study.protocols.protocol import Settings
from cubeling.app.workshop.study.protocols.protocol_file import load_protocol
from cubeling.app.workshop.study.reporting.cmos import ANSWER_SCORES, Votes
from cubeling.app.workshop.study.reporting.tables import StudyData, gather

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RATERS, CHILDREN, EVALUATORS = 92, 12, 62
"""Participants of each study, as printed, and as many simulated ones."""

SIMULATED_HANDS = 40
"""Simulated hands that try one turn and two."""

PRINTED_QUESTIONS = (
    ("after task 1", "Do you think that Pleo is happy?", "5-point Likert"),
    ("after task 1", "Without Vleo, how would you make Pleo happy?", "open"),
    ("after task 2", "Do you think that Pleo is angry?", "5-point Likert"),
    ("after task 2", "Without Vleo, how would you make Pleo angry?", "open"),
    ("end", "Do you like to play with Vleo?", "5-point Likert + open"),
    ("end", "How do you like to play most?", "only Pleo / Pleo and Vleo"),
)
"""Table 5.1: when, question and answers."""

NOT_PEOPLE = (
    "Ours are simulated participants, who answer by the printed shares: that they come near shows "
    "that protocol and counting work, and nothing about people."
)


def simulated_study(name: str, count: int) -> StudyData:
    """Return what simulated participants do in a bundled protocol."""
    protocol, source = load_protocol(name)
    with tempfile.TemporaryDirectory() as folder:
        study = StudyFolder(Path(folder, "study"), protocol, source, "simulated")
        run_simulated(study, count)
        return gather(protocol, "simulated", participants_in(study.path))


def gesture_votes(request: ReproductionRequest) -> Reproduction:
    """Return tables 4.3 and 4.4 of Fernández-Baena 2015: which gestures suit the speech."""
    request.progress("simulated evaluators")
    data = simulated_study("gesture-and-speech", EVALUATORS)
    scores = gesture_and_speech.votes_of(data.tables["answers"])
    ours = {
        pair: Votes(*([score for _, score in given].count(each) for each in ANSWER_SCORES))
        for pair, given in scores.items()
    }
    shares, middles, below = [], [], []
    for pair, counted in gesture_and_speech.COUNTS.items():
        own = ours[pair]
        better, worse, mean, median, _ = gesture_and_speech.PRINTED[pair]
        name, both = " / ".join(pair), (counted, own)
        cells = (
            *(better, *(percent(each.better_share) for each in both)),
            *(worse, *(percent(each.worse_share) for each in both)),
        )
        shares.append((name, *(cell.removesuffix(" %") for cell in cells)))
        cells = (
            *(mean, *(figure(each.mean) for each in both)),
            *(median, *(figure(each.median, 0) for each in both)),
        )
        middles.append((name, *cells))
        if pair[1] == "original":
            rated = (percent(1 - each.worse_share) for each in both)
            below.append((pair[0], f"{gesture_and_speech.NOT_BELOW[pair[0]]} %", *rated))
    return Reproduction(
        (
            ReportTable(
                "First against second: shares",
                (
                    "",
                    *_heads("better [%]", ("counted", "simulated")),
                    *_heads("worse [%]", ("counted", "simulated")),
                ),
                tuple(shares),
            ),
            ReportTable(
                "First against second: scores",
                (
                    "",
                    *_heads("mean", ("counted", "simulated")),
                    *_heads("median", ("counted", "simulated")),
                ),
                tuple(middles),
            ),
            ReportTable(
                "Not rated below the original",
                ("", "printed", "counted", "simulated"),
                tuple(below),
            ),
        ),
        f"counts of 124 answers that have all printed figures, and {EVALUATORS} simulated "
        "evaluators in the protocol 'gesture-and-speech'",
        "The thesis prints shares, means and medians, not counts: the counts are ours, and 10 of "
        f"124 are 8.1 %, printed as 8.0. {NOT_PEOPLE} The films are not public. Our specification "
        "has the figures of the tables without their numbers, and of the two figures only that "
        "they are box plots.",
        (
            DrawnFigure(
                "Figure 4.13: scores of the conditions against each other, counted",
                partial(_draw_votes, gesture_and_speech.COUNTS, False),
            ),
            DrawnFigure(
                "Figure 4.14: scores against the original, counted",
                partial(_draw_votes, gesture_and_speech.COUNTS, True),
            ),
        ),
    )


def vleo_and_pleo(request: ReproductionRequest) -> Reproduction:
    """Return table 5.1 and the results of the study with children."""
    request.progress("simulated children")
    data = simulated_study("vleo-and-pleo", CHILDREN)
    (printed,) = children.printed_tables()
    (ours,) = children.own_tables(data)
    times = {
        task: [
            row["time_s"]
            for row in data.tables["tasks"]
            if row["task"] == task and row["time_s"] is not None
        ]
        for task in children.TASKS
    }
    ours_asked = [item.text for each in data.protocol.questionnaires.values() for item in each.item]
    asked = tuple(
        (when, question, answers, next((text for text in ours_asked if text == question), "–"))
        for when, question, answers in PRINTED_QUESTIONS
    )
    task = data.protocol.tasks[children.TASKS[0]]
    turned = []
    for turns in (2.0, 1.0):
        rngs = (np.random.default_rng([1, number]) for number in range(SIMULATED_HANDS))
        found = [simulate_task(task, Settings(turns=turns), rng) for rng in rngs]
        reached = [each.time_s for each in found if each.time_s is not None]
        mean, longest = (figure(each, 1) for each in (sum(reached) / len(reached), max(reached)))
        turned.append((f"{turns:g}", f"{len(reached)} of {len(found)}", mean, longest))
    return Reproduction(
        (
            ReportTable(
                "Table 5.1: questions",
                ("printed: when", "printed question", "printed answers", "in our protocol"),
                asked,
            ),
            ReportTable("Results", ("", "printed", "from its counts"), printed.rows, printed.note),
            ReportTable("Simulated", ("", "simulated"), ours.rows),
            ReportTable(
                "Simulated: make Pleo happy, by the turns of the cube for full strength",
                ("turns", "reached", "mean time [s]", "longest [s]"),
                tuple(turned),
            ),
        ),
        f"the printed counts, and {CHILDREN} simulated children who turn a simulated cube in the "
        "protocol 'vleo-and-pleo'",
        f"{NOT_PEOPLE} Their times are those of a hand that tries one face after the other and "
        "turns on where Pleo's mood comes nearer. 27 % faster is 23.6 % of the printed means. Only "
        "the text about the figures is left.",
        (
            DrawnFigure("Figure 5.22: is Pleo happy, is Pleo angry", _draw_answers, (8.8, 2.6)),
            DrawnFigure("Figure 5.23: times of the tasks", partial(_draw_times, times), (8.8, 2.4)),
            DrawnFigure("Figure 5.24: how they like to play most", _draw_preference, (8.8, 1.5)),
        ),
    )


def facial_actions(request: ReproductionRequest) -> Reproduction:
    """Return tables 4.3 to 4.5 of Huang 2013: how well single facial actions are identified."""
    request.progress("simulated raters")
    data = simulated_study("single-facial-actions", RATERS)
    answers = data.tables["answers"]
    tables = []
    for factor, levels, number, printed in single_facial_actions.FACTORS:
        rows = []
        for action, means in printed.items():
            for level, values in zip(levels, means, strict=True):
                cells = [f"{action}, {level}"]
                for scale, value in zip(single_facial_actions.SCALES, values, strict=True):
                    own = [
                        float(row["answer"])
                        for row in single_facial_actions.identified(answers, scale)
                        if row["stimulus"]["action"] == action and row["stimulus"][factor] == level
                    ]
                    mean = sum(own) / len(own) if own else None
                    cells += [figure(value), figure(mean)]
                rows.append(tuple(cells))
        heads = (name for scale in single_facial_actions.SCALES for name in _heads(scale))
        tables.append(ReportTable(f"Table {number}: means by {factor}", ("", *heads), tuple(rows)))
    chosen = single_facial_actions.first_choices(answers)
    rates = tuple(
        (
            action,
            *(figure(each[0]), figure(_share(chosen, action, "with"))),
            *(figure(each[1]), figure(_share(chosen, action, "without"))),
        )
        for action, each in single_facial_actions.FIRST_CHOICE.items()
    )
    columns = ("", *_heads("with wrinkles"), *_heads("without"))
    tables.append(ReportTable("Table 4.5: right label first", columns, rates))
    return Reproduction(
        tuple(tables),
        f"{RATERS} simulated raters, {len(answers):,} answers to single questions, in the "
        "protocol 'single-facial-actions'",
        f"{NOT_PEOPLE} They judge by an ordinal model whose means are the printed ones. Each "
        "factor is printed by itself, so that the simulated ones have no interaction. "
        "cubeling study faces draws the 128 stimuli with our renderer.",
        (
            DrawnFigure(
                "Table 4.3: identified at high and at low intensity",
                partial(_draw_actions, tables[0]),
            ),
            DrawnFigure(
                "Table 4.4: identified in animations and in pictures",
                partial(_draw_actions, tables[1]),
            ),
        ),
    )


def _heads(what: str, ours: Sequence[str] = ("simulated",)) -> tuple[str, ...]:
    """Return the headings of a printed figure and of ours."""
    return f"printed {what}", *ours


def _share(
    chosen: Mapping[tuple[str, str], Sequence[bool]], action: str, wrinkles: str
) -> float | None:
    values = chosen.get((action, wrinkles), ())
    return sum(values) / len(values) if values else None


def _draw_votes(counts: Mapping[tuple[str, str], Votes], original: bool, sheet: "Figure") -> None:
    pairs = [pair for pair in counts if (pair[1] == "original") == original]
    scores = [
        [
            score
            for score, count in zip(ANSWER_SCORES, _counts(counts[pair]), strict=True)
            for _ in range(count)
        ]
        for pair in pairs
    ]
    axes = sheet.subplots()
    axes.boxplot(scores, orientation="horizontal", showmeans=True)
    axes.set_yticks(range(1, len(pairs) + 1), [" / ".join(pair) for pair in pairs])
    axes.set_xlabel("score: −2 second much better … +2 first much better; triangle: mean")
    axes.invert_yaxis()


def _counts(votes: Votes) -> tuple[int, ...]:
    return votes.much_better, votes.better, votes.same, votes.worse, votes.much_worse


def _draw_answers(sheet: "Figure") -> None:
    axes = sheet.subplots()
    rows = (("is Pleo happy?", children.HAPPY_COUNTS), ("is Pleo angry?", children.ANGRY_COUNTS))
    for number, (_, counts) in enumerate(rows):
        axes.bar(
            [place + 0.4 * number - 0.2 for place in range(1, 6)],
            counts,
            0.36,
            color=CURVE_STYLES[number + 1][0],
            label=rows[number][0],
        )
    axes.set_xticks(range(1, 6), ["1 not at all", "2", "3", "4", "5 very"])
    axes.set_ylabel("children, printed")
    axes.legend(loc="upper left")


def _draw_times(times: Mapping[str, Sequence[float]], sheet: "Figure") -> None:
    axes = sheet.subplots()
    for row, (task, own) in enumerate(times.items()):
        mean, spread = children.MEAN_S[row], children.DEVIATION_S[row]
        axes.errorbar(
            [mean],
            [row + 0.15],
            xerr=[spread],
            fmt="s",
            color=SECONDARY_COLOR,
            capsize=4,
            label="printed: mean ± SD" if not row else None,
        )
        axes.plot(
            own,
            [row - 0.15] * len(own),
            "o",
            alpha=0.6,
            color=CURVE_STYLES[2][0],
            label="simulated" if not row else None,
        )
        del task
    axes.set_yticks(range(len(times)), list(times))
    axes.set_xlabel("time [s]")
    axes.set_xlim(left=0.0)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def _draw_preference(sheet: "Figure") -> None:
    axes = sheet.subplots()
    counts = {"Pleo and Vleo": children.BOTH_COUNT, "only Pleo": CHILDREN - children.BOTH_COUNT}
    axes.barh(list(counts), list(counts.values()), color=SECONDARY_COLOR)
    axes.set_xlabel("children, printed")
    axes.invert_yaxis()


def _draw_actions(shown: ReportTable, sheet: "Figure") -> None:
    """Draw the identification at both levels of a factor: printed, and simulated."""
    axes = sheet.subplots()
    identified: list[tuple[str, str, float, float]] = []
    for name, *cells in shown.rows:
        action, _, level = name.partition(", ")
        printed, own = (float(cell.replace("–", "nan")) for cell in cells[:2])  # EXP
        identified.append((action, level, printed, own))
    actions = list(dict.fromkeys(action for action, *_ in identified))
    levels = list(dict.fromkeys(level for _, level, *_ in identified))
    for marker, level in zip("^v", levels, strict=True):
        there = [row for row in identified if row[1] == level]
        for values, shift, who, color in (
            ([row[2] for row in there], -0.08, "printed", SECONDARY_COLOR),
            ([row[3] for row in there], 0.08, "simulated", CURVE_STYLES[2][0]),
        ):
            places = [place + shift for place in range(len(actions))]
            axes.plot(places, values, marker, color=color, label=f"{who}, {level}")
    axes.set_xticks(range(len(actions)), actions)
    axes.set_ylabel("identification, 1…5")
    axes.set_ylim(1.0, 5.0)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
