"""From one motion to the next by playing both for a while and mixing them.

It costs two motions while it lasts, and feet slide where the two differ; inertialisation
(`StateMachine`, `characters.motion.inertialization`) does neither. It is right where the old
motion shall be seen to go on: a walk that dies down into another.
"""

import math
from dataclasses import dataclass

from characters.errors import CharacterError
from characters.motion.blend import mix
from characters.motion.curves import Ease, ease
from characters.motion.motion import Motion, RootDelta
from characters.motion.travel import accumulated, mean_step
from characters.skeleton.pose import Pose


@dataclass(frozen=True)
class CrossFade:
    """A motion, and another one that takes its place from a time on."""

    first: Motion
    """What plays before."""

    second: Motion
    """What plays after; its time 0 is `start`."""

    start: float
    """When the fade starts [s]."""

    length: float = 0.25
    """How long it takes [s]."""

    shape: Ease = "gonio"
    """How it goes."""

    def __post_init__(self) -> None:
        """Refuse times that are none."""
        if not math.isfinite(self.start) or not 0.0 < self.length < math.inf:
            raise CharacterError(
                f"cross-fade at {self.start} s over {self.length} s; give a positive length"
            )

    @property
    def duration(self) -> float:
        """Time until the second motion repeats or ends [s]."""
        return self.start + self.second.duration

    def weight(self, time: float) -> float:
        """Return how much of the second motion plays at a time [s], 0…1."""
        return ease((time - self.start) / self.length, self.shape)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        weight = self.weight(time)
        if weight <= 0.0:
            return self.first.sample(time)
        after = self.second.sample(time - self.start)
        if weight >= 1.0:
            return after
        return mix([self.first.sample(time), after], [1.0 - weight, weight])

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        fades = (
            min(max(self.start, start), end),
            min(max(self.start + self.length, start), end),
        )
        before = self.first.travel(start, fades[0])
        during = accumulated(*fades, self._moved)
        after = self.second.travel(fades[1] - self.start, end - self.start)
        return before.then(during).then(after)

    def _moved(self, start: float, end: float, moment: float) -> RootDelta:
        weight = self.weight(moment)
        first = self.first.travel(start, end)
        second = self.second.travel(start - self.start, end - self.start)
        return mean_step([first, second], [1.0 - weight, weight])
