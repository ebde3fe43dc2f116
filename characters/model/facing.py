"""Turning what a file contains so that it faces +z."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.facing import common_from_skeleton
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_UP = np.array([0.0, 1.0, 0.0])


def turn_ahead(
    skeleton: Skeleton, anatomy: Anatomy, clips: Mapping[str, Clip]
) -> tuple[Skeleton, dict[str, Clip]]:
    """Return a skeleton and its clips turned about the vertical to face +z at rest.

    Bodies that do not stand upright stay as they are.
    """
    turn = common_from_skeleton(skeleton, anatomy)
    upright = np.allclose(rotations.rotate(turn, _UP), _UP)
    if not upright or np.allclose(turn, rotations.IDENTITY):
        return skeleton, dict(clips)
    rooted = skeleton.has_root_motion and anatomy.joint("hips") != 0
    turned = partial(_turn, parents=np.array(skeleton.parents), rooted=rooted, turn=turn)
    return (
        replace(skeleton, rest=turned(skeleton.rest)),
        {name: replace(clip, poses=turned(clip.poses)) for name, clip in clips.items()},
    )


def _turn(pose: Pose, parents: NDArray[np.intp], rooted: bool, turn: Array) -> Pose:
    """Return poses (…, joints) turned about the origin; a root keeps its own axes."""
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    carried = parents == 0 if rooted else parents < 0
    translations[..., carried, :] = rotations.rotate(turn, translations[..., carried, :])
    turns[..., carried, :] = rotations.multiply(turn, turns[..., carried, :])
    if rooted:
        translations[..., 0, :] = rotations.rotate(turn, translations[..., 0, :])
        own = rotations.multiply(turns[..., 0, :], rotations.conjugate(turn))
        turns[..., 0, :] = rotations.multiply(turn, own)
    return replace(pose, translations=translations, rotations=turns)
