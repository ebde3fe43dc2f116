"""What moves after the body in our own files: spring bones, constraints, and how eyes follow.

They are written as extras, since VRM's extensions need a whole humanoid, and chains with an end.
"""

from dataclasses import asdict, replace
from typing import Any, get_args

from cubeling.characters.formats.gltf.document import (
    REAL,
    TEXT,
    VECTOR,
    DamagedFileError,
    Json,
    check,
    error_context,
)
from cubeling.characters.model.character import Character
from cubeling.characters.model.constraints import ConstraintKind, JointConstraint, constraint_levels
from cubeling.characters.model.look_at import LookAt, RangeMap
from cubeling.characters.model.springs import SpringBone, SpringCollider

EXTRA = "cubelingFollowers"
"""Name of the extra of the scene."""

_RANGE = {"greatest!": REAL, "output!": REAL}
_SCHEMA: Json = {
    "springs": [
        {
            "joint!": TEXT,
            "tail!": VECTOR,
            "stiffness!": REAL,
            "drag!": REAL,
            "gravity!": VECTOR,
            "radius!": REAL,
            "colliders!": [{"joint!": TEXT, "start!": VECTOR, "end!": VECTOR, "radius!": REAL}],
            "center": TEXT,
            "wind!": REAL,
        }
    ],
    "constraints": [
        {"kind!": TEXT, "joint!": TEXT, "source!": TEXT, "axis!": VECTOR, "weight!": REAL}
    ],
    "look_at": {
        "by!": TEXT,
        **{f"{name}!": _RANGE for name in ("inner", "outer", "down", "up")},
        "eye_offset": VECTOR,
    },
}


def followers_of(character: Character) -> Json:
    """Return the extra of a character; empty if nothing follows its body."""
    followers = {
        "springs": [_without_none(asdict(bone)) for bone in character.springs],
        "constraints": [_without_none(asdict(each)) for each in character.constraints],
        "look_at": None if character.look_at is None else _without_none(asdict(character.look_at)),
    }
    return {name: value for name, value in followers.items() if value}


def with_followers(character: Character, extra: object) -> Character:
    """Return a character with what an extra states."""
    with error_context(EXTRA):
        check(extra, _SCHEMA, EXTRA)
        assert isinstance(extra, dict)
        constraints = tuple(
            JointConstraint(**_with_tuples(each)) for each in extra.get("constraints", ())
        )
        springs = tuple(_spring(each) for each in extra.get("springs", ()))
        _check_names(character, springs, constraints)
        constraint_levels(character.skeleton, constraints)
        return replace(
            character,
            springs=springs or character.springs,
            constraints=constraints or character.constraints,
            look_at=_look_at(extra["look_at"]) if "look_at" in extra else character.look_at,
        )


def _spring(stated: Json) -> SpringBone:
    if not any(stated["tail"]) or not 0.0 <= stated["drag"] <= 1.0:
        raise DamagedFileError(
            f"the spring bone {stated['joint']!r:.40} has no length, or gains speed"
        )
    colliders = tuple(SpringCollider(**_with_tuples(each)) for each in stated["colliders"])
    return SpringBone(**_with_tuples(stated) | {"colliders": colliders})


def _look_at(stated: Json) -> LookAt:
    maps = {name: RangeMap(**stated[name]) for name in ("inner", "outer", "down", "up")}
    if stated["by"] not in ("bone", "expression") or min(m.greatest for m in maps.values()) <= 0:
        raise DamagedFileError("look_at is by neither bone nor expression, or has no range")
    return LookAt(**_with_tuples(stated) | maps)


def _check_names(
    character: Character,
    springs: tuple[SpringBone, ...],
    constraints: tuple[JointConstraint, ...],
) -> None:
    named = {bone.joint for bone in springs} | {c.joint for b in springs for c in b.colliders}
    named |= {bone.center for bone in springs if bone.center is not None}
    named |= {name for each in constraints for name in (each.joint, each.source)}
    unknown = named - set(character.skeleton.names)
    if unknown:
        raise DamagedFileError(f"has no joint {min(unknown)!r:.40}")
    turned = [bone.joint for bone in springs]
    if len(set(turned)) < len(turned):
        raise DamagedFileError("a joint has two spring bones")
    for each in constraints:
        if each.kind not in get_args(ConstraintKind):
            raise DamagedFileError(f"{each.kind!r:.20} is no constraint")


def _without_none(values: Json) -> Json:
    """Return the members that are not None; JSON makes lists of tuples by itself."""
    return {name: value for name, value in values.items() if value is not None}


def _with_tuples(stated: Json) -> dict[str, Any]:
    known = {name: value for name, value in stated.items() if value is not None}
    return {name: tuple(v) if isinstance(v, list) else v for name, v in known.items()}
