"""The pose that a character was modelled in, which tells how its joints belong to its body.

Files often rest in the first frame of a clip, mid-stride; their skins are bound to the pose in
which the body stands upright on its feet.
"""

from dataclasses import replace

import numpy as np

from characters.model.character import Character
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

_EXACT = 1e-6  # of what counts as no difference
_SAME = 0.01  # of the body's size: bound so near to its rest pose, a body is bound there


def bound_skeleton(character: Character) -> Skeleton:
    """Return the skeleton of a character, resting in the pose that its skin was bound in."""
    skeleton = character.skeleton
    rest = skeleton.rest.globals(skeleton)
    bound, skinned = rest.copy(), np.zeros(len(skeleton), bool)
    for mesh in character.meshes:
        used = np.unique(mesh.joints[mesh.weights > 0])
        # What hangs rigidly on a joint is bound in that joint's frame, wherever it rests.
        used = used[np.abs(mesh.inverse_bind[used] - np.eye(4)).max((1, 2)) > _EXACT]
        bound[used], skinned[used] = np.linalg.inv(mesh.inverse_bind[used]), True
    size = float(np.ptp(rest[:, :3, 3], axis=0).max()) or 1.0
    apart = np.linalg.norm(bound[:, :3, 3] - rest[:, :3, 3], axis=-1)
    if skinned.sum() < 3 or apart.max() < _SAME * size:
        return skeleton
    bound[skinned] = _upright(bound[skinned], rest[skinned])
    for joint, parent in enumerate(skeleton.parents):
        if not skinned[joint] and parent >= 0:
            above = np.linalg.inv(rest[parent])
            bound[joint] = bound[parent] @ above @ rest[joint]
    return replace(skeleton, rest=_locals(bound, skeleton))


def _upright(bound: Array, rest: Array) -> Array:
    """Return placements (n, 4, 4) turned in whole quarters, sized and placed as the rest pose is.

    Some exporters write skins in the axes and units of the program that they were made in.
    """
    ours, theirs = (at[:, :3, 3] - at[:, :3, 3].mean(0) for at in (rest, bound))
    left, _, right = np.linalg.svd(ours.T @ theirs)
    turn = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
    quarter = np.zeros((3, 3))
    for _ in range(3):  # the greatest entry first, then of what is left
        row, column = np.unravel_index(np.abs(turn).argmax(), turn.shape)
        quarter[row, column] = np.sign(turn[row, column])
        turn = turn.copy()
        turn[row], turn[:, column] = 0.0, 0.0
    scale = float(np.sqrt(np.square(ours).sum() / np.square(theirs).sum()))
    scale = 1.0 if 0.8 < scale < 1.25 else scale
    frame = np.eye(4)
    frame[:3, :3] = scale * quarter
    turned = np.asarray(frame @ bound, float)
    # Feet on the ground where they are at rest, and the body in the middle.
    turned[:, 0, 3] -= np.median(turned[:, 0, 3])
    turned[:, 1, 3] += rest[:, 1, 3].min() - turned[:, 1, 3].min()
    return turned


def _locals(globals_: Array, skeleton: Skeleton) -> Pose:
    """Return the pose that puts joints at placements (joints, 4, 4)."""
    parents = np.array(skeleton.parents)
    above = np.where(parents[:, None, None] >= 0, globals_[parents], np.eye(4))
    local = np.linalg.inv(above) @ globals_
    sizes = np.linalg.norm(local[:, :3, :3], axis=1)
    turns = rotations.from_matrix(local[:, :3, :3] / np.where(sizes > 0, sizes, 1.0)[:, None])
    scales = None if np.allclose(sizes, 1.0, atol=1e-4) else sizes
    return Pose(local[:, :3, 3].copy(), turns, scales)
