"""A character that walks and runs to where it is sent."""

import math

import numpy as np

from characters.control.actions import WEIGHT_LAG, Act, Footing, acts_of, proceed
from characters.control.command import CharacterCommand
from characters.errors import CharacterError
from characters.locomotion.foot_lock import FootLock
from characters.locomotion.gaits import (
    IDLE_SPEED,
    MAX_ANGULAR_RAD,
    RUN_CLIPS,
    RUN_SPEED,
    TOP_SPEED,
    WALK_CLIPS,
    Gaits,
)
from characters.locomotion.steering import STANDSTILL, Steering, SteeringOutput
from characters.locomotion.stride_blending import StrideBlend
from characters.model.character import Character
from characters.motion.motion import Motion, RootDelta
from characters.motion.phase import Cyclic, RetimedMotion
from characters.motion.state_machine import StateMachine
from characters.skeleton.pose import Pose, Skeleton
from characters.smoothing import low_pass

_SPEED_LAG = 0.15  # [s]
_ANGULAR_LAG = 0.15  # [s]
_STRIDE_LAG = 0.08  # [s]
_TURN_FROM, _TURN_UNTIL = math.radians(25), math.radians(4)  # turning on the spot, with steps
_TURN_SPEED = 1.2  # Speed of those steps

NO_ACTS = (*WALK_CLIPS.values(), *RUN_CLIPS.values(), "move")
"""Clips that walking is made of, and the word for it."""


class Walker:
    """Plays a character with the movement tree of AvatAR; a `Performer`.

    Two states, as there: it stands, or it walks and runs. Standing, it turns to what it is to
    look at in small steps on the spot. Its other clips are actions, which it stands for: see
    `characters.control.actions`.
    """

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None:
        clips, skeleton = character.clips, character.skeleton
        idle: Motion = clips.get("idle", clips["Walk"])
        self.gaits = Gaits(clips, skeleton, idle.sample(0.0))
        self.place = place or RootDelta()
        self.state, self.speed, self.angular = "idle", 0.0, 0.0
        self.weight, self.height = 0.0, 0.0
        self._scale = scale
        self._course_in_use = STANDSTILL
        self._turning = False
        self._steering = Steering(self.gaits, scale)
        self._motion = self.gaits.at(IDLE_SPEED, 0.0)
        self._steps = RetimedMotion(self._motion)
        self._first = _likest(idle.sample(0.0), self.gaits.at(IDLE_SPEED, 0.0), skeleton)
        self._acts = acts_of(character, NO_ACTS)
        self._done = ""  # what was asked for, and has ended
        self._machine = StateMachine({"idle": idle, "move": self._steps, **self._acts}, "idle")
        self._time = 0.0
        legs = self.gaits.legs
        self.lock = FootLock(legs, character.height) if legs is not None else None
        """What holds its feet, or None where there are no legs to bend."""
        self._footing = {
            name: Footing.of(act.clip, skeleton, legs.feet if legs is not None else ())
            for name, act in self._acts.items()
        }

    @property
    def actions(self) -> tuple[str, ...]:
        """What it can be asked to do beside standing, walking and running."""
        return tuple(self._acts)

    def release(self) -> None:
        """Hold no feet from now on: they go where the motion has them."""
        self.lock = None

    @staticmethod
    def suits(character: Character) -> bool:
        """Whether a character has a walk that gets it anywhere."""
        walk = character.clips.get("Walk")
        return walk is not None and walk.loop and walk.cycle.length > 0.1 * character.height

    def update(self, command: CharacterCommand, elapsed: float) -> Pose:
        """Advance by a time [s] under a command and return the pose, with the root in place."""
        wish = "idle" if command.activity == "move" else command.activity
        if wish != "idle" and wish not in self._acts:
            raise CharacterError(
                f"the character does not know {wish!r}; it knows "
                f"{', '.join(['idle', 'move', *self._acts])}"
            )
        act, self._done = proceed(self._machine, self._acts, wish, self._done, self._time)
        if act != "idle":
            return self.go(STANDSTILL, elapsed, act, min(max(command.weight, -1.0), 1.0))
        return self.go(self._course(command), elapsed)

    def go(
        self, course: SteeringOutput, elapsed: float, act: str = "idle", weight: float = 0.0
    ) -> Pose:
        """Advance by a time [s] on a course and return the pose, with the root in place.

        Standing, it plays an action at an intensity −1…1.
        """
        used = self._course_in_use = self._follow(course, elapsed)
        now, self._time = self._time, self._time + elapsed
        self._play(used, "move" if course.speed > 0.0 else act, weight, now)
        self._report(used, course.speed > 0.0 and not self._turning)
        step = self._machine.travel(now, self._time)
        self.place = self.place.then(
            RootDelta(step.x * self._scale, step.z * self._scale, step.yaw)
        )
        pose = self._machine.sample(self._time)
        if self.lock is None:
            return pose
        return self.lock.apply(
            pose,
            RootDelta(self.place.x / self._scale, self.place.z / self._scale, self.place.yaw),
            self._down(),
            self._machine.state == "idle",
            elapsed,
        )

    def _down(self) -> list[bool]:
        """Return which feet the motion has on the ground; who stands, stands on all."""
        state, count = self._machine.state, len(self.lock.feet) if self.lock is not None else 0
        if state in self._acts:
            return self._footing[state].at(
                self._acts[state].phase(self._time - self._machine.entered)
            )
        if state == "idle" or not isinstance(self._motion, StrideBlend):
            return [True] * count
        phase = self._steps.phase(self._time - self._machine.entered)
        return [part > 0.5 for part in self._motion.contacts(phase)]

    def _course(self, command: CharacterCommand) -> SteeringOutput:
        """Return where to go, or how to turn on the spot."""
        course = STANDSTILL
        going = command.locomotion
        if command.activity == "move" and going is not None and going.target is not None:
            x, z = (float(value) for value in going.target)
            speed = min(going.speed, TOP_SPEED)
            course = self._steering.update(self.place, (x, z), speed, going.stop)
        if course.speed > 0.0:
            self._turning = False
            return course
        return self._look(command)

    def _look(self, command: CharacterCommand) -> SteeringOutput:
        """Return the course of turning on the spot to what it is to look at."""
        if command.locomotion is None or command.locomotion.facing is None:
            self._turning = False
            return STANDSTILL
        error = -self.place.bearing(*(float(value) for value in command.locomotion.facing))
        self._turning = abs(error) > (_TURN_UNTIL if self._turning else _TURN_FROM)
        if not self._turning:
            return STANDSTILL
        return SteeringOutput(
            _TURN_SPEED, min(max(2 * error, -MAX_ANGULAR_RAD), MAX_ANGULAR_RAD), 0.0
        )

    def _follow(self, course: SteeringOutput, elapsed: float) -> SteeringOutput:
        """Let Speed, Angular and stride go after a course and return them."""
        used = self._course_in_use
        if self._machine.state != "move":
            # From standing it sets off in the right way at once; the transition is the easing.
            used = SteeringOutput(0.0, course.angular, course.stride)
        return SteeringOutput(
            low_pass(used.speed, course.speed, elapsed, _SPEED_LAG),
            low_pass(used.angular, course.angular, elapsed, _ANGULAR_LAG),
            low_pass(used.stride, course.stride, elapsed, _STRIDE_LAG),
        )

    def _play(self, used: SteeringOutput, state: str, weight: float, now: float) -> None:
        """Keep the right state going with the parameters in use."""
        motion = self._motion = self.gaits.at(used.speed, used.angular, used.stride)
        if self._machine.state == "move":
            self._steps.change(motion, now - self._machine.entered)
        elif state == "move":
            self._steps.restart(motion, self._first)
        if state in self._acts:
            self._perform(self._acts[state], weight, now if self._machine.state == state else None)
        self._machine.request(state, now)

    def _perform(self, act: Act, weight: float, now: float | None) -> None:
        """Let an action go on, or begin where there is no time [s] yet."""
        if now is None:
            self.weight = weight
            act.begin(weight)
            return
        self.weight = low_pass(self.weight, weight, self._time - now, WEIGHT_LAG)
        act.change(self.weight, now - self._machine.entered)

    def _report(self, used: SteeringOutput, going: bool) -> None:
        """Say what it is doing; to turn on the spot is to stand."""
        state = self._machine.state
        self.state, self.speed, self.angular = "idle", 0.0, 0.0
        if state in self._acts:
            self.state = state
        else:
            self.weight = 0.0
        if going:
            self.state = "run" if used.speed > RUN_SPEED else "walk"
            self.speed, self.angular = used.speed, used.angular


def _likest(pose: Pose, motion: Cyclic, skeleton: Skeleton) -> float:
    """Return the phase at which a cyclic motion is most like a pose: where to set off."""
    still = pose.globals(skeleton)[:, :3, 3]
    phases = np.arange(32) / 32
    apart = [np.square(motion.at(p).globals(skeleton)[:, :3, 3] - still).sum() for p in phases]
    return float(phases[int(np.argmin(apart))])
