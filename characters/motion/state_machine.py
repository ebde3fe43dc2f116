"""A few motions with names, one of which plays, and smooth transitions between them."""

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from characters.errors import CharacterError
from characters.motion.blend import mix
from characters.motion.curves import ease
from characters.motion.inertialization import Inertialization, OffsetDecay
from characters.motion.motion import Motion, RootDelta
from characters.motion.travel import accumulated, mean_step
from characters.skeleton.pose import Array, Pose

_PROBE = 1e-3  # [s]: velocities at a switch are differences over this time


@dataclass(frozen=True)
class _Switch:
    """The moment at which a state was entered."""

    time: float
    state: str
    transition: Inertialization | None
    drift: OffsetDecay | None
    """What the velocity over the ground (x, z, yaw) differed by."""

    below: "_Switch | None" = None
    """What goes on below while this one fades in, instead of a transition."""

    fade: float = 0.0
    """How long that takes [s]."""

    def weight(self, time: float) -> float:
        """Return how much of the new state is shown at a time [s], 0…1."""
        return ease((time - self.time) / self.fade, "gonio") if self.below else 1.0

    def plays(self, state: str) -> bool:
        """Return whether it shows a state, or one below does."""
        return self.state == state or (self.below is not None and self.below.plays(state))


class StateMachine:
    """Named motions and the record of when each was entered; a `Motion`.

    A state plays from its own time 0 when it is entered. All that a request changes is written
    down as a fading offset, so any later pose follows from the time alone. One state is sampled for
    a pose, in a transition, too; only a cross-fade goes on with the old one as well.
    """

    def __init__(self, states: Mapping[str, Motion], initial: str, length: float = 0.25) -> None:
        self.states = dict(states)
        self.length = length
        """How long a transition takes [s]."""
        self._check(initial)
        self._switches = [_Switch(0.0, initial, None, None)]

    @property
    def state(self) -> str:
        """Name of the state that was entered last."""
        return self._switches[-1].state

    @property
    def entered(self) -> float:
        """When it was entered [s]."""
        return self._switches[-1].time

    @property
    def duration(self) -> float:
        """It plays for ever."""
        return math.inf

    def request(
        self,
        state: str,
        time: float,
        crossfade: float = 0.0,
        begin: Callable[[], None] | None = None,
    ) -> None:
        """Enter a state at a time [s], not before the last request; nothing if it is the state.

        Its difference to what was shown fades (inertialisation), unless a time is given for which
        the old state goes on and is mixed with the new one [s]. A state that still fades out
        cannot play twice: it is entered again by inertialisation.

        `begin` starts the state's motion over, if that must be told; it is called once the old
        motion has been looked at.

        Raises
        ------
        CharacterError
            If there is no such state.
        """
        self._check(state)
        if state == self.state:
            return
        if time < self.entered:
            raise CharacterError(
                f"state {state!r} was requested for {time:.3f} s, before the last request at "
                f"{self.entered:.3f} s; requests come in order"
            )
        if not 0.0 <= crossfade < math.inf:
            raise CharacterError(
                f"state {state!r} was requested with a cross-fade of {crossfade} s; give 0 or more"
            )
        last = self._switches[-1]
        if last.below is not None and last.weight(time) >= 1.0:
            last = replace(last, below=None)  # or a long session would drag all its states along
        if crossfade > 0.0 and not last.plays(state):
            if begin is not None:
                begin()
            switch = _Switch(time, state, None, None, last, crossfade)
        else:
            switch = self._inertial(last, state, time, begin)
        # The last two states are enough to look back over one frame.
        self._switches = [last, switch]

    def _inertial(
        self, last: _Switch, state: str, time: float, begin: Callable[[], None] | None
    ) -> _Switch:
        """Return the switch to a state whose difference to what was shown fades."""
        motion = self.states[state]
        # Forward differences: just before its start, a loop that does not quite close would jump.
        old = (self._shown(last, time), self._shown(last, time + _PROBE))
        went = self._moved(last, time, time + _PROBE)
        if begin is not None:
            begin()
        new = (motion.sample(0.0), motion.sample(_PROBE))
        drift = _velocity(went) - _velocity(motion.travel(0.0, _PROBE))
        return _Switch(
            time,
            state,
            Inertialization.begin(old, new, _PROBE, self.length),
            OffsetDecay(drift, np.zeros(3), self.length),
        )

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._shown(self._switches[self._playing(time)], time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        total = RootDelta()
        first, last = self._playing(start), self._playing(end)
        for number in range(first, last + 1):
            stop = end if number == last else self._switches[number + 1].time
            total = total.then(self._moved(self._switches[number], start, stop))
            start = stop
        return total

    def _shown(self, switch: _Switch, time: float) -> Pose:
        """Return the pose at a time [s] as if no later state had been entered."""
        pose = self.states[switch.state].sample(time - switch.time)
        weight = switch.weight(time)
        if switch.below is not None and weight < 1.0:
            pose = mix([self._shown(switch.below, time), pose], [1.0 - weight, weight])
        if switch.transition is None:
            return pose
        return switch.transition.apply(pose, time - switch.time)

    def _moved(self, switch: _Switch, start: float, end: float) -> RootDelta:
        """Return the way over the ground as if no later state had been entered."""
        below, faded = switch.below, min(max(switch.time + switch.fade, start), end)
        if below is not None and faded > start:

            def mixed(low: float, high: float, moment: float) -> RootDelta:
                weight = switch.weight(moment)
                steps = [self._moved(below, low, high), self._alone(switch, low, high)]
                return mean_step(steps, [1.0 - weight, weight])

            return accumulated(start, faded, mixed).then(self._alone(switch, faded, end))
        return self._alone(switch, start, end)

    def _alone(self, switch: _Switch, start: float, end: float) -> RootDelta:
        """Return the way of one state with what its velocity differed by."""
        start, end = start - switch.time, end - switch.time
        step = self.states[switch.state].travel(start, end)
        if switch.drift is None or start >= switch.drift.length:
            return step
        x, z, yaw = switch.drift.integral(start, end).tolist()
        return RootDelta(step.x + x, step.z + z, step.yaw + yaw)

    def _playing(self, time: float) -> int:
        """Return the number of the switch that is in force at a time."""
        return max(bisect_right(self._switches, time, key=lambda switch: switch.time) - 1, 0)

    def _check(self, state: str) -> None:
        if state not in self.states:
            raise CharacterError(f"no state {state!r}; there are {', '.join(self.states)}")


def _velocity(step: RootDelta) -> Array:
    """Return the velocity (3,) of a step over the probe: x, z [m/s] and yaw [rad/s]."""
    return np.array([step.x, step.z, step.yaw]) / _PROBE
