"""The sidecar file of a character, `fox.toml` for `fox.glb`: parts, motions, springs, face."""

import difflib
import os
import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.face_maps import FaceTable, read_face_table
from cubeling.characters.model.files import read_file
from cubeling.characters.model.springs import SpringGroup, read_spring_groups
from cubeling.characters.motion.trees.plan import Plan
from cubeling.characters.motion.trees.reading import PLAN_TABLES, read_plan
from cubeling.characters.skeleton.anatomy import BODY_PARTS

_MAX_BYTES = 1_000_000  # larger files are not written by hand


_TABLES = ("joints", "body", "springs", "face", *PLAN_TABLES)

BODY_LAYERS = ("dependent_joints", "self_collision")
"""Layers that the table [body] switches on; `cubeling.characters.control.layers` makes them."""


@dataclass(frozen=True)
class Sidecar:
    """What a file beside a character says of it."""

    joints: Mapping[str, str]
    """Joint by body part, as in `Character.semantics`."""

    plan: Plan | None
    """How its motions are combined."""

    body_layers: tuple[str, ...]
    """Which of `BODY_LAYERS` it has."""

    springs: tuple[SpringGroup, ...] = ()
    """Joints that swing after the body."""

    face: FaceTable | None = None
    """Wrinkles and blood of its face."""


def read_sidecar(path: Path, clips: Collection[str]) -> Sidecar:
    """Return what the file of a character says; one that does not exist is empty.

    `clips` are the names of the character's clips.
    """
    document = _document(path)
    for key in document:
        if key not in _TABLES:
            tables = ", ".join(_TABLES)
            raise CharacterError(f"{path}: [{key}] is not a known table; there are {tables}")
    joints = document.get("joints", {})
    if not isinstance(joints, dict) or not all(isinstance(j, str) for j in joints.values()):
        raise CharacterError(f'{path}: joints: write part = "name of a joint"')
    for part in joints:
        if part not in BODY_PARTS:
            near = difflib.get_close_matches(part, BODY_PARTS, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise CharacterError(f"{path}: joints.{part}: not a body part{hint}")
    body = document.get("body", {})
    for name, value in body.items() if isinstance(body, dict) else [("", None)]:
        if name not in BODY_LAYERS or not isinstance(value, bool):
            known = " and ".join(f"{each} = true" for each in BODY_LAYERS)
            raise CharacterError(f"{path}: body.{name}: the table [body] may have {known}")
    layers = tuple(name for name in BODY_LAYERS if body.get(name))
    plan = read_plan(document, str(path), clips)
    springs = read_spring_groups(document, str(path))
    return Sidecar(joints, plan, layers, springs, read_face_table(document, path))


def _document(path: Path) -> dict[str, Any]:
    if not os.path.exists(path):
        return {}
    try:
        return tomllib.loads(read_file(path, _MAX_BYTES).decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:  # not TOML, not UTF-8, or nested too deeply
        raise CharacterError(f"{path}: not TOML ({error}); correct that line") from None
