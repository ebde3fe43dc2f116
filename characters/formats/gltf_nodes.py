"""From the nodes of a glTF scene to a skeleton."""

from dataclasses import dataclass

import numpy as np
import pygltflib
from numpy.typing import NDArray

from characters import rotations
from characters.formats.gltf_file import DamagedFileError
from characters.pose import Pose, Skeleton

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NodeTree:
    """The nodes that matter, as a skeleton."""

    skeleton: Skeleton
    """Joints, all their ancestors, and nodes that carry rigid meshes."""

    joint_of_node: dict[int, int]
    """Joint number by node number."""


def read_tree(document: pygltflib.GLTF2) -> NodeTree:
    """Return the skeleton of a document.

    Ancestors of joints are joints too: exporters put the change of axes and units there, and
    sometimes animate it. Rigid meshes that hang on a joint ride along.
    """
    parents = _parents(document)
    wanted: set[int] = set()
    for skin in document.skins:
        for node in skin.joints:
            wanted.update(_line(node, parents))
    rigid = [n for n, node in enumerate(document.nodes) if _is_rigid_mesh(node)]
    for node in rigid:
        line = _line(node, parents)
        if wanted.intersection(line):
            wanted.update(line)
    order: list[int] = []
    for node in sorted(wanted):
        order += [n for n in reversed(_line(node, parents)) if n not in order]
    joint_of_node = {node: joint for joint, node in enumerate(order)}
    nodes = [document.nodes[n] for n in order]
    skeleton = Skeleton(
        names=_unique([node.name or f"node{n}" for n, node in zip(order, nodes, strict=True)]),
        parents=tuple(joint_of_node.get(parents[n], -1) for n in order),
        rest=_rest(nodes),
    )
    return NodeTree(skeleton, joint_of_node)


def _parents(document: pygltflib.GLTF2) -> list[int]:
    """Return each node's parent, −1 for none; refuse two parents."""
    parents = [-1] * len(document.nodes)
    for number, node in enumerate(document.nodes):
        for child in node.children or []:
            if not 0 <= child < len(parents) or parents[child] != -1:
                raise DamagedFileError(f"node {child} does not exist or has two parents")
            parents[child] = number
    return parents


def _line(node: int, parents: list[int]) -> list[int]:
    """Return a node and its ancestors, from itself up."""
    if not 0 <= node < len(parents):
        raise DamagedFileError(f"joint {node} does not exist")
    line = [node]
    while parents[line[-1]] != -1:
        line.append(parents[line[-1]])
        if len(line) > len(parents):
            raise DamagedFileError(f"node {node} is its own ancestor")
    return line


def _is_rigid_mesh(node: pygltflib.Node) -> bool:
    return node.mesh is not None and node.skin is None


def _unique(names: list[str]) -> tuple[str, ...]:
    """Return the names, numbered where they repeat."""
    seen: dict[str, int] = {}
    unique: list[str] = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        unique.append(name if seen[name] == 1 else f"{name}.{seen[name]}")
    return tuple(unique)


def _rest(nodes: list[pygltflib.Node]) -> Pose:
    parts = [_placement(node) for node in nodes]
    scales = np.array([scale for _, _, scale in parts]).reshape(-1, 3)
    return Pose(
        np.array([translation for translation, _, _ in parts]).reshape(-1, 3),
        rotations.normalize(np.array([rotation for _, rotation, _ in parts]).reshape(-1, 4)),
        None if np.allclose(scales, 1.0, atol=1e-6) else scales,
    )


def _placement(node: pygltflib.Node) -> tuple[Array, Array, Array]:
    """Return a node's translation, rotation and scale, taken from its matrix if it has one."""
    if not node.matrix:
        return (
            np.array(node.translation or (0.0, 0.0, 0.0)),
            np.array(node.rotation or (0.0, 0.0, 0.0, 1.0)),
            np.array(node.scale or (1.0, 1.0, 1.0)),
        )
    matrix = np.array(node.matrix, float).reshape(4, 4).T
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if np.linalg.det(matrix[:3, :3]) < 0:
        scale[0] = -scale[0]
    safe = np.where(scale == 0, 1.0, scale)
    return matrix[:3, 3], rotations.from_matrix(matrix[:3, :3] / safe), scale
