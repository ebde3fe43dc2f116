"""The morphs of a face that speaks: expressions, visemes, and what they are made of."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

_Face = TypeVar("_Face", bound=Any)

DIVIDED = ("happy", "angry", "sad", "surprised", "relaxed")
"""The expressions whose mouth is a morph by itself, so that it can give way to speech."""


def all_morphs(
    neutral: _Face,
    moods: Mapping[str, _Face],
    visemes: Mapping[str, _Face],
    parts: Mapping[str, _Face],
) -> dict[str, _Face]:
    """Return every morph: expressions, visemes, mouths of the expressions alone, parts of the face.

    Faces are dataclasses of parameters, those of the mouth last, from `width` on. New morphs come
    last, since clips and recordings refer to them by number.
    """
    return {
        **moods,
        **{f"viseme_{name}": shape for name, shape in visemes.items()},
        **{f"{name}Mouth": _mouth_of(moods[name], neutral) for name in DIVIDED},
        **parts,
    }


def _mouth_of(face: _Face, neutral: _Face) -> _Face:
    """Return the mouth of an expression, with eyes, brows and cheeks at rest."""
    names = [field.name for field in fields(face)]
    mouth = {name: getattr(face, name) for name in names[names.index("width") :]}
    return replace(neutral, **mouth | {"cheeks": neutral.cheeks})
