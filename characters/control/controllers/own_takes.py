"""Takes of a character that walks by its own clips: what matching plays without recordings."""

from collections.abc import Sequence

import numpy as np

from characters.control.controllers.walk import TURN_SPEED, WalkController
from characters.ik.legs import find_legs
from characters.locomotion.foot_lock import FootLock
from characters.locomotion.gaits import MAX_ANGULAR_RAD
from characters.locomotion.steering import STANDSTILL, SteeringOutput
from characters.model.character import Character
from characters.motion.clip import Clip
from characters.motion.motion import RootDelta
from characters.skeleton import rotations
from characters.skeleton.pose import Pose

TAKE_RATE_HZ = 30.0
"""Rate of the takes [Hz]."""

Course = Sequence[tuple[SteeringOutput, float]]
"""What a take walks: Speed, Angular and stride, and for how long [s]."""

_HOLD_S, _STAND_S = 1.3, 0.7
_SPEEDS = (0.6, 1.2, 1.8, 2.4, 3.4, 4.2, 5.0)


def standing_takes(character: Character, side: float = 1.0) -> list[Clip]:
    """Return a take of standing and of turning in place, to the right, or to the left for −1."""
    turn = SteeringOutput(TURN_SPEED, side * MAX_ANGULAR_RAD, 0.0)
    half = SteeringOutput(TURN_SPEED, side * MAX_ANGULAR_RAD / 2, 0.0)
    course = [(STANDSTILL, _STAND_S), (turn, 2.5), (STANDSTILL, _STAND_S), (half, 1.5)]
    return [_take(character, "turn in place", [*course, (STANDSTILL, 2.0)])]


def walking_takes(character: Character, side: float = 1.0) -> list[Clip]:
    """Return takes of setting off, walking, running, turning and stopping.

    They turn to the right, or to the left for a `side` of −1.
    """
    straight: list[tuple[SteeringOutput, float]] = []
    for speed in _SPEEDS:
        straight += [(_course(speed), _HOLD_S), (STANDSTILL, 1.0 + speed / 5)]
    faster = [(_course(speed), _HOLD_S) for speed in (*_SPEEDS, *_SPEEDS[::-1])]
    leap = [(_course(speed), _HOLD_S) for speed in (1.8, 4.2, 1.2, 5.0, 2.4)]
    takes = {"start and stop": straight, "faster and slower": [*faster, *leap]}
    for speed in _SPEEDS:
        shares = [side * share for share in (0.0, 0.3, 0.6, 1.0, 0.0, 1.0, -1.0, 0.5)]
        takes[f"bends at {speed:g}"] = [(_course(speed, share), _HOLD_S) for share in shares]
    for share in (0.5 * side, side):
        takes[f"turn and go {share:g}"] = [
            (STANDSTILL, _STAND_S),
            (_course(1.8, share), _HOLD_S),
            (STANDSTILL, 1.2),
            (_course(3.6, share), _HOLD_S),
            (STANDSTILL, 1.6),
        ]
    return [_take(character, name, course) for name, course in takes.items()]


def _course(speed: float, turn: float = 0.0) -> SteeringOutput:
    """Return a course at a Speed with a part −1…1 of the sharpest turn."""
    return SteeringOutput(speed, turn * MAX_ANGULAR_RAD, 1.0)


def _take(character: Character, name: str, course: Course) -> Clip:
    """Return the clip of a character that walks a course, its feet held on the ground."""
    controller = WalkController(character, 1.0, None)
    legs = find_legs(character.skeleton)
    lock = None if legs is None else FootLock(legs, character.height)
    poses: list[Pose] = []
    places: list[RootDelta] = []
    for steering, seconds in course:
        for _ in range(round(seconds * TAKE_RATE_HZ)):
            elapsed = 1.0 / TAKE_RATE_HZ if poses else 0.0
            frame = controller.steer(steering, elapsed)
            pose = frame.pose
            if lock is not None and frame.feet_down is not None:
                pose = lock.apply(pose, frame.place, frame.feet_down, frame.standing, elapsed)
            poses.append(pose)
            places.append(frame.place)
    turns = np.stack([pose.rotations for pose in poses])
    shifts = np.stack([pose.translations for pose in poses])
    yaw = rotations.about("y", np.array([place.yaw for place in places]))
    turns[:, 0] = rotations.multiply(yaw, turns[:, 0])
    shifts[:, 0] = rotations.rotate(yaw, shifts[:, 0])
    shifts[:, 0] += np.array([(place.x, 0.0, place.z) for place in places])
    return Clip(name, TAKE_RATE_HZ, Pose(shifts, turns), loop=False, root_motion=True)
