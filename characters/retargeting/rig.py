"""A skeleton with its anatomy, in axes that all skeletons share: +y up and +z ahead."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.retargeting.soles import Sole, shared_skin, skin_of_joints
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.facing import common_from_skeleton
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.skeleton_part import SkeletonPart

_STANDING_HEIGHT = (-0.02, 0.12)  # of the lowest joint of a standing rest pose, in body sizes
_MAX_HOVERING = 0.2  # of feet above the ground at rest, in leg lengths
_FOOT_LENGTH, _ANKLE_HEIGHT = 0.15, 0.09  # [leg lengths], of feet without toes and skin
_MAX_STANDING_SPREAD = 0.2  # [rad]: legs farther apart at rest do not stand; see `Rig.flat_foot`


@dataclass(frozen=True)
class LegJoints:
    """The joints of a leg; its ankle is a point of the shin, even if the foot is detached."""

    upper: int
    """Joint of the thigh."""

    lower: int
    """Joint of the shin."""

    foot: int
    """Joint of the foot."""

    toes: int | None
    """Joint of the toes, at the ball of the foot, if there is one."""

    attached: bool
    """Whether the foot is below the shin in the tree; some IK rigs have it elsewhere."""

    @property
    def end(self) -> int:
        """The joint that is nearest to the ground."""
        return self.foot if self.toes is None else self.toes


@dataclass(frozen=True)
class Rig:
    """A skeleton with its anatomy; measures are in the common axes."""

    skeleton: Skeleton

    anatomy: Anatomy
    """Which joint is which body part."""

    meshes: Sequence[Mesh] = ()
    """The skin of a character: where its soles are; without it, that is assumed."""

    @cached_property
    def common_from_skeleton(self) -> Array:
        """The rotation (4,) from the skeleton's axes to the common ones, by quarter turns."""
        return common_from_skeleton(self.skeleton, self.anatomy)

    @cached_property
    def rest_rotations(self) -> Array:
        """Global rotations at rest, (joints, 4)."""
        rest = self.skeleton.rest.globals(self.skeleton)
        return rotations.multiply(self.common_from_skeleton, global_rotations(rest))

    @cached_property
    def rest_positions(self) -> Array:
        """Positions at rest, (joints, 3) [m]."""
        rest = self.skeleton.rest.globals(self.skeleton)
        return rotations.rotate(self.common_from_skeleton, rest[:, :3, 3])

    @cached_property
    def legs(self) -> tuple[LegJoints, ...]:
        """Its legs, left before right, hind before front."""
        return tuple(
            leg
            for front in ("", "Front")
            for side in SIDES
            if (leg := self._leg(side + front)) is not None
        )

    def _leg(self, side: str) -> LegJoints | None:
        joint = self.anatomy.joint
        upper, lower, foot = (joint(side + part) for part in ("UpperLeg", "LowerLeg", "Foot"))
        if upper is None or lower is None or foot is None or upper not in self.chain_to(lower):
            return None
        return LegJoints(upper, lower, foot, joint(side + "Toes"), lower in self.chain_to(foot))

    def chain_to(self, joint: int) -> list[int]:
        """Return the ancestors of a joint from the root down, and the joint itself."""
        return self.skeleton.with_ancestors([joint])

    def placements(self, pose: Pose, joints: Sequence[int]) -> Array:
        """Return global placements (…, joints, 4, 4) of some joints and what is above them.

        Those of the others are zero; legs are a few joints of many.
        """
        part = SkeletonPart.of(self.skeleton, joints)
        found = np.zeros((*pose.rotations.shape[:-1], 4, 4))
        found[..., part.joints, :, :] = part.globals(pose)
        return found

    def direction(self, start: str, end: str) -> Array | None:
        """Return the unit vector (3,) from one body part to another at rest, or None."""
        a, b = self.anatomy.joint(start), self.anatomy.joint(end)
        if a is None or b is None:
            return None
        bone = self.rest_positions[b] - self.rest_positions[a]
        length = float(np.linalg.norm(bone))
        return bone / length if length > 1e-9 else None

    @cached_property
    def leg_length(self) -> float:
        """Mean length of the legs [m]: along the bones from hip to ankle for a person.

        Quadrupeds stand on bent legs, on toes or on soles: for them, the standing height of the
        hip counts.
        """
        if self.anatomy.kind == "quadruped":
            lengths = [
                float(self.rest_positions[leg.upper, 1] - self.rest_positions[leg.end, 1])
                for leg in self.legs
            ]
        else:
            lengths = [sum(self.bone_lengths(leg)) for leg in self.legs]
        if not lengths or not min(lengths) > 0:
            raise CharacterError(
                "retargeting needs legs, but of thigh, shin and foot "
                f"{', '.join(self.anatomy.missing) or 'some'} are missing; "
                "say which joints they are in a [joints] table"
            )
        return float(np.mean(lengths))

    def bone_lengths(self, leg: LegJoints) -> tuple[float, float]:
        """Return the lengths of thigh and shin [m]."""
        hip, knee, ankle = self.rest_positions[[leg.upper, leg.lower, leg.foot]]
        return float(np.linalg.norm(knee - hip)), float(np.linalg.norm(ankle - knee))

    @cached_property
    def rests_on_feet(self) -> bool:
        """Whether its feet are on the ground at rest, as those of models are."""
        size = float(np.ptp(self.rest_positions, axis=0).max()) or 1.0
        lowest = min(float(self.rest_positions[leg.end, 1]) for leg in self.legs) / size
        return _STANDING_HEIGHT[0] < lowest < _STANDING_HEIGHT[1]

    def flat_foot(self, leg: LegJoints) -> Array:
        """Return the rotation (4,) from +z ahead and +y up to those of a flat foot at rest.

        Models rest on flat feet. The soles of a recorded skeleton, whose legs are spread in its
        zero pose, are perpendicular to the shin.
        """
        shin = self.rest_positions[leg.upper] - self.rest_positions[leg.foot]
        up = np.array([0.0, 1.0, 0.0])
        if self._leg_spread > _MAX_STANDING_SPREAD:
            up = np.array([shin[0], shin[1], 0.0]) / float(np.hypot(shin[0], shin[1]))
        ahead = np.array([0.0, 0.0, 1.0])
        if leg.toes is not None:
            ahead = self.rest_positions[leg.toes] - self.rest_positions[leg.foot]
        ahead = ahead - up * float(ahead @ up)
        ahead = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
        return rotations.from_matrix(np.stack([np.cross(up, ahead), up, ahead], axis=-1))

    @cached_property
    def floor(self) -> float | None:
        """Height of the ground under its feet at rest [m], or None if it does not rest on them."""
        if not self.rests_on_feet:
            return None
        heights = [self.rest_positions[leg.foot, 1] + self.sole(leg).lowest for leg in self.legs]
        return float(min(heights))

    def standing_ankle_height(self, leg: LegJoints) -> float:
        """Return the height of an ankle whose sole is on the ground [m].

        At rest the feet of some models are a little above the ground; those that are far above it
        are hands.
        """
        at_rest = float(self.rest_positions[leg.foot, 1])
        hovers = 0.0 if self.floor is None else at_rest + self.sole(leg).lowest - self.floor
        return at_rest - (hovers if hovers < _MAX_HOVERING * self.leg_length else 0.0)

    def sole(self, leg: LegJoints) -> Sole:
        """Return the underside of a foot at rest."""
        return self._soles[leg.foot]

    @cached_property
    def _soles(self) -> dict[int, Sole]:
        """The undersides of the feet by joint."""
        return {leg.foot: self._sole(leg) for leg in self.legs}

    def _sole(self, leg: LegJoints) -> Sole:
        toes = [] if leg.toes is None else subtree(self.skeleton, leg.toes)
        foot = [joint for joint in subtree(self.skeleton, leg.foot) if joint not in toes]
        ankle = self.rest_positions[leg.foot]
        ball = None if leg.toes is None else self.rest_positions[leg.toes] - ankle
        ahead = rotations.rotate(self.flat_foot(leg), [0.0, 0.0, 1.0])
        rest = self.skeleton.rest.globals(self.skeleton)
        points, tips = (
            rotations.rotate(self.common_from_skeleton, skin_of_joints(self.meshes, rest, *parts))
            for parts in ((foot, toes), (toes, foot))
        )
        if len(points) and (ball is None or len(tips)):
            origin = ankle if ball is None else ankle + ball
            return Sole.of(points - ankle, tips - origin, ball, ahead)
        height = float(ankle[1]) if self.rests_on_feet else self._assumed_ankle_height(leg)
        return Sole.assume(ball, height, ahead, _FOOT_LENGTH * self.leg_length)

    def foot_joints(self, leg: LegJoints) -> list[int]:
        """Return the joints that move with a foot or its toes."""
        ends = {leg.foot, leg.end}
        return sorted({joint for end in ends for joint in subtree(self.skeleton, end)})

    def sole_depths(self, pose: Pose, legs: Sequence[LegJoints]) -> Array:
        """Return how deep skin that feet share with their shins is below the floor [m].

        A `Sole` is rigid; shared skin goes elsewhere when the foot turns. (frames, legs), at
        least 0.
        """
        depths = np.zeros((len(pose.rotations), len(legs)))
        if self.floor is None or not any(self._shared_skin[leg.foot] for leg in legs):
            return depths
        placements = pose.globals(self.skeleton)
        for number, leg in enumerate(legs):
            for part in self._shared_skin[leg.foot]:
                points = rotations.rotate(self.common_from_skeleton, skin(part, placements))
                below = self.floor - points[..., 1].min(-1)
                depths[:, number] = np.maximum(depths[:, number], below)
        return depths

    @cached_property
    def _shared_skin(self) -> dict[int, list[Mesh]]:
        """The skin that each foot shares with its shin, by joint."""
        return {leg.foot: shared_skin(self.meshes, self.foot_joints(leg)) for leg in self.legs}

    def _assumed_ankle_height(self, leg: LegJoints) -> float:
        """Return the height of an ankle whose ground is not known [m]."""
        if leg.toes is None:
            return _ANKLE_HEIGHT * self.leg_length
        up = rotations.rotate(self.flat_foot(leg), [0.0, 1.0, 0.0])
        return 1.5 * float(up @ (self.rest_positions[leg.foot] - self.rest_positions[leg.toes]))

    @cached_property
    def _leg_spread(self) -> float:
        """Greatest angle between a leg and the vertical, seen from the front [rad]."""
        positions = self.rest_positions
        bones = [positions[leg.upper] - positions[leg.foot] for leg in self.legs]
        return max(abs(float(np.arctan2(bone[0], bone[1]))) for bone in bones)


def leg_pairs(source: Rig, target: Rig) -> list[tuple[LegJoints, LegJoints]]:
    """Return the legs that both rigs have."""
    by_part = {source.anatomy.parts[leg.foot]: leg for leg in source.legs}
    return [
        (by_part[part], leg)
        for leg in target.legs
        if (part := target.anatomy.parts[leg.foot]) in by_part
    ]


def global_rotations(placements: Array) -> Array:
    """Return the rotations (…, 4) of placements (…, 4, 4) without their scale."""
    matrices = placements[..., :3, :3]
    lengths = np.linalg.norm(matrices, axis=-2, keepdims=True)
    return rotations.from_matrix(matrices / np.where(lengths > 0, lengths, 1.0))
