"""Feet that stay on the ground while one motion goes over into another.

A transition mixes the turns of joints. Legs that bend differently in the two motions bring their
feet elsewhere meanwhile, though these stand on one place in both: they skid. Here such feet go
straight from where they were to where the new motion has them.
"""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik import two_bones
from cubeling.characters.model.character import Character
from cubeling.characters.motion.inertialization import Inertialization
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_MAX_HEIGHT, _MAX_WAY = 0.01, 0.05
"""Of a foot that stands in both motions: its height above the rest pose's, and how far it goes in
the transition [body heights]."""

_LET_GO = 0.02
"""How far a foot goes in the new motion until it is no longer held [body heights]."""


_Chain = tuple[int, int, int]  # the joints of a leg: hip, knee and ankle


class FeetInTransition:
    """The feet of a character without legs for inverse kinematics; advanced once a frame.

    Its legs bend so that they end at their feet; where a foot has no two joints of its own above
    it, it is moved alone.
    """

    def __init__(self, character: Character) -> None:
        self._skeleton = character.skeleton
        self._feet = [foot[0] for foot in find_feet(character.skeleton)]
        self._above = [character.skeleton.parents[foot] for foot in self._feet]
        self._chains = [_chain(character.skeleton, foot, self._feet) for foot in self._feet]
        self._height = character.height
        rest = character.skeleton.rest.globals(character.skeleton)
        self._rest_heights = rest[self._feet, 1, 3]
        self._last: Pose | None = None
        self._entered = 0.0
        self._start: Pose | None = None  # of the feet in the new motion
        self._transition: Inertialization | None = None
        self._standing = np.zeros(len(self._feet), bool)

    def hold(self, shown: Pose, own: Pose, entered: float, spent: float, length: float) -> Pose:
        """Return the shown pose with the feet that stand held.

        Parameters
        ----------
        shown
            The pose in the transition.
        own
            That of the new motion.
        entered
            When the new motion was entered [s].
        spent
            For how long it has played [s].
        length
            Of the transition [s].
        """
        if not self._feet or spent >= length:
            self._last = None
            return shown
        joints = shown.globals(self._skeleton)
        feet, free = self._place(own.globals(self._skeleton)), self._place(joints)
        if self._last is None or entered != self._entered:
            old = self._last or free
            stand = self._stand(old, feet)
            # A foot that is held already is not let go in between.
            self._standing = stand | self._standing if self._last is not None else stand
            self._entered, self._start = entered, feet
            self._transition = Inertialization.begin((old, old), (feet, feet), 1.0, length)
        assert self._transition is not None
        assert self._start is not None
        held = self._transition.apply(feet, spent)
        gone = np.linalg.norm(feet.translations - self._start.translations, axis=1)
        share = np.maximum(1.0 - gone / (_LET_GO * self._height), 0.0) * self._standing
        aims = _between(free, held, share)
        places, turns = shown.translations.copy(), shown.rotations.copy()
        for number in np.flatnonzero(share).tolist():
            foot, target = self._feet[number], aims.translations[number]
            above = _turns(joints[self._above[number]][None])[0]
            chain = self._chains[number]
            if chain is None:
                places[foot] = np.linalg.solve(joints[self._above[number]], [*target, 1.0])[:3]
            else:
                above = self._bend(turns, joints, chain, target)
            turns[foot] = rotations.multiply(rotations.conjugate(above), aims.rotations[number])
        pose = Pose(places, turns, shown.scales, shown.morphs)
        self._last = self._place(pose.globals(self._skeleton))
        return pose

    def _bend(self, turns: Array, joints: Array, chain: _Chain, target: Array) -> Array:
        """Bend a leg so that its foot is at a target; return how its shin is turned then."""
        hip, knee, foot = (tuple(joints[joint, :3, 3].tolist()) for joint in chain)
        upper, lower = two_bones.reach(hip, knee, foot, tuple(target.tolist()), knees_ahead=False)
        carrier, thigh, shin = _turns(joints[[self._skeleton.parents[chain[0]], *chain[:2]]])
        thigh = rotations.multiply(np.array(upper), thigh)
        shin = rotations.multiply(rotations.multiply(np.array(upper), np.array(lower)), shin)
        turns[chain[0]] = rotations.multiply(rotations.conjugate(carrier), thigh)
        turns[chain[1]] = rotations.multiply(rotations.conjugate(thigh), shin)
        return shin

    def _place(self, joints: Array) -> Pose:
        """Return where the feet are and how they are turned in the character's frame."""
        feet = joints[self._feet]
        return Pose(feet[:, :3, 3], _turns(feet))

    def _stand(self, old: Pose, new: Pose) -> NDArray[np.bool_]:
        """Return which feet stand in both motions."""
        heights = np.maximum(old.translations[:, 1], new.translations[:, 1]) - self._rest_heights
        way = np.linalg.norm((old.translations - new.translations)[:, [0, 2]], axis=1)
        stand: NDArray[np.bool_] = (heights < _MAX_HEIGHT * self._height) & (
            way < _MAX_WAY * self._height
        )
        return stand


def _chain(skeleton: Skeleton, foot: int, feet: list[int]) -> _Chain | None:
    """Return the leg of a foot; None where it has fewer joints of its own above it."""
    knee = skeleton.parents[foot]
    hip = skeleton.parents[knee] if knee >= 0 else -1
    if (
        hip < 0
        or skeleton.parents[hip] < 0
        or any(f in subtree(skeleton, hip) for f in feet if f != foot)
    ):
        return None
    return hip, knee, foot


def _between(free: Pose, held: Pose, share: Array) -> Pose:
    """Return placements between two, (n,), by the share of the second, 0…1."""
    places = free.translations + share[:, None] * (held.translations - free.translations)
    return Pose(places, rotations.slerp(free.rotations, held.rotations, share))


def _turns(joints: Array) -> Array:
    """Return the rotations of placements (n, 4, 4), which may be scaled, (n, 4)."""
    axes = joints[:, :3, :3]
    turns: Array = rotations.from_matrix(axes / np.linalg.norm(axes, axis=1, keepdims=True))
    return turns
