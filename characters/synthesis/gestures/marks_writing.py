"""Writing marked gestures: CSV, ELAN, Anvil and BML."""

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from cubeling.characters.errors import CharacterError
from cubeling.characters.synthesis.gestures.intervals import PhaseInterval, intervals_of
from cubeling.characters.synthesis.gestures.marks import GestureMarks, MarkTable
from cubeling.characters.synthesis.gestures.marks_files import COLUMNS
from cubeling.files import write_whole

APEX_S = 0.02
"""How long the annotation of an apex lasts: ELAN and Anvil have no moments [s]."""

SYNCS = "start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end"
"""Sync points of BML, in the order of the fields of `GestureMarks`."""


def write_marks(path: Path, table: MarkTable) -> None:
    """Write marks; the suffix says in which format, and only CSV takes several clips.

    Raises
    ------
    CharacterError
        If the format does not take them, or the file cannot be written.
    """
    suffix = path.suffix.lower()
    if suffix == ".csv":
        write_whole(path, _csv_text(table), CharacterError)
        return
    if len(table) != 1:
        raise CharacterError(f"{path}: it takes the marks of one recording; write a .csv file")
    (marks,) = table.values()
    root = _WRITERS[suffix](marks)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    write_whole(path, f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n', CharacterError)


def _csv_text(table: MarkTable) -> str:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["clip", *(names[0] for names in COLUMNS)])
    for name, marks in table.items():
        writer.writerows([name, *vars(each).values()] for each in marks)
    return text.getvalue()


def _tiers(marks: Sequence[GestureMarks]) -> dict[str, list[PhaseInterval]]:
    """Return a tier of the phases, and one of the apices."""
    return {
        "gesture phase": [part for each in marks for part in intervals_of(each)],
        "gesture apex": [
            PhaseInterval(each.stroke, each.stroke + APEX_S, "apex") for each in marks
        ],
    }


def _elan(marks: Sequence[GestureMarks]) -> Element:
    root = Element(
        "ANNOTATION_DOCUMENT",
        AUTHOR="cubeling",
        DATE="1970-01-01T00:00:00+00:00",  # of no clock: the same marks give the same file
        FORMAT="3.0",
        VERSION="3.0",
    )
    SubElement(root, "HEADER", MEDIA_FILE="", TIME_UNITS="milliseconds")
    order = SubElement(root, "TIME_ORDER")
    count = 0
    for name, intervals in _tiers(marks).items():
        tier = SubElement(root, "TIER", LINGUISTIC_TYPE_REF="phase", TIER_ID=name)
        for each in intervals:
            count += 1
            slots = {f"TIME_SLOT_REF{n}": f"ts{2 * count + n - 2}" for n in (1, 2)}
            for slot, time in zip(slots.values(), (each.start, each.end), strict=True):
                milliseconds = f"{1000 * time:.0f}"
                SubElement(order, "TIME_SLOT", TIME_SLOT_ID=slot, TIME_VALUE=milliseconds)
            note = SubElement(tier, "ANNOTATION")
            own = SubElement(note, "ALIGNABLE_ANNOTATION", {"ANNOTATION_ID": f"a{count}", **slots})
            SubElement(own, "ANNOTATION_VALUE").text = each.word
    SubElement(root, "LINGUISTIC_TYPE", LINGUISTIC_TYPE_ID="phase", TIME_ALIGNABLE="true")
    return root


def _anvil(marks: Sequence[GestureMarks]) -> Element:
    root = Element("annotation")
    body = SubElement(root, "body")
    for name, intervals in _tiers(marks).items():
        track = SubElement(body, "track", name=name, type="primary")
        for index, each in enumerate(intervals):
            times = {"start": f"{each.start:g}", "end": f"{each.end:g}"}
            own = SubElement(track, "el", {"index": str(index), **times})
            SubElement(own, "attribute", name="phase").text = each.word
    return root


def _bml(marks: Sequence[GestureMarks]) -> Element:
    root = Element("bml", xmlns="http://www.bml-initiative.org/bml/bml-1.0", id="marks")
    for number, each in enumerate(marks, 1):
        times = zip(SYNCS, vars(each).values(), strict=True)
        points = {sync: f"{time:g}" for sync, time in times if time is not None}
        SubElement(root, "gesture", {"id": f"gesture{number}", "lexeme": "BEAT", **points})
    return root


_WRITERS: dict[str, Callable[[Sequence[GestureMarks]], Element]] = {
    ".eaf": _elan,
    ".anvil": _anvil,
    ".bml": _bml,
}
