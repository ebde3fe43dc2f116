"""Reading marked gestures: CSV, ELAN (.eaf), Anvil (.anvil), sync points of BML (.bml)."""

import csv
import io
import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.synthesis.gestures.intervals import PhaseInterval, gestures_of
from cubeling.characters.synthesis.gestures.marks import GestureMarks, MarkTable
from cubeling.characters.xml_elements import XmlElement, XmlLimits, read_xml
from cubeling.files import FileKind

MARKS_FILE = FileKind(
    "marks of gestures",
    (".csv", ".eaf", ".anvil", ".bml"),
    CharacterError,
    1 << 25,
    "cubeling.characters.synthesis.gestures.marks_files:read_marks",
)
"""Times of gestures that a person marked, or that were found."""

LIMITS = XmlLimits(bytes=1 << 25, elements=400_000, depth=60)
"""An hour of speech with ten tiers has 20,000 annotations."""

COLUMNS = (
    ("start_s", "start"),
    ("ready_s", "ready"),
    ("stroke_start_s", "strokestart"),
    ("emphasis_s", "stroke", "apex_s", "apex", "stroke_s"),
    ("stroke_end_s", "strokeend"),
    ("relax_s", "relax"),
    ("end_s", "end"),
)
"""Columns of CSV, of which the first is written, and sync points of BML in lower case."""

MAX_TIME_S = 1e6


def read_marks(path: str | Path) -> MarkTable:
    """Read marks of gestures; the suffix says in which format.

    Raises
    ------
    CharacterError
        If the file cannot be read, or has no gesture with a time.
    """
    text = MARKS_FILE.read(path)
    suffix = Path(path).suffix.lower()
    if suffix not in _READERS:
        known = ", ".join(MARKS_FILE.suffixes)
        raise CharacterError(f"{path}: marks of gestures are files with {known}")
    table: dict[str, list[GestureMarks]] = {}
    for name, marks in _READERS[suffix](text, Path(path)):
        table.setdefault(Path(name).stem, []).append(marks)
    if not table:
        raise CharacterError(f"{path}: no stroke of a gesture is marked in it")
    return table


def _read_csv(data: bytes, path: Path) -> Iterator[tuple[str, GestureMarks]]:
    try:
        rows = csv.reader(io.StringIO(data.decode("utf-8-sig"), newline=""))
        head = [cell.strip().lower() for cell in next(rows, [])]
        for row in rows:
            cells = dict(zip(head, row, strict=False))
            if any(map(str.strip, row)):
                place = f"{path}:{rows.line_num}"
                yield cells.get("clip") or path.stem, _marks(cells, place)
    except (UnicodeDecodeError, csv.Error):
        raise CharacterError(f"{path}: not a CSV file in UTF-8") from None


def _read_bml(data: bytes, path: Path) -> Iterator[tuple[str, GestureMarks]]:
    for each in _walk(_root(data, path)):
        points = {key.lower().replace("_", ""): value for key, value in each.attributes.items()}
        if "strokestart" in points and _number(points["strokestart"]) is not None:
            yield points.get("name", path.stem), _marks(points, f"{path}:{each.line}")


def _marks(cells: Mapping[str, str], place: str) -> GestureMarks:
    """Return the marks of a row, or of an element; what is not given lies where it can."""
    times: list[float | None] = []
    for names in COLUMNS:
        text = next((cells[name] for name in names if cells.get(name, "").strip()), None)
        time = None if text is None else _number(text)
        if text is not None and time is None:
            raise CharacterError(f"{place}: '{text[:40]}' is no time in seconds")
        times.append(time)
    start, ready, stroke_start, stroke, stroke_end, relax, end = times
    if stroke_start is None or stroke_end is None or not stroke_start < stroke_end:
        raise CharacterError(f"{place}: a gesture needs stroke_start_s before stroke_end_s")
    return GestureMarks(
        start,
        stroke_start if ready is None else ready,
        stroke_start,
        stroke_end if stroke is None else stroke,
        stroke_end,
        stroke_end if relax is None else relax,
        end,
    )


def _number(text: str) -> float | None:
    """Return a time [s], or None if the text is none."""
    try:
        time = float(text)
    except ValueError:
        return None
    return time if math.isfinite(time) and 0.0 <= time <= MAX_TIME_S else None


def _read_elan(data: bytes, path: Path) -> Iterator[tuple[str, GestureMarks]]:
    elements = [*_walk(_root(data, path))]
    slots = {
        each.attributes.get("TIME_SLOT_ID"): _number(each.attributes.get("TIME_VALUE", ""))
        for each in elements
        if each.tag == "TIME_SLOT"
    }
    times: dict[str, tuple[float, float]] = {}
    intervals = []
    for each in elements:
        own = each.attributes
        if each.tag == "ALIGNABLE_ANNOTATION":
            ends = slots.get(own.get("TIME_SLOT_REF1")), slots.get(own.get("TIME_SLOT_REF2"))
            if ends[0] is None or ends[1] is None:  # in ELAN a slot need not have a time
                continue
            times[own.get("ANNOTATION_ID", "")] = ends[0] / 1000.0, ends[1] / 1000.0
        elif each.tag != "REF_ANNOTATION" or own.get("ANNOTATION_REF", "") not in times:
            continue
        else:
            times[own.get("ANNOTATION_ID", "")] = times[own["ANNOTATION_REF"]]
        intervals.append(PhaseInterval(*times[own.get("ANNOTATION_ID", "")], each.text.strip()))
    return ((path.stem, marks) for marks in gestures_of(intervals))


def _read_anvil(data: bytes, path: Path) -> Iterator[tuple[str, GestureMarks]]:
    times: dict[tuple[str, str], tuple[float, float]] = {}
    intervals = []
    for track in (each for each in _walk(_root(data, path)) if each.tag == "track"):
        name, of = track.attributes.get("name", ""), track.attributes.get("ref", "")
        direct = track.attributes.get("type", "primary") == "primary"
        for element in (each for each in track.children if each.tag == "el"):
            first, last = (element.attributes.get(key, "") for key in ("start", "end"))
            ends: tuple[float | None, float | None] = _number(first), _number(last)
            if not direct:  # spans and singletons count the elements of another track
                only = element.attributes.get("ref", "")
                a, b = times.get((of, first or only)), times.get((of, last or only))
                ends = (a[0] if a else None), (b[1] if b else None)
            if ends[0] is None or ends[1] is None:
                continue
            times[name, element.attributes.get("index", "")] = ends[0], ends[1]
            intervals.append(PhaseInterval(ends[0], ends[1], element.text.strip()))
    return ((path.stem, marks) for marks in gestures_of(intervals))


def _root(data: bytes, path: Path) -> XmlElement:
    return read_xml(data, LIMITS, lambda line: f"{path}:{line}")


def _walk(element: XmlElement) -> Iterator[XmlElement]:
    """Yield an element and all that is inside, in the order of the document."""
    waiting = [element]
    while waiting:
        each = waiting.pop()
        yield each
        waiting += reversed(each.children)


_READERS: dict[str, Callable[[bytes, Path], Iterator[tuple[str, GestureMarks]]]] = {
    ".csv": _read_csv,
    ".eaf": _read_elan,
    ".anvil": _read_anvil,
    ".bml": _read_bml,
}
