"""State machines: named motions, one of which plays, with smooth transitions between them."""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.blend import mix
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.inertialization import Inertialization, OffsetDecay
from cubeling.characters.motion.motion import Motion, RootDelta, integrate_travel, mean_delta
from cubeling.characters.skeleton.pose import Array, Pose

_VELOCITY_STEP_S = 1e-3  # velocities at a switch are differences over this time


@dataclass(frozen=True)
class _Switch:
    """A change of state."""

    time: float
    state: str
    """Name of the state; "" for a motion that is none."""

    motion: Motion | None
    """What plays where it is no state, so that the states alone own their motions."""

    transition: Inertialization | None
    drift: OffsetDecay | None
    """Decaying difference of the velocity over the ground (x, z, yaw)."""

    below: "_Switch | None" = None
    """The previous state, which continues during a cross-fade."""

    fade: float = 0.0
    """Length of the cross-fade [s]."""

    def weight(self, time: float) -> float:
        """Return the weight of the new state at a time [s], 0…1."""
        return ease((time - self.time) / self.fade, "gonio") if self.below else 1.0

    def plays(self, state: str) -> bool:
        """Return whether a state plays here or below."""
        return self.state == state or (self.below is not None and self.below.plays(state))


class _States(Mapping[str, Motion]):
    """Motions by name, of which the others are not asked for before they are needed.

    Motions may change from frame to frame: no frozen dataclass, which checkpoints share.
    """

    def __init__(self, first: Mapping[str, Motion], others: Mapping[str, Motion]) -> None:
        self.first, self.others = dict(first), others

    def __getitem__(self, name: str) -> Motion:
        return self.first[name] if name in self.first else self.others[name]

    def __iter__(self) -> Iterator[str]:
        yield from self.first
        yield from (name for name in self.others if name not in self.first)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, name: object) -> bool:
        return name in self.first or name in self.others


class StateMachine:
    """Named motions and the times at which they were entered; a `Motion`.

    A state plays from its own time 0 when it is entered. A request records a decaying offset, so
    any later pose depends on the time only. Even during a transition a pose samples one state; only
    a cross-fade samples the previous state as well.

    Parameters
    ----------
    states
        The motions by name.
    initial
        Name of the state that is entered at time 0.
    length
        Length of a transition by inertialization [s].
    others
        More motions by name, which may be made when they are first asked for.

    Raises
    ------
    CharacterError
        If there is no state of the initial name.
    """

    def __init__(
        self,
        states: Mapping[str, Motion],
        initial: str,
        length: float = 0.25,
        others: Mapping[str, Motion] | None = None,
    ) -> None:
        self.states: Mapping[str, Motion] = _States(states, others or {})
        self.length = length
        """Length of a transition [s]."""
        self._check(initial)
        self._switches = [_Switch(0.0, initial, None, None, None)]

    @property
    def state(self) -> str:
        """Name of the current state."""
        return self._switches[-1].state

    @property
    def entered(self) -> float:
        """When it was entered [s]."""
        return self._switches[-1].time

    @property
    def duration(self) -> float:
        """Infinite: it stays in its last state."""
        return math.inf

    def request(
        self,
        state: str,
        time: float,
        crossfade: float = 0.0,
        begin: Callable[[], None] | None = None,
    ) -> None:
        """Enter a state; nothing happens if it is the current state.

        Parameters
        ----------
        state
            Its name.
        time
            When [s]; not before the last request.
        crossfade
            Length of a cross-fade [s] with the previous state; 0 for inertialization. A state that
            still fades out is entered by inertialization, because it cannot play twice.
        begin
            Restarts the state's motion, if it keeps a state of its own; called after the old motion
            was sampled.

        Raises
        ------
        CharacterError
            If there is no such state, or the times are invalid.
        """
        self._check(state)
        if state != self.state:
            self._enter(state, None, time, crossfade, begin)

    def play(self, motion: Motion, time: float, length: float | None = None) -> None:
        """Play a motion from its start on, by inertialization; the state has no name then.

        `time` [s] is not before the last request; a `length` [s] is that of this transition alone.

        Raises
        ------
        CharacterError
            If it is.
        """
        self._enter("", motion, time, 0.0, None, length)

    def _enter(
        self,
        state: str,
        motion: Motion | None,
        time: float,
        crossfade: float,
        begin: Callable[[], None] | None,
        length: float | None = None,
    ) -> None:
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
            # Or the chain of states below would grow with every request.
            last = replace(last, below=None)  # drop finished states
        if crossfade > 0.0 and not last.plays(state):
            if begin is not None:
                begin()
            switch = _Switch(time, state, motion, None, None, last, crossfade)
        else:
            switch = self._inertialize(last, state, motion, time, begin, length or self.length)
        # Two switches are enough to look back over one frame.
        self._switches = [last, switch]

    def _inertialize(
        self,
        last: _Switch,
        state: str,
        motion: Motion | None,
        time: float,
        begin: Callable[[], None] | None,
        length: float,
    ) -> _Switch:
        # Forward differences: before its start, a loop with a gap would jump.
        old = (self._sample(last, time), self._sample(last, time + _VELOCITY_STEP_S))
        # Before `begin`: it may restart the very motion that is being left.
        old_delta = self._travel(last, time, time + _VELOCITY_STEP_S)
        if begin is not None:
            begin()
        entered = motion or self.states[state]
        new = (entered.sample(0.0), entered.sample(_VELOCITY_STEP_S))
        new_delta = entered.travel(0.0, _VELOCITY_STEP_S)
        drift = _velocity(old_delta) - _velocity(new_delta)
        return _Switch(
            time,
            state,
            motion,
            Inertialization.begin(old, new, _VELOCITY_STEP_S, length),
            OffsetDecay(drift, np.zeros(3), length),
        )

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._sample(self._switches[self._active(time)], time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        first, last = self._active(start), self._active(end)
        if first == last:
            return self._travel(self._switches[last], start, end)
        total = RootDelta()
        for number in range(first, last + 1):
            stop = end if number == last else self._switches[number + 1].time
            total = total.then(self._travel(self._switches[number], start, stop))
            start = stop
        return total

    def _motion(self, switch: _Switch) -> Motion:
        return switch.motion or self.states[switch.state]

    def _sample(self, switch: _Switch, time: float) -> Pose:
        """Return the pose at a time [s] without later switches."""
        pose = self._motion(switch).sample(time - switch.time)
        weight = switch.weight(time)
        if switch.below is not None and weight < 1.0:
            pose = mix([self._sample(switch.below, time), pose], [1.0 - weight, weight])
        if switch.transition is None:
            return pose
        return switch.transition.apply(pose, time - switch.time)

    def _travel(self, switch: _Switch, start: float, end: float) -> RootDelta:
        """Return the root delta without later switches."""
        below, fade_end = switch.below, min(max(switch.time + switch.fade, start), end)
        if below is None or fade_end <= start:
            return self._own_travel(switch, start, end)

        def step(low: float, high: float, weight_time: float) -> RootDelta:
            weight = switch.weight(weight_time)
            deltas = [self._travel(below, low, high), self._own_travel(switch, low, high)]
            return mean_delta(deltas, [1.0 - weight, weight])

        during = integrate_travel(start, fade_end, step)
        return during.then(self._own_travel(switch, fade_end, end))

    def _own_travel(self, switch: _Switch, start: float, end: float) -> RootDelta:
        """Return the root delta of one state, with its decaying velocity difference."""
        start, end = start - switch.time, end - switch.time
        delta = self._motion(switch).travel(start, end)
        if switch.drift is None or start >= switch.drift.length:
            return delta
        x, z, yaw = switch.drift.integral(start, end).tolist()
        return RootDelta(delta.x + x, delta.z + z, delta.yaw + yaw)

    def _active(self, time: float) -> int:
        """Return the number of the last switch before a time [s]."""
        last = len(self._switches) - 1
        if time >= self._switches[last].time:  # as in nearly all frames
            return last
        return max(bisect_right(self._switches, time, key=lambda switch: switch.time) - 1, 0)

    def _check(self, state: str) -> None:
        if state not in self.states:
            raise CharacterError(f"no state {state!r}; there are {', '.join(self.states)}")


def _velocity(delta: RootDelta) -> Array:
    """Return the velocity (3,) over `_VELOCITY_STEP_S`: x, z [m/s] and yaw [rad/s]."""
    return np.array([delta.x, delta.z, delta.yaw]) / _VELOCITY_STEP_S
