"""From the numbers of a frame to how joints move: what BVH and Acclaim have in common.

In both, a joint turns about a list of fixed axes, one number an axis. In BVH they are the axes of
the file; in Acclaim those of the bone's own frame C, and since C R(e, a) C⁻¹ = R(C e, a), they are
fixed directions of the file's axes just as well. So every rest rotation is the identity.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_BLOCK = 1024  # frames at once: what is in hand stays in the processor's cache


@dataclass(frozen=True)
class Turn:
    """One rotation of one joint by one number of a frame."""

    joint: int
    """Which joint."""

    axis: Array
    """Unit vector in the parent's frame, (3,)."""

    column: int
    """Which number of the frame is the angle."""


@dataclass(frozen=True)
class Slide:
    """One translation of one joint by one number of a frame."""

    joint: int
    """Which joint."""

    direction: Array
    """What a number of 1 adds to the joint's place in its parent's frame, (3,)."""

    column: int
    """Which number of the frame is the distance."""


@dataclass(frozen=True)
class Channels:
    """How the numbers of a frame move joints."""

    places: Array
    """Where joints are in their parents' frames when every number is zero, (joints, 3)."""

    turns: tuple[Turn, ...]
    """The rotations; of one joint's, the first is applied last."""

    slides: tuple[Slide, ...]
    """The translations; they add up."""

    radians: float
    """How much an angle of 1 is [rad]."""

    def poses(self, values: Array) -> Pose:
        """Return the poses of frames of numbers, (frames, numbers)."""
        frames, joints = len(values), len(self.places)
        translations = np.tile(self.places, (frames, 1, 1))
        for slide in self.slides:
            translations[:, slide.joint] += values[:, slide.column, None] * slide.direction
        quaternions = np.empty((frames, joints, 4))
        rounds = self._rounds()
        for start in range(0, frames, _BLOCK):
            block = slice(start, start + _BLOCK)
            quaternions[block] = self._turned(values[block], rounds)
        return Pose(translations, quaternions)

    def _rounds(self) -> "list[tuple[NDArray[np.intp], Array, NDArray[np.intp]]]":
        """Return joints, axes and columns of every joint's first rotation, second, and so on."""
        rounds: list[list[Turn]] = []
        seen: dict[int, int] = {}
        for turn in self.turns:
            place = seen.get(turn.joint, 0)
            seen[turn.joint] = place + 1
            if place == len(rounds):
                rounds.append([])
            rounds[place].append(turn)
        return [
            (
                np.array([turn.joint for turn in turns]),
                np.array([turn.axis for turn in turns]),
                np.array([turn.column for turn in turns]),
            )
            for turns in rounds
        ]

    def _turned(
        self, values: Array, rounds: "list[tuple[NDArray[np.intp], Array, NDArray[np.intp]]]"
    ) -> Array:
        """Return the rotations of a block of frames, (frames, joints, 4)."""
        turned = np.tile(rotations.IDENTITY, (len(values), len(self.places), 1))
        for number, (joints, axes, columns) in enumerate(rounds):
            q = rotations.about(axes, values[:, columns] * self.radians)
            turned[:, joints] = rotations.multiply(turned[:, joints], q) if number else q
        return turned
