"""The times of dialects: durations, times before the start, marks that are not there."""

from collections.abc import Iterable, Sequence

from cubeling.characters.behaviour.bml.document import SYNC_NAMES, SYNCS
from cubeling.characters.behaviour.bml.parser import SECONDS, reference
from cubeling.characters.errors import CharacterError
from cubeling.characters.xml_elements import XmlElement

OLD_NAMES = {"stroke_start": "strokeStart", "stroke_end": "strokeEnd", "attack": "attackPeak"}
"""Sync points as they are written elsewhere."""

ALIKE = (
    ("start",),
    ("ready", "attackPeak", "strokeStart", "stroke"),
    ("stroke", "strokeStart", "attackPeak", "ready"),
    ("strokeStart", "stroke", "attackPeak", "ready"),
    ("attackPeak", "stroke", "ready"),
    ("strokeEnd", "relax", "end"),
    ("relax", "strokeEnd", "end"),
    ("end", "relax"),
)
"""For each sync point those that stand for it where a kind of behaviour has no such one."""

_ALIKE = {names[0]: names for names in ALIKE}


def mend_times(elements: Sequence[XmlElement], notes: list[tuple[int, str]]) -> None:
    """Write the times of behaviours as BML 1.0 does, and note what is changed.

    Numbers of which the end is before the start are durations, as in Greta's first BML: `end` and
    `stroke` then count from the start, in the whole document. If anything starts before the block,
    the block starts earlier: all numbers are later by that.
    """
    behaviours = [each for each in elements if not each.namespace]
    for each in behaviours:
        for old, new in OLD_NAMES.items():
            if old in each.attributes:
                each.attributes.setdefault(new, each.attributes.pop(old))
    _durations(behaviours, notes)
    _shift(behaviours, notes)
    kinds = {each.attributes["id"]: each for each in behaviours if each.attributes.get("id")}
    points = {name: _points(each) for name, each in kinds.items()}
    for each in behaviours:
        _references(each, points, notes)
        _own_points(each)


def _durations(behaviours: Iterable[XmlElement], notes: list[tuple[int, str]]) -> None:
    timed = [each for each in behaviours if _seconds(each, "start") is not None]
    short = [each for each in timed if _before(each, "end")]
    if short:
        notes.append((short[0].line, "ends before starts are durations, here and elsewhere"))
    for each in timed:
        start = _seconds(each, "start") or 0.0
        for sync in ("stroke", "end"):
            since = _seconds(each, sync)
            if since is not None and (short or (sync == "stroke" and since < start)):
                each.attributes[sync] = f"{start + since:g}"


def _shift(behaviours: Sequence[XmlElement], notes: list[tuple[int, str]]) -> None:
    first, earliest = None, 0.0
    for each in behaviours:
        for sync in SYNC_NAMES & each.attributes.keys():
            seconds = _seconds(each, sync)
            if seconds is not None and seconds < earliest:
                first, earliest = each, seconds
    for each in behaviours:
        timed = SYNC_NAMES & each.attributes.keys()
        if first is not None and not timed:
            each.attributes["start"] = f"{-earliest:g}"
        for sync in timed:
            seconds = _seconds(each, sync)
            if seconds is not None and first is not None:
                each.attributes[sync] = f"{seconds - earliest:g}"
            elif seconds == 0.0 and sync == "start" and len(timed) == 1:
                del each.attributes[sync]  # as early as it can: what refers to it may be earlier
    if first is not None:
        notes.append(
            (first.line, f"the block begins {-earliest:g} s early, with its first behaviour")
        )


def _points(element: XmlElement) -> tuple[str, ...]:
    """Return the sync points that a behaviour has; () if its kind is not known here."""
    known = SYNCS.get(element.tag, ())
    if element.tag != "speech":
        return known
    marks = [part.attributes["id"] for text in element.children for part in text.children]
    return (*known, *marks)


def _references(
    element: XmlElement, points: dict[str, tuple[str, ...]], notes: list[tuple[int, str]]
) -> None:
    """Let times refer to sync points that there are; forget those that refer to nothing."""
    seen = set[str]()
    for sync in sorted(SYNC_NAMES & element.attributes.keys(), key=list(_ALIKE).index):
        text = element.attributes[sync].strip()
        try:
            moment = reference(text)
        except CharacterError as error:
            notes.append((element.line, f"its {sync} is left out: {error}"))
            del element.attributes[sync]
            continue
        known = points.get(moment.behaviour, ())
        named = moment.sync
        if moment.behaviour and not moment.block and known and named not in known:
            named = next((each for each in _ALIKE.get(named, ()) if each in known), "")
        absent = moment.behaviour and not moment.block and moment.behaviour not in points
        if (moment.behaviour and not named) or absent:
            notes.append((element.line, f"its {sync} is left out: there is no {text[:80]}"))
            del element.attributes[sync]
        elif named != moment.sync:
            rest = text[text.index(moment.sync, text.index(":")) + len(moment.sync) :]
            element.attributes[sync] = f"{moment.behaviour}:{named}{rest}"
        if sync == "end" and element.attributes.get(sync) in seen:
            notes.append((element.line, "its end is left out: it is that of another of its times"))
            del element.attributes[sync]
        seen.add(element.attributes.get(sync, ""))


def _own_points(element: XmlElement) -> None:
    """Give times to the sync points that a behaviour of its kind has, instead of those alike."""
    known = SYNCS.get(element.tag)
    if known is None:
        return
    for sync in [each for each in SYNC_NAMES & element.attributes.keys() if each not in known]:
        text = element.attributes.pop(sync)
        own = next((each for each in _ALIKE[sync] if each in known), "")
        if own and element.tag != "speech":
            element.attributes.setdefault(own, text)


def _seconds(element: XmlElement, sync: str) -> float | None:
    text = element.attributes.get(sync, "")
    return float(text) if SECONDS.fullmatch(text) else None


def _before(element: XmlElement, sync: str) -> bool:
    start, end = _seconds(element, "start"), _seconds(element, sync)
    return start is not None and end is not None and end <= start and end > 0.0
