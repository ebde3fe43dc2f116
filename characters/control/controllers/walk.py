"""A character that walks and runs to where it is sent."""

import math

from cubeling.characters.control.command import CharacterCommand
from cubeling.characters.control.controllers.actions import (
    WEIGHT_LAG_S,
    ActionMotion,
    Actions,
    next_action,
)
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.control.speaking.shifting import CommandedStanding
from cubeling.characters.locomotion.gaits import (
    IDLE_SPEED,
    MAX_ANGULAR_RAD,
    MIN_CYCLE_LENGTH,
    RUN_CLIPS,
    RUN_SPEED,
    TOP_SPEED,
    WALK_CLIPS,
)
from cubeling.characters.locomotion.steering import STANDSTILL, Steering, SteeringOutput
from cubeling.characters.locomotion.stride_blending import StrideBlend
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.phase import RetimedMotion
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.smoothing import low_pass

SPEED_LAG_S = 0.15
ANGULAR_LAG_S = 0.15
STRIDE_LAG_S = 0.08
TURN_START_RAD, TURN_END_RAD = math.radians(25), math.radians(4)  # turning in place, with steps
TURN_SPEED = 1.2  # Speed of those steps

NOT_ACTIONS = (*WALK_CLIPS.values(), *RUN_CLIPS.values(), "move")
"""Clips of walking and running, and the state that plays them."""


class WalkController:
    """Plays a character with the movement tree of AvatAR; a `CharacterController`.

    It has two states: it stands, or it walks and runs. Standing, it turns to the point that it
    faces in small steps. Its other clips are actions, for which it stands still.
    """

    walks = True

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None:
        clips = character.clips
        self._standing = CommandedStanding(character)
        idle: Motion = self._standing.motion or clips.get("idle", clips["Walk"])
        self.gaits = character.gaits
        self.place = place or RootDelta()
        """Where it stands on the table [m] and faces [rad]."""
        self._scale = scale
        self._steered = STANDSTILL
        self._turning = False
        self._steering = Steering(self.gaits, scale)
        self._motion = self.gaits.at(IDLE_SPEED, 0.0)
        self._strides = RetimedMotion(self._motion)
        self._first_phase = self.gaits.first_phase
        self._actions = Actions(character, NOT_ACTIONS)
        self._finished = ""
        self._machine = StateMachine(
            {"idle": idle, "move": self._strides}, "idle", others=self._actions
        )
        self._time = 0.0
        self._weight = 0.0
        self._feet = 0 if self.gaits.legs is None else len(self.gaits.legs.feet)

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that it knows, besides standing, walking and running."""
        return tuple(self._actions)

    @staticmethod
    def suits(character: Character) -> bool:
        """Whether a character has a walk that moves its root."""
        walk = character.clips.get("Walk")
        return (
            walk is not None
            and walk.loop
            and walk.cycle.length > MIN_CYCLE_LENGTH * character.height
        )

    def update(
        self, command: CharacterCommand, elapsed: float, tempo: float = 1.0
    ) -> ControllerFrame:
        """Advance by a time [s] under a command and return what is played."""
        # Also while it walks: when it stops it stands as it feels now.
        self._standing.update(command, self._actions.first_pose(command.coming))
        action, self._finished = next_action(
            self._machine, self._actions, command.action, self._finished, self._time
        )
        if action != "idle":
            return self.steer(STANDSTILL, elapsed, action, min(max(command.weight, -1.0), 1.0))
        return self.steer(self._course(command), elapsed)

    def steer(
        self, course: SteeringOutput, elapsed: float, action: str = "idle", weight: float = 0.0
    ) -> ControllerFrame:
        """Advance by a time [s] on a course and return what is played.

        Standing, it plays an action at an intensity −1…1.
        """
        steered = self._steered = self._smooth(course, elapsed)
        # The play starts at the frame's begin, and the pose is of its end, so no frame is lost.
        now, self._time = self._time, self._time + elapsed
        self._play(steered, "move" if course.speed > 0.0 else action, weight, now)
        step = self._machine.travel(now, self._time)
        self.place = self.place.then(step.scale(self._scale))
        return self._frame(steered, course.speed > 0.0 and not self._turning)

    def _frame(self, steered: SteeringOutput, going: bool) -> ControllerFrame:
        """Return what is played now; to turn in place is to stand."""
        state = self._machine.state
        action = self._actions.get(state)
        if action is None:
            self._weight = 0.0
        name = "idle" if action is None else state
        if going:
            name = "run" if steered.speed > RUN_SPEED else "walk"
        return ControllerFrame(
            self._machine.sample(self._time),
            name,
            self.place,
            speed=steered.speed if going else 0.0,
            angular=steered.angular if going else 0.0,
            weight=self._weight,
            acting=action is not None and not going,
            shows_emotion=action is not None and not going and action.shows_emotion,
            feet_down=self._feet_down(),
            standing=state == "idle",
        )

    def _feet_down(self) -> list[bool] | None:
        """Return which feet the motion has on the ground; standing, all of them."""
        if not self._feet:
            return None
        state, spent = self._machine.state, self._time - self._machine.entered
        if state in self._actions:
            action = self._actions[state]
            contacts, phase = self.gaits.contacts(action.clip), action.phase(spent)
            # The end of an action that is held is its last frame, not the first of a loop.
            frame = int((phase if phase == 1.0 else phase % 1.0) * (len(contacts) - 1))
            return contacts[frame]
        if state == "idle":
            return [True] * self._feet
        assert isinstance(self._motion, StrideBlend)  # as always for a character with legs
        return [part > 0.5 for part in self._motion.contacts(self._strides.phase(spent))]

    def _course(self, command: CharacterCommand) -> SteeringOutput:
        """Return where to go, or how to turn in place."""
        course, going = STANDSTILL, command.locomotion
        if command.activity == "move" and going is not None and going.target is not None:
            x, z = (float(value) for value in going.target)
            speed = min(going.speed, TOP_SPEED)
            course = self._steering.update(self.place, (x, z), speed, going.stop)
        if course.speed > 0.0:
            self._turning = False
            return course
        return self._turn_in_place(command)

    def _turn_in_place(self, command: CharacterCommand) -> SteeringOutput:
        """Return the course of turning to the point to be faced."""
        if command.locomotion is None or command.locomotion.facing is None:
            self._turning = False
            return STANDSTILL
        # Angular is positive to the right, bearings to the left.
        error = -self.place.bearing(*(float(value) for value in command.locomotion.facing))
        # Hysteresis: it starts late, and then turns all the way.
        self._turning = abs(error) > (TURN_END_RAD if self._turning else TURN_START_RAD)
        if not self._turning:
            return STANDSTILL
        angular = min(max(2 * error, -MAX_ANGULAR_RAD), MAX_ANGULAR_RAD)
        # Stride 0: steps on the spot.
        return SteeringOutput(TURN_SPEED, angular, 0.0)

    def _smooth(self, course: SteeringOutput, elapsed: float) -> SteeringOutput:
        """Return Speed, Angular and stride on their way to those of a course."""
        used = self._steered
        if self._machine.state != "move":
            # From standing it sets off in the right direction; the transition smooths it.
            used = SteeringOutput(0.0, course.angular, course.stride)
        speed = low_pass(used.speed, course.speed, elapsed, SPEED_LAG_S)
        return SteeringOutput(
            self.gaits.next_speed(used.speed, speed, elapsed),
            low_pass(used.angular, course.angular, elapsed, ANGULAR_LAG_S),
            low_pass(used.stride, course.stride, elapsed, STRIDE_LAG_S),
        )

    def _play(self, steered: SteeringOutput, state: str, weight: float, now: float) -> None:
        moves = self._machine.state == "move"
        if moves or state == "move":
            motion = self._motion = self.gaits.at(steered.speed, steered.angular, steered.stride)
            if moves:
                self._strides.change(motion, now - self._machine.entered)
            else:
                self._strides.restart(motion, self._first_phase)
        if state in self._actions:
            self._play_action(self._actions[state], weight, now, self._machine.state == state)
        self._machine.request(state, now)

    def _play_action(self, action: ActionMotion, weight: float, now: float, playing: bool) -> None:
        if not playing:
            self._weight = weight
            action.begin(weight)
            return
        self._weight = low_pass(self._weight, weight, self._time - now, WEIGHT_LAG_S)
        action.set_weight(self._weight, now - self._machine.entered)
