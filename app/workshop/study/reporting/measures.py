"""The parts of a report that hold for every study: tasks, scales, choices and stimuli."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from cubeling.app.counted import quantity
from cubeling.app.workshop.pages.box_plot import box_plot
from cubeling.app.workshop.pages.page import heading, items, paragraph, table
from cubeling.app.workshop.pages.report_table import (
    ReportTable,
    figure,
    interval,
    p_value,
    percent,
)
from cubeling.app.workshop.study.protocols.protocol import StimulusSet
from cubeling.app.workshop.study.protocols.questionnaires import Item
from cubeling.app.workshop.study.reporting.statistics import (
    SampleComparison,
    compare_paired,
    compare_several,
    compare_unpaired,
    describe,
    holm,
    share_bounds,
    sides_p,
)
from cubeling.app.workshop.study.reporting.tables import Row, StudyData

Values = Mapping[str, float]
"""A value of each participant, by their code."""

FIGURES = ("n", "mean", "SD", "median", "95 % interval of the mean")
COMPARED = ("test", "difference", "95 % interval", "effect", "p", "p (Holm)")


def task_parts(data: StudyData) -> Iterator[str]:
    """Yield what there is to say about tasks."""
    rows = data.tables["tasks"]
    if not rows:
        return
    yield heading("Tasks")
    for name, task in data.protocol.tasks.items():
        own = [row for row in rows if row["task"] == name]
        if not own:
            continue
        yield heading(f"{name}: {task.goal.words} within {task.limit_s:g} s", 3)
        lines, counted = [], [row for row in own if not _is_cut_off(row)]
        for condition, played in _by_condition(data, counted).items():
            reached = sum(bool(row["reached"]) for row in played)
            share = f"{reached} of {len(played)} ({percent(reached / len(played), 0)})"
            lines.append((_condition(condition), share, share_bounds(reached, len(played))))
        columns = ("condition", "reached", "95 % interval")
        yield table(ReportTable("Reached", columns, tuple(lines), _how_counted(own, task.ends)))
        times = _per_condition(own, "time_s")
        yield from _compared(data, f"Time to the goal [s]: {name}", times, "time [s]", (0.0, None))


def _is_cut_off(row: Row) -> bool:
    """Return whether a task ended for a reason that says nothing about the participant."""
    return row["ended_by"] == "source" and not row["reached"]


def _how_counted(rows: Sequence[Row], ends: str) -> str:
    """Return how tasks count that did not go on to their goal or limit; "" if all did."""
    left = [row for row in rows if row["ended_by"] == "person" and not row["reached"]]
    cut = [row for row in rows if _is_cut_off(row)]
    again = [row for row in rows if (row["attempt"] or 1) > 1]
    early = "before goal and limit" if ends == "goal" else "before the goal"
    words = (
        (left, f"Ended by the participant {early}, counted as not reached"),
        (cut, "Cut off, as there were no more pictures, not counted"),
        (again, "Begun again after an interruption, of which the last attempt counts"),
    )
    return " ".join(
        f"{what}: {', '.join(dict.fromkeys(str(row['participant']) for row in found))}."
        for found, what in words
        if found
    )


def wizard_parts(data: StudyData) -> Iterator[str]:
    """Yield what a wizard did: how much, how late, and how often in error."""
    rows = data.tables["acts"]
    if not rows:
        return
    yield heading("The wizard")
    wrong = sum(row["undone"] for row in rows)
    yield paragraph(
        f"{quantity(len(rows), 'act')}; taken back as errors: {wrong} "
        f"({percent(wrong / len(rows))}). Delays are from the cue to the act at the desk, without "
        "the acts that were errors, and with them."
    )
    lines = []
    for task, own in _by(rows, "task").items():
        for condition, acts in _by_condition(data, own).items():
            errors = sum(row["undone"] for row in acts)
            share = f"{errors} ({percent(errors / len(acts), 0)})"
            bounds = share_bounds(errors, len(acts))
            cued = [row for row in acts if row["delay_s"] is not None]
            meant = _delays([row for row in cued if not row["undone"]])
            lines.append(
                (task, _condition(condition), f"{len(acts)}", share, bounds, meant, _delays(cued))
            )
    columns = (
        *("task", "condition", "acts", "errors", "95 % interval"),
        *("delay [s]: mean, SD, longest, n", "with errors"),
    )
    note = "Acts of one wizard are not independent: the intervals are too narrow."
    yield table(ReportTable("Acts of the wizard", columns, tuple(lines), note))


def _delays(rows: Sequence[Row]) -> str:
    """Return mean, deviation, longest and number of some acts' delays."""
    if not rows:
        return "–"
    late = [row["delay_s"] for row in rows]
    found = describe(late)
    spread = f"{figure(found.mean)}, {figure(found.deviation)}, {figure(max(late))}"
    return f"{spread}, {len(late)}"


def scale_parts(data: StudyData) -> Iterator[str]:
    """Yield what there is to say about scales, sliders and scores that are about no stimulus."""
    answers = [row for row in data.tables["answers"] if not row["stimulus"]]
    yield from _scores(data)
    numeric, chosen, texts = [], [], []
    for name, questionnaire in data.protocol.questionnaires.items():
        own = [row for row in answers if row["questionnaire"] == name]
        for item in questionnaire.item:
            of_item = [row for row in own if row["item"] == item.name]
            if of_item and item.kind in ("scale", "slider"):
                numeric.append((item, of_item))
            elif of_item and item.kind == "choice":
                chosen.append((item, of_item))
            elif of_item:
                texts.append((item, of_item))
    if numeric:
        yield heading("Questions")
    for item, rows in numeric:
        values = _per_condition(rows, "answer")
        yield from _compared(data, item.words, values, _ends(item), (item.low, item.high))
    if chosen:
        yield heading("Choices")
    for item, rows in chosen:
        yield table(_choices(data, item, rows))
    if texts:
        yield heading("Free answers")
    for item, rows in texts:
        said = [str(row["answer"]) for row in rows if row["answer"]]
        yield heading(item.words, 3)
        yield items(said) if said else paragraph("Nobody wrote anything.", "note")


def stimulus_parts(data: StudyData) -> Iterator[str]:
    """Yield what there is to say about answers to stimuli, factor by factor."""
    rows = [row for row in data.tables["answers"] if row["stimulus"]]
    for name, shown in data.protocol.stimuli.items():
        own = [row for row in rows if _is_of(row, shown)]
        if not own:
            continue
        yield heading(f"Stimuli: {name}")
        places = {(row["participant"], row["place"]) for row in own}
        people = {row["participant"] for row in own}
        yield paragraph(
            f"{len(shown.stimuli)} stimuli, {len(places)} shown to {len(people)} participants. "
            "Each participant's mean of a level is one value."
        )
        if shown.pair:
            left = len({(row["participant"], row["place"]) for row in own if row["first_left"]})
            yield paragraph(
                f"The first of the pair was on the left in {left} of {len(places)} "
                f"(χ², p = {p_value(sides_p(left, len(places)))})."
            )
            continue  # scores of pairs need the side: the protocol's own table has them
        yield from _factors(data, own)


def _factors(data: StudyData, rows: Sequence[Row]) -> Iterator[str]:
    numeric = [row for row in rows if isinstance(row["answer"], int | float)]
    for item, own in _by(numeric, "item").items():
        for factor in sorted({name for row in own for name in row["stimulus"]}):
            means: dict[str, dict[str, float]] = {}
            for level in dict.fromkeys(
                row["stimulus"][factor] for row in own if factor in row["stimulus"]
            ):
                of_level = [row for row in own if row["stimulus"].get(factor) == level]
                means[level] = _per_person(of_level, "answer")
            if len(means) > 1:
                title = f"{item}, by {factor}"
                yield table(_described(title, factor, dict(sorted(means.items()))))


def _scores(data: StudyData) -> Iterator[str]:
    scores = _by(data.tables["scores"], "score")
    if scores:
        yield heading("Scores")
    for name, rows in scores.items():
        for after, own in _by(rows, "after").items():
            values = _per_condition(own, "value")
            title = f"{name}, after {after}" if after else name
            yield from _compared(data, title, values, name, None)


def _compared(
    data: StudyData,
    title: str,
    groups: Mapping[str, Values],
    label: str,
    span: tuple[float, float | None] | None,
) -> Iterator[str]:
    """Yield the figures of a measure under each condition, its plot, and what differs."""
    known = [*data.protocol.conditions, ""]
    named = {_condition(name): groups[name] for name in known if groups.get(name)}
    if not named:
        return
    yield table(_described(title, "condition", named))
    limits = None
    if span is not None:
        largest = max(value for values in named.values() for value in values.values())
        limits = (span[0], largest if span[1] is None else span[1])
    yield box_plot([(name, list(values.values())) for name, values in named.items()], label, limits)
    if len(named) > 1 and min(map(len, named.values())) > 1:
        yield table(comparisons(title, named, paired=data.protocol.design == "within"))


def comparisons(title: str, groups: Mapping[str, Values], *, paired: bool) -> ReportTable:
    """Return all pairs of conditions compared, with p-values corrected for their number."""
    found: list[tuple[str, SampleComparison]] = []
    for first, second in combinations(groups, 2):
        one, other = groups[first], groups[second]
        both = [code for code in one if code in other]
        if paired and both:
            result = compare_paired([one[code] for code in both], [other[code] for code in both])
        else:
            result = compare_unpaired(list(one.values()), list(other.values()))
        found.append((f"{first} − {second}", result))
    corrected = holm([result.p for _, result in found])
    rows = tuple(
        (
            name,
            result.test,
            figure(result.difference),
            interval(result.interval),
            figure(result.effect),
            p_value(result.p),
            p_value(p),
        )
        for (name, result), p in zip(found, corrected, strict=True)
    )
    note = "Effect: rank-biserial correlation, −1 to 1."
    shared = [code for code in next(iter(groups.values())) if _has_all(groups, code)]
    if len(groups) > 2 and (len(shared) > 1 or not paired):
        samples = [
            [group[code] for code in shared] if paired else list(group.values())
            for group in groups.values()
        ]
        test, statistic, p = compare_several(samples, paired=paired)
        note = f"All conditions: {test}, {figure(statistic)}, p = {p_value(p)}. {note}"
    return ReportTable(f"Conditions compared: {title}", ("difference of", *COMPARED), rows, note)


def _has_all(groups: Mapping[str, Values], code: str) -> bool:
    """Return whether a participant has a value under every condition."""
    return all(code in values for values in groups.values())


def _described(title: str, by: str, groups: Mapping[str, Values]) -> ReportTable:
    rows = []
    for name, values in groups.items():
        found = describe(list(values.values()))
        rows.append(
            (
                name,
                f"{found.count}",
                figure(found.mean),
                figure(found.deviation),
                figure(found.median),
                interval(found.interval),
            )
        )
    return ReportTable(title, (by, *FIGURES), tuple(rows))


def _choices(data: StudyData, item: Item, rows: Sequence[Row]) -> ReportTable:
    lines = []
    for condition, own in _by_condition(data, rows).items():
        given = [row["answer"] for row in own if row["answer"] is not None]
        for option in item.options:
            count = given.count(option)
            share = percent(count / max(len(given), 1))
            bounds = share_bounds(count, len(given))
            lines.append((option, _condition(condition), f"{count}/{len(given)}", share, bounds))
    columns = ("answer", "condition", "n", "share", "95 % interval")
    return ReportTable(item.words, columns, tuple(lines))


def _by(rows: Sequence[Row], key: str) -> dict[str, list[Row]]:
    found: defaultdict[str, list[Row]] = defaultdict(list)
    for row in rows:
        found[str(row[key])].append(row)
    return dict(sorted(found.items()))


def _by_condition(data: StudyData, rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Return the rows of each condition, in the order of the protocol."""
    known = [*data.protocol.conditions, ""]
    return dict(sorted(_by(rows, "condition").items(), key=lambda each: known.index(each[0])))


def _per_condition(rows: Sequence[Row], key: str) -> dict[str, Values]:
    """Return the values of all participants under each condition."""
    return {name: _per_person(own, key) for name, own in _by(rows, "condition").items()}


def _per_person(rows: Sequence[Row], key: str) -> dict[str, float]:
    """Return the mean of each participant's values; those without any are left out."""
    found: defaultdict[str, list[float]] = defaultdict(list)
    for row in rows:
        if isinstance(row[key], int | float):
            found[row["participant"]].append(float(row[key]))
    return {code: float(np.mean(values)) for code, values in found.items()}


def _condition(name: str) -> str:
    return name or "everybody"


def _is_of(row: Row, shown: StimulusSet) -> bool:
    stimulus: Any = row["stimulus"]
    return stimulus in shown.stimuli


def _ends(item: Item) -> str:
    ends = (item.anchors[0], item.anchors[-1]) if item.anchors else ("", "")
    return f"{item.low:g} {ends[0]} … {item.high:g} {ends[1]}".strip()
