"""How a message's content is written down once: its JSON, what is allowed, the document's table."""

import dataclasses
import json
import math
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from robot.errors import RobotError

PAYLOAD_BYTES = 4096
"""Largest payload that is sent or read [bytes]."""

TEXT_BYTES = 80
"""Longest text in a message [bytes of UTF-8]."""

COUNT_MAX = 2**53 - 1
"""Largest whole number: beyond it, JSON readers that know only doubles would lose bits."""

LIST_MAX = 32
"""Most entries of a list or a table in a message."""

M = TypeVar("M")


class MalformedError(RobotError):
    """A payload that says nothing valid; it is counted and left alone."""


@dataclasses.dataclass(frozen=True)
class Form:
    """What a value may be."""

    says: str
    """The same for a person: "number −1 … 1"."""

    read: Callable[[Any], Any]
    """Returns the value, or raises ValueError or TypeError."""


def _whole(low: int) -> Callable[[Any], int]:
    def read(value: Any) -> int:
        if type(value) is not int or not low <= value <= COUNT_MAX:
            raise ValueError
        return value

    return read


def _number(low: float, high: float) -> Callable[[Any], float]:
    def read(value: Any) -> float:
        if type(value) not in (int, float) or not low <= value <= high:  # refuses NaN too
            raise ValueError
        return float(value)

    return read


def _text(value: Any) -> str:
    if type(value) is not str or len(value.encode()) > TEXT_BYTES or not value.isprintable():
        raise ValueError
    return value


def _flag(value: Any) -> bool:
    if type(value) is not bool:
        raise ValueError
    return value


def _texts(value: Any) -> tuple[str, ...]:
    if type(value) is not list or len(value) > LIST_MAX:
        raise ValueError
    return tuple(_text(one) for one in value)


def _word(*words: str) -> Callable[[Any], str]:
    def read(value: Any) -> str:
        if value not in words:
            raise ValueError
        return str(value)

    return read


def _marks(value: Any) -> dict[str, tuple[int, int]]:
    if type(value) is not dict or len(value) > LIST_MAX:
        raise ValueError
    count = _whole(0)
    marks = {}
    for place, pair in value.items():
        if type(pair) is not list or len(pair) != 2:
            raise ValueError
        marks[_text(place)] = count(pair[0]), count(pair[1])
    return marks


def _point(value: Any) -> tuple[float, float]:
    if type(value) is not list or len(value) != 2:
        raise ValueError
    axis = _number(-1.0, 1.0)
    return axis(value[0]), axis(value[1])


COUNT = Form("whole number ≥ 0", _whole(0))
SERIAL = Form("whole number ≥ 1", _whole(1))
UNIT = Form("number −1 … 1", _number(-1.0, 1.0))
SHARE = Form("number 0 … 1", _number(0.0, 1.0))
SECONDS = Form("number ≥ 0 [s]", _number(0.0, math.inf))
TEXT = Form(f"text, ≤ {TEXT_BYTES} bytes", _text)
FLAG = Form("true or false", _flag)
TEXTS = Form(f"list of ≤ {LIST_MAX} texts", _texts)
PRESENCE = Form('"online", "lost" or "closed"', _word("online", "lost", "closed"))
MARKS = Form(f"table of ≤ {LIST_MAX}: SITE/NAME to [session, number]", _marks)
POINT = Form("[valence, arousal], each −1 … 1", _point)


def entry(form: Form, meaning: str, default: Any = dataclasses.MISSING) -> Any:
    """Declare a field: what it may be and what it means; without a default it must be there.

    A field whose default is None may also be null.
    """
    return dataclasses.field(default=default, metadata={"form": form, "meaning": meaning})


def decode(kind: type[M], payload: bytes) -> M:
    """Read a payload. What is not known in it is skipped: a later version has added it.

    Raises
    ------
    MalformedError
        If it is too long, no JSON object, or lacks a field or has one that is not allowed.
    """
    if len(payload) > PAYLOAD_BYTES:
        raise MalformedError(f"{len(payload)} bytes; a message has at most {PAYLOAD_BYTES}")
    try:
        document = json.loads(payload)
    except (ValueError, RecursionError) as error:
        raise MalformedError("no JSON") from error
    if not isinstance(document, dict):
        raise MalformedError("no JSON object")
    return kind(**_read(kind, document))


def _read(kind: type[Any], document: Mapping[str, Any]) -> dict[str, Any]:
    values = {}
    for field in dataclasses.fields(kind):
        value = document.get(field.name)
        if value is None:
            if field.default is dataclasses.MISSING:
                raise MalformedError(f"{field.name} is missing")
            continue
        try:
            values[field.name] = field.metadata["form"].read(value)
        except (ValueError, TypeError) as error:
            form = field.metadata["form"].says
            raise MalformedError(f"{field.name} must be a {form}") from error
    return values


def encode(message: Any) -> bytes:
    """Return a message's payload; fields that are None are left out."""
    document = {
        field.name: value
        for field in dataclasses.fields(message)
        if (value := getattr(message, field.name)) is not None
    }
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()


def table(kind: type[Any]) -> str:
    """Return the document's table of a message's fields."""
    rows = ["| field | form | meaning |", "|---|---|---|"]
    for field in dataclasses.fields(kind):
        form, meaning = field.metadata["form"].says, field.metadata["meaning"]
        optional = "" if field.default is dataclasses.MISSING else "; may be missing"
        rows.append(f"| `{field.name}` | {form}{optional} | {meaning} |")
    return "\n".join(rows)
