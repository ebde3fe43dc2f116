"""What the simulated robot is made of: the joints of a Pleo, and what they do in each mood.

Joints, limits and speeds are those of `robot.drivers.pleo.joints`. The motions are our own.
"""

import numpy as np
from numpy.typing import NDArray

from robot.contract.catalogue import Catalogue
from robot.contract.motions import Motion, Sway
from robot.drivers.pleo.joints import JOINTS as PLEO

Array = NDArray[np.float64]

_LIMITS = tuple(joint.limits for joint in PLEO)

JOINTS = tuple(joint.name for joint in _LIMITS)
"""Names of the joints, in the order of the catalogue."""

MOOD_LOOPS = (
    Motion(
        "neutral",
        4.0,
        {
            "torso": Sway(0, 2),
            "neck up": Sway(5, 4, 1, 0.25),
            "neck sideways": Sway(0, 10),
            "tail sideways": Sway(0, 12, 1, 0.5),
            "eyes and mouth": Sway(50, 8, 2),
        },
        "breath",
    ),
    Motion(
        "happy",
        3.2,
        {
            "right shoulder": Sway(8, 6, 1),
            "left shoulder": Sway(8, 6, 1, 0.5),
            "torso": Sway(0, 6, 1),
            "neck up": Sway(25, 8, 2),
            "neck sideways": Sway(0, 20, 1, 0.25),
            "tail up": Sway(30, 8, 2),
            "tail sideways": Sway(0, 45, 2),
            "eyes and mouth": Sway(65, 15, 2),
        },
        "purr",
    ),
    Motion(
        "angry",
        2.4,
        {
            "right shoulder": Sway(-15),
            "left shoulder": Sway(-15),
            "right elbow": Sway(35, 8, 2),
            "left elbow": Sway(35, 8, 2, 0.5),
            "torso": Sway(-6, 3.5, 2),
            "neck up": Sway(-30, 5, 2),
            "neck sideways": Sway(0, 15, 1),
            "tail up": Sway(45, 10, 3),
            "tail sideways": Sway(0, 25, 3),
            "eyes and mouth": Sway(-55, 20, 2),
        },
        "growl",
    ),
)
"""One endless motion with one sound for each mood, in the order of `mood.LABELS`."""

ACTIONS = (
    Motion("nod", 2.0, {"neck up": Sway(0, 6, 2), "eyes and mouth": Sway(50)}),
    Motion("shake head", 2.0, {"neck sideways": Sway(0, 7, 2), "eyes and mouth": Sway(50)}),
    Motion("wag tail", 2.0, {"tail sideways": Sway(0, 30, 2), "tail up": Sway(20)}),
    Motion(
        "bow",
        4.0,
        {
            "right shoulder": Sway(18, 18, 1, -0.25),
            "left shoulder": Sway(18, 18, 1, -0.25),
            "right elbow": Sway(30, 30, 1, -0.25),
            "left elbow": Sway(30, 30, 1, -0.25),
            "neck up": Sway(-20, 20, 1, 0.25),
        },
    ),
    Motion(
        "kiss",
        2.4,
        {"neck up": Sway(12, 8, 1, -0.25), "eyes and mouth": Sway(-50, 30, 2, -0.25)},
    ),
)
"""Motions that are played once and then give way to the mood again."""

SOUNDS = {"breath": 2.0, "purr": 3.0, "growl": 1.5, "chirp": 0.5, "smack": 0.6, "roar": 1.8}
"""Length of every sound [s]."""

MOTIONS = MOOD_LOOPS + ACTIONS
"""Every motion, in the order of the catalogue."""

LOW = np.array([joint.low for joint in _LIMITS])
HIGH = np.array([joint.high for joint in _LIMITS])
SPEED = np.array([joint.speed for joint in _LIMITS])
"""Limits [rad] and top speeds [rad/s] of the joints, (joints,) each."""

CATALOGUE = Catalogue(
    name="Dino",
    firmware="simulator 1",
    joints=_LIMITS,
    motions=tuple(motion.name for motion in MOTIONS),
    sounds=tuple(SOUNDS),
    moods=tuple(loop.name for loop in MOOD_LOOPS),
)
"""What the simulated robot says that it has."""
