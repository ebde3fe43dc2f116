"""The bundled explorer's idle clip: weight shifts, glances, hands to the straps."""

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.acting import ActingCurves, clip_from_acting
from tools.authoring.human.limbs import HandTarget
from tools.authoring.modelling.shapes import Array

DURATION_S = 9.0
FRAME_RATE_HZ = 30.0
BREATHS_PER_LOOP = 3
STRAP_GRIP_M = np.array([0.212, 1.0, 0.138])
"""Position of the left wrist when the hand holds its strap, in the rest pose [m]."""


def idle(skeleton: Skeleton) -> Clip:
    """Return a loop of nine seconds on planted feet; blinks are added at run time."""
    time = np.arange(round(DURATION_S * FRAME_RATE_HZ) + 1) / FRAME_RATE_HZ
    turn = 2 * np.pi * time / DURATION_S
    left, right = eased_pulse(time, 2.1, 3.6, 0.3), eased_pulse(time, 5.6, 7.0, 0.26)
    up, strapped = eased_pulse(time, 5.75, 6.9, 0.4), eased_pulse(time, 4.6, 7.3, 0.75)
    slow = [sign * np.sin(2 * turn) for sign in (1.0, -1.0)]
    grip = HandTarget(
        STRAP_GRIP_M,
        fingers=np.array([-0.85, 0.5, -0.2]),
        thumb=np.array([0.4, 0.85, 0.0]),
        elbow=np.array([0.9, -0.6, -0.25]),
        share=strapped,
    )
    score = ActingCurves(
        weight=idle_weight(turn),
        look=(26 * left - 21 * right + 2.5 * np.sin(turn + 0.7), 4 * left - 8 * up),
        tilt=4 * left - 3 * right,
        breath=np.sin(BREATHS_PER_LOOP * turn),
        swing=(3 + 2 * slow[0], 3 + 2 * slow[1]),
        bend=(19 + 4 * slow[0], 19 + 4 * slow[1]),
        fist=(18 + 5 * slow[0] + 34 * strapped, 18 + 5 * slow[1] + 34 * strapped),
        hands={"Left": grip, "Right": grip},
        mood={
            "happy": 0.06
            + 0.20 * eased_pulse(time, 2.5, 4.2, 0.5)
            + 0.26 * eased_pulse(time, 6.0, 8.0, 0.6),
            "surprised": 0.10 * up,
        },
    )
    return clip_from_acting("idle", skeleton, DURATION_S, score, loop=True, rate=FRAME_RATE_HZ)


def idle_weight(turn: Array) -> Array:
    """Return the weight shift at angles of the loop [rad], −1 right … 1 left."""
    return np.asarray(np.tanh(2.2 * np.sin(turn - 0.5)) / np.tanh(2.2))


def eased_pulse(time: Array, begin: float, end: float, ramp: float) -> Array:
    """Return a pulse of height 1 between two times [s], with eased ramps and some overshoot."""
    rise, fall = (np.clip((time - t) / ramp, 0.0, 1.0) for t in (begin, end))
    held = _soft(rise) - _soft(fall)
    settle = np.exp(-3.5 * np.clip(time - begin - ramp, 0.0, None))
    return np.asarray(held * (1 + 0.1 * settle * np.sin(np.pi * rise)))


def _soft(u: Array) -> Array:
    return np.asarray(u**3 * (u * (6 * u - 15) + 10))
