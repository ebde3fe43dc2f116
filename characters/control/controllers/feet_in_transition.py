"""Feet that stay on the ground while one motion goes over into another.

A transition mixes the turns of joints. Legs that bend differently in the two motions bring their
feet elsewhere meanwhile, though these stand on one place in both: they skid. Here such feet go
straight from where they were to where the new motion has them.
"""

import numpy as np
from numpy.typing import NDArray

from characters.model.character import Character
from characters.motion.inertialization import Inertialization
from characters.skeleton import rotations
from characters.skeleton.feet import find_feet
from characters.skeleton.pose import Array, Pose

_MAX_HEIGHT, _MAX_WAY = 0.01, 0.05
"""Of a foot that stands in both motions: its height above the rest pose's, and how far it goes in
the transition [body heights]."""


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
        self._transition: Inertialization | None = None
        self._standing = np.zeros(len(self._feet), bool)

    def held(self, shown: Pose, own: Pose, entered: float, spent: float, length: float) -> Pose:
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
        feet = self._placed(own.globals(self._skeleton))
        if self._last is None or entered != self._entered:
            old = self._last or self._placed(joints)
            self._entered = entered
            self._transition = Inertialization.begin((old, old), (feet, feet), 1.0, length)
            self._standing = self._stand(old, feet)
        assert self._transition is not None
        held = self._transition.apply(feet, spent)
        places, turns = shown.translations.copy(), shown.rotations.copy()
        for number in np.flatnonzero(self._standing).tolist():
            foot, above = self._feet[number], joints[self._above[number]]
            places[foot] = np.linalg.solve(above, [*held.translations[number], 1.0])[:3]
            turn = _turns(above[None])[0]
            turns[foot] = rotations.multiply(rotations.conjugate(turn), held.rotations[number])
        pose = Pose(places, turns, shown.scales, shown.morphs)
        self._last = self._placed(pose.globals(self._skeleton))
        return pose

    def _placed(self, joints: Array) -> Pose:
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


def _turns(joints: Array) -> Array:
    """Return the rotations of placements (n, 4, 4), which may be scaled, (n, 4)."""
    axes = joints[:, :3, :3]
    turns: Array = rotations.from_matrix(axes / np.linalg.norm(axes, axis=1, keepdims=True))
    return turns
