"""Skeletons with an unrotated rest pose, and posed rigs of all frames at once.

In the rest pose every joint has the axes of the character frame, so a joint rotation about +x nods
forward, about +y turns to the left, and about +z leans to the right.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from cubeling.characters.skeleton.skeleton_part import SkeletonPart
from tools.authoring.modelling.ik import aim_rotation, hinge_position
from tools.authoring.modelling.shapes import Array, Vector, mirrored_name


def build_skeleton(joints: Mapping[str, tuple[str, Vector]]) -> Skeleton:
    """Return a skeleton from each joint's parent and position; "Left" joints are mirrored.

    Parameters
    ----------
    joints : parent's name ("" for the root) and position in the character frame [m] by name,
        parents first
    """
    places = dict(joints)
    for name, (parent, (x, y, z)) in joints.items():
        if name != mirrored_name(name):
            places[mirrored_name(name)] = (mirrored_name(parent), (-x, y, z))
    names = tuple(places)
    parents = tuple(names.index(parent) if parent else -1 for parent, _ in places.values())
    world = np.array([place for _, place in places.values()])
    local = world - np.where(np.array(parents)[:, None] >= 0, world[list(parents)], 0.0)
    return Skeleton(names, parents, Pose(local, np.tile(rotations.IDENTITY, (len(names), 1))))


def rest_positions(skeleton: Skeleton) -> dict[str, Array]:
    """Return the rest position of each joint in the character frame, (3,) each [m]."""
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    return dict(zip(skeleton.names, places, strict=True))


class PosedRig:
    """A skeleton in `frames` poses, edited joint by joint in the frame of its root."""

    def __init__(self, skeleton: Skeleton, frames: int) -> None:
        """Start in the rest pose."""
        self.skeleton = skeleton
        self._rest = rest_positions(skeleton)
        self._translations = np.tile(skeleton.rest.translations, (frames, 1, 1))
        self._rotations = np.tile(skeleton.rest.rotations, (frames, 1, 1))

    @property
    def pose(self) -> Pose:
        """All poses, (frames, joints, …)."""
        return Pose(self._translations, self._rotations)

    def rest(self, name: str) -> Array:
        """Return the rest position of a joint, (3,) [m]."""
        return self._rest[name]

    def shift(self, name: str, offset: ArrayLike) -> None:
        """Move a joint in its parent's axes by (frames, 3) or (3,) [m]."""
        self._translations[:, self.skeleton.names.index(name)] += np.asarray(offset, float)

    def turn(self, name: str, rotation: ArrayLike) -> None:
        """Rotate a joint in its own axes by quaternions (frames, 4) or (4,)."""
        joint = self.skeleton.names.index(name)
        self._rotations[:, joint] = rotations.multiply(self._rotations[:, joint], rotation)

    def places(self, name: str) -> Array:
        """Return the positions of a joint, (frames, 3) [m]."""
        joint = self.skeleton.names.index(name)
        above = SkeletonPart.of(self.skeleton, [joint])  # in order: the joint is its last
        return np.asarray(above.globals(self.pose)[:, -1, :3, 3])

    def facing(self, name: str) -> Array:
        """Return the rotation of a joint in the character frame, (frames, 4)."""
        joint, result = self.skeleton.names.index(name), None
        while joint >= 0:
            own = self._rotations[:, joint]
            result = own if result is None else rotations.multiply(own, result)
            joint = self.skeleton.parents[joint]
        return np.asarray(result)

    def face(self, name: str, facing: Array) -> None:
        """Set the rotation of a joint in the character frame, (frames, 4)."""
        joint = self.skeleton.names.index(name)
        parent = self.skeleton.names[self.skeleton.parents[joint]]
        above = rotations.conjugate(self.facing(parent))
        self._rotations[:, joint] = rotations.multiply(above, facing)

    def place_foot(self, side: str, ankle: Array, facing: Array, toe: Array) -> None:
        """Bend a leg so that its foot has a position and rotation.

        Parameters
        ----------
        side : "Left" or "Right"
        ankle : (frames, 3) [m]
        facing : of the foot in the character frame, (frames, 4)
        toe : bend of the toes, (frames,), positive upwards [rad]
        """
        forward = _flat(_ahead(facing) + _ahead(self.facing("hips")))
        legs = (f"{side}UpLeg", f"{side}Leg", f"{side}Foot")
        self._bend_limb(legs, ankle, forward, np.array([0.0, 0.0, 1.0]))
        self.face(legs[2], facing)
        self.turn(f"{side}Toe", rotations.about("x", -toe))

    def place_hand(self, side: str, wrist: Array, facing: Array, elbow: Array) -> None:
        """Bend an arm so that its hand has a position and rotation.

        Parameters
        ----------
        side : "Left" or "Right"
        wrist : (frames, 3) [m]
        facing : of the hand in the character frame, (frames, 4)
        elbow : direction to which the elbow points, (frames, 3)
        """
        arm = (f"{side}Arm", f"{side}ForeArm", f"{side}Hand")
        self._bend_limb(arm, wrist, elbow, np.array([0.0, 0.0, -1.0]))
        self.face(arm[2], facing)

    def _bend_limb(
        self, names: tuple[str, str, str], end: Array, pole: Array, rest_pole: Array
    ) -> None:
        """Rotate two bones so that the third joint is at `end`, bending towards `pole`."""
        first, second, third = (self.rest(name) for name in names)
        upper, lower = second - first, third - second
        start = self.places(names[0])
        lengths = float(np.linalg.norm(upper)), float(np.linalg.norm(lower))
        middle = hinge_position(start, end, pole, *lengths)
        rest_hinge, hinge = np.cross(rest_pole, third - first), np.cross(pole, end - start)
        self.face(names[0], aim_rotation(upper, rest_hinge, middle - start, hinge))
        self.face(names[1], aim_rotation(lower, rest_hinge, end - middle, hinge))

    def leg_extension(self, side: str, ankle: Array) -> Array:
        """Return the distance from hip to ankle over the length of the leg, (frames,)."""
        hip, knee, foot = (self.rest(f"{side}{part}") for part in ("UpLeg", "Leg", "Foot"))
        length = float(np.linalg.norm(knee - hip) + np.linalg.norm(foot - knee))
        reach = np.linalg.norm(ankle - self.places(f"{side}UpLeg"), axis=-1)
        return np.asarray(reach / length)


def mirrored(pose: Pose, skeleton: Skeleton) -> Pose:
    """Return poses (…, joints, …) reflected in the plane x = 0: left becomes right."""
    swap = [skeleton.names.index(mirrored_name(name)) for name in skeleton.names]
    translations = pose.translations[..., swap, :] * [-1.0, 1.0, 1.0]
    return Pose(translations, pose.rotations[..., swap, :] * [1.0, -1.0, -1.0, 1.0])


def _ahead(facing: Array) -> Array:
    return rotations.rotate(facing, [0.0, 0.0, 1.0])


def _flat(direction: Array) -> Array:
    return direction * [1.0, 0.0, 1.0]
