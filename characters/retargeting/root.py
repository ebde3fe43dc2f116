"""Root trajectories: for clips without root motion, and root joints for characters without one.

A root trajectory is (frames, 3): x, z [m] and yaw [rad]. Hips sway with every step; the root
follows them smoothed over a stride.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.rig import Rig, global_rotations
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.smoothing import gaussian_smooth

_MAX_ROOT_YAW_RAD = 1e-3  # rounding in files
_SMOOTHING_S = 0.3  # standard deviation; removes the sway of a stride


def root_trajectory(clip: Clip, source: Rig, ratio: float) -> Array:
    """Return the trajectory of the root, its lengths times a ratio.

    Without a root, that of the smoothed hips of a person, or of what is between an animal's feet.
    """
    if clip.root_motion:
        return clip.track * [ratio, ratio, 1.0]
    joint = source.anatomy.joints["hips"]
    hips = clip.poses.globals(source.skeleton)[:, joint]
    positions = rotations.rotate(source.common_from_skeleton, hips[:, :3, 3]) * ratio
    turned = rotations.multiply(source.common_from_skeleton, global_rotations(hips))
    from_rest = rotations.multiply(turned, rotations.conjugate(source.rest_rotations[joint]))
    yaw = np.unwrap(rotations.heading(from_rest))
    if source.anatomy.kind == "quadruped":
        feet = source.rest_positions[[leg.end for leg in source.legs]].mean(0)
        behind = ratio * (source.rest_positions[joint] - feet)
        positions = positions - rotations.rotate(rotations.about("y", yaw), behind)
    path = np.stack([positions[:, 0], positions[:, 2], yaw], axis=-1)
    return gaussian_smooth(path, _SMOOTHING_S * clip.rate)


def has_root_joint(skeleton: Skeleton, anatomy: Anatomy) -> bool:
    """Return whether joint 0 is a root on the ground that looks ahead at rest.

    The hips under that name are none. Nor is one that is turned, as in some VRM 0: a root's yaw is
    the way that it goes.
    """
    ahead = abs(float(rotations.heading(skeleton.rest.rotations[0]))) < _MAX_ROOT_YAW_RAD
    return skeleton.has_root_motion and ahead and anatomy.joint("hips") != 0


def with_root_joint(character: Character) -> Character:
    """Return a character whose joint 0 is a root on the ground; itself if it has one."""
    if has_root_joint(character.skeleton, character.anatomy):
        return character
    skeleton = character.skeleton
    names = tuple(f"{name}_" if name == "root" else name for name in skeleton.names)
    parents = (-1, *(parent + 1 for parent in skeleton.parents))
    meshes = tuple(
        replace(
            mesh,
            joints=(mesh.joints + 1).astype(mesh.joints.dtype),
            inverse_bind=np.concatenate([np.eye(4)[None], mesh.inverse_bind]),
        )
        for mesh in character.meshes
    )
    clips = {
        name: replace(clip, poses=_with_static_root(clip.poses), root_motion=True)
        for name, clip in character.clips.items()
    }
    renamed = dict(zip(skeleton.names, names, strict=True))
    semantics = {part: renamed.get(j, j) for part, j in character.semantics.items()}
    return replace(
        character,
        skeleton=Skeleton(("root", *names), parents, _with_static_root(skeleton.rest)),
        clips=clips,
        meshes=meshes,
        semantics=semantics,
        springs=tuple(bone.with_names(renamed) for bone in character.springs),
        constraints=tuple(each.with_names(renamed) for each in character.constraints),
    )


def clip_with_root(clip: Clip, skeleton: Skeleton, anatomy: Anatomy) -> Clip:
    """Return a clip with a root joint that follows the hips; every other joint stays in place."""
    trajectory = root_trajectory(clip, Rig(skeleton, anatomy), 1.0)
    children = np.flatnonzero(np.array(skeleton.parents) < 0) + 1
    poses = with_root_trajectory(_with_static_root(clip.poses), children, trajectory)
    return replace(clip, poses=poses, root_motion=True)


def with_root_trajectory(pose: Pose, children: NDArray[np.intp], trajectory: Array) -> Pose:
    """Return poses with another root trajectory; `children` of the root stay in the world."""
    turn = rotations.about("y", trajectory[:, 2])
    at = ground_positions(trajectory)
    old_turn, old_at = pose.rotations[:, 0], pose.translations[:, 0]
    change = rotations.multiply(rotations.conjugate(turn), old_turn)
    shift = rotations.rotate(rotations.conjugate(turn), old_at - at)
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[:, children] = (
        rotations.rotate(change[:, None], translations[:, children]) + shift[:, None]
    )
    turns[:, children] = rotations.multiply(change[:, None], turns[:, children])
    translations[:, 0], turns[:, 0] = at, turn
    return replace(pose, translations=translations, rotations=rotations.continuous(turns))


def move_to_trajectory(pose: Pose, trajectory: Array) -> Pose:
    """Return poses with another root trajectory; the whole body moves with the root."""
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[:, 0] = ground_positions(trajectory)
    turns[:, 0] = rotations.about("y", trajectory[:, 2])
    return replace(pose, translations=translations, rotations=rotations.continuous(turns))


def ground_positions(trajectory: Array) -> Array:
    """Return the positions (frames, 3) of a root trajectory, on the ground."""
    return np.stack([trajectory[:, 0], np.zeros(len(trajectory)), trajectory[:, 1]], axis=-1)


def _with_static_root(pose: Pose) -> Pose:
    """Return poses (…, joints) with a root that does not move before all joints."""

    def prepend(values: Array, first: Array) -> Array:
        shape = (*values.shape[:-2], 1, values.shape[-1])
        return np.concatenate([np.broadcast_to(first, shape), values], axis=-2)

    return Pose(
        prepend(pose.translations, np.zeros(3)),
        prepend(pose.rotations, rotations.IDENTITY),
        None if pose.scales is None else prepend(pose.scales, np.ones(3)),
        pose.morphs,
    )
