"""The outline of a body: few points whose hull bounds it in any pose."""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.body.extreme_vertices import extreme_vertices
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array


class Outline:
    """Extreme vertices of each joint of a character; they move as if they were rigid."""

    def __init__(self, character: Character) -> None:
        joints: list[NDArray[np.intp]] = []
        places: list[Array] = []
        for mesh in character.meshes:
            if not len(mesh.positions):
                continue
            movers = mesh.movers
            chosen = extreme_vertices(mesh.positions, movers.astype(np.uint32))
            carriers = mesh.inverse_bind[movers[chosen]]
            points = np.column_stack([mesh.positions[chosen], np.ones(len(chosen))])
            joints.append(movers[chosen])
            places.append(np.einsum("nij,nj->ni", carriers[:, :3], points))
        self._joints = np.concatenate(joints) if joints else np.zeros(0, np.intp)
        self._places = np.concatenate(places) if places else np.zeros((0, 3))
        arms = _arms(character)
        self.is_arm = np.isin(self._joints, list(arms))
        """Which of the points are of arms, (n,)."""

    def points(self, table_from_joints: Array) -> Array:
        """Return the points, (n, 3), for placements of the joints, (joints, 4, 4)."""
        carriers = table_from_joints[self._joints, :3]
        turned = np.einsum("nij,nj->ni", carriers[:, :, :3], self._places)
        found: Array = turned + carriers[:, :, 3]
        return found


def _arms(character: Character) -> Collection[int]:
    """Return the joints of both arms, down to the fingers."""
    return {
        joint
        for arm in character.upper_body.arms.values()
        for joint in subtree(character.skeleton, arm.joints[1])
    }
