"""What differs between two sessions: what was played, their figures, and their channels."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from cubeling.app.session import SessionFile
from cubeling.app.session.encoding import upgrade
from cubeling.app.workshop.inspecting.figures import SessionFigures
from cubeling.app.workshop.inspecting.summary import lines_of

NAMED_LINES = ("session",)
"""Lines of a summary that differ between any two files."""

PLAYED_WORDS = {
    "others": "others of the cast",
    "character_sha256": "files of the characters",
    "turns": "turns to the greatest intensity",
    "cube_folded": "cube as folded",
    "driver": "robot's protocol",
    "seeds": "seeds of chance",
    "version": "version of Cubeling",
}
"""The keys of what was played in words, where they are none."""

MAX_SHOWN_CHARS = 240
"""Longest value that is shown whole."""


@dataclass(frozen=True)
class Difference:
    """Something that is not the same in both sessions."""

    what: str
    """A figure, or a channel."""

    first: str
    second: str
    """What it is in each."""


def figure_differences(first: SessionFigures, second: SessionFigures) -> Iterator[Difference]:
    """Yield which lines of their summaries differ, and what else was played differently."""
    yield from _differences(dict(lines_of(first)), dict(lines_of(second)), NAMED_LINES)
    # The summaries have said these.
    said = "scenario", "character", "personality"
    yield from _differences(_played(first), _played(second), said)
    begun = "begun (UTC)"
    yield from _differences({begun: first.info.clock_zero}, {begun: second.info.clock_zero})


def _played(figures: SessionFigures) -> dict[str, str]:
    return {PLAYED_WORDS.get(name, name): value for name, value in figures.played.items()}


def channel_differences(
    first: Path, second: Path, *, salvage: bool = False
) -> Iterator[Difference]:
    """Yield which channels differ, and from when on [s]; raises AppError if one is no session.

    Messages that older versions wrote are compared as this one writes them. Times are those of the
    first session's first frame.
    """
    with SessionFile(first, salvage=salvage) as one, SessionFile(second, salvage=salvage) as other:
        topics = sorted({*_topics(one), *_topics(other)})
        for topic in topics:
            pairs = zip_longest(one.messages(topic), other.messages(topic))
            start: float | None = None
            for mine, theirs in pairs:
                time = (mine or theirs)[1]
                start = time if start is None else start
                if mine is None or theirs is None:
                    ended = f"ends before {time - start:.3f} s", "goes on"
                    yield Difference(topic, ended[mine is not None], ended[theirs is not None])
                    break
                data = upgrade(topic, mine[2]), upgrade(topic, theirs[2])
                if data[0] != data[1]:
                    shown = _first_difference(*data)
                    at = f"at {time - start:.3f} s"
                    yield Difference(topic, *(f"{at}: {each}" for each in shown))
                    break


def _topics(session: SessionFile) -> set[str]:
    return {topic for topic, _, _ in session.messages()}


def _differences(
    first: Mapping[str, str], second: Mapping[str, str], leave_out: tuple[str, ...] = ()
) -> Iterator[Difference]:
    for word in dict.fromkeys((*first, *second)):
        one, other = first.get(word, ""), second.get(word, "")
        if one != other and word not in leave_out:
            is_json = one[:1] in ("{", "[") and other[:1] in ("{", "[")
            parts = _first_difference(one, other) if is_json else (_shown(one), _shown(other))
            yield Difference(word, *parts)


def _first_difference(first: str | bytes, second: str | bytes) -> tuple[str, str]:
    """Return what two documents say differently first: "visible: no", or how long they are."""
    try:
        one, other = _leaves(json.loads(first)), _leaves(json.loads(second))
    except ValueError:
        return f"{len(first):,} bytes", f"{len(second):,} other bytes"
    for key in dict.fromkeys((*one, *other)):
        if one.get(key) != other.get(key):
            return f"{key}: {_shown(one.get(key))}", f"{key}: {_shown(other.get(key))}"
    return "written in one way", "written in another way"


def _leaves(value: Any, before: str = "") -> dict[str, Any]:
    """Return the values in nested tables and lists by the words that lead to them."""
    if isinstance(value, dict):
        parts = list(value.items())
    elif isinstance(value, list):
        parts = [(str(place), each) for place, each in enumerate(value, 1)]
    else:
        return {before or "value": value}
    found: dict[str, Any] = {}
    for key, each in parts:
        found |= _leaves(each, f"{before} {key}".strip().replace("_", " "))
    return found


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    text = "–" if value in (None, "") else " ".join(str(value).split())
    return text if len(text) <= MAX_SHOWN_CHARS else f"{text[:MAX_SHOWN_CHARS]}…"
