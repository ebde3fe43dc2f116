"""What differs between two sessions: what was played, their figures, and their channels."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from cubeling.app.session import SessionFile
from cubeling.app.session.encoding import upgrade

UNCOMPARED_KEYS = ("session", "bytes", "channels")
"""Keys of the figures that differ between any two files, or are compared by themselves."""

MAX_SHOWN_ENTRIES = 12
"""A list with more entries is one value, of which their number is shown."""

MAX_SHOWN_CHARS = 48
"""Longest value that is shown whole."""


@dataclass(frozen=True)
class Difference:
    """Something that is not the same in both sessions."""

    what: str
    """A figure, or a channel."""

    first: str
    second: str
    """What it is in each."""


def figure_differences(first: dict[str, Any], second: dict[str, Any]) -> Iterator[Difference]:
    """Yield which figures differ, by `document_of` of both sessions."""
    one, other = _flat(first), _flat(second)
    for key in dict.fromkeys((*one, *other)):
        if one.get(key) != other.get(key):
            yield Difference(key, _shown(one.get(key)), _shown(other.get(key)))


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
                    ended = "ends", "goes on"
                    yield Difference(
                        f"{topic} from {time - start:.3f} s",
                        ended[mine is not None],
                        ended[theirs is not None],
                    )
                    break
                if upgrade(topic, mine[2]) != upgrade(topic, theirs[2]):
                    yield Difference(f"{topic} from {time - start:.3f} s", "differs", "differs")
                    break


def _topics(session: SessionFile) -> set[str]:
    return {topic for topic, _, _ in session.messages()}


def _flat(document: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Return nested tables and short lists as one, "tracking.found_share", "states[1].what"."""
    flat: dict[str, Any] = {}
    for key, value in document.items():
        if not before and key in UNCOMPARED_KEYS:
            continue
        name = f"{before}{key}"
        if isinstance(value, list) and len(value) <= MAX_SHOWN_ENTRIES:
            parts = {f"{name}[{place}]": each for place, each in enumerate(value)}
        else:
            parts = {name: value}
        for part, each in parts.items():
            flat |= _flat(each, f"{part}.") if isinstance(each, dict) else {part: each}
    return flat


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return f"{len(value)} entries"
    text = "–" if value in (None, "") else " ".join(str(value).split())
    return text if len(text) <= MAX_SHOWN_CHARS else f"{text[:MAX_SHOWN_CHARS]}…"
