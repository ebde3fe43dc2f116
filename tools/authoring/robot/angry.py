"""The robot's angry clips: glare, snap and stomp; at full intensity rear up and whip the tail."""

from tools.authoring.modelling.curves import delayed, keys, wave
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.robot.motion import face_ahead, keys_deg, neck, stomp_curve, tail
from tools.authoring.robot.rig import set_lamps, set_lids, set_mouth

DURATION_S = 2.0
"""Duration of the loop [s]."""


def angry(level: int) -> AnimationTracks:
    """Glower from below, draw back, snap, and shake the head.

    Parameters
    ----------
    level : 0 head only, 1 head and legs, 2 whole body; all levels have the same accents, so that
        they blend at equal phase
    """
    anim = AnimationTracks(round(DURATION_S * FRAME_RATE_HZ))
    n = anim.frames
    set_lamps(anim, "angry")
    _glower(anim, level)
    if level >= 1:
        _stalk(anim, rear=level == 2)
    if level == 2:
        _whip(anim)
    else:
        stiff = keys_deg(n, (0.0, -4), (0.20, 2 + 6 * level), (0.31, -9), (0.50, -5))
        tail(anim, stiff, (2 + 5 * level) * DEGREE * wave(n, 4), 1.2, 0.6)
    # The chin is drawn in before the snap and thrust out with it.
    face_ahead(anim, keys_deg(n, (0.0, -8), (0.20, -14), (0.30, 6), (0.40, -4), (0.74, -8)))
    return anim


def _glower(anim: AnimationTracks, level: int) -> None:
    """Keep the head low and face ahead; snap, then shake the head with an open jaw."""
    n = anim.frames
    big = (1.0, 0.95, 0.9)[level]  # the body's lunge adds to it
    bend = keys_deg(n, (0.0, -26), (0.20, -6 * big), (0.30, -40 * big), (0.38, -33), (0.74, -30))
    neck(anim, bend)
    raging = keys(n, (0.34, 0), (0.42, 1), (0.66, 1), (0.78, 0), (0.97, 0))
    shake = raging * wave(n, 6, 0.34)
    neck(anim, 0 * shake, 9 * DEGREE * delayed(shake, 0.01))
    anim.turn("head", left=12 * DEGREE * shake, tilt=5 * DEGREE * raging * wave(n, 6, 0.37))
    snap = keys(
        n,
        (0.0, 0.0), (0.20, 0.12), (0.285, 1.0), (0.35, 0.22), (0.44, 0.30), (0.66, 0.26),
        (0.80, 0.0),
    )  # fmt: skip
    set_mouth(anim, (0.75, 0.85, 1.0)[level] * snap, -1.0)
    set_lids(anim, 0.0, 0.30, keys(n, (0.0, 0.95), (0.22, 1.12), (0.36, 1.0), (0.80, 0.95)))


def _stalk(anim: AnimationTracks, rear: bool) -> None:
    """Crouch, draw back (at full intensity rear up), lunge, and stomp alternately."""
    n = anim.frames
    anim.move(
        "hips",
        y=keys(
            n,
            (0.0, -5),
            (0.20, 1 + 5 * rear),
            (0.30, -12),
            (0.40, -6),
            (0.52, -11),
            (0.58, -5),
            (0.70, -11),
            (0.78, -5),
        )
        / 1000,
        z=keys(
            n,
            (0.0, -0.002),
            (0.20, -0.015 - 0.007 * rear),
            (0.30, 0.019),
            (0.74, 0.012),
            (0.92, -0.002),
        ),
    )
    pitch = keys_deg(n, (0.0, -6), (0.20, 3 + 14 * rear), (0.30, -10), (0.42, -6), (0.76, -6))
    anim.turn("hips", up=pitch)
    anim.turn("chest", up=0.3 * delayed(pitch, 0.01))
    first = (0.06, 0.20, 0.30)
    both = [first, (0.60, 0.645, 0.70)] if rear else [(0.60, 0.645, 0.70)]
    lean = 0.0 * pitch
    for side, sign, times in (("Left", 1.0, both), ("Right", -1.0, [first, (0.42, 0.47, 0.52)])):
        up = sum((stomp_curve(n, *each) for each in times), start=0.0 * pitch)
        high = 0.034 + 0.014 * rear
        anim.step(f"{side}FrontFoot", y=high * up, z=0.016 * up, toes=0.25 * up)
        lean = lean + sign * up
    anim.move("hips", x=-0.005 * lean)
    anim.turn("hips", tilt=2.5 * DEGREE * lean)


def _whip(anim: AnimationTracks) -> None:
    """Raise the tail like a scorpion, slam it down with the snap, and lash from side to side."""
    n = anim.frames
    up = keys_deg(n, (0.0, 14), (0.20, 36), (0.30, -8), (0.42, 30), (0.74, 26), (0.88, 14))
    left = keys_deg(
        n,
        (0.0, 0), (0.10, -6), (0.30, 0), (0.42, 26), (0.53, -28), (0.64, 26), (0.75, -24),
        (0.87, 9),
    )  # fmt: skip
    tail(anim, up, left, 1.1, 0.5)
