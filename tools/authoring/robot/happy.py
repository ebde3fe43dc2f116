"""The robot is happy: it beams and nods, dances on its feet, and hops while its tail wags."""

import numpy as np

from tools.authoring.modelling.curves import Array, keys, later, wave
from tools.authoring.modelling.quadruped import DEGREE, RATE, Performance
from tools.authoring.robot.motion import degrees, face_ahead, neck, raised, tail
from tools.authoring.robot.rig import FEET, lids, light, mouth

SECONDS = 2.0
"""Duration of the dance: two beats [s]."""


def happy(level: int) -> Performance:
    """Beam, with the head high and to one side and then to the other.

    Parameters
    ----------
    level : 0 with the head alone, 1 with the legs too, 2 with all of it; the three share every
        accent, so that they blend at equal phase
    """
    act = Performance(round(SECONDS * RATE))
    n = act.frames
    light(act, "happy")
    _beam(act, level)
    if level == 1:
        _dance(act)
    if level == 2:
        _hop(act)
    high, wide = ((8, 7), (14, 12), (16, 30))[level]
    beat = keys(n, (0.05, 0.85), (0.20, 1.1), (0.30, 0.9), (0.55, 0.85), (0.70, 1.1), (0.80, 0.9))
    tail(act, high * DEGREE * beat, wide * DEGREE * wave(n, 4, 0.02), 1.15, 0.55)
    face_ahead(act, degrees(n, (0.08, -5), (0.23, 8), (0.40, 1), (0.58, -5), (0.73, 8), (0.9, 1)))
    return act


def _beam(act: Performance, level: int) -> None:
    """Hold the head high, nod on the beat, tilt it from side to side, and laugh."""
    n = act.frames
    side = keys(n, (0.02, 1), (0.38, 1), (0.52, -1), (0.88, -1))
    # A dip before every toss of the head.
    toss = degrees(n, (0.06, -6), (0.20, 15), (0.36, 8), (0.56, -6), (0.70, 15), (0.86, 8))
    neck(act, toss + 8 * DEGREE, 7 * DEGREE * side)
    act.turn("head", left=5 * DEGREE * side)
    act.turn("head", tilt=(15, 13, 11)[level] * DEGREE * later(side, 0.02))
    laugh = keys(
        n, (0.06, 0.55), (0.20, 1.0), (0.36, 0.70), (0.56, 0.55), (0.70, 1.0), (0.86, 0.70)
    )
    mouth(act, (0.75, 0.82, 0.90)[level] * laugh, 1.0)
    squint = keys(
        n, (0.06, 0.80), (0.22, 1.05), (0.40, 0.85), (0.56, 0.80), (0.72, 1.05), (0.9, 0.85)
    )
    lids(act, 0.0, squint, 0.0)


def _dance(act: Performance) -> None:
    """Step from one front foot to the other and bounce on the beat."""
    n = act.frames
    bounce = keys(n, (0.06, -9), (0.20, 5), (0.36, -3), (0.56, -9), (0.70, 5), (0.86, -3)) / 1000
    act.move("hips", y=bounce)
    act.turn("hips", up=5 * DEGREE + degrees(n, (0.06, -3), (0.20, 4), (0.56, -3), (0.70, 4)))
    left, right = raised(n, 0.08, 0.20, 0.34), raised(n, 0.58, 0.70, 0.84)
    _lift(act, "Left", left, 0.030)
    _lift(act, "Right", right, 0.030)
    lean = left - right
    act.move("hips", x=-0.007 * lean)
    act.turn("hips", tilt=3.5 * DEGREE * lean, left=-4 * DEGREE * lean)
    act.turn("chest", left=-3 * DEGREE * later(lean, 0.02))


def _hop(act: Performance) -> None:
    """Crouch, leap off all four feet, land softly; rear up and wave a foot on the way."""
    n = act.frames
    squat = keys(
        n,
        (0.06, -13),
        (0.20, 15),
        (0.33, -11),
        (0.43, -2),
        (0.56, -13),
        (0.70, 15),
        (0.83, -11),
        (0.93, -2),
    )
    air = keys(n, (0.11, 0), (0.21, 1), (0.295, 0), (0.61, 0), (0.71, 1), (0.795, 0))
    act.move("hips", y=squat / 1000)
    rear = degrees(n, (0.06, -4), (0.20, 10), (0.34, 2), (0.56, -4), (0.70, 10), (0.84, 2))
    act.turn("hips", up=3 * DEGREE + rear)
    act.turn("chest", up=0.25 * later(rear, 0.02))
    sway = keys(n, (0.06, 0), (0.20, 1), (0.36, 0), (0.56, 0), (0.70, -1), (0.86, 0))
    act.turn("hips", left=6 * DEGREE * sway, tilt=3 * DEGREE * sway)
    for foot in FEET:
        front = "Front" in foot
        act.step(foot, y=(0.042 if front else 0.016) * air, z=(0.014 if front else -0.006) * air)
        act.step(foot, toes=(0.35 if front else -0.30) * np.asarray(air))


def _lift(act: Performance, side: str, up: Array, high: float) -> None:
    """Raise a front foot, its toes up."""
    act.step(f"{side}FrontFoot", y=high * up, z=0.014 * up, toes=0.35 * up)
