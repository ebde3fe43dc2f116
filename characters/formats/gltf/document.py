"""The JSON of a glTF, checked once against a schema so that readers can rely on it."""

import json
import struct
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

Json = dict[str, Any]
"""An object of the file, checked against `SCHEMA`."""


class DamagedFileError(ValueError):
    """A glTF file is invalid; the message lacks the name of the file."""


_INVALID_DATA = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, struct.error)
TEXT, REAL, COUNT, FLAG = "text", "a number", "a count", "true or false"
INTEGER = "a whole number"  # also an index that may be −1 for none, as VRM exporters write
_NUMBER_LISTS = {n: f"{n} numbers" for n in (2, 3, 4, 16)}
VECTOR = _NUMBER_LISTS[3]
_ANY_NUMBER_LIST = "numbers"

_TEXTURE = {
    "index!": "textures",
    "texCoord": COUNT,
    "scale": REAL,
    "extensions": {
        "KHR_texture_transform": {
            "offset": _NUMBER_LISTS[2],
            "rotation": REAL,
            "scale": _NUMBER_LISTS[2],
            "texCoord": COUNT,
        }
    },
}
_BINDS = {"index!": COUNT, "weight!": REAL}
_EXPRESSION = {"morphTargetBinds?": [{"node!": "nodes"} | _BINDS]}
_XYZ = {"x": REAL, "y": REAL, "z": REAL}
_SPHERE = {"offset": _NUMBER_LISTS[3], "radius": REAL}
_SPRING = {"stiffness": REAL, "gravityPower": REAL, "dragForce": REAL, "hitRadius": REAL}
_CONSTRAINT = {"source!": "nodes", "weight": REAL}
_RANGE = {"inputMaxValue": REAL, "outputScale": REAL}
_RANGE_0 = {"xRange": REAL, "yRange": REAL}
_SPARSE_PART = {"bufferView!": "bufferViews", "byteOffset": COUNT}

SCHEMA: Json = {
    "scenes": [{"nodes": ["nodes"]}],
    "nodes": [
        {
            "name": TEXT,
            "children": ["nodes"],
            "mesh": "meshes",
            "skin": "skins",
            "translation": _NUMBER_LISTS[3],
            "rotation": _NUMBER_LISTS[4],
            "scale": _NUMBER_LISTS[3],
            "matrix": _NUMBER_LISTS[16],
            "weights": _ANY_NUMBER_LIST,
            "extensions": {
                "VRMC_node_constraint?": {
                    "constraint!": {
                        "roll": _CONSTRAINT | {"rollAxis!": TEXT},
                        "aim": _CONSTRAINT | {"aimAxis!": TEXT},
                        "rotation": _CONSTRAINT,
                    }
                }
            },
        }
    ],
    "skins": [{"joints!": ["nodes"], "inverseBindMatrices": "accessors"}],
    "meshes": [
        {
            "name": TEXT,
            "weights": _ANY_NUMBER_LIST,
            "primitives!": [
                {
                    "attributes!": {"*": "accessors"},
                    "indices": "accessors",
                    "material": "materials",
                    "mode": COUNT,
                    "targets": [{"*": "accessors"}],
                    "extensions": {
                        "KHR_draco_mesh_compression": {
                            "bufferView!": "bufferViews",
                            "attributes!": {"*": COUNT},
                        }
                    },
                }
            ],
        }
    ],
    "accessors": [
        {
            "bufferView": "bufferViews",
            "byteOffset": COUNT,
            "componentType!": COUNT,
            "count!": COUNT,
            "type!": TEXT,
            "normalized": FLAG,
            "sparse": {
                "count!": COUNT,
                "indices!": _SPARSE_PART | {"componentType!": COUNT},
                "values!": _SPARSE_PART,
            },
        }
    ],
    "bufferViews": [
        {"buffer!": "buffers", "byteOffset": COUNT, "byteLength!": COUNT, "byteStride": COUNT}
    ],
    "buffers": [{"uri": TEXT, "byteLength!": COUNT}],
    "images": [{"uri": TEXT, "bufferView": "bufferViews", "name": TEXT}],
    "textures": [
        {
            "source": "images",
            "extensions": {
                "EXT_texture_webp": {"source": "images"},
                "KHR_texture_basisu": {"source": "images"},
            },
        }
    ],
    "materials": [
        {
            "name": TEXT,
            "pbrMetallicRoughness": {
                "baseColorFactor": _NUMBER_LISTS[4],
                "baseColorTexture": _TEXTURE,
                "metallicFactor": REAL,
                "roughnessFactor": REAL,
                "metallicRoughnessTexture": _TEXTURE,
            },
            "normalTexture": _TEXTURE,
            "emissiveTexture": _TEXTURE,
            "occlusionTexture": _TEXTURE | {"strength": REAL},
            "emissiveFactor": _NUMBER_LISTS[3],
            "alphaMode": TEXT,
            "alphaCutoff": REAL,
            "doubleSided": FLAG,
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": REAL},
                "VRMC_materials_mtoon?": {
                    "shadeColorFactor": _NUMBER_LISTS[3],
                    "shadeMultiplyTexture": _TEXTURE,
                    "shadingShiftFactor": REAL,
                    "shadingToonyFactor": REAL,
                    "giEqualizationFactor": REAL,
                },
            },
        }
    ],
    "animations": [
        {
            "name": TEXT,
            "samplers!": [{"input!": "accessors", "output!": "accessors", "interpolation": TEXT}],
            "channels!": [{"sampler!": COUNT, "target!": {"node": "nodes", "path!": TEXT}}],
        }
    ],
    "extensionsRequired": [TEXT],
    "extensions": {
        "VRMC_vrm": {
            "specVersion": TEXT,
            "humanoid": {"humanBones": {"*?": {"node!": "nodes"}}},
            "expressions?": {"preset": {"*?": _EXPRESSION}, "custom": {"*?": _EXPRESSION}},
            "lookAt?": {
                "type": TEXT,
                "offsetFromHeadBone": _NUMBER_LISTS[3],
                "rangeMapHorizontalInner": _RANGE,
                "rangeMapHorizontalOuter": _RANGE,
                "rangeMapVerticalDown": _RANGE,
                "rangeMapVerticalUp": _RANGE,
            },
        },
        "VRMC_vrm_animation": {
            "specVersion": TEXT,
            "humanoid": {"humanBones": {"*": {"node!": "nodes"}}},
        },
        "VRMC_springBone?": {
            "colliders?": [
                {
                    "node!": INTEGER,
                    "shape!": {
                        "sphere": _SPHERE,
                        "capsule": _SPHERE | {"tail": _NUMBER_LISTS[3]},
                    },
                }
            ],
            "colliderGroups?": [{"colliders": [INTEGER]}],
            "springs?": [
                {
                    "joints": [
                        {"node!": "nodes", "gravityDir": _NUMBER_LISTS[3]} | _SPRING,
                    ],
                    "colliderGroups": [INTEGER],
                    "center": INTEGER,
                }
            ],
        },
        "VRM": {
            "humanoid": {"humanBones?": [{"bone!": TEXT, "node!": "nodes"}]},
            "blendShapeMaster?": {
                "blendShapeGroups?": [
                    {"name": TEXT, "presetName": TEXT, "binds?": [{"mesh!": "meshes"} | _BINDS]}
                ]
            },
            "firstPerson?": {
                "lookAtTypeName": TEXT,
                "firstPersonBoneOffset": _XYZ,
                "lookAtHorizontalInner": _RANGE_0,
                "lookAtHorizontalOuter": _RANGE_0,
                "lookAtVerticalDown": _RANGE_0,
                "lookAtVerticalUp": _RANGE_0,
            },
            "secondaryAnimation?": {
                "boneGroups?": [
                    {
                        "stiffiness": REAL,  # spelt like this in VRM 0.x
                        "gravityPower": REAL,
                        "gravityDir": _XYZ,
                        "dragForce": REAL,
                        "hitRadius": REAL,
                        "center": INTEGER,
                        "bones": [INTEGER],
                        "colliderGroups": [INTEGER],
                    }
                ],
                "colliderGroups?": [
                    {"node": INTEGER, "colliders?": [{"offset": _XYZ, "radius": REAL}]}
                ],
            },
            "materialProperties?": [
                {
                    "shader": TEXT,
                    "floatProperties": {
                        "_ShadeShift": REAL,
                        "_ShadeToony": REAL,
                        "_IndirectLightIntensity": REAL,
                    },
                    "vectorProperties": {"_ShadeColor": _ANY_NUMBER_LIST},
                    "textureProperties": {"_ShadeTexture": INTEGER},
                }
            ],
        },
    },
}
"""The members that are read: an object, [a list] or the kind of a value. The name of a top-level
list stands for an index into it, "*" for any key; "!" marks required members, and "?" those that
a character can do without: items of their lists are None where they are invalid, others absent."""


def parse(text: bytes) -> tuple[Json, list[str]]:
    """Return the document in a JSON text, and what is wrong with members that are left out.

    A text that is no glTF raises another ValueError than `DamagedFileError`.
    """
    document = json.loads(text, parse_constant=_refuse_constant)
    if not isinstance(document, dict) or not isinstance(document.get("asset"), dict):
        raise ValueError("not a glTF")
    sizes = {key: len(v) for key, v in document.items() if isinstance(v, list)}
    checker = _Checker(sizes)
    for key, kind in SCHEMA.items():
        if key in document:
            checker.check(document[key], kind, key)
    return document, checker.left_out


def check(value: object, schema: Json, place: str) -> None:
    """Refuse a value that is not an object as a schema says; see `SCHEMA`."""
    _Checker({}).check(value, schema, place)


@contextmanager
def error_context(place: str) -> Iterator[None]:
    """Raise errors that invalid data cause inside as a `DamagedFileError` with the place."""
    try:
        yield
    except _INVALID_DATA as error:
        raise DamagedFileError(f"{place}: {error}") from error


def label(kind: str, number: int, item: Json) -> str:
    """Return the label of an item in messages: mesh 'Body', or mesh 3 without a name."""
    return f"{kind} {item['name']!r}" if item.get("name") else f"{kind} {number}"


def _refuse_constant(name: str) -> None:
    raise DamagedFileError(f"its JSON contains {name}")


@dataclass(frozen=True)
class _Checker:
    """Compares a document with a schema."""

    sizes: Mapping[str, int]
    """Lengths of the document's top-level lists."""

    left_out: list[str] = field(default_factory=list)
    """What is wrong with members that were left out."""

    def check(self, value: object, kind: Any, place: str) -> None:
        """Refuse a value that is not of a kind."""
        if isinstance(kind, dict):
            self._check_object(value, kind, place)
        elif isinstance(kind, list):
            if not isinstance(value, list):
                raise DamagedFileError(f"{place} is not a list")
            for number, each in enumerate(value):
                self.check(each, kind[0], f"{place}[{number}]")
        elif kind in SCHEMA:
            count = self.sizes.get(kind, 0)
            if type(value) is not int or not 0 <= value < count:
                raise DamagedFileError(f"{place} is {value!r:.40}, but the file has {count} {kind}")
        elif not _VALUE_CHECKS[kind](value):
            raise DamagedFileError(f"{place} is {value!r:.40}, not {kind}")

    def _check_object(self, value: object, kind: Json, place: str) -> None:
        if not isinstance(value, dict):
            raise DamagedFileError(f"{place} is not an object")
        for name, inner in kind.items():
            key = name.rstrip("!?")
            members = list(value) if key == "*" else [key] if key in value else []
            if not members and name.endswith("!"):
                raise DamagedFileError(f"{place} lacks {key!r}")
            for member in members:
                if name.endswith("?"):
                    self._leave_out_invalid(value, member, inner, f"{place}.{member}")
                else:
                    self.check(value[member], inner, f"{place}.{member}")

    def _leave_out_invalid(self, holder: Any, key: str | int, kind: Any, place: str) -> None:
        """Take out what is invalid of a member: items of a list become None, else all of it."""
        items = holder[key]
        if isinstance(kind, list) and isinstance(items, list):
            for number in range(len(items)):
                self._leave_out_invalid(items, number, kind[0], f"{place}[{number}]")
            return
        try:
            self.check(holder[key], kind, place)
        except DamagedFileError as error:
            if isinstance(key, int):
                holder[key] = None  # other members count the items
            else:
                del holder[key]
            self.left_out.append(str(error))


def _is_real(value: object) -> bool:
    # Numbers beyond single precision are not meant, and their products would overflow.
    return isinstance(value, int | float) and type(value) is not bool and -1e30 < value < 1e30


def _are_reals(value: object, count: int | None = None) -> bool:
    if not isinstance(value, list) or not all(map(_is_real, value)):
        return False
    return count is None or len(value) == count


_VALUE_CHECKS: dict[str, Callable[[object], bool]] = {
    TEXT: lambda value: isinstance(value, str),
    FLAG: lambda value: isinstance(value, bool),
    INTEGER: lambda value: type(value) is int,
    COUNT: lambda value: type(value) is int and value >= 0,
    REAL: _is_real,
    _ANY_NUMBER_LIST: _are_reals,
    **{name: partial(_are_reals, count=count) for count, name in _NUMBER_LISTS.items()},
}


def present(holder: Json, key: str) -> list[Any]:
    """Return the items of a list that were not left out; none of a list that is absent."""
    return [each for each in holder.get(key, ()) if each is not None]
