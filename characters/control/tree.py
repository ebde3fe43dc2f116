"""Plays a character as the file beside it says."""

import math

from characters.control.command import CharacterCommand, LocomotionIntent
from characters.locomotion.steering import ARRIVAL_DISTANCE_M, DEPARTURE_DISTANCE_M
from characters.model.character import Character
from characters.model.mirroring import mirror_of
from characters.motion.motion import Motion, RootDelta
from characters.motion.state_machine import StateMachine
from characters.motion.trees.building import Builder
from characters.motion.trees.parametric import ParameterBindings
from characters.motion.trees.plan import PARAMETERS, Plan, Transition
from characters.skeleton.pose import Pose
from characters.smoothing import low_pass

LAGS = {"speed": 0.15, "angular": 0.15, "weight": 0.12}
"""How slowly parameters follow where the file does not say [s]: a wish that jumps is no pop."""

_BRAKING = 63.0  # Speed for each metre on the table that is left to go
_SLOW_TURN = math.radians(60)  # a target farther round than this is approached at a walk
_TURNING_SPEED = 1.5


class TreePlayer:
    """Plays a plan; a `Performer`.

    The root moves as the motions say. A target is steered for by the parameters alone: it is the
    plan that turns them into steps.

    Parameters
    ----------
    character
        With a plan.
    scale
        Table metres for each metre of the character.
    place
        Where it first stands on the table.
    """

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None:
        if character.plan is None:
            raise ValueError(f"{character.name} has no plan")
        self._plan: Plan = character.plan
        self.place = place or RootDelta()
        self.state, self.speed, self.angular, self.weight, self.height = "idle", 0.0, 0.0, 0.0, 0.0
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
        built = {n: builder.build(node, self._values) for n, node in nodes.items() if node}
        self._motions: dict[str, Motion] = {name: motion for name, (motion, _) in built.items()}
        self._steering: dict[str, ParameterBindings] = {
            name: steer for name, (_, steer) in built.items()
        }
        self._machine = StateMachine(self._motions, "" if machine is None else machine.start)

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of its states: what each answers to, its conditions say."""
        return () if self._plan.machine is None else tuple(self._plan.machine.states)

    @staticmethod
    def suits(character: Character) -> bool:
        """Whether a file says how a character is to be played."""
        return character.plan is not None

    def update(self, command: CharacterCommand, elapsed: float) -> Pose:
        """Advance by a time [s] under a command and return the pose, with the root in place."""
        self._read(command, elapsed)
        now, self._time = self._time, self._time + elapsed
        self._change(command, now)
        state = self._machine.state
        self._steering[state].set_values(self._values, now - self._machine.entered)
        self._report(command)
        step = self._machine.travel(now, self._time)
        self.place = self.place.then(
            RootDelta(step.x * self._scale, step.z * self._scale, step.yaw)
        )
        return self._machine.sample(self._time)

    def _read(self, command: CharacterCommand, elapsed: float) -> None:
        """Take the parameters from a command."""
        wish = dict.fromkeys(PARAMETERS, 0.0)
        wish["weight"] = min(max(command.weight, -1.0), 1.0)
        going = command.locomotion or LocomotionIntent()
        if going.facing is not None:
            wish["bearing"] = math.degrees(self.place.bearing(*map(float, going.facing)))
        if command.activity == "move" and going.target is not None:
            x, z = map(float, going.target)
            away = math.hypot(x - self.place.x, z - self.place.z)
            self._arrived = going.stop and away < (
                DEPARTURE_DISTANCE_M if self._arrived else ARRIVAL_DISTANCE_M
            )
            if not self._arrived:
                wish |= self._course(going, (x, z), away)
        for name, value in wish.items():
            lag = self._plan.lags.get(name, LAGS.get(name, 0.0))
            self._values[name] = low_pass(self._values[name], value, elapsed, lag) if lag else value

    def _course(
        self, going: LocomotionIntent, target: tuple[float, float], away: float
    ) -> dict[str, float]:
        """Return the parameters that lead to a target."""
        right = -self.place.bearing(*target)
        speed = min(max(going.speed, 0.0), 5.0)
        if going.stop:
            speed = min(speed, 0.6 + _BRAKING * max(away - ARRIVAL_DISTANCE_M, 0.0))
        if abs(right) > _SLOW_TURN:
            speed = min(speed, _TURNING_SPEED)
        angular = min(max(2.0 * math.degrees(right), -90.0), 90.0)
        return {"speed": speed, "angular": angular, "distance": away / self._scale}

    def _change(self, command: CharacterCommand, now: float) -> None:
        """Enter another state if a condition says so; one at a time."""
        machine = self._plan.machine
        if machine is None:
            return
        state = self._machine.state
        spent = now - self._machine.entered
        ended = spent >= self._motions[state].duration
        values: dict[str, float | str | bool] = {**self._values, "time": spent, "done": ended}
        values["action"] = command.activity
        for change in machine.transitions:
            if _leads_on(change, state) and change.when.holds(values):
                self._enter(change, now)
                return

    def _enter(self, change: Transition, now: float) -> None:
        """Enter a state; its motion starts over once the old one has been looked at."""
        steering = self._steering[change.end]
        self._machine.length = change.seconds
        self._machine.request(
            change.end,
            now,
            change.seconds if change.crossfade else 0.0,
            lambda: steering.restart_with(self._values),
        )

    def _report(self, command: CharacterCommand) -> None:
        self.state = self._machine.state or command.activity
        self.speed, self.weight = self._values["speed"], self._values["weight"]
        self.angular = math.radians(self._values["angular"])


def _leads_on(change: Transition, state: str) -> bool:
    return change.end != state and change.start in (state, "*")
