"""A character that is played as the file beside it describes."""

import math

from cubeling.characters.control.command import CharacterCommand, LocomotionIntent
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.face.affect_display import EMOTIONAL_WORDS
from cubeling.characters.locomotion.gaits import TOP_SPEED
from cubeling.characters.locomotion.steering import ARRIVAL_DISTANCE_M, has_arrived
from cubeling.characters.model.character import Character
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.motion.trees.building import Builder
from cubeling.characters.motion.trees.parametric import ParameterBindings
from cubeling.characters.motion.trees.plan import PARAMETERS, Plan, StateTransition
from cubeling.characters.smoothing import low_pass

DEFAULT_LAGS_S = {"speed": 0.15, "angular": 0.15, "weight": 0.12}
"""Time constants of the parameters where the file has none [s]."""

GAIT_STATES = ("idle", "walk", "run")
"""Names of states that leave head and face free; every other state is an action."""

BRAKING_PER_M = 63.0
"""Limit of the Speed for each metre on the table that is left to go [1/m]."""

SLOW_TURN_RAD = math.radians(60)
"""A target farther to the side than this is approached at `TURNING_SPEED`."""

TURNING_SPEED = 1.5


class TreeController:
    """Plays a plan of blend trees and states; a `CharacterController`.

    The root moves as the motions do. Steering sets parameters only; the plan turns them into steps.
    """

    walks = True

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None:
        assert character.plan is not None  # `first_suitable` asks
        self._plan: Plan = character.plan
        self._place = place or RootDelta()
        self._scale = scale
        self._time = 0.0
        self._arrived = True
        self._values: dict[str, float] = dict.fromkeys(PARAMETERS, 0.0)
        builder = Builder(
            self._plan,
            character.skeleton,
            character.clips,
            character.anatomy,
            lambda: mirror_of(character),
        )
        machine = self._plan.machine
        nodes = {"": self._plan.root} if machine is None else machine.states
        self._motions: dict[str, Motion] = {}
        self._bindings: dict[str, ParameterBindings] = {}
        for name, node in nodes.items():
            if node is not None:
                self._motions[name], self._bindings[name] = builder.build(node, self._values)
        self._machine = StateMachine(self._motions, "" if machine is None else machine.start)

    @property
    def actions(self) -> tuple[str, ...]:
        """The names of its states; their conditions decide which action enters them."""
        return () if self._plan.machine is None else tuple(self._plan.machine.states)

    def update(
        self, command: CharacterCommand, elapsed: float, tempo: float = 1.0
    ) -> ControllerFrame:
        """Advance by a time [s] under a command and return what is played."""
        self._read(command, elapsed)
        now, self._time = self._time, self._time + elapsed
        self._change(command, now)
        state = self._machine.state
        self._bindings[state].set_values(self._values, now - self._machine.entered)
        step = self._machine.travel(now, self._time)
        self._place = self._place.then(step.scale(self._scale))
        name = state or command.activity
        return ControllerFrame(
            self._machine.sample(self._time),
            name,
            self._place,
            speed=self._values["speed"],
            angular=math.radians(self._values["angular"]),
            weight=self._values["weight"],
            acting=name not in GAIT_STATES,
            shows_emotion=name in EMOTIONAL_WORDS,
        )

    def _read(self, command: CharacterCommand, elapsed: float) -> None:
        """Move the parameters towards those of a command."""
        target_values = dict.fromkeys(PARAMETERS, 0.0)
        target_values["weight"] = min(max(command.weight, -1.0), 1.0)
        going = command.locomotion or LocomotionIntent()
        if going.facing is not None:
            target_values["bearing"] = math.degrees(self._place.bearing(*map(float, going.facing)))
        if command.activity == "move" and going.target is not None:
            x, z = map(float, going.target)
            away = math.hypot(x - self._place.x, z - self._place.z)
            self._arrived = going.stop and has_arrived(away, self._arrived)
            if not self._arrived:
                target_values |= self._course(going, (x, z), away)
        for name, value in target_values.items():
            lag = self._plan.lags.get(name, DEFAULT_LAGS_S.get(name, 0.0))
            self._values[name] = low_pass(self._values[name], value, elapsed, lag) if lag else value

    def _course(
        self, going: LocomotionIntent, target: tuple[float, float], away: float
    ) -> dict[str, float]:
        """Return the parameters that lead to a target."""
        right = -self._place.bearing(*target)
        speed = min(max(going.speed, 0.0), TOP_SPEED)
        if going.stop:
            speed = min(speed, 0.6 + BRAKING_PER_M * max(away - ARRIVAL_DISTANCE_M, 0.0))
        if abs(right) > SLOW_TURN_RAD:
            speed = min(speed, TURNING_SPEED)
        angular = min(max(2.0 * math.degrees(right), -90.0), 90.0)
        return {"speed": speed, "angular": angular, "distance": away / self._scale}

    def _change(self, command: CharacterCommand, now: float) -> None:
        """Enter the state of the first transition whose condition holds."""
        machine = self._plan.machine
        if machine is None:
            return
        state = self._machine.state
        spent = now - self._machine.entered
        ended = spent >= self._motions[state].duration
        values: dict[str, float | str | bool] = {**self._values, "time": spent, "done": ended}
        values["action"] = command.activity
        for change in machine.transitions:
            here = change.end != state and change.start in (state, "*")
            if here and change.when.holds(values):
                self._enter(change, now)
                return

    def _enter(self, change: StateTransition, now: float) -> None:
        """Enter a state; its motion restarts once the old pose has been sampled."""
        bindings = self._bindings[change.end]
        self._machine.length = change.seconds
        self._machine.request(
            change.end,
            now,
            change.seconds if change.crossfade else 0.0,
            lambda: bindings.restart_with(self._values),
        )
