"""The values of a cube's file, each checked as it is read.

Raises TrackingError; `where` names the file in its message.
"""

from collections.abc import Sequence
from typing import Any

from cubeling.tracking.errors import TrackingError


def length(document: dict[str, Any], key: str, where: str) -> float:
    """Return a length of a table [mm]."""
    value = document.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 1 <= value <= 1000:
        raise TrackingError(f"{where}: '{key}' must be a length from 1 to 1000 mm, not {value!r}")
    return float(value)


def text(document: dict[str, Any], key: str, where: str, owner: str = "") -> str:
    """Return a line of text of a table; "" if it is absent."""
    value = document.get(key, "")
    if not isinstance(value, str) or not value.isprintable():
        raise TrackingError(f"{where}: {owner}'{key}' must be one line of text, not {value!r}")
    return value


def check_keys(table: dict[str, Any], known: Sequence[str], where: str) -> None:
    """Refuse a key that a table may not have."""
    unknown = [key for key in table if key not in known]
    if unknown:
        raise TrackingError(f"{where}: the key {unknown[0]!r} is not known; use {', '.join(known)}")


def check_each_once(values: Sequence[object], what: str, where: str) -> None:
    """Refuse a value that two faces have."""
    twice = [value for value in values if values.count(value) > 1]
    if twice:
        raise TrackingError(f"{where}: two faces have the {what} {twice[0]!r}; each must differ")
