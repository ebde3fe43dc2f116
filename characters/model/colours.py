"""Other colours for a character, so that two of one file are told apart: hair, cloth, shoes."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Array

MAX_COLOUR_DISTANCE = 0.012
"""Largest distance of a linear colour from one that is exchanged: written in two digits a channel
it is at most 0.008 off, and the human's iris is 0.02 from its hair."""

MOST_NAMED = 8
"""Of a character's colours so many are named, those of the largest parts."""


def colours_of(text: str) -> dict[str, str]:
    """Return which colours another one takes the place of, as `#7c391d=#b9b3a8 #12b3b3=#7a1f33`.

    Raises
    ------
    CharacterError
        It is written in another way.
    """
    pairs = text.split()
    found = dict(pair.lower().split("=", 1) for pair in pairs if "=" in pair)
    if len(found) != len(pairs) or not all(
        re.fullmatch("#[0-9a-f]{6}", each) for pair in found.items() for each in pair
    ):
        raise CharacterError(f"'{text:.60}' are no colours; write #7c391d=#b9b3a8")
    return found


def with_colours(character: Character, exchanged: Mapping[str, str]) -> Character:
    """Return a character with other colours where it has some, by `colours_of`.

    A texture is multiplied by what takes the place of its mesh's colour, #ffffff if it has none.

    Raises
    ------
    CharacterError
        It has not one of the colours; the message names those that it has.
    """
    meshes = []
    missing = set(exchanged)
    for mesh in character.meshes:
        base = np.array(mesh.material.base_color[:3])
        colours = np.ones((len(mesh.positions), 4)) if mesh.colors is None else mesh.colors
        shown, new = colours[:, :3] * base, np.array(colours, np.float32)
        for old, other in exchanged.items():
            alike = np.linalg.norm(shown - _linear(old), axis=1) < MAX_COLOUR_DISTANCE
            if alike.any():
                missing.discard(old)
                new[alike, :3] = _linear(other) / np.maximum(base, 1e-6)
        meshes.append(replace(mesh, colors=new) if (new != colours).any() else mesh)
    if missing:
        known = ", ".join(_named(character.meshes))
        raise CharacterError(f"{character.name} has no {min(missing)}; it has {known}")
    return replace(character, meshes=tuple(meshes))


def _linear(code: str) -> Array:
    """Return a colour as linear RGB (IEC 61966-2-1)."""
    value = np.array([int(code[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.asarray(np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4))


def _code(linear: Array) -> str:
    value = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255 * each):02x}" for each in np.clip(value, 0.0, 1.0))


def _named(meshes: Iterable[Mesh]) -> list[str]:
    """Return the colours of most of a character, as they are written."""
    counts: Counter[str] = Counter()
    for mesh in meshes:
        base = np.array(mesh.material.base_color[:3])
        own = np.ones((len(mesh.positions), 3)) if mesh.colors is None else mesh.colors[:, :3]
        found, numbers = np.unique(own * base, axis=0, return_counts=True)
        for colour, number in zip(found, numbers, strict=True):
            counts[_code(colour)] += int(number)
    return [code for code, _ in counts.most_common(MOST_NAMED)]
