"""The sidecar file of a character, `fox.toml` for `fox.glb`: parts, motions, springs, face."""

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.face_maps import FaceTable, read_face_table
from cubeling.characters.model.springs import SpringGroup, read_spring_groups
from cubeling.characters.motion.trees.plan import Plan
from cubeling.characters.motion.trees.reading import PLAN_TABLES, read_plan
from cubeling.characters.skeleton.anatomy import BODY_PARTS
from cubeling.characters.synthesis.idle.pauses import PauseLaw
from cubeling.toml_file import MAX_LONG_FILE_BYTES, TomlTable, read, toml_kind

SIDECAR_FILE = toml_kind(
    "file beside the character",
    CharacterError,
    "cubeling.characters.model.sidecar:read_sidecar",
    MAX_LONG_FILE_BYTES,
)
"""The file of the same name beside a character, which adds to it."""

_MAX_ENTRIES = 1000  # a character has hundreds of joints

_TABLES = ("joints", "body", "springs", "face", "idle", *PLAN_TABLES)

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

    pauses: PauseLaw | None = None
    """How what it feels shortens its pauses between balance shifts; None as in the thesis."""


def read_sidecar(path: Path, clips: Collection[str] = ()) -> Sidecar:
    """Return what the file of a character says; one that does not exist is empty.

    `clips` are the names of the character's clips.
    """
    content = read(path, SIDECAR_FILE) if os.path.lexists(path) else {}
    file = TomlTable(content, str(path), error=CharacterError, most=_MAX_ENTRIES)
    file.only(*_TABLES)
    joints, body = file.table("joints", *BODY_PARTS), file.table("body", *BODY_LAYERS)
    return Sidecar(
        {part: joints.text(part) for part in joints},
        read_plan(file, clips),
        tuple(name for name in BODY_LAYERS if body.truth(name, False)),
        read_spring_groups(file),
        read_face_table(file, path.parent),
        file.table("idle").fill(PauseLaw) if "idle" in file else None,
    )
