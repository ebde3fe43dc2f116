"""What people say of a session: who played, under which condition, and which moments matter.

It is given at the start, or later in a file beside the recording, which stays as it was.
"""

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.files import is_there, write_whole
from cubeling.toml_file import TomlTable, read, toml_kind

LABELS_FILE = toml_kind("labels", AppError, "cubeling.app.session.labels:read_labels", 1_000_000)
"""The file beside a session: `anna.labels.toml` for `anna.mcap`."""

MAX_MARKS = 10_000
"""Most marks in such a file."""

MAX_LABEL_CHARS = 64
"""Longest participant code or condition."""

LABEL_NAMES = ("participant", "condition", "notes")
"""What a session is labelled with, besides marks."""

_MARK = re.compile(r"mark (\d+)(?:: (.*))?")
_CODE = re.compile(r"\w[\w.+-]*( [\w.+-]+)*")


@dataclass(frozen=True)
class Mark:
    """A moment that somebody marked."""

    at_s: float
    """When, from the session's first frame [s]."""

    kind: str = ""
    """Its type: the digit that was pressed, or the word before a colon; "" for none."""

    name: str = ""
    """What it is; "" where nobody said."""

    @classmethod
    def of(cls, at_s: float, text: str) -> "Mark":
        """Return the mark that a text names.

        >>> Mark.of(1.5, "error: the cube fell"), Mark.of(2.0, "7").kind
        (Mark(at_s=1.5, kind='error', name='the cube fell'), '7')
        """
        kind, colon, name = text.partition(":")
        if colon:
            return cls(at_s, kind.strip(), name.strip())
        return cls(at_s, text, "") if text.isdigit() else cls(at_s, "", text.strip())

    @property
    def words(self) -> str:
        """Its type and what it is, as `of` takes them; "marked" without either.

        >>> Mark(1.5, "error", "the cube fell").words
        'error: the cube fell'
        """
        return ": ".join(filter(None, (self.kind, self.name))) or "marked"


@dataclass(frozen=True)
class SessionLabels:
    """Who played a session, and under which condition."""

    participant: str = ""
    """A code, never a name; "" where nobody said."""

    condition: str = ""
    """The condition of the study; "" for none."""

    notes: str = ""
    """What the experimenter noted."""

    marks: tuple[Mark, ...] = ()
    """Moments that were marked after the session."""

    def __post_init__(self) -> None:
        check_participant(self.participant)
        condition = self.condition
        if len(condition) > MAX_LABEL_CHARS or not condition.isprintable():
            raise AppError(
                f"the condition {condition[:MAX_LABEL_CHARS]!r} must be one line of at most "
                f"{MAX_LABEL_CHARS} characters"
            )


def check_participant(code: str) -> None:
    """Refuse a code that could not stand in the name of a file; "" is none."""
    if code and (len(code) > MAX_LABEL_CHARS or not _CODE.fullmatch(code)):
        raise AppError(
            f"the participant {code[:MAX_LABEL_CHARS]!r} must be a short code: letters, digits and "
            f"characters of . _ + -, at most {MAX_LABEL_CHARS}"
        )


def labels_path(session: Path) -> Path:
    """Return where the labels of a session are that were given later.

    >>> labels_path(Path("study/anna.mcap")).as_posix()
    'study/anna.labels.toml'
    """
    return session.with_suffix(".labels.toml")


def read_labels(path: Path) -> SessionLabels:
    """Read a file of labels; raises AppError for what is no such file."""
    return TomlTable(read(path, LABELS_FILE), str(path), "", AppError, MAX_MARKS).fill(
        SessionLabels
    )


def corrected_labels(session: Path, recorded: SessionLabels) -> SessionLabels:
    """Return the labels of a session: those beside it, else those that were recorded."""
    path = labels_path(session)
    return read_labels(path) if is_there(path) else recorded


def write_labels(session: Path, labels: SessionLabels) -> Path:
    """Write the labels beside a session, and return their file; the session stays as it is."""
    path = labels_path(session)
    lines = [
        f"{name} = {json.dumps(getattr(labels, name), ensure_ascii=False)}" for name in LABEL_NAMES
    ]
    for mark in sorted(labels.marks, key=lambda each: each.at_s):
        words = (
            f"{name} = {json.dumps(getattr(mark, name), ensure_ascii=False)}"
            for name in ("kind", "name")
        )
        lines += ["", "[[marks]]", f"at_s = {float(mark.at_s)!r}", *words]
    write_whole(path, "\n".join(lines) + "\n", AppError)
    return path


def recorded_marks(events: Iterable[tuple[float, str]], first: float) -> tuple[Mark, ...]:
    """Return the marks among events, by their numbers.

    A mark is recorded when the key is pressed, and once more when it has got a name; `first` is the
    time of the first frame [s].

    >>> recorded_marks([(3.0, "mark 1"), (4.0, "lifted"), (3.0, "mark 1: error: fell")], 1.0)
    (Mark(at_s=2.0, kind='error', name='fell'),)
    """
    marks: dict[str, Mark] = {}
    for time, event in events:
        if found := _MARK.fullmatch(event):
            marks[found[1]] = Mark.of(time - first, found[2] or "")
    return tuple(marks.values())


def with_mark(labels: SessionLabels, text: str, duration: float) -> SessionLabels:
    """Return labels with one more mark, from "SECONDS NAME" or "SECONDS TYPE: NAME".

    Raises AppError if it does not begin with a time within the session.
    """
    seconds, _, name = text.partition(" ")
    try:
        at_s = float(seconds)
    except ValueError:
        raise AppError(
            f"a mark is SECONDS and a name, as '12.5 error: fell', not {text!r}"
        ) from None
    if not 0.0 <= at_s <= duration:
        raise AppError(f"a mark at {at_s:g} s is outside the session, which lasts {duration:.1f} s")
    return replace(labels, marks=(*labels.marks, Mark.of(at_s, name.strip())))
