"""Bodies that reach, and what is measured on them."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from cubeling.characters import Character, Pose
from cubeling.characters.ik.reaching import UpperBody
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton

PERSON_M = 1.7
"""Height to which lengths are scaled [m]."""

BUNDLED = ("human", "vleo", "robot")


@dataclass(frozen=True)
class Body:
    """A body in its rest pose, with what tests look at."""

    skeleton: Skeleton
    anatomy: Anatomy
    upper: UpperBody
    height: float

    @property
    def rest(self) -> Pose:
        """The rest pose."""
        return self.skeleton.rest

    def place(self, pose: Pose, joint: int) -> Array:
        """Return where a joint is, (3,) [m]."""
        where: Array = pose.globals(self.skeleton)[joint, :3, 3]
        return where

    def shoulder(self, side: str, pose: Pose | None = None) -> Array:
        """Return where an upper arm begins, (3,) [m]."""
        return self.place(pose or self.rest, self.upper.arms[side].joints[1])

    def elbow(self, side: str, pose: Pose) -> Array:
        """Return where an elbow is, (3,) [m]."""
        return self.place(pose, self.upper.arms[side].joints[2])

    def wrist(self, side: str, pose: Pose) -> Array:
        """Return where a wrist is, (3,) [m]."""
        return self.place(pose, self.upper.arms[side].joints[3])

    def palm(self, side: str, pose: Pose) -> Array:
        """Return where a palm is, (3,) [m], by the rest pose's offset from the hand's joint."""
        hand = self.upper.arms[side].hand
        rest, now = (each.globals(self.skeleton)[hand.joint] for each in (self.rest, pose))
        return np.asarray((now @ np.linalg.inv(rest) @ [*hand.palm, 1.0])[:3])

    def reach_of(self, side: str) -> float:
        """Return the length of an arm to the palm [m]."""
        arm = self.upper.arms[side]
        return arm.upper + float(np.linalg.norm(arm.hand.palm - np.array(arm.elbow)))

    def from_trunk(self, place: Array, pose: Pose) -> float:
        """Return how far a place is from the trunk [m]: from its axis, or to the side of it."""
        hips, neck = (self.place(pose, self.anatomy.joints[part]) for part in ("hips", "neck"))
        if self.anatomy.kind == "quadruped":
            return float(abs((self.chest(pose).T @ (place - neck))[0]))
        along = np.clip((place - hips) @ (neck - hips) / ((neck - hips) @ (neck - hips)), 0.0, 1.0)
        return float(np.linalg.norm(place - hips - along * (neck - hips)))

    def chest(self, pose: Pose) -> Array:
        """Return the rotation of what carries the arms from its rest, (3, 3)."""
        carrier = next(iter(self.upper.arms.values())).carrier
        rest, now = (each.globals(self.skeleton)[carrier, :3, :3] for each in (self.rest, pose))
        return np.asarray(now @ np.linalg.inv(rest))

    def lean(self, pose: Pose) -> float:
        """Return how far the chest leans from upright [rad]."""
        return float(np.arccos(np.clip(self.chest(pose)[1, 1], -1.0, 1.0)))

    def turn(self, pose: Pose) -> float:
        """Return how far the chest is turned to the left [rad]."""
        ahead = self.chest(pose)[:, 2]
        return float(np.arctan2(ahead[0], ahead[2]))

    def person_mm(self, length: Array) -> float:
        """Return the length of a vector [mm], scaled to a person."""
        return float(np.linalg.norm(length)) / self.height * PERSON_M * 1e3


@cache
def bundled(name: str) -> Body:
    """Return a bundled character."""
    character = Character.load(name)
    return Body(character.skeleton, character.anatomy, character.upper_body, character.height)


def stick(*, arms: tuple[str, ...] = ("left", "right"), bone: float = 0.25) -> Body:
    """Return a person of sticks in T-pose without collarbones and fingers.

    Both joints of its trunk are at one place, so that it leans as one bone does.
    """
    names, parents = ["hips", "spine", "chest"], [-1, 0, 1]
    shifts = [(0.0, 1.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.0)]
    joints = {"hips": 0, "spine": 1, "chest": 2}
    for side in arms:
        sign = 1.0 if side == "left" else -1.0
        for part, shift in zip(
            ("UpperArm", "LowerArm", "Hand"),
            ((0.15, 0.4, 0.0), (bone, 0.0, 0.0), (bone, 0.0, 0.0)),
            strict=True,
        ):
            joints[side + part] = len(names)
            parents.append(2 if part == "UpperArm" else len(names) - 1)
            names.append(side + part)
            shifts.append((sign * shift[0], shift[1], shift[2]))
    rest = Pose(np.array(shifts, float), np.tile(rotations.IDENTITY, (len(names), 1)))
    skeleton, anatomy = Skeleton(tuple(names), tuple(parents), rest), Anatomy("humanoid", joints)
    return Body(skeleton, anatomy, UpperBody.of(skeleton, anatomy), 1.7)
