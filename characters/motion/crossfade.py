"""Cross-fade: both motions play for a while and are mixed, so feet slide where they differ."""

import math
from dataclasses import dataclass

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.blend import mix
from cubeling.characters.motion.curves import Ease, ease
from cubeling.characters.motion.motion import Motion, RootDelta, integrate_travel, mean_delta
from cubeling.characters.skeleton.pose import Pose


@dataclass(frozen=True)
class CrossFade:
    """A motion that is replaced by another one at a time."""

    first: Motion
    """The motion that fades out."""

    second: Motion
    """The motion after; its time 0 is `start`."""

    start: float
    """Start of the fade [s]."""

    length: float = 0.25
    """Length of the fade [s]."""

    shape: Ease = "gonio"
    """Shape of the fade."""

    def __post_init__(self) -> None:
        if not math.isfinite(self.start) or not 0.0 < self.length < math.inf:
            raise CharacterError(
                f"cross-fade at {self.start} s over {self.length} s; give a positive length"
            )

    @property
    def duration(self) -> float:
        """Time until the second motion repeats or ends [s]."""
        return self.start + self.second.duration

    def weight(self, time: float) -> float:
        """Return the weight of the second motion at a time [s], 0…1."""
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
        fade_end = self.start + self.length
        fade = min(max(self.start, start), end), min(max(fade_end, start), end)
        before = self.first.travel(start, fade[0])
        during = integrate_travel(*fade, self._travel)
        after = self.second.travel(fade[1] - self.start, end - self.start)
        return before.then(during).then(after)

    def _travel(self, start: float, end: float, weight_time: float) -> RootDelta:
        weight = self.weight(weight_time)
        first = self.first.travel(start, end)
        second = self.second.travel(start - self.start, end - self.start)
        return mean_delta([first, second], [1.0 - weight, weight])
