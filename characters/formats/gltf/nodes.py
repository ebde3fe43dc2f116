"""Reading nodes as a skeleton."""

import warnings
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cubeling.characters.errors import CharacterWarning
from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_MAX_JOINTS = 4096
_MAX_LENGTH_ERROR = 1e-2  # of a quaternion: rounding to bytes causes less


@dataclass(frozen=True)
class NodeTree:
    """The nodes that move meshes, as a skeleton."""

    skeleton: Skeleton
    """Joints, all their ancestors, and nodes that carry rigid meshes."""

    joint_of_node: dict[int, int]
    """Joint number by node number."""

    mesh_nodes: tuple[int, ...]
    """Numbers of the nodes with a mesh that the skeleton moves."""


def read_node_tree(file: GltfFile, extra_joints: Iterable[int]) -> NodeTree:
    """Return the skeleton of a document.

    Ancestors of joints are joints too: exporters put the change of axes and units there, and
    sometimes animate it. Nodes with rigid meshes below a joint are joints as well. Nodes with the
    numbers `extra_joints` are joints without being listed by a skin.
    """
    nodes = file.all("nodes")
    parents = _parents(nodes)
    wanted: set[int] = set()
    for joint in (*extra_joints, *(node for skin in file.all("skins") for node in skin["joints"])):
        _add_with_ancestors(wanted, joint, parents)
    below: set[int] = set()
    for number in _top_down(nodes, parents):
        if number in wanted or parents[number] in below:
            below.add(number)
            if "mesh" in nodes[number] and "skin" not in nodes[number]:
                _add_with_ancestors(wanted, number, parents)
    order = _parents_first(wanted, nodes, parents)
    if len(order) > _MAX_JOINTS:
        raise DamagedFileError(f"has {len(order)} joints, more than {_MAX_JOINTS}")
    joint_of_node = {node: joint for joint, node in enumerate(order)}
    skeleton = Skeleton(
        names=unique_names([nodes[n].get("name") or f"node{n}" for n in order]),
        parents=tuple(joint_of_node.get(parents[n], -1) for n in order),
        rest=_rest(file, order),
    )
    carriers = [
        number
        for number, node in enumerate(nodes)
        if "mesh" in node and ("skin" in node or number in joint_of_node)
    ]
    return NodeTree(skeleton, joint_of_node, tuple(carriers))


def _parents(nodes: list[Json]) -> list[int]:
    """Return each node's parent, or −1; refuse two parents."""
    parents = [-1] * len(nodes)
    for number, node in enumerate(nodes):
        for child in node.get("children", ()):
            if parents[child] != -1:
                raise DamagedFileError(f"{label('node', child, nodes[child])} has two parents")
            parents[child] = number
    return parents


def _top_down(nodes: list[Json], parents: list[int]) -> list[int]:
    """Return all nodes, parents before children; refuse cycles."""
    # Nodes that no root reaches are in a cycle or below one.
    reached = [n for n, parent in enumerate(parents) if parent == -1]
    for number in reached:
        reached += nodes[number].get("children", ())
    if len(reached) < len(nodes):
        cyclic = min(set(range(len(nodes))) - set(reached))
        raise DamagedFileError(f"{label('node', cyclic, nodes[cyclic])} is its own ancestor")
    return reached


def _add_with_ancestors(wanted: set[int], node: int, parents: list[int]) -> None:
    while node != -1 and node not in wanted:
        wanted.add(node)
        node = parents[node]


def _parents_first(wanted: set[int], nodes: list[Json], parents: list[int]) -> list[int]:
    """Return nodes in the order of the file, except that parents precede children."""
    order: list[int] = []
    placed: set[int] = set()
    for node in sorted(wanted):
        line = []
        while node != -1 and node not in placed:
            line.append(node)
            placed.add(node)
            node = parents[node]
        order += reversed(line)
    return order


def unique_names(names: list[str]) -> tuple[str, ...]:
    """Return the names with numbers where they repeat."""
    taken = set(names)
    seen: dict[str, int] = {}
    unique: list[str] = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        new = name
        while seen[name] > 1 and (new := f"{name}.{seen[name]}") in taken:
            seen[name] += 1
        taken.add(new)
        unique.append(new)
    return tuple(unique)


def _rest(file: GltfFile, order: list[int]) -> Pose:
    nodes = file.all("nodes")
    parts = []
    for number in order:
        where = label("node", number, nodes[number])
        with error_context(where):
            parts.append(_local_transform(nodes[number], f"{file.path}: {where}"))
    scales = np.array([scale for _, _, scale in parts]).reshape(-1, 3)
    return Pose(
        np.array([translation for translation, _, _ in parts]).reshape(-1, 3),
        rotations.normalize(np.array([rotation for _, rotation, _ in parts]).reshape(-1, 4)),
        None if np.allclose(scales, 1.0, atol=1e-6) else scales,
    )


def _local_transform(node: Json, where: str) -> tuple[Array, Array, Array]:
    """Return a node's translation, rotation and scale, taken from its matrix if it has one."""
    if "matrix" not in node:
        rotation = np.array(node.get("rotation", (0.0, 0.0, 0.0, 1.0)), float)
        return (
            np.array(node.get("translation", (0.0, 0.0, 0.0)), float),
            unit_quaternions(rotation[None], where)[0],
            np.array(node.get("scale", (1.0, 1.0, 1.0)), float),
        )
    matrix = np.array(node["matrix"], float).reshape(4, 4).T
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if np.linalg.det(matrix[:3, :3]) < 0:
        scale[0] = -scale[0]
    safe = np.where(scale == 0, 1.0, scale)
    return matrix[:3, 3], rotations.from_matrix(matrix[:3, :3] / safe), scale


def unit_quaternions(quaternions: Array, where: str) -> Array:
    """Return normalised quaternions (n, 4); warn of other lengths, refuse length zero."""
    lengths: Array = np.linalg.norm(quaternions, axis=1, keepdims=True)
    if (lengths < 1e-6).any():
        shortest = quaternions[int(lengths.argmin())].tolist()
        raise DamagedFileError(f"rotation {shortest} has no length")
    worst = int(np.abs(lengths - 1).argmax()) if len(quaternions) else 0
    if len(quaternions) and abs(lengths[worst, 0] - 1) > _MAX_LENGTH_ERROR:
        warnings.warn(
            f"{where} has a rotation of length {lengths[worst, 0]:.3g}; normalised it",
            CharacterWarning,
            stacklevel=2,
        )
    return quaternions / lengths
