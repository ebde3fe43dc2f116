"""Where the joints of a body are in a pose: the forward kinematics of trunk, arms, legs and neck.

The joints have numbers of their own: ancestors come first, then forearms and hands, then legs and
neck, so that the last can be left out. The frames are lists: for so few joints these are faster
than arrays.
"""

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.heels import angle_at
from cubeling.characters.ik.reaching.arms import Arm, to_quaternion, turns_of
from cubeling.characters.ik.reaching.stance import StandingLegs
from cubeling.characters.ik.reaching.torso import FOUR_LEGS, PlacedTorso
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.joint_chains import chains_to_root
from cubeling.characters.skeleton.natural_limits import natural_limits
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    conjugate,
    make_global,
    multiply,
)

Extent = Literal["upper", "arms", "all"]
"""Trunk and upper arms, with forearms and hands, or with legs and neck as well."""


class Frames(NamedTuple):
    """Global frames of the joints of a body and their ancestors, in one pose."""

    turns: list[Quaternion]
    """`character_from_joint` rotations."""

    places: list[Vector]
    """[m]."""


class UpperBodyKinematics:
    """The joints of a trunk and its arms, and their ancestors, in one skeleton."""

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy, arms: Mapping[str, Arm]) -> None:
        trunk = _trunk(skeleton, anatomy, arms)
        roots = skeleton.with_ancestors([*trunk, *(arm.joints[1] for arm in arms.values())])
        ends = skeleton.with_ancestors(arm.joints[3] for arm in arms.values())
        order = [*roots, *(joint for joint in ends if joint not in roots)]
        self._counts = {"upper": len(roots), "arms": len(order)}
        self.stance = StandingLegs.of(skeleton, anatomy)
        """Its pelvis, legs and neck."""
        below = skeleton.with_ancestors(self.stance.joints)
        order += [joint for joint in below if joint not in order]
        self._counts["all"] = len(order)
        self._order = np.array(order, np.intp)
        number = {joint: place for place, joint in enumerate(order)} | {-1: -1}
        self.number: Mapping[int, int] = number
        """Numbers of the skeleton's joints; −1 of none, which is −1 too."""
        self.parents = [number[skeleton.parents[joint]] for joint in order]
        """Number of each joint's parent; −1 of a root."""
        rest = skeleton.rest.globals(skeleton)
        self.height = float(np.ptp(rest[:, 1, 3]))
        """From the lowest joint at rest to the highest one [m]."""
        self.ankle_angles = [
            angle_at(*(tuple(rest[joint, :3, 3].tolist()) for joint in (ankle, knee, toe)))
            for (_, knee, ankle), toe in zip(self.stance.legs, self.stance.toes, strict=True)
        ]
        """Between shin and foot at rest, of each leg [rad]."""
        self._rest = [to_quaternion(turn) for turn in turns_of(rest[order, :3, :3])]
        self._sizes = _scales_above(rest, self._order, skeleton)
        self.trunk_joints = np.array(trunk, np.intp)
        """The skeleton's joints that bend the trunk, from the lowest one on."""
        limits = natural_limits(skeleton, anatomy)[trunk]
        # Of (twist, side, bend), as bow, turn and tilt.
        low, high = (each.sum(0)[[2, 0, 1]].tolist() for each in (limits.low, limits.high))
        self.spine_ranges: list[tuple[float, float]] = list(zip(low, high, strict=True))
        """How far they bow, turn and tilt together, by their natural limits [rad]."""
        self._trunk = [number[joint] for joint in trunk]
        self._pelvis = self.parents[self._trunk[0]] if self._trunk else -1
        self._first = [number[arm.joints[arm.joints[0] < 0]] for arm in arms.values()]
        carriers = [number[arm.carrier] for arm in arms.values()]
        self._chest = self._trunk[-1] if self._trunk else (carriers[0] if carriers else -1)
        self._limits = FOUR_LEGS if anatomy.kind == "quadruped" else 1.0

    def frames(self, pose: Pose, extent: Extent = "upper") -> Frames:
        """Return the frames of trunk and upper arms, with the whole arms, or all."""
        count = self._counts[extent]
        order = self._order[:count]
        turns: list[Quaternion] = pose.rotations.take(order, 0).tolist()
        places: list[Vector] = (pose.translations.take(order, 0) * self._sizes[:count]).tolist()
        make_global(turns, places, self.parents[:count])
        return Frames(turns, places)

    def size_above(self, number: int) -> float:
        """Return the scale at rest of what carries a joint, by its number here."""
        return float(self._sizes[number, 0])

    def torso(self, frames: Frames) -> PlacedTorso:
        """Return the torso of a body with arms, as it is in a pose."""
        x, y, z = frames.places[self._first[0]]
        ox, oy, oz = frames.places[self._first[-1]]
        return PlacedTorso(
            [frames.places[joint] for joint in self._trunk],
            self._from_rest(frames, self._pelvis),
            self._from_rest(frames, self._chest),
            (0.5 * (x + ox), 0.5 * (y + oy), 0.5 * (z + oz)),
            self._limits,
        )

    def turn_trunk(self, local: Array, frames: Frames, step: Quaternion) -> None:
        """Write the local rotations (joints, 4) of a trunk each of whose joints turns by a step."""
        if not self._trunk:
            return
        rows = []
        for joint in self._trunk:
            parent = self.parents[joint]
            above = frames.turns[parent] if parent >= 0 else IDENTITY
            rows.append(multiply(conjugate(above), multiply(step, frames.turns[joint])))
        local[self.trunk_joints] = rows

    def _from_rest(self, frames: Frames, joint: int) -> Quaternion:
        return (
            multiply(frames.turns[joint], conjugate(self._rest[joint])) if joint >= 0 else IDENTITY
        )


def _trunk(skeleton: Skeleton, anatomy: Anatomy, arms: Mapping[str, Arm]) -> list[int]:
    """Return the joints from the spine to what carries the arms; [] if they move no arm."""
    chains = chains_to_root(skeleton.parents)
    lines = [chains[arm.carrier] for arm in arms.values() if arm.carrier >= 0]
    if len(lines) < len(arms) or not lines:
        return []
    common = [joint for joint in lines[0] if all(joint in line for line in lines)]
    spine, hips = anatomy.joint("spine"), anatomy.joint("hips")
    if spine in common:
        return common[common.index(spine) :]
    return common[common.index(hips) + 1 :] if hips in common else []


def _scales_above(rest: Array, order: NDArray[np.intp], skeleton: Skeleton) -> Array:
    """Return the scales at rest of the joints' parents, (n, 1)."""
    sizes = np.append(np.linalg.norm(rest[:, :3, :3], axis=1).max(1), 1.0)
    above = np.array(skeleton.parents)[order]
    scales: Array = sizes[above][:, None]
    return scales
