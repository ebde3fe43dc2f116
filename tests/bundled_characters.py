"""The bundled characters, read once for all tests of a process.

They are never changed. `tests/characters/formats` reads their files.
"""

import functools
from collections.abc import Iterator
from pathlib import Path

import pytest

from cubeling.characters import Character

BUNDLED = Character.bundled()
"""Their names."""

_read = Character.load


@functools.cache
def bundled_character(name: str) -> Character:
    """Return a bundled character, the same one every time."""
    return _read(name)


@pytest.fixture(scope="module", autouse=True)
def bundled_characters_are_read_once() -> Iterator[None]:
    """Let all tests of a module share the characters, instead of reading them each time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Character, "load", staticmethod(_read_once))
        yield


def _read_once(name_or_path: str | Path) -> Character:
    return bundled_character(str(name_or_path)) if name_or_path in BUNDLED else _read(name_or_path)
