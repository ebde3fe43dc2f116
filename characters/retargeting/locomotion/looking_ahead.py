"""Walkers and standing people that look and face ahead, as recordings rarely do exactly.

The necks of motion capture skeletons are straight in their zero pose; those of people lean ahead.
So their heads seem to be bent by 10° to 25° while they look ahead, and a character that is modelled
looking ahead would look at the floor.
"""

from dataclasses import replace

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.measures import facing_error
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import with_root_trajectory
from cubeling.characters.retargeting.transfer import turns_from_rest, with_turns_from_rest
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

_MAX_DOWNWARD = np.radians(5.0)  # that the head looks down in most of a clip
_PARTS = ("neck", "head")


def look_ahead(clip: Clip, rig: Rig) -> Clip:
    """Return a clip with the head raised if it is bent in most of it; it still nods and turns."""
    joints = [joint for part in _PARTS if (joint := rig.anatomy.joint(part)) is not None]
    if rig.anatomy.joint("head") is None:
        return clip
    turns = turns_from_rest(clip.poses, rig, joints)
    ahead = rotations.rotate(turns[:, -1], [0.0, 0.0, 1.0])
    pitch = float(np.median(np.arcsin(np.clip(ahead[:, 1], -1.0, 1.0))))
    missing = -_MAX_DOWNWARD - pitch
    if missing <= 0:
        return clip
    side = np.stack([-ahead[:, 2], np.zeros(len(ahead)), ahead[:, 0]], axis=-1)
    side /= np.maximum(np.linalg.norm(side, axis=-1, keepdims=True), 1e-9)
    for number in range(len(joints)):  # the neck takes its share
        up = rotations.from_rotation_vector(side * missing * (number + 1) / len(joints))
        turns[:, number] = rotations.multiply(up, turns[:, number])
    return replace(clip, poses=with_turns_from_rest(clip.poses, rig, joints, turns))


def face_ahead(clip: Clip, rig: Rig) -> Clip:
    """Return a clip in place whose body faces +z and stands over the root, on average."""
    poses = clip.in_place
    yaw = facing_error(poses, rig)
    hips = rig.anatomy.joints["hips"]
    mean = poses.globals(rig.skeleton)[:, hips, :3, 3].mean(0)
    rest = rig.skeleton.rest.globals(rig.skeleton)[hips, :3, 3] - rig.rest_positions[0]
    middle: Array = mean - rotations.rotate(rotations.about("y", yaw), rest)
    path = np.tile([middle[0], middle[2], yaw], (len(clip), 1))
    children = np.flatnonzero(np.array(rig.skeleton.parents) == 0)
    turned = replace(clip, poses=with_root_trajectory(poses, children, path), root_motion=True)
    return replace(turned, poses=turned.in_place)
