"""A character that acts in place, and hops to where it is wanted."""

import math
from dataclasses import dataclass

from cubeling.characters.control.command import CharacterCommand, LocomotionIntent
from cubeling.characters.control.controllers.actions import WEIGHT_LAG_S, Actions, next_action
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.control.controllers.feet_in_transition import FeetInTransition
from cubeling.characters.control.speaking.shifting import CommandedStanding
from cubeling.characters.model.character import Character
from cubeling.characters.model.standing import idle_clip
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.phase import StaticPose
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.rotations import wrap
from cubeling.characters.smoothing import damped_spring, low_pass

TURN_LAG_S = 0.9  # of small turns, without a hop
MIN_HOP_M, MAX_HOP_M = 0.015, 0.05
MIN_HOP_TURN_RAD, MAX_HOP_TURN_RAD = math.radians(20), math.radians(70)
HOP_TIME_S = 0.3


@dataclass(frozen=True)
class _Hop:
    """A hop over the table."""

    start: RootDelta
    end: RootDelta
    time: float
    """Since take-off [s]."""

    def at(self) -> tuple[RootDelta, float]:
        """Return the place on the table and the height [m]."""
        u = min(self.time / HOP_TIME_S, 1.0)
        top = 0.006 + 0.25 * math.hypot(self.end.x - self.start.x, self.end.z - self.start.z)
        return self.start.interpolate(self.end, ease(u, "cubic")), 4 * u * (1 - u) * top


class InPlaceController:
    """Plays a character with "idle" and actions; a `CharacterController`.

    It hops to the target of a command, whatever the speed, and turns to the point that it faces.
    An action that ends is followed by idle until another is asked for.
    """

    walks = False

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None:
        self._place = place or RootDelta()
        self._height = self._weight = 0.0
        self._actions = Actions(character)
        self._standing = CommandedStanding(character)
        idle = self._standing.motion or _idle(character)
        self._machine = StateMachine({"idle": idle}, "idle", others=self._actions)
        self._feet = FeetInTransition(character)
        self._state = "idle"
        self._time = 0.0
        self._placed = place is not None
        self._hop: _Hop | None = None
        self._turn_speed = 0.0
        self._finished = ""

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that it knows, besides standing."""
        return tuple(self._actions)

    def update(
        self, command: CharacterCommand, elapsed: float, tempo: float = 1.0
    ) -> ControllerFrame:
        """Advance by a time [s] under a command and return what is played."""
        self._standing.update(command, self._actions.first_pose(command.coming), tempo)
        playing = elapsed * tempo if self._state == "idle" else elapsed
        now, self._time = self._time, self._time + playing
        self._act(command, elapsed, now)
        hops = self._move(command.locomotion or LocomotionIntent(), elapsed)
        action = self._actions.get(self._state)
        return ControllerFrame(
            self._pose(),
            "hop" if hops and action is None else self._state,
            self._place,
            height=self._height,
            weight=self._weight,
            acting=action is not None,
            shows_emotion=action is not None and action.shows_emotion,
        )

    def _pose(self) -> Pose:
        """Return what is played, with feet that do not skid in a transition."""
        machine, pose = self._machine, self._machine.sample(self._time)
        spent = self._time - machine.entered
        own = pose if spent >= machine.length else machine.states[machine.state].sample(spent)
        return self._feet.hold(pose, own, machine.entered, spent, machine.length)

    def _act(self, command: CharacterCommand, elapsed: float, now: float) -> None:
        weight = min(max(command.weight, -1.0), 1.0)
        name, self._finished = next_action(
            self._machine, self._actions, command.action, self._finished, now
        )
        self._weight = low_pass(self._weight, weight, elapsed, WEIGHT_LAG_S)
        if name != self._machine.state and name != "idle":
            self._weight = weight
            self._actions[name].begin(weight)
        self._machine.request(name, now)
        self._state = name
        if name != "idle":
            self._actions[name].set_weight(self._weight, now - self._machine.entered)

    def _move(self, going: LocomotionIntent, elapsed: float) -> bool:
        """Hop to the target and turn to the point to be faced; return whether it hops."""
        target = self._place
        if going.target is not None:
            target = RootDelta(float(going.target[0]), float(going.target[1]), self._place.yaw)
        if not self._placed and going.target is not None:
            yaw = target.yaw + _bearing(target, going)
            self._place, self._placed = RootDelta(target.x, target.z, yaw), True
        if self._hop is None:
            self._hop = self._start_hop(target, going)
        if self._hop is not None:
            self._hop = _Hop(self._hop.start, self._hop.end, self._hop.time + elapsed)
            self._place, self._height = self._hop.at()
            if self._hop.time >= HOP_TIME_S:
                self._hop = None
            return True
        bearing = _bearing(self._place, going)
        turn, self._turn_speed = damped_spring(-bearing, self._turn_speed, 0.0, elapsed, TURN_LAG_S)
        self._place = RootDelta(self._place.x, self._place.z, self._place.yaw + bearing + turn)
        return False

    def _start_hop(self, target: RootDelta, going: LocomotionIntent) -> _Hop | None:
        """Return a hop on the way to the target, if it is worth one."""
        distance = math.hypot(target.x - self._place.x, target.z - self._place.z)
        turn = _bearing(self._place, going)
        if distance < MIN_HOP_M and abs(turn) < MIN_HOP_TURN_RAD:
            return None
        # Hops of equal length, so that the last one is not much shorter than the others.
        part = 1.0 / math.ceil(max(distance / MAX_HOP_M, abs(turn) / MAX_HOP_TURN_RAD))
        self._turn_speed = 0.0
        way = self._place.interpolate(target, part)
        return _Hop(self._place, RootDelta(way.x, way.z, self._place.yaw + part * turn), 0.0)


def _bearing(place: RootDelta, going: LocomotionIntent) -> float:
    """Return the angle to turn to face the point of a command [rad]."""
    if going.facing is None:
        return 0.0
    x, z = going.facing
    return wrap(place.bearing(float(x), float(z)))


def _idle(character: Character) -> Motion:
    """Return its idle clip, or the rest pose of a character without clips."""
    name = idle_clip(character.clips)
    return StaticPose(character.skeleton.rest, 1.0) if name is None else character.clips[name]
