"""Motions and weights that depend on parameters while they play."""

from collections.abc import Callable, Mapping

from cubeling.characters.motion.motion import Motion
from cubeling.characters.motion.phase import RetimedMotion, as_cyclic

Values = Mapping[str, float]
"""Values of parameters by name."""


class ParametricMotion(RetimedMotion):
    """A motion that depends on parameters and keeps its phase when they change; a `Motion`.

    `make` returns the motion for given values.
    """

    def __init__(self, make: Callable[[Values], Motion], values: Values) -> None:
        super().__init__(as_cyclic(make(values)))
        self._make = make

    def set_values(self, values: Values, time: float) -> None:
        """Continue with other values from a time [s] on."""
        self.change(as_cyclic(self._make(values)), time)

    def restart_with(self, values: Values) -> None:
        """Start again at time 0."""
        self.restart(as_cyclic(self._make(values)), 0.0)


class ParametricWeight:
    """A weight that is the value of a parameter, limited to `lowest`…1; a `Curve`."""

    def __init__(self, parameter: str, lowest: float) -> None:
        self._parameter = parameter
        self._lowest = lowest
        self._value = 0.0

    def at(self, time: float, duration: float) -> float:
        """Return the present value."""
        return self._value

    def set_values(self, values: Values) -> None:
        """Take the parameter's value."""
        self._value = min(max(values[self._parameter], self._lowest), 1.0)


class ParameterBindings:
    """All motions and weights in one motion of a plan that depend on parameters."""

    def __init__(self) -> None:
        self.motions: list[ParametricMotion] = []
        self.weights: list[ParametricWeight] = []

    def set_values(self, values: Values, time: float) -> None:
        """Set the parameters from a time [s] of the motion on."""
        for weight in self.weights:
            weight.set_values(values)
        for motion in self.motions:
            motion.set_values(values, time)

    def restart_with(self, values: Values) -> None:
        """Set the parameters and start again at time 0."""
        for weight in self.weights:
            weight.set_values(values)
        for motion in self.motions:
            motion.restart_with(values)
