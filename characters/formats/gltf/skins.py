"""Reading skins: joints, weights and inverse bind matrices of vertices."""

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterWarning
from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.formats.gltf.nodes import NodeTree
from cubeling.characters.skeleton.pose import Array

_MAX_WEIGHT_ERROR = 0.02  # of the sum of a vertex: rounding of four bytes causes less


class VertexSkin(NamedTuple):
    """How joints move vertices."""

    joints: NDArray[np.int64]
    """Numbers of joints in the skeleton, (vertices, 4)."""

    weights: Array
    """(vertices, 4); each row sums to one."""

    inverse_bind: Array
    """(joints of the skeleton, 4, 4)."""


def read_skin(
    file: GltfFile, attributes: Json, number: int, tree: NodeTree, vertices: int, where: str
) -> VertexSkin:
    """Return the skin of a primitive's vertices; `where` names it in warnings."""
    with error_context(f"skin {number}"):
        skin = file.document["skins"][number]
        to_skeleton = np.array([tree.joint_of_node[node] for node in skin["joints"]], np.int64)
        if len(set(to_skeleton.tolist())) < len(to_skeleton) or not len(to_skeleton):
            raise DamagedFileError("has no joints, or repeats one")
        file.budget.spend(16 * len(tree.skeleton), "its bind matrices")
        inverse_bind = np.tile(np.eye(4), (len(tree.skeleton), 1, 1))
        if "inverseBindMatrices" in skin:
            matrices = file.floats(skin["inverseBindMatrices"], 16).reshape(-1, 4, 4)
            if len(matrices) < len(to_skeleton):
                raise DamagedFileError("has fewer bind matrices than joints")
            inverse_bind[to_skeleton] = np.swapaxes(matrices, 1, 2)[: len(to_skeleton)]
    joints, weights = _strongest_four(file, attributes, vertices, where)
    if joints.size and joints.max() >= len(to_skeleton):
        raise DamagedFileError(f"a vertex has joint {joints.max()} of a skin of {len(to_skeleton)}")
    return VertexSkin(to_skeleton[joints], weights, inverse_bind)


def rigid_skin(joint: int, vertices: int, joints: int) -> VertexSkin:
    """Return the skin of a rigid mesh of one joint; its vertices are in that joint's frame."""
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (vertices, 1))
    numbers = np.tile([joint, 0, 0, 0], (vertices, 1))
    return VertexSkin(numbers, weights, np.tile(np.eye(4), (joints, 1, 1)))


def _strongest_four(
    file: GltfFile, attributes: Json, vertices: int, where: str
) -> tuple[NDArray[np.int64], Array]:
    """Return four joints and weights per vertex: the strongest if there are more."""
    sets = 0
    while f"JOINTS_{sets}" in attributes and f"WEIGHTS_{sets}" in attributes:
        sets += 1
    if not sets:
        raise DamagedFileError("is skinned, but has no joints or weights")
    joints = np.concatenate([file.integers(attributes[f"JOINTS_{n}"], 4) for n in range(sets)], 1)
    weights = np.concatenate([file.floats(attributes[f"WEIGHTS_{n}"], 4) for n in range(sets)], 1)
    if not len(joints) == len(weights) == vertices:
        raise DamagedFileError(
            f"has {len(joints)} joints and {len(weights)} weights for {vertices} vertices"
        )
    weights = _checked_weights(weights, where)
    strongest = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    chosen = np.take_along_axis(weights, strongest, 1)
    totals = chosen.sum(1, keepdims=True)
    # A vertex without weights would collapse to the origin: its first joint gets all.
    chosen = np.where(totals > 1e-6, chosen / np.maximum(totals, 1e-6), [1.0, 0.0, 0.0, 0.0])
    numbers = np.take_along_axis(joints, strongest, 1)
    return np.where(chosen > 0, numbers, 0), chosen


def _checked_weights(weights: Array, where: str) -> Array:
    """Return weights of at least zero; warn of vertices whose sum is not one."""
    if (weights < -_MAX_WEIGHT_ERROR).any():
        raise DamagedFileError(f"has a skin weight of {weights.min():.3g}")
    weights = np.maximum(weights, 0.0)
    errors = np.abs(weights.sum(1) - 1)
    wrong = int((errors > _MAX_WEIGHT_ERROR).sum())
    if wrong:
        worst = int(errors.argmax())
        warnings.warn(
            f"{where} has skin weights that do not sum to one, "
            f"at {wrong} of {len(weights)} vertices "
            f"({weights[worst].sum():.3g} at vertex {worst}); scaled them",
            CharacterWarning,
            stacklevel=2,
        )
    return weights
