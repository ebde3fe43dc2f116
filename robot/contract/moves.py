"""Turning single joints: for the drivers whose robots have that."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from cubeling.robot.contract.catalogue import Catalogue, JointLimits
from cubeling.robot.errors import RobotError

ROUNDING_RAD = 5e-4
"""How far an angle may be beyond a limit that a robot reports in whole milliradians [rad]."""

MAX_DURATION_S = 65.0
"""Longest time for a move [s]."""


@dataclass(frozen=True)
class JointMove:
    """Which joints go where, and which are let go; by index in the catalogue."""

    angles: Mapping[int, float]
    """Angle of each joint that is to be held, within its limits [rad]."""

    released: frozenset[int]
    """Joints that follow mood and motion again."""

    duration: float
    """Time for the way [s]; a joint whose top speed is too low for it takes longer."""


class JointMover(Protocol):
    """What a driver has whose robot turns single joints."""

    def move(self, move: JointMove) -> bool:
        """Request a move once; return False if too many wait. Without a session it is dropped."""


def joint_move(
    catalogue: Catalogue, angles: Mapping[str, float | None], duration: float
) -> JointMove:
    """Return a move of joints by their names; None lets go of a joint.

    Raises
    ------
    RobotError
        If the robot has no such joint, or an angle [rad] or the duration [s] is out of its range.
    """
    if not 0 <= duration <= MAX_DURATION_S:
        raise RobotError(f"a move takes 0 to {MAX_DURATION_S:g} s, not {duration:g} s")
    joints = {joint.name: (index, joint) for index, joint in enumerate(catalogue.joints)}
    held, released = {}, set()
    for name, angle in angles.items():
        if name not in joints:
            known = ", ".join(joints) or "it has none"
            raise RobotError(f"{catalogue.name} has no joint {name!r}: {known}")
        index, joint = joints[name]
        if angle is None:
            released.add(index)
        else:
            held[index] = _within_limits(joint, angle)
    return JointMove(held, frozenset(released), duration)


def _within_limits(joint: JointLimits, angle: float) -> float:
    if not joint.low - ROUNDING_RAD <= angle <= joint.high + ROUNDING_RAD:  # also refuses NaN
        low, high, asked = (f"{math.degrees(one):.0f}°" for one in (joint.low, joint.high, angle))
        raise RobotError(f"{joint.name} turns from {low} to {high}, not to {asked}")
    return min(max(angle, joint.low), joint.high)
