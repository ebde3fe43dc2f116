"""Small variations over a blend of idle motion and gestures.

Source: Egges, Molet and Magnenat-Thalmann 2004, section 7.2 (S10). A gesture is blended with idle
motion joint by joint, as in `MaskedLayer` and `Schedule`; small variations are added afterwards.
"""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.synthesis.idle.database import IdleDatabase
from cubeling.characters.synthesis.idle.motion_texture import StretchStream


@dataclass
class Varied:
    """A motion with a person's small variations on top; a `Motion`, in the order of time."""

    motion: Motion
    """What moves: a gesture over an `IdleMotion` whose own small variations are "none"."""

    database: IdleDatabase
    """Whose variations they are."""

    share: float = 1.0
    """How much of them is added."""

    seed: int = 0
    """Seed of the generator that chooses them."""

    def __post_init__(self) -> None:
        rng = np.random.default_rng([self.seed, 2])
        self._stream = StretchStream(self.database.stretches, rng)

    @property
    def duration(self) -> float:
        """That of the motion [s]."""
        return self.motion.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] not before the last one."""
        pose, kind = self.motion.sample(time), self.database.kind
        offset = self.share * self._stream.at(time)
        return kind.poses(kind.vectors(pose) + offset, pose)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root of the motion moves over the ground between two times [s]."""
        return self.motion.travel(start, end)
