"""VRM: a humanoid in a glTF that says which joint is what, and what its face can express.

VRM 1.0 (extension VRMC_vrm) and 0.x (extension VRM), whose characters face −z. Of its materials
the glTF part is drawn; springs, constraints and what first persons see are left out.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from characters.formats.gltf.document import DamagedFileError, Json, at, called
from characters.formats.gltf.file import GltfFile
from characters.model.mesh import Mesh, Morph

Bind = tuple[int, int, float]
"""Node that carries a mesh, number of the morph target in it, and how far that is on."""

_EXPRESSIONS_0 = {
    "joy": "happy",
    "sorrow": "sad",
    "fun": "relaxed",
    "a": "aa",
    "i": "ih",
    "u": "ou",
    "e": "ee",
    "o": "oh",
    "blink_l": "blinkLeft",
    "blink_r": "blinkRight",
    "lookup": "lookUp",
    "lookdown": "lookDown",
    "lookleft": "lookLeft",
    "lookright": "lookRight",
}
_THUMBS_0 = {"Proximal": "Metacarpal", "Intermediate": "Proximal", "Distal": "Distal"}


@dataclass(frozen=True)
class Humanoid:
    """What the VRM part of a file says."""

    bones: Mapping[str, int]
    """Node of each bone, by VRM 1.0's name of it."""

    expressions: Mapping[str, tuple[Bind, ...]] = field(default_factory=dict)
    """Morph targets that each expression turns on."""


def read_humanoid(file: GltfFile) -> Humanoid | None:
    """Return the VRM part of a file, or None where it has none.

    Raises
    ------
    DamagedFileError
        If it is of a version that is not known, or contradicts itself.
    """
    extensions = file.document.get("extensions", {})
    if "VRMC_vrm" in extensions:
        with at("VRMC_vrm"):
            return _humanoid_1(extensions["VRMC_vrm"])
    if "VRM" in extensions:
        with at("VRM"):
            return _humanoid_0(file, extensions["VRM"])
    return None


def faces_backwards(file: GltfFile) -> bool:
    """Whether a file is a VRM 0.x, whose characters face −z."""
    extensions = file.document.get("extensions", {})
    return "VRM" in extensions and "VRMC_vrm" not in extensions


def turned_around(file: GltfFile) -> GltfFile:
    """Return the file with a node above all others that turns its character to face +z."""
    nodes = file.all("nodes")
    children = {child for node in nodes for child in node.get("children", ())}
    roots = [number for number in range(len(nodes)) if number not in children]
    turn = {"name": "facing", "rotation": [0.0, 1.0, 0.0, 0.0], "children": roots}
    return replace(file, document=file.document | {"nodes": [*nodes, turn]})


def expressed(
    parts: Iterable[tuple[int, Mesh]], humanoid: Humanoid
) -> tuple[tuple[Mesh, ...], tuple[str, ...]]:
    """Return meshes whose morphs are the expressions, and the names of those.

    Parameters
    ----------
    parts
        The node that carries each mesh, and the mesh with all of its morph targets.
    humanoid
        What the targets make up.
    """
    meshes = tuple(
        replace(mesh, morphs=tuple(_mixed(mesh.morphs, node, humanoid.expressions)))
        for node, mesh in parts
    )
    there = {morph.name for mesh in meshes for morph in mesh.morphs}
    return meshes, tuple(name for name in humanoid.expressions if name in there)


def _mixed(
    targets: Sequence[Morph], node: int, expressions: Mapping[str, tuple[Bind, ...]]
) -> Iterable[Morph]:
    for name, binds in expressions.items():
        own = [(index, weight) for carrier, index, weight in binds if carrier == node and weight]
        beyond = [index for index, _ in own if index >= len(targets)]
        if beyond:
            raise DamagedFileError(
                f"expression {name!r} binds morph target {beyond[0]} of node {node}, "
                f"which has {len(targets)}"
            )
        if own:
            yield _sum(name, [(targets[index], weight) for index, weight in own])


def _sum(name: str, weighted: list[tuple[Morph, float]]) -> Morph:
    """Return the morph that several make together."""
    where = np.unique(np.concatenate([morph.vertices for morph, _ in weighted]))
    shifts = np.zeros((len(where), 3), np.float32)
    turns: NDArray[np.float32] = np.zeros_like(shifts)
    for morph, weight in weighted:
        rows = np.searchsorted(where, morph.vertices)
        shifts[rows] += weight * morph.shifts
        if morph.normal_shifts is not None:
            turns[rows] += weight * morph.normal_shifts
    lit = any(morph.normal_shifts is not None for morph, _ in weighted)
    return Morph(name, where.astype(np.uint32), shifts, turns if lit else None)


def _humanoid_1(extension: Json) -> Humanoid:
    version = extension.get("specVersion", "")
    if not version.startswith("1."):
        raise DamagedFileError(f"is version {version!r:.20}; export it as VRM 1.0")
    bones = {
        name: bone["node"]
        for name, bone in extension.get("humanoid", {}).get("humanBones", {}).items()
    }
    stated = extension.get("expressions", {})
    expressions = {
        name: tuple(
            (bind["node"], bind["index"], float(bind["weight"]))
            for bind in expression.get("morphTargetBinds", ())
        )
        for kind in ("preset", "custom")
        for name, expression in stated.get(kind, {}).items()
    }
    return Humanoid(bones, expressions)


def _humanoid_0(file: GltfFile, extension: Json) -> Humanoid:
    bones = {
        _bone_1(bone["bone"]): bone["node"]
        for bone in extension.get("humanoid", {}).get("humanBones", ())
    }
    carriers: dict[int, list[int]] = {}
    for number, node in enumerate(file.all("nodes")):
        if "mesh" in node:
            carriers.setdefault(node["mesh"], []).append(number)
    expressions: dict[str, tuple[Bind, ...]] = {}
    groups = extension.get("blendShapeMaster", {}).get("blendShapeGroups", ())
    for number, group in enumerate(groups):
        preset = group.get("presetName", "unknown").lower()
        own = group.get("name") or called("blend shape", number, {})
        name = own if preset == "unknown" else _EXPRESSIONS_0.get(preset, preset)
        expressions[name] = tuple(
            (node, bind["index"], float(bind["weight"]) / 100.0)
            for bind in group.get("binds", ())
            for node in carriers.get(bind["mesh"], ())
        )
    return Humanoid(bones, expressions)


def _bone_1(name: str) -> str:
    """Return VRM 1.0's name of a bone of VRM 0.x: its thumbs were named like fingers."""
    side, thumb, part = name.partition("Thumb")
    return f"{side}{thumb}{_THUMBS_0.get(part, part)}" if thumb else name
