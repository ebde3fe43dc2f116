"""The simulated dinosaur's joints, motions and sounds.

Joints, limits and speeds are those of `robot.drivers.pleo.joints`; the motions are our own.
"""

import numpy as np

from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.motions import JointSine, SineMotion
from cubeling.robot.drivers.pleo.joints import JOINTS as PLEO_JOINTS

_LIMITS = tuple(joint.limits for joint in PLEO_JOINTS)

JOINTS = tuple(joint.name for joint in _LIMITS)
"""Joint names in the order of the catalogue."""

MOOD_LOOPS = (
    SineMotion(
        "neutral",
        4.0,
        {
            "torso": JointSine(0, 2),
            "neck up": JointSine(5, 4, 1, 0.25),
            "neck sideways": JointSine(0, 10),
            "tail sideways": JointSine(0, 12, 1, 0.5),
            "eyes and mouth": JointSine(50, 8, 2),
        },
        "breath",
    ),
    SineMotion(
        "happy",
        3.2,
        {
            "right shoulder": JointSine(8, 6, 1),
            "left shoulder": JointSine(8, 6, 1, 0.5),
            "torso": JointSine(0, 6, 1),
            "neck up": JointSine(25, 8, 2),
            "neck sideways": JointSine(0, 20, 1, 0.25),
            "tail up": JointSine(30, 8, 2),
            "tail sideways": JointSine(0, 45, 2),
            "eyes and mouth": JointSine(65, 15, 2),
        },
        "purr",
    ),
    SineMotion(
        "angry",
        2.4,
        {
            "right shoulder": JointSine(-15),
            "left shoulder": JointSine(-15),
            "right elbow": JointSine(35, 8, 2),
            "left elbow": JointSine(35, 8, 2, 0.5),
            "torso": JointSine(-6, 3.5, 2),
            "neck up": JointSine(-30, 5, 2),
            "neck sideways": JointSine(0, 15, 1),
            "tail up": JointSine(45, 10, 3),
            "tail sideways": JointSine(0, 25, 3),
            "eyes and mouth": JointSine(-55, 20, 2),
        },
        "growl",
    ),
)
"""A looping motion with a sound for each mood, in the order of `THESIS_LABELS`."""

ACTIONS = (
    SineMotion("nod", 2.0, {"neck up": JointSine(0, 6, 2), "eyes and mouth": JointSine(50)}),
    SineMotion(
        "shake head", 2.0, {"neck sideways": JointSine(0, 7, 2), "eyes and mouth": JointSine(50)}
    ),
    SineMotion("wag tail", 2.0, {"tail sideways": JointSine(0, 30, 2), "tail up": JointSine(20)}),
    SineMotion(
        "bow",
        4.0,
        {
            "right shoulder": JointSine(18, 18, 1, -0.25),
            "left shoulder": JointSine(18, 18, 1, -0.25),
            "right elbow": JointSine(30, 30, 1, -0.25),
            "left elbow": JointSine(30, 30, 1, -0.25),
            "neck up": JointSine(-20, 20, 1, 0.25),
        },
    ),
    SineMotion(
        "kiss",
        2.4,
        {"neck up": JointSine(12, 8, 1, -0.25), "eyes and mouth": JointSine(-50, 30, 2, -0.25)},
    ),
    SineMotion(
        "shout",
        2.0,
        {
            "neck up": JointSine(-12, 10, 1, -0.25),
            "neck sideways": JointSine(0, 6, 2),
            "tail up": JointSine(40, 10, 2),
            "eyes and mouth": JointSine(-40, 20, 3, -0.25),
        },
    ),
)
"""Motions that play once; then the loop of the mood continues."""

SOUND_LENGTHS_S = {
    "breath": 2.0,
    "purr": 3.0,
    "growl": 1.5,
    "chirp": 0.5,
    "smack": 0.6,
    "roar": 1.8,
}
"""Length of every sound [s]."""

MOTIONS = MOOD_LOOPS + ACTIONS
"""Every motion, in the order of the catalogue."""

MIN_ANGLES_RAD = np.array([joint.low for joint in _LIMITS])
MAX_ANGLES_RAD = np.array([joint.high for joint in _LIMITS])
MAX_SPEEDS_RAD_PER_S = np.array([joint.speed for joint in _LIMITS])
"""Limits [rad] and top speeds [rad/s] of the joints, (joints,) each."""

CATALOGUE = Catalogue(
    name="Dino",
    firmware="simulator 1",
    joints=_LIMITS,
    motions=tuple(motion.name for motion in MOTIONS),
    sounds=tuple(SOUND_LENGTHS_S),
    moods=tuple(loop.name for loop in MOOD_LOOPS),
)
"""The catalogue that the simulated robot reports."""
