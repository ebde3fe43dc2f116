"""Fingers of motions that have none: hands hang relaxed, not flat.

A relaxed finger is bent at each joint, the index least and the little finger most, and the thumb
is turned a little towards the palm. A hand that is bent at rest already stays as it is.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array

# Flexion from one bone to the next [deg]: at the knuckle, the middle joint and the last one.
_RELAXED_DEG = {
    "Index": (15.0, 20.0, 15.0),
    "Middle": (20.0, 25.0, 17.0),
    "Ring": (24.0, 30.0, 20.0),
    "Little": (28.0, 35.0, 22.0),
}
_FINGER_PARTS = ("Proximal", "Intermediate", "Distal")
_THUMB_DEG = {"Metacarpal": 12.0, "Proximal": 10.0, "Distal": 15.0}
_MAX_STILL_RAD = np.radians(2.0)  # fingers that turn less in all of a clip were not recorded
_MAX_FLAT_RAD = np.radians(8.0)  # mean flexion of a flat hand


def relaxed_rest(target: Rig, source: Rig, joints: NDArray[np.intp], turns: Array) -> Array:
    """Return the rest rotations of a target, (joints, 4), with relaxed fingers where none move.

    Parameters
    ----------
    target, source
        The rig that is to move, and that of the motion.
    joints
        Joints of the target that the motion moves, (n,).
    turns
        Their rotations from rest in the motion, (frames, n, 4), in the common axes.
    """
    rest = target.rest_rotations.copy()
    if target.anatomy.kind != "humanoid":
        return rest
    hands = [hand for side in SIDES if (hand := _Hand.of(target, side)) is not None]
    moving = {int(joint): turns[:, number] for number, joint in enumerate(joints)}
    fingers = {
        hand.joint: {joint: moving[joint] for joint in hand.finger_joints if joint in moving}
        for hand in hands
    }
    if (
        not _have_the_same_hands(source, target)
        and _are_flat(source)
        and all(_are_still(moving.get(hand), of) for hand, of in fingers.items())
    ):
        fingers = {hand.joint: {} for hand in hands}
    for hand in hands:
        for joint, turn in hand.relaxing_turns():
            if not fingers[hand.joint].keys() & set(target.chain_to(joint)):
                rest[joint] = rotations.multiply(turn, target.rest_rotations[joint])
    return rest


def _have_the_same_hands(source: Rig, target: Rig) -> bool:
    """Return whether two rigs are one body, whose own motions keep its fingers as they are."""
    theirs, own = (
        {
            rig.skeleton.names[joint]: rig.skeleton.rest.translations[joint]
            for side in SIDES
            if (hand := _Hand.of(rig, side)) is not None
            for joint in hand.finger_joints
        }
        for rig in (source, target)
    )
    return theirs.keys() == own.keys() and all(np.allclose(theirs[n], own[n]) for n in own)


def _are_flat(rig: Rig) -> bool:
    """Return whether the fingers of both hands are straight at rest."""
    hands = [_Hand.of(rig, side) for side in SIDES]
    return all(hand is None or hand.mean_flexion < _MAX_FLAT_RAD for hand in hands)


def _are_still(hand: Array | None, fingers: dict[int, Array]) -> bool:
    """Return whether fingers, (frames, 4) each, never turn in their hand."""
    if hand is None or not fingers:
        return not fingers
    turns = rotations.multiply(rotations.conjugate(hand), np.stack(list(fingers.values())))
    angles = np.linalg.norm(rotations.to_rotation_vector(turns), axis=-1)
    return bool(angles.max() < _MAX_STILL_RAD)


class _Hand:
    """One hand at rest, in the common axes."""

    def __init__(self, rig: Rig, joint: int, fingers: dict[str, list[int]], mirror: float) -> None:
        self.rig, self.joint, self.fingers = rig, joint, fingers
        places = rig.rest_positions
        knuckles = {name: places[chain[0]] for name, chain in fingers.items() if name != "Thumb"}
        self.along = _unit(np.mean(list(knuckles.values()), axis=0) - places[joint])
        across = _to_index_side(knuckles, places, fingers, self.along)
        # Out of the palm: the index finger of a left hand whose palm is down is ahead.
        self.out = _unit(np.cross(self.along, across)) * mirror
        self.across = across

    @classmethod
    def of(cls, rig: Rig, side: str) -> "_Hand | None":
        """Return a hand of a rig, or None if it has no two fingers."""
        joints = rig.anatomy.joints
        fingers = {
            finger: [joints[n] for part in parts if (n := f"{side}{finger}{part}") in joints]
            for finger, parts in (
                *((finger, _FINGER_PARTS) for finger in _RELAXED_DEG),
                ("Thumb", tuple(_THUMB_DEG)),
            )
        }
        fingers = {finger: chain for finger, chain in fingers.items() if chain}
        hand = joints.get(f"{side}Hand")
        if hand is None or len(fingers) < 2:
            return None
        return cls(rig, hand, fingers, 1.0 if side == "left" else -1.0)

    @property
    def finger_joints(self) -> list[int]:
        """Joints of all fingers."""
        return [joint for chain in self.fingers.values() for joint in chain]

    @property
    def mean_flexion(self) -> float:
        """Mean angle between the bones of the fingers, the thumb left out [rad]."""
        angles = [
            angle
            for finger, chain in self.fingers.items()
            if finger != "Thumb"
            for angle in self._flexions(chain, self._axis(chain))
            if angle is not None
        ]
        return float(np.mean(angles)) if angles else 0.0

    def relaxing_turns(self) -> Iterator[tuple[int, Array]]:
        """Return for each joint of the fingers, and below them, its turn from rest (4,)."""
        for finger, chain in self.fingers.items():
            turn = rotations.IDENTITY
            for number, (axis, angle) in enumerate(self._bends(finger, chain)):
                turn = rotations.multiply(turn, rotations.about(axis, angle))
                below = chain[number + 1] if number + 1 < len(chain) else None
                for joint in subtree(self.rig.skeleton, chain[number]):
                    if below is None or below not in self.rig.chain_to(joint):
                        yield joint, turn

    def _bends(self, finger: str, chain: list[int]) -> list[tuple[Array, float]]:
        """Return axis (3,) and angle [rad] by which each joint of a finger is to bend."""
        if finger == "Thumb":
            return self._thumb_bends(chain)
        axis = self._axis(chain)
        bends: list[tuple[Array, float]] = []
        done = 0.0  # the part of the last joint's flexion that it had at rest
        relaxed = np.radians(_RELAXED_DEG[finger])
        for wanted, angle in zip(relaxed, self._flexions(chain, axis), strict=False):
            done = done if angle is None else min(max(angle / wanted, 0.0), 1.0)
            bends.append((axis, float(wanted) * (1.0 - done)))
        return bends

    def _thumb_bends(self, chain: list[int]) -> list[tuple[Array, float]]:
        """Return the bends of the thumb: to the palm at its base, then across the palm."""
        places = self.rig.rest_positions
        thumb = _unit(places[chain[-1]] - places[self.joint])
        names = [part for part in _THUMB_DEG if self._has_part(part, chain)]
        opposed = float(np.arcsin(np.clip(thumb @ self.out, -1.0, 1.0)))
        first = max(np.radians(_THUMB_DEG["Metacarpal"]) - max(opposed, 0.0), 0.0)
        across_palm = _unit(np.cross(thumb, _unit(self.out - self.across)))
        bends = [(_unit(np.cross(thumb, self.out)), float(first))]
        return bends + [(across_palm, float(np.radians(_THUMB_DEG[name]))) for name in names[1:]]

    def _has_part(self, part: str, chain: list[int]) -> bool:
        return any(self.rig.anatomy.parts[joint].endswith(part) for joint in chain)

    def _axis(self, chain: list[int]) -> Array:
        """Return the axis (3,) about which a finger bends to the palm."""
        places = self.rig.rest_positions
        bone = places[chain[1]] - places[chain[0]] if len(chain) > 1 else self.along
        return _unit(np.cross(bone, self.out))

    def _flexions(self, chain: list[int], axis: Array) -> list[float | None]:
        """Return by joint the angle between its bone and the one above [rad], None if unknown."""
        places = self.rig.rest_positions
        bones = [places[below] - places[above] for above, below in pairwise(chain)]
        tips = [j for j, above in enumerate(self.rig.skeleton.parents) if above == chain[-1]]
        bones += [places[tips[0]] - places[chain[-1]]] if tips else []
        angles: list[float | None] = [
            float(np.arctan2(np.cross(above, bone) @ axis, above @ bone))
            for above, bone in pairwise([self.along, *bones])
        ]
        return angles + [None] * (len(chain) - len(angles))


def _to_index_side(
    knuckles: dict[str, Array], places: Array, fingers: dict[str, list[int]], along: Array
) -> Array:
    """Return the unit vector (3,) across a hand from the little finger to the index finger."""
    ordered = [knuckles[name] for name in _RELAXED_DEG if name in knuckles]
    across = ordered[0] - ordered[-1]
    if len(ordered) == 1:
        across = places[fingers["Thumb"][-1]] - ordered[0]
    return _unit(across - along * float(across @ along))


def _unit(vector: Array) -> Array:
    return vector / max(float(np.linalg.norm(vector)), 1e-9)
