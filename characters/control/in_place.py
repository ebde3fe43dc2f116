"""A character that acts on the spot, and hops to where it is wanted."""

import math
from dataclasses import dataclass

from characters.control.actions import WEIGHT_LAG, acts_of, proceed
from characters.control.command import CharacterCommand, LocomotionIntent
from characters.errors import CharacterError
from characters.model.character import Character
from characters.motion.motion import Motion, RootDelta
from characters.motion.phase import StaticPose
from characters.motion.state_machine import StateMachine
from characters.skeleton.pose import Pose
from characters.skeleton.rotations import wrap
from characters.smoothing import damped_spring, low_pass

_GAZE_LAG = 0.9  # [s]: how slowly it turns on the spot where it need not hop
_HOP_FROM = 0.015  # [m]: nearer targets are not worth a hop
_HOP_REACH = 0.05  # [m]
_HOP_TURN = math.radians(20)  # beyond this it turns in a hop
_HOP_MOST = math.radians(70)
_HOP_TIME = 0.3  # [s]


@dataclass(frozen=True)
class _Hop:
    """A jump over the table."""

    start: RootDelta
    end: RootDelta
    time: float
    """Since take-off [s]."""

    def at(self) -> tuple[RootDelta, float]:
        """Return where it is on the table and how high [m]."""
        u = min(self.time / _HOP_TIME, 1.0)
        ease = u * u * (3 - 2 * u)
        a, b = self.start, self.end
        place = RootDelta(
            a.x + (b.x - a.x) * ease, a.z + (b.z - a.z) * ease, a.yaw + (b.yaw - a.yaw) * ease
        )
        top = 0.006 + 0.25 * math.hypot(b.x - a.x, b.z - a.z)
        return place, 4 * u * (1 - u) * top


class Actor:
    """Plays a character with "idle" and actions at three intensities; a `Performer`.

    For what an action is, see `characters.control.actions`. One that ends is followed by idle,
    until another is asked for.
    """

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None:
        self.place = place or RootDelta()
        self.state, self.speed, self.angular, self.weight, self.height = "idle", 0.0, 0.0, 0.0, 0.0
        self.tempo = 1.0
        """How much faster it idles than its clip; a mood changes it."""
        self._acts = acts_of(character)
        states: dict[str, Motion] = {"idle": _idle(character), **self._acts}
        self._machine = StateMachine(states, "idle")
        self._time = 0.0
        self._placed = place is not None
        self._hop: _Hop | None = None
        self._turn_speed = 0.0
        self._done = ""  # what was asked for, and has ended

    @property
    def actions(self) -> tuple[str, ...]:
        """What it can be asked to do beside standing."""
        return tuple(self._acts)

    def update(self, command: CharacterCommand, elapsed: float) -> Pose:
        """Advance by a time [s] under a command and return the pose, with the root in place."""
        going = elapsed * self.tempo if self.state == "idle" else elapsed
        now, self._time = self._time, self._time + going
        self._act(command, elapsed, now)
        self._move(command, elapsed)
        return self._machine.sample(self._time)

    def _act(self, command: CharacterCommand, elapsed: float, now: float) -> None:
        wish = min(max(command.weight, -1.0), 1.0)
        action = "idle" if command.activity == "move" else command.activity
        if action != "idle" and action not in self._acts:
            raise CharacterError(
                f"the character does not know {action!r}; it knows "
                f"{', '.join(['idle', *self._acts])}"
            )
        self.weight = low_pass(self.weight, wish, elapsed, WEIGHT_LAG)
        action, self._done = proceed(self._machine, self._acts, action, self._done, now)
        if action != self._machine.state and action != "idle":
            self.weight = wish
            self._acts[action].begin(wish)
        self._machine.request(action, now)
        self.state = action
        if action != "idle":
            self._acts[action].change(self.weight, now - self._machine.entered)

    def _move(self, command: CharacterCommand, elapsed: float) -> None:
        """Hop to the target and turn to what is to be looked at."""
        going, target = command.locomotion or LocomotionIntent(), self.place
        if going.target is not None:
            target = RootDelta(float(going.target[0]), float(going.target[1]), self.place.yaw)
        if not self._placed and going.target is not None:
            self.place, self._placed = target, True
            if going.facing is not None:
                self.place = RootDelta(target.x, target.z, target.yaw + _bearing(target, command))
        if self._hop is None:
            self._hop = self._start_hop(target, command)
        if self._hop is not None:
            self._hop = _Hop(self._hop.start, self._hop.end, self._hop.time + elapsed)
            self.place, self.height = self._hop.at()
            if self._hop.time >= _HOP_TIME:
                self._hop = None
            return
        turn, self._turn_speed = damped_spring(
            -_bearing(self.place, command), self._turn_speed, 0.0, elapsed, _GAZE_LAG
        )
        self.place = RootDelta(
            self.place.x, self.place.z, self.place.yaw + _bearing(self.place, command) + turn
        )

    def _start_hop(self, target: RootDelta, command: CharacterCommand) -> _Hop | None:
        distance = math.hypot(target.x - self.place.x, target.z - self.place.z)
        turn = _bearing(self.place, command)
        if distance < _HOP_FROM and abs(turn) < _HOP_TURN:
            return None
        # Hops of equal length, so that the last one is not a stumble.
        part = 1.0 / math.ceil(max(distance / _HOP_REACH, abs(turn) / _HOP_MOST))
        self._turn_speed = 0.0
        return _Hop(
            self.place,
            RootDelta(
                self.place.x + part * (target.x - self.place.x),
                self.place.z + part * (target.z - self.place.z),
                self.place.yaw + part * turn,
            ),
            0.0,
        )


def _bearing(place: RootDelta, command: CharacterCommand) -> float:
    """Return how far to turn to look where it is to look [rad]."""
    if command.locomotion is None or command.locomotion.facing is None:
        return 0.0
    x, z = command.locomotion.facing
    return wrap(place.bearing(float(x), float(z)))


def _idle(character: Character) -> Motion:
    """Return the idle clip; failing that, the first clip, or the rest pose for ever."""
    for name, clip in character.clips.items():
        if "idle" in name.lower():
            return clip
    if character.clips:
        return next(iter(character.clips.values()))
    return StaticPose(character.skeleton.rest, 1.0)
