"""The mirror of a character, by the pose in which its skin is symmetric."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from characters.model.character import Character
from characters.motion.mirror import EXACT, Mirror
from characters.skeleton.pose import Pose

_NONE: Mapping[str, str] = MappingProxyType({})


def mirror_of(
    character: Character, pairs: Mapping[str, str] = _NONE, symmetric: Pose | None = None
) -> Mirror:
    """Return the mirror of a character, by a pose in which its skin is symmetric.

    That is the pose given, such as one of its clips' "idle"; else the one that the skin was
    bound in, since files often rest in the first frame of a clip.

    Raises
    ------
    CharacterError
        If that pose is not symmetric, or a joint has no partner.
    """
    skeleton = character.skeleton
    rest = skeleton.rest.globals(skeleton)
    bound = rest.copy() if symmetric is None else symmetric.globals(skeleton)
    skinned = np.zeros(len(skeleton), bool)
    for mesh in character.meshes:
        used = np.unique(mesh.joints[mesh.weights > 0])
        skinned[used] = True
        if symmetric is None:
            # What hangs rigidly on a joint is bound in that joint's frame, wherever it rests.
            used = used[np.abs(mesh.inverse_bind[used] - np.eye(4)).max((1, 2)) > EXACT]
            bound[used] = np.linalg.inv(mesh.inverse_bind[used])
    if symmetric is None:
        # Bound elsewhere than at rest means modelled for it, about a plane of its own.
        far = np.linalg.norm(bound[:, :3, 3] - rest[:, :3, 3], axis=-1)
        skinned &= far < 100 * EXACT * np.ptp(rest[:, :3, 3], axis=0).max()
    return Mirror.about(skeleton, character.morphs, pairs, bound, skinned)
