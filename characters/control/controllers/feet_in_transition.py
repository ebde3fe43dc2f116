"""Feet that stay on the ground while one motion goes over into another.

A transition mixes the turns of joints. Legs that bend differently in the two motions bring their
feet elsewhere meanwhile, though these stand on one place in both: they skid. Here such feet go
straight from where they were to where the new motion has them.
"""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.motion.inertialization import Inertialization
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.pose import Array, Pose

_MAX_HEIGHT, _MAX_WAY = 0.01, 0.05
"""Of a foot that stands in both motions: its height above the rest pose's, and how far it goes in
the transition [body heights]."""

_LET_GO = 0.02
"""How far a foot goes in the new motion until it is no longer held [body heights]."""


class FeetInTransition:
    """The feet of a character without legs for inverse kinematics; advanced once a frame."""

    def __init__(self, character: Character) -> None:
        self._skeleton = character.skeleton
        self._feet = [foot[0] for foot in find_feet(character.skeleton)]
        self._above = [character.skeleton.parents[foot] for foot in self._feet]
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
            foot, above = self._feet[number], joints[self._above[number]]
            places[foot] = np.linalg.solve(above, [*aims.translations[number], 1.0])[:3]
            turn = _turns(above[None])[0]
            turns[foot] = rotations.multiply(rotations.conjugate(turn), aims.rotations[number])
        pose = Pose(places, turns, shown.scales, shown.morphs)
        self._last = self._place(pose.globals(self._skeleton))
        return pose

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


def _between(free: Pose, held: Pose, share: Array) -> Pose:
    """Return placements between two, (n,), by the share of the second, 0…1."""
    places = free.translations + share[:, None] * (held.translations - free.translations)
    return Pose(places, rotations.slerp(free.rotations, held.rotations, share))


def _turns(joints: Array) -> Array:
    """Return the rotations of placements (n, 4, 4), which may be scaled, (n, 4)."""
    axes = joints[:, :3, :3]
    turns: Array = rotations.from_matrix(axes / np.linalg.norm(axes, axis=1, keepdims=True))
    return turns
