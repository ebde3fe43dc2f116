"""A motion whose parameters change while it plays."""

from characters.motion.motion import RootDelta
from characters.motion.phase import Cyclic, unit
from characters.skeleton.pose import Pose


class RetimedMotion:
    """A cyclic motion that may be exchanged for another one at the same phase; a `Motion`.

    What came before the last exchange is forgotten: earlier times show the present motion.
    """

    def __init__(self, motion: Cyclic, phase: float = 0.0) -> None:
        self._motion = motion
        self._time, self._phase = 0.0, phase

    @property
    def duration(self) -> float:
        """Length of one cycle of what plays now [s]."""
        return self._motion.duration

    def phase(self, time: float) -> float:
        """Return the phase at a time [s]; grows by one each cycle."""
        return self._phase + (time - self._time) / unit(self._motion.duration)

    def change(self, motion: Cyclic, time: float) -> None:
        """Go on with another motion from a time on [s], at the phase that was reached."""
        # Whole cycles are dropped, so that a long session does not lose precision.
        self._phase, self._time = self.phase(time) % 1.0, time
        self._motion = motion

    def restart(self, motion: Cyclic, phase: float) -> None:
        """Start over with a motion at a phase, at time 0."""
        self._motion, self._time, self._phase = motion, 0.0, phase

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._motion.at(self.phase(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._motion.between(self.phase(start), self.phase(end))
