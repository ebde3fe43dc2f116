"""The bundled characters, read once for all tests of a process.

They are never changed. `tests/characters/formats` reads their files. Their levels of detail are
computed once as well, also for others with the same meshes: that takes half of the first picture of
a character.
"""

import functools
import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.characters import Character
from cubeling.characters.rendering.geometry import detail_levels
from cubeling.characters.rendering.geometry.edge_collapse import Tolerance, collapsed_levels

BUNDLED = Character.bundled_names()
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
        patch.setattr(detail_levels, "collapsed_levels", _collapsed_once)
        yield


def _read_once(name_or_path: str | Path) -> Character:
    return bundled_character(str(name_or_path)) if name_or_path in BUNDLED else _read(name_or_path)


_levels: dict[bytes, list[NDArray[np.intp]]] = {}


def _collapsed_once(
    positions: NDArray[np.float32],
    features: NDArray[Any],
    triangles: NDArray[np.intp],
    tolerances: Sequence[Tolerance],
) -> list[NDArray[np.intp]]:
    """Return what `collapsed_levels` does, the same arrays for the same vertices."""
    key = hashlib.blake2b(repr(tolerances).encode())
    for array in (positions, features, triangles):
        key.update(repr((array.shape, array.dtype)).encode())
        key.update(np.ascontiguousarray(array).tobytes())
    if key.digest() not in _levels:
        levels = collapsed_levels(positions, features, triangles, tolerances)
        for level in levels:
            level.setflags(write=False)
        _levels[key.digest()] = levels
    return _levels[key.digest()]
