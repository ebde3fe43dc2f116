"""VRM: the body parts and facial expressions of a humanoid in a glTF.

Supports VRM 1.0 (extension VRMC_vrm) and 0.x (extension VRM). Spring bones, constraints, how eyes
follow a point, and materials are in `vrm_springs`, `vrm_constraints`, `vrm_look_at` and `mtoon`.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.formats.gltf.document import (
    DamagedFileError,
    Json,
    error_context,
    label,
    present,
)
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.model.mesh import Mesh, Morph

Bind = tuple[int, int, float]
"""Node with a mesh, index of a morph target of the mesh, and its weight."""

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
class VrmHumanoid:
    """The VRM part of a file."""

    bones: Mapping[str, int]
    """Node of each bone, by its name in VRM 1.0."""

    expressions: Mapping[str, tuple[Bind, ...]]
    """Morph targets of each expression."""


def read_humanoid(file: GltfFile) -> VrmHumanoid | None:
    """Return the VRM part of a file, or None without one."""
    extensions = file.document.get("extensions", {})
    for name in ("VRMC_vrm", "VRMC_vrm_animation"):
        if name in extensions:
            with error_context(name):
                return _humanoid_1(extensions[name])
    if "VRM" in extensions:
        with error_context("VRM"):
            return _humanoid_0(file, extensions["VRM"])
    return None


def mixed_expressions(
    file: GltfFile, parts: Iterable[tuple[int, Mesh]], humanoid: VrmHumanoid
) -> tuple[tuple[Mesh, ...], tuple[str, ...]]:
    """Return meshes, given with their nodes, with expressions as morphs, and names of these."""
    meshes = tuple(
        replace(mesh, morphs=tuple(_expression_morphs(file, mesh.morphs, node, humanoid)))
        for node, mesh in parts
    )
    used = {morph.name for mesh in meshes for morph in mesh.morphs}
    return meshes, tuple(name for name in humanoid.expressions if name in used)


def _expression_morphs(
    file: GltfFile, targets: Sequence[Morph], node: int, humanoid: VrmHumanoid
) -> Iterable[Morph]:
    for name, binds in humanoid.expressions.items():
        own = [(index, weight) for bound, index, weight in binds if bound == node and weight]
        within = [(targets[index], weight) for index, weight in own if index < len(targets)]
        if len(within) < len(own):
            beyond = next(index for index, _ in own if index >= len(targets))
            file.warn(
                f"expression {name!r} binds morph target {beyond} of node {node}, "
                f"which has {len(targets)}; left it out"
            )
        if within:
            yield _weighted_sum(name, within)


def _weighted_sum(name: str, weighted: list[tuple[Morph, float]]) -> Morph:
    where = np.unique(np.concatenate([morph.vertices for morph, _ in weighted]))
    displacements = np.zeros((len(where), 3), np.float32)
    normal_displacements: NDArray[np.float32] = np.zeros_like(displacements)
    for morph, weight in weighted:
        rows = np.searchsorted(where, morph.vertices)
        displacements[rows] += weight * morph.displacements
        if morph.normal_displacements is not None:
            normal_displacements[rows] += weight * morph.normal_displacements
    has_normals = any(morph.normal_displacements is not None for morph, _ in weighted)
    return Morph(
        name, where.astype(np.uint32), displacements, normal_displacements if has_normals else None
    )


def _humanoid_1(extension: Json) -> VrmHumanoid:
    version = extension.get("specVersion", "")
    if not version.startswith("1."):
        raise DamagedFileError(f"is version {version!r:.20}; export it as VRM 1.0")
    named = extension.get("humanoid", {}).get("humanBones", {})
    bones = {name: bone["node"] for name, bone in named.items()}
    stated = extension.get("expressions", {})
    expressions = {
        name: tuple(
            (bind["node"], bind["index"], float(bind["weight"]))
            for bind in present(expression, "morphTargetBinds")
        )
        for kind in ("preset", "custom")
        for name, expression in stated.get(kind, {}).items()
    }
    return VrmHumanoid(bones, expressions)


def _humanoid_0(file: GltfFile, extension: Json) -> VrmHumanoid:
    named = present(extension.get("humanoid", {}), "humanBones")
    bones = {_bone_1(bone["bone"]): bone["node"] for bone in named}
    nodes_of_mesh: dict[int, list[int]] = {}
    for number, node in enumerate(file.all("nodes")):
        if "mesh" in node:
            nodes_of_mesh.setdefault(node["mesh"], []).append(number)
    expressions: dict[str, tuple[Bind, ...]] = {}
    groups = present(extension.get("blendShapeMaster", {}), "blendShapeGroups")
    for number, group in enumerate(groups):
        preset = group.get("presetName", "unknown").lower()
        own = group.get("name") or label("blend shape", number, {})
        name = own if preset == "unknown" else _EXPRESSIONS_0.get(preset, preset)
        expressions[name] = tuple(
            (node, bind["index"], float(bind["weight"]) / 100.0)
            for bind in present(group, "binds")
            for node in nodes_of_mesh.get(bind["mesh"], ())
        )
    return VrmHumanoid(bones, expressions)


def _bone_1(name: str) -> str:
    """Return the VRM 1.0 name of a bone of VRM 0.x, which named thumbs like fingers."""
    side, thumb, part = name.partition("Thumb")
    return f"{side}{thumb}{_THUMBS_0.get(part, part)}" if thumb else name
