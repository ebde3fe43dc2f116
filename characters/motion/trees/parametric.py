"""Motions and weights that parameters change while they play."""

from collections.abc import Callable, Mapping

from characters.motion.motion import Motion, RootDelta
from characters.motion.phase import RetimedMotion, as_cyclic
from characters.skeleton.pose import Pose

Values = Mapping[str, float]
"""Parameters by name."""

Maker = Callable[[Values], Motion]
"""Gives the motion for some parameters."""


class ParametricMotion:
    """A motion that parameters change while it plays, without losing its phase; a `Motion`."""

    def __init__(self, make: Maker, values: Values) -> None:
        self._make = make
        self._live = RetimedMotion(as_cyclic(make(values)))

    @property
    def duration(self) -> float:
        """Length of one cycle of what plays now [s]."""
        return self._live.duration

    def steer(self, values: Values, time: float) -> None:
        """Go on from a time on [s] with other parameters."""
        self._live.change(as_cyclic(self._make(values)), time)

    def restart(self, values: Values) -> None:
        """Start over at time 0."""
        self._live.restart(as_cyclic(self._make(values)), 0.0)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._live.sample(time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._live.travel(start, end)


class ParametricWeight:
    """A weight that a parameter sets; a `Curve`."""

    def __init__(self, parameter: str, low: float) -> None:
        self._parameter = parameter
        self._low = low
        self._value = 0.0

    def at(self, time: float, duration: float) -> float:
        """Return what was set last."""
        return self._value

    def steer(self, values: Values) -> None:
        """Take the parameter's value."""
        self._value = min(max(values[self._parameter], self._low), 1.0)


class ParameterBindings:
    """All that parameters change in one motion of a plan."""

    def __init__(self) -> None:
        self.motions: list[ParametricMotion] = []
        self.weights: list[ParametricWeight] = []

    def steer(self, values: Values, time: float) -> None:
        """Set the parameters from a time [s] of the motion on."""
        for weight in self.weights:
            weight.steer(values)
        for motion in self.motions:
            motion.steer(values, time)

    def restart(self, values: Values) -> None:
        """Set the parameters and start over at time 0."""
        for weight in self.weights:
            weight.steer(values)
        for motion in self.motions:
            motion.restart(values)
