"""The report of a study: one page with its tables, plots and statistics."""

from collections import Counter
from collections.abc import Iterator
from importlib import import_module, metadata

from cubeling.app.workshop.pages.page import heading, items, page, paragraph, table
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.study.reporting.measures import (
    scale_parts,
    stimulus_parts,
    task_parts,
    wizard_parts,
)
from cubeling.app.workshop.study.reporting.tables import StudyData

KIND_WORDS = {
    "simulated": "Simulated participants. Their answers are drawn from stated shares, or at "
    "random: these figures show that the study runs, and say nothing about people.",
    "pilot": "A pilot: these participants do not count for the study.",
}
"""What stands above a report that is not one of a study."""


def report_page(data: StudyData, changed: bool) -> str:
    """Return the page; `changed` is whether the protocol is another one than at the first run."""
    return page(data.protocol.title, list(_parts(data, changed)))


def deviations(data: StudyData, changed: bool) -> list[str]:
    """Return what is not as it was laid down before the study."""
    plan, people = data.protocol.preregistered, data.tables["participants"]
    found = []
    if changed:
        found.append("The protocol was changed after the first participant.")
    if plan.participants and len(people) != plan.participants:
        found.append(f"{plan.participants} participants were planned, and {len(people)} took part.")
    for row in people:
        if row["done"] < row["planned"]:
            found.append(f"{row['participant']} finished {row['done']} of {row['planned']} steps.")
        if row["begun"] > 1:
            found.append(f"{row['participant']} was interrupted, and began {row['begun']} times.")
    known = {row["item"] for row in data.tables["answers"]}
    known |= {row["score"] for row in data.tables["scores"]}
    known |= {row["task"] for row in data.tables["tasks"]}
    found += [
        f"'{name}' was to be measured, and was not." for name in plan.measures if name not in known
    ]
    return found


def _parts(data: StudyData, changed: bool) -> Iterator[str]:
    protocol = data.protocol
    yield heading(protocol.title, 1)
    if data.kind in KIND_WORDS:
        yield paragraph(KIND_WORDS[data.kind], "warning")
    for block in protocol.about.strip().split("\n\n"):
        yield paragraph(" ".join(block.split()))
    yield heading("Participants")
    yield from _people(data)
    if protocol.preregistered.hypotheses:
        yield heading("Hypotheses", 3)
        yield items(protocol.preregistered.hypotheses)
    yield heading("Deviations from what was laid down", 3)
    found = deviations(data, changed)
    yield items(found) if found else paragraph("None.")
    if protocol.printed:
        module = import_module(f"cubeling.app.workshop.study.bundled.{protocol.printed}")
        yield heading("Beside what was published")
        for each in (*module.printed_tables(), *module.own_tables(data)):
            yield table(each)
    yield from task_parts(data)
    yield from wizard_parts(data)
    yield from scale_parts(data)
    yield from stimulus_parts(data)
    yield heading("How it was made")
    yield paragraph(
        f"Cubeling {metadata.version('cubeling')}, SciPy {metadata.version('scipy')}. Intervals "
        "are 95 % bootstrap intervals, those of shares by Wilson. Tests are two-sided; p-values of "
        "several comparisons of one measure are corrected by Holm. The tables are beside this "
        "page, as CSV with a data dictionary."
    )


def _people(data: StudyData) -> Iterator[str]:
    people = data.tables["participants"]
    finished = sum(row["done"] == row["planned"] for row in people)
    yield paragraph(f"{len(people)} took part, {finished} finished.")
    if len(data.protocol.conditions) > 1:
        orders = Counter(str(row["conditions"]) for row in people)
        rows = tuple(
            (order.replace(";", " → "), f"{count}") for order, count in sorted(orders.items())
        )
        what = "order of the conditions" if data.protocol.design == "within" else "condition"
        yield table(ReportTable("Orders", (what, "participants"), rows))
