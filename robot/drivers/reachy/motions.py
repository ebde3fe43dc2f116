"""Reachy Mini's joints with their limits, and its motions."""

from math import radians

import numpy as np

from cubeling.robot.contract.catalogue import Catalogue, JointLimits
from cubeling.robot.contract.motions import Array, JointSine, SineMotion

_LIMITS_DEG = (
    ("head roll", -25, 25, 60),
    ("head pitch", -30, 30, 60),
    ("head yaw", -35, 35, 90),
    ("body yaw", -25, 25, 60),
    ("right antenna", -90, 90, 180),
    ("left antenna", -90, 90, 180),
)
"""Well inside what the robot allows: ±40° of pitch and roll, at most 65° between head and body
(Reachy Mini's SDK documentation, "Core concepts"). The speeds are ours; none are published."""

JOINTS = tuple(name for name, *_ in _LIMITS_DEG)
"""Joint names. Zero looks ahead; positive is right, down and to its left, as the SDK's roll, pitch
and yaw; antennas are upright at zero and fall outwards or back."""

MIN_ANGLES_RAD = np.radians([row[1] for row in _LIMITS_DEG])
MAX_ANGLES_RAD = np.radians([row[2] for row in _LIMITS_DEG])
MAX_SPEEDS_RAD_PER_S = np.radians([row[3] for row in _LIMITS_DEG])
"""Limits [rad] and top speeds [rad/s] of the joints, (joints,) each."""

MOODS = (
    SineMotion(
        "neutral",
        5.0,
        {
            "head yaw": JointSine(0, 10),
            "head pitch": JointSine(0, 2, 2),
            "right antenna": JointSine(-12, 5, 2),
            "left antenna": JointSine(12, 5, 2, 0.1),
        },
    ),
    SineMotion(
        "happy",
        2.4,
        {
            "head roll": JointSine(0, 11, 2),
            "head pitch": JointSine(-10, 5, 2, 0.25),
            "body yaw": JointSine(0, 12),
            "right antenna": JointSine(-5, 26, 3),
            "left antenna": JointSine(5, 26, 3, 0.5),
        },
    ),
    SineMotion(
        "angry",
        2.0,
        {
            "head pitch": JointSine(15, 3, 4),
            "head yaw": JointSine(0, 12, 2),
            "right antenna": JointSine(-75, 6, 6),
            "left antenna": JointSine(75, 6, 6, 0.5),
        },
    ),
    SineMotion(
        "sad",
        6.0,
        {
            "head pitch": JointSine(22, 3),
            "head roll": JointSine(5, 2, 1, 0.25),
            "right antenna": JointSine(-85, 4),
            "left antenna": JointSine(85, 4, 1, 0.1),
        },
    ),
    SineMotion(
        "afraid",
        3.0,
        {
            "head pitch": JointSine(-8, 2, 8),
            "head roll": JointSine(-14, 2, 6),
            "body yaw": JointSine(16, 2, 8),
            "right antenna": JointSine(-80, 4, 9),
            "left antenna": JointSine(80, 4, 9, 0.3),
        },
    ),
    SineMotion(
        "surprised",
        4.0,
        {
            "head pitch": JointSine(-16, 2),
            "right antenna": JointSine(8, 3, 4),
            "left antenna": JointSine(-8, 3, 4),
        },
    ),
    SineMotion(
        "sleepy",
        7.0,
        {
            "head pitch": JointSine(14, 7),
            "head roll": JointSine(6, 3),
            "right antenna": JointSine(-50, 4),
            "left antenna": JointSine(50, 4),
        },
    ),
)
"""A looping motion for each mood, neutral first."""

ACTIONS = (
    SineMotion("nod", 1.6, {"head pitch": JointSine(2, 10, 2)}),
    SineMotion("shake head", 1.8, {"head yaw": JointSine(0, 16, 2)}),
    SineMotion(
        "wiggle",
        1.5,
        {"right antenna": JointSine(0, 30, 3), "left antenna": JointSine(0, 30, 3, 0.5)},
    ),
    SineMotion("bow", 3.0, {"head pitch": JointSine(12, 12, 1, -0.25)}),
    SineMotion("kiss", 2.0, {"head pitch": JointSine(-4, 9, 2), "head roll": JointSine(8, 0)}),
)
"""Motions that play once; then the loop of the mood continues."""

MOTIONS = MOODS + ACTIONS
"""Every motion, in the order of the catalogue."""


def catalogue(firmware: str) -> Catalogue:
    """Return the catalogue; `firmware` is the version of the daemon."""
    joints = tuple(
        JointLimits(name, radians(low), radians(high), radians(speed))
        for name, low, high, speed in _LIMITS_DEG
    )
    names = tuple(motion.name for motion in MOTIONS)
    moods = tuple(motion.name for motion in MOODS)
    return Catalogue("Reachy Mini", firmware, joints, names, (), moods)


def step_towards(angles: Array, wanted: Array, elapsed: float) -> Array:
    """Return the angles after a step of `elapsed` [s] towards the wanted ones, (joints,) [rad].

    They stay within the limits and speeds.
    """
    reach = MAX_SPEEDS_RAD_PER_S * elapsed
    return np.clip(angles + np.clip(wanted - angles, -reach, reach), MIN_ANGLES_RAD, MAX_ANGLES_RAD)
