"""The bones of a person as other programs expect them: turned from a T-pose, in straight axes.

VRM 0 and Unity call such bones normalised: at rest, with arms out and legs straight, no bone is
turned, whatever the axes and the rest pose of the file. So one model shows the pose of another.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import Character
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import BODY_PARTS, SIDES
from cubeling.characters.skeleton.pose import Array, Pose

DOWN = np.array([0.0, -1.0, 0.0])
OUTWARDS = {"left": np.array([1.0, 0.0, 0.0]), "right": np.array([-1.0, 0.0, 0.0])}
"""Where legs and arms of a T-pose point, +x to the person's left, +y up, +z ahead."""

LIMBS = (("UpperArm", "LowerArm", "Hand"), ("UpperLeg", "LowerLeg", "Foot"))


class TPoseBones:
    """The bones of one character, turned from a T-pose.

    Raises CharacterError if the character is no person with hips.
    """

    def __init__(self, character: Character) -> None:
        anatomy = character.anatomy
        if anatomy.kind != "humanoid" or "hips" not in anatomy.joints:
            raise CharacterError(
                f"{character.name} is no person: other programs know only the bones of persons"
            )
        self._rig = Rig(character.skeleton, anatomy)
        parts = sorted(
            (part for part in BODY_PARTS if part in anatomy.joints), key=anatomy.joints.__getitem__
        )
        self.parts = tuple(parts)
        """Names of the bones that the body has, as in VRM 1.0, parents first."""
        self._joints = [anatomy.joints[part] for part in parts]
        self.parents = tuple(self._parent(joint) for joint in self._joints)
        """Number of each bone's parent, −1 for the hips."""
        self._straighten = self._straightening()
        self.offsets = self._offsets()
        """Where each bone is in its parent in the T-pose, (bones, 3) [m]; the hips in the body."""

    def _parent(self, joint: int) -> int:
        above = self._rig.chain_to(joint)[-2::-1]
        return next((self._joints.index(each) for each in above if each in self._joints), -1)

    def _straightening(self) -> Array:
        """Return what turns each bone at rest into the T-pose, (bones, 4)."""
        turns = dict.fromkeys(self.parts, rotations.IDENTITY)
        for side in SIDES:
            for limb, goal in zip(LIMBS, (OUTWARDS[side], DOWN), strict=True):
                turn = rotations.IDENTITY
                for start, end in pairwise(limb):
                    bone = self._rig.direction(side + start, side + end)
                    if bone is not None:
                        aligned = rotations.between(rotations.rotate(turn, bone), goal)
                        turn = rotations.multiply(aligned, turn)
                        turns[side + start] = turn
                if limb[-1] != "Hand" or side + "Hand" not in turns:
                    continue  # feet stay flat on the ground
                hand = self._rig.anatomy.joints[side + "Hand"]
                for part, joint in zip(self.parts, self._joints, strict=True):
                    if hand in self._rig.chain_to(joint):
                        turns[part] = turn
        return np.array([turns[part] for part in self.parts])

    def _offsets(self) -> Array:
        rest = self._rig.rest_positions[self._joints]
        offsets = rest.copy()
        for bone, parent in enumerate(self.parents):
            if parent >= 0:
                apart = rest[bone] - rest[parent]
                offsets[bone] = rotations.rotate(self._straighten[parent], apart)
        return offsets

    def update(self, pose: Pose) -> tuple[Array, NDArray[np.float64]]:
        """Return how the bones are turned in their parents, (bones, 4), and where the hips are [m].

        Both are in the axes of the body: +x to its left, +y up, +z ahead.
        """
        placements = pose.globals(self._rig.skeleton)[self._joints]
        to_common, rest = self._rig.common_from_skeleton, self._rig.rest_rotations[self._joints]
        now = rotations.multiply(to_common, rotations.from_matrix(_unscaled(placements)))
        turned = rotations.multiply(now, rotations.conjugate(rest))
        turned = rotations.multiply(turned, rotations.conjugate(self._straighten))
        local = turned.copy()
        children = [bone for bone, parent in enumerate(self.parents) if parent >= 0]
        above = turned[[self.parents[bone] for bone in children]]
        local[children] = rotations.multiply(rotations.conjugate(above), turned[children])
        hips = rotations.rotate(to_common, placements[self.parts.index("hips"), :3, 3])
        return local, np.asarray(hips)


def _unscaled(placements: Array) -> Array:
    """Return the rotations of placements (…, 4, 4) as matrices (…, 3, 3)."""
    matrices = placements[..., :3, :3]
    return np.asarray(matrices / np.linalg.norm(matrices, axis=-2, keepdims=True))
