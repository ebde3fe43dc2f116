"""Files of gestures: one TOML file a gesture.

    name = "POINT_UP"
    summary = "Up there"
    one_handed = true

    [[right]]
    at = 1.0
    shape = "point"
    fingers = "up"
    place = { x = "XP", y = "YUpperEP", z = "ZFar" }

What a file leaves out is as in `SymbolicGesture`, `HandKey`, `BodyKey` and `Place`.
"""

import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from cubeling.characters.behaviour.gestures.checking import MAX_KEYS, check_gesture
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture
from cubeling.characters.errors import CharacterError
from cubeling.files import whole_file
from cubeling.toml_file import MAX_LONG_FILE_BYTES, TomlTable, read, toml_kind

GESTURE_SUFFIX = ".toml"
"""Suffix of files of gestures."""

GESTURE_FILE = toml_kind(
    "gesture",
    CharacterError,
    "cubeling.characters.behaviour.gestures.files:load_gesture",
    MAX_LONG_FILE_BYTES,
)
"""The file of a gesture."""

_KEY_LISTS = ("right", "left", "body")


def load_gesture(path: Path) -> SymbolicGesture:
    """Read a gesture; a file without a name is named after itself.

    Raises
    ------
    CharacterError
        If it cannot be read, or is no gesture.
    """
    content = {"name": path.stem.upper(), **read(path, GESTURE_FILE)}
    gesture = TomlTable(content, str(path), error=CharacterError, most=MAX_KEYS).fill(
        SymbolicGesture
    )
    try:
        check_gesture(gesture)
    except CharacterError as error:
        raise CharacterError(f"{path}: {error}") from None
    return gesture


def save_gesture(gesture: SymbolicGesture, path: Path) -> None:
    """Write a gesture, whole or not at all; `load_gesture` gives the same back.

    Raises
    ------
    CharacterError
        If it is no gesture that can be performed, or the file cannot be written.
    """
    check_gesture(gesture)
    with whole_file(path, CharacterError) as partial:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_text("\n".join(_lines(gesture)) + "\n", encoding="utf-8")


def _lines(gesture: SymbolicGesture) -> Iterator[str]:
    """Yield the lines of a file: only what is not as by default."""
    yield f"name = {_value(gesture.name)}"
    yield from _fields(gesture, SymbolicGesture(""), ("name", *_KEY_LISTS))
    for kind in _KEY_LISTS:
        for key in getattr(gesture, kind):
            yield from ("", f"[[{kind}]]", f"at = {_value(key.at)}")
            yield from _fields(key, type(key)(0.0), ("at",))


def _fields(own: Any, usual: Any, without: tuple[str, ...]) -> Iterator[str]:
    changed = [
        (field.name, getattr(own, field.name), getattr(usual, field.name))
        for field in fields(own)
        if field.name not in without and getattr(own, field.name) != getattr(usual, field.name)
    ]
    for name, value, default in changed:
        if is_dataclass(value):
            inner = ", ".join(_fields(value, default, ()))
            yield f"{name} = {{ {inner} }}"
        else:
            yield f"{name} = {_value(value)}"


def _value(value: Any) -> str:
    """Return a value as TOML; JSON writes texts as it does, but for the character DEL."""
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
