"""The robot's happy clips: beam and nod, dance, and hop with a wagging tail."""

from tools.authoring.modelling.curves import Array, delayed, keys, wave
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.robot.motion import face_ahead, keys_deg, neck, stomp_curve, tail
from tools.authoring.robot.rig import FEET, set_lamps, set_lids, set_mouth

DURATION_S = 2.0
"""Duration of the dance: two beats [s]."""


def happy(level: int) -> AnimationTracks:
    """Beam, with the raised head tilted from side to side.

    Parameters
    ----------
    level : 0 head only, 1 head and legs, 2 whole body; all levels have the same accents, so that
        they blend at equal phase
    """
    anim = AnimationTracks(round(DURATION_S * FRAME_RATE_HZ))
    n = anim.frames
    set_lamps(anim, "happy")
    _beam(anim, level)
    if level == 1:
        _dance(anim)
    if level == 2:
        _hop(anim)
    high, wide = ((8, 7), (14, 12), (16, 30))[level]
    beat = keys(n, (0.05, 0.85), (0.20, 1.1), (0.30, 0.9), (0.55, 0.85), (0.70, 1.1), (0.80, 0.9))
    tail(anim, high * DEGREE * beat, wide * DEGREE * wave(n, 4, 0.02), 1.15, 0.55)
    face_ahead(anim, keys_deg(n, (0.08, -5), (0.23, 8), (0.40, 1), (0.58, -5), (0.73, 8), (0.9, 1)))
    return anim


def _beam(anim: AnimationTracks, level: int) -> None:
    """Hold the head high, nod on the beat, tilt it from side to side, and laugh."""
    n = anim.frames
    side = keys(n, (0.02, 1), (0.38, 1), (0.52, -1), (0.88, -1))
    # Anticipation: a dip before every toss of the head.
    toss = keys_deg(n, (0.06, -6), (0.20, 15), (0.36, 8), (0.56, -6), (0.70, 15), (0.86, 8))
    neck(anim, toss + 8 * DEGREE, 7 * DEGREE * side)
    anim.turn("head", left=5 * DEGREE * side)
    anim.turn("head", tilt=(15, 13, 11)[level] * DEGREE * delayed(side, 0.02))
    laugh = keys(
        n, (0.06, 0.55), (0.20, 1.0), (0.36, 0.70), (0.56, 0.55), (0.70, 1.0), (0.86, 0.70)
    )
    set_mouth(anim, (0.75, 0.82, 0.90)[level] * laugh, 1.0)
    squint = keys(
        n, (0.06, 0.80), (0.22, 1.05), (0.40, 0.85), (0.56, 0.80), (0.72, 1.05), (0.9, 0.85)
    )
    set_lids(anim, 0.0, squint, 0.0)


def _dance(anim: AnimationTracks) -> None:
    """Step from one front foot to the other and bounce on the beat."""
    n = anim.frames
    bounce = keys(n, (0.06, -9), (0.20, 5), (0.36, -3), (0.56, -9), (0.70, 5), (0.86, -3)) / 1000
    anim.move("hips", y=bounce)
    anim.turn("hips", up=5 * DEGREE + keys_deg(n, (0.06, -3), (0.20, 4), (0.56, -3), (0.70, 4)))
    left, right = stomp_curve(n, 0.08, 0.20, 0.34), stomp_curve(n, 0.58, 0.70, 0.84)
    _lift(anim, "Left", left, 0.030)
    _lift(anim, "Right", right, 0.030)
    lean = left - right
    anim.move("hips", x=-0.007 * lean)
    anim.turn("hips", tilt=3.5 * DEGREE * lean, left=-4 * DEGREE * lean)
    anim.turn("chest", left=-3 * DEGREE * delayed(lean, 0.02))


def _hop(anim: AnimationTracks) -> None:
    """Crouch, leap with all four feet rearing up, and land softly."""
    n = anim.frames
    squat = keys(
        n,
        (0.06, -13), (0.20, 15), (0.33, -11), (0.43, -2), (0.56, -13), (0.70, 15), (0.83, -11),
        (0.93, -2),
    )  # fmt: skip
    air = keys(n, (0.11, 0), (0.21, 1), (0.295, 0), (0.61, 0), (0.71, 1), (0.795, 0))
    anim.move("hips", y=squat / 1000)
    rear = keys_deg(n, (0.06, -4), (0.20, 10), (0.34, 2), (0.56, -4), (0.70, 10), (0.84, 2))
    anim.turn("hips", up=3 * DEGREE + rear)
    anim.turn("chest", up=0.25 * delayed(rear, 0.02))
    sway = keys(n, (0.06, 0), (0.20, 1), (0.36, 0), (0.56, 0), (0.70, -1), (0.86, 0))
    anim.turn("hips", left=6 * DEGREE * sway, tilt=3 * DEGREE * sway)
    for foot in FEET:
        front = "Front" in foot
        up, ahead, toes = (0.042, 0.014, 0.35) if front else (0.016, -0.006, -0.30)
        anim.step(foot, y=up * air, z=ahead * air, toes=toes * air)


def _lift(anim: AnimationTracks, side: str, up: Array, high: float) -> None:
    """Raise a front foot, its toes up."""
    anim.step(f"{side}FrontFoot", y=high * up, z=0.014 * up, toes=0.35 * up)
