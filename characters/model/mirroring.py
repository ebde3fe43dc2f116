"""The mirror of a character."""

from collections.abc import Mapping

import numpy as np

from cubeling.characters.model.bind_pose import bind_placements
from cubeling.characters.model.character import Character
from cubeling.characters.motion.mirror import LENGTH_TOLERANCE, NO_PAIRS, Mirror
from cubeling.characters.skeleton.pose import Pose


def mirror_of(
    character: Character, pairs: Mapping[str, str] = NO_PAIRS, symmetric: Pose | None = None
) -> Mirror:
    """Return the mirror of a character, by a pose in which its skin is symmetric.

    Parameters
    ----------
    character
        The character.
    pairs
        Partners that cannot be found, by joint names; each pair applies both ways.
    symmetric
        A pose (joints, …) that is symmetric about x = 0; left out, the one that the skin was bound
        in: files often rest in the middle of a stride.

    Raises
    ------
    CharacterError
        If that pose is not symmetric, or a joint has no partner.
    """
    skeleton = character.skeleton
    skinned = np.zeros(len(skeleton), bool)
    for mesh in character.meshes:
        skinned[mesh.joints[mesh.weights > 0]] = True
    if symmetric is not None:
        placements = symmetric.globals(skeleton)
    else:
        placements, _ = bind_placements(character)
        # Parts bound away from the rest pose are modelled about a plane of their own.
        rest = skeleton.rest.globals(skeleton)[:, :3, 3]
        distances = np.linalg.norm(placements[:, :3, 3] - rest, axis=-1)
        skinned &= distances < 100 * LENGTH_TOLERANCE * np.ptp(rest, axis=0).max()
    return Mirror.about(skeleton, character.morphs, pairs, placements, skinned)
