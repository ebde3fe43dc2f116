"""Takes of a character that walks by its own clips: what matching plays without recordings."""

from collections.abc import Sequence

from cubeling.characters.control.controllers.walk import TURN_SPEED, WalkController
from cubeling.characters.locomotion.gaits import IDLE_SPEED, MAX_ANGULAR_RAD
from cubeling.characters.locomotion.steering import STANDSTILL, SteeringOutput
from cubeling.characters.model.character import Character
from cubeling.characters.motion.baking import placed_clip
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Pose

TAKE_RATE_HZ = 60.0
"""Rate of the takes [Hz]."""

SPEEDS = (0.0, 0.6, 1.2, 1.8, 2.4, 3.3, 4.1, 5.0)
"""AvatAR's Speeds that are walked."""

_HOLD_S = 0.8  # of one Speed and turn
_RAMP_PER_S, _SHORTEST_RAMP_S = 5.0, 0.3  # change of Speed a second before, as a body can
_SLOWEST = SteeringOutput(IDLE_SPEED, 0.0, 1.0)
_TURNS = (0.0, 0.3, 1.0, 0.0, 0.6, -1.0, 0.0)  # as many as share no divisor with the changes

Course = Sequence[tuple[SteeringOutput, float]]
"""What a take walks: Speed, Angular and stride, and for how long [s]."""


def walking_take(character: Character, side: float = 1.0) -> Clip:
    """Return a take of every change between `SPEEDS`, straight and in bends.

    The bends are mostly to the right, or to the left for a `side` of −1.
    """
    course, before = [], 0.0
    for number, speed in enumerate(every_change(SPEEDS)):
        angular = side * _TURNS[number % len(_TURNS)] * MAX_ANGULAR_RAD
        going = SteeringOutput(speed, angular, 1.0) if speed > 0.0 else STANDSTILL
        course.append((going, _HOLD_S + _ramp(before, speed)))
        before = speed
    return _take(character, "own walk", course)


def standing_take(character: Character, side: float = 1.0) -> Clip:
    """Return a take of standing and of turning in place, to the right, or to the left for −1."""
    turn = SteeringOutput(TURN_SPEED, side * MAX_ANGULAR_RAD, 0.0)
    half = SteeringOutput(TURN_SPEED, side * MAX_ANGULAR_RAD / 2, 0.0)
    course = [(STANDSTILL, 0.7), (turn, 2.5), (STANDSTILL, 0.7), (half, 1.5), (STANDSTILL, 2.0)]
    return _take(character, "own turn in place", course)


def every_change(values: Sequence[float]) -> list[float]:
    """Return the values in an order that has each change from one to another once.

    The change to the first from the last is left out.

    >>> every_change([0, 1, 2])
    [0, 1, 0, 2, 1, 2]
    """
    return [
        value
        for number, first in enumerate(values)
        for second in values[number + 1 :]
        for value in (first, second)
    ]


def _take(character: Character, name: str, course: Course) -> Clip:
    """Return the clip of a character that walks a course."""
    controller = WalkController(character, 1.0, None)
    poses: list[Pose] = []
    places: list[RootDelta] = []
    before = STANDSTILL
    for steering, seconds in course:
        for number in range(round(seconds * TAKE_RATE_HZ)):
            elapsed = 1.0 / TAKE_RATE_HZ if poses else 0.0
            part = number / TAKE_RATE_HZ / _ramp(before.speed, steering.speed)
            asked = _on_the_way(before, steering, part)
            frame = controller.steer(asked, elapsed)
            poses.append(frame.pose)
            places.append(frame.place)
        before = steering
    return placed_clip(name, TAKE_RATE_HZ, Pose.of_frames(poses), places)


def _ramp(before: float, after: float) -> float:
    """Return how long a change of Speed takes [s]."""
    return max(abs(after - before) / _RAMP_PER_S, _SHORTEST_RAMP_S)


def _on_the_way(before: SteeringOutput, after: SteeringOutput, part: float) -> SteeringOutput:
    """Return what is steered a part of the way from one course to another; slowest next to a stop.

    It sets off in the direction and with the strides of the new course, and stops with the old.
    """
    if part >= 1.0 or before.speed == after.speed == 0.0:
        return after
    old = (
        before
        if before.speed > 0.0
        else _SLOWEST._replace(angular=after.angular, stride=after.stride)
    )
    new = (
        after
        if after.speed > 0.0
        else _SLOWEST._replace(angular=before.angular, stride=before.stride)
    )
    return SteeringOutput(
        old.speed + part * (new.speed - old.speed),
        old.angular + part * (new.angular - old.angular),
        old.stride + part * (new.stride - old.stride),
    )
