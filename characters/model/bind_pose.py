"""The pose in which the skin of a character was bound.

Files often rest in the first frame of a clip, in mid-stride, while their skins are bound to the
pose in which the body was modelled, upright on its feet.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.model.character import Character
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

_IDENTITY_TOLERANCE = 1e-5
_MAX_REST_DISTANCE = 0.01  # body sizes; a skin bound closer to the rest pose is bound there
_MIN_RESCALING = 1.25  # smaller ratios of size come from the pose, larger ones from the unit


def bind_placements(character: Character) -> tuple[Array, NDArray[np.bool_]]:
    """Return the placements that joints were bound in, (joints, 4, 4), and which joints were.

    Rigid meshes are bound in their joint's own frame, which says nothing about its placement:
    their joints are returned at rest, as those without a skin.
    """
    skeleton = character.skeleton
    placements, bound = skeleton.rest.globals(skeleton).copy(), np.zeros(len(skeleton), bool)
    for mesh in character.meshes:
        used = np.unique(mesh.joints[mesh.weights > 0])
        rigid = np.abs(mesh.inverse_bind[used] - np.eye(4)).max((1, 2)) <= _IDENTITY_TOLERANCE
        used = used[~rigid]
        placements[used], bound[used] = np.linalg.inv(mesh.inverse_bind[used]), True
    return placements, bound


def with_bind_pose(character: Character) -> Skeleton:
    """Return the skeleton of a character with the bind pose of its skin as rest pose."""
    skeleton = character.skeleton
    rest = skeleton.rest.globals(skeleton)
    placements, bound = bind_placements(character)
    size = float(np.ptp(rest[:, :3, 3], axis=0).max()) or 1.0
    distances = np.linalg.norm(placements[:, :3, 3] - rest[:, :3, 3], axis=-1)
    if bound.sum() < 3 or distances.max() < _MAX_REST_DISTANCE * size:
        return skeleton
    placements[bound] = _aligned(placements[bound], rest[bound])
    for joint, parent in enumerate(skeleton.parents):
        if not bound[joint] and parent >= 0:
            placements[joint] = placements[parent] @ np.linalg.inv(rest[parent]) @ rest[joint]
    return replace(skeleton, rest=_local_pose(placements, skeleton))


def _aligned(bound: Array, rest: Array) -> Array:
    """Return placements (n, 4, 4) in the axes, unit and position of the rest pose.

    Some exporters write skins in the axes and units of the modelling program; the axes differ by
    quarter turns.
    """
    rest_points, bound_points = (at[:, :3, 3] - at[:, :3, 3].mean(0) for at in (rest, bound))
    left, _, right = np.linalg.svd(rest_points.T @ bound_points)
    turn = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
    quarter_turns = np.zeros((3, 3))
    for _ in range(3):  # the greatest entry first, then those of the other rows and columns
        row, column = np.unravel_index(np.abs(turn).argmax(), turn.shape)
        quarter_turns[row, column] = np.sign(turn[row, column])
        turn[row], turn[:, column] = 0.0, 0.0
    scale = float(np.sqrt(np.square(rest_points).sum() / np.square(bound_points).sum()))
    scale = 1.0 if 1 / _MIN_RESCALING < scale < _MIN_RESCALING else scale
    frame = np.eye(4)
    frame[:3, :3] = scale * quarter_turns
    aligned = np.asarray(frame @ bound, float)
    # The feet stand on the ground of the rest pose, the body is centred.
    aligned[:, 0, 3] -= np.median(aligned[:, 0, 3])
    aligned[:, 1, 3] += rest[:, 1, 3].min() - aligned[:, 1, 3].min()
    return aligned


def _local_pose(placements: Array, skeleton: Skeleton) -> Pose:
    """Return the pose with these global placements, (joints, 4, 4)."""
    parents = np.array(skeleton.parents)
    above = np.where(parents[:, None, None] >= 0, placements[parents], np.eye(4))
    local = np.linalg.inv(above) @ placements
    sizes = np.linalg.norm(local[:, :3, :3], axis=1)
    turns = rotations.from_matrix(local[:, :3, :3] / np.where(sizes > 0, sizes, 1.0)[:, None])
    scales = None if np.allclose(sizes, 1.0, atol=1e-4) else sizes
    return Pose(local[:, :3, 3].copy(), turns, scales)
