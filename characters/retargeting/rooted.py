"""A root on the ground for characters that have none, and for motions that are of them."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from characters.model.character import Character
from characters.motion.clip import Clip
from characters.retargeting.body import Body
from characters.retargeting.root import root_way
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose, Skeleton


def is_rooted(skeleton: Skeleton, anatomy: Anatomy) -> bool:
    """Return whether joint 0 is a root on the ground, and not the hips under that name."""
    return skeleton.has_root_motion and anatomy.joint("hips") != 0


def with_root(character: Character) -> Character:
    """Return a character whose joint 0 is a root on the ground; itself if it has one."""
    if is_rooted(character.skeleton, character.anatomy):
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
        name: replace(clip, poses=rooted_pose(clip.poses), root_motion=True)
        for name, clip in character.clips.items()
    }
    return replace(
        character,
        skeleton=Skeleton(("root", *names), parents, rooted_pose(skeleton.rest)),
        clips=clips,
        meshes=meshes,
        semantics=_said(character, names),
    )


def _said(character: Character, names: tuple[str, ...]) -> Mapping[str, str]:
    """Return the semantics with the names that joints have now."""
    now = dict(zip(character.skeleton.names, names, strict=True))
    return {part: now.get(joint, joint) for part, joint in character.semantics.items()}


def rooted_pose(pose: Pose) -> Pose:
    """Return poses (…, joints) with a root before all joints that does not move."""

    def before(values: Array, first: Array) -> Array:
        shape = (*values.shape[:-2], 1, values.shape[-1])
        return np.concatenate([np.broadcast_to(first, shape), values], axis=-2)

    return Pose(
        before(pose.translations, np.zeros(3)),
        before(pose.rotations, rotations.IDENTITY),
        None if pose.scales is None else before(pose.scales, np.ones(3)),
        pose.morphs,
    )


def rooted_clip(clip: Clip, skeleton: Skeleton, anatomy: Anatomy) -> Clip:
    """Return a clip of a character without a root as one of the same `with_root`.

    The root goes under the hips, smoothly; every joint stays where it was.
    """
    way = root_way(clip, Body(skeleton, anatomy), 1.0)
    pose = rooted_pose(clip.poses)
    below = np.flatnonzero(np.array(skeleton.parents) < 0) + 1
    return replace(clip, poses=on_way(pose, below, way), root_motion=True)


def on_way(pose: Pose, below: "np.typing.NDArray[np.intp]", way: Array) -> Pose:
    """Return poses whose root is on a way (frames, 3) and whose other joints stay in the world.

    Parameters
    ----------
    below
        The joints whose parent is the root.
    way
        x, z [m] and yaw [rad].
    """
    turn = rotations.multiply(rotations.about("y", way[:, 2]), np.array(rotations.IDENTITY))
    at = np.stack([way[:, 0], np.zeros(len(way)), way[:, 1]], axis=-1)
    old_turn, old_at = pose.rotations[:, 0], pose.translations[:, 0]
    change = rotations.multiply(rotations.conjugate(turn), old_turn)
    shift = rotations.rotate(rotations.conjugate(turn), old_at - at)
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[:, below] = (
        rotations.rotate(change[:, None], translations[:, below]) + shift[:, None]
    )
    turns[:, below] = rotations.multiply(change[:, None], turns[:, below])
    translations[:, 0], turns[:, 0] = at, turn
    return replace(pose, translations=translations, rotations=rotations.continuous(turns))
