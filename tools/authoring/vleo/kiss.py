"""Vleo's kisses: with the head, the legs too, or the whole body; hearts fly.

The three intensities have the same accents, so that they blend at equal phase.
"""

import numpy as np

from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import Array, delayed, keys, spring_follow, wave
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.vleo.clips import EffectFlight, animate_effects, breathe, tail
from tools.authoring.vleo.rig import FEET, HEARTS

DURATION_S = 2.4
"""Duration of the loop [s]."""


def kiss(level: int, bound: Skeleton) -> AnimationTracks:
    """Draw back, pucker, and throw a kiss that turns into hearts.

    Parameters
    ----------
    level : 0 head only, 1 head and legs, 2 whole body
    bound : the skeleton in its bind pose
    """
    anim = AnimationTracks(round(DURATION_S * FRAME_RATE_HZ))
    breathe(anim, 1)
    throw = _throw(anim, (1.0, 1.05, 1.15)[level])
    _pucker(anim)
    if level == 1:
        _rise(anim)
    if level == 2:
        _jump(anim)
        _wag(anim)
    else:
        bob = 0.12 * spring_follow(throw, DURATION_S, 2.0, 0.5) * (1 + level)
        sway = (3 + 3 * level) * DEGREE * wave(anim.frames, 1)
        tail(anim, 4 * DEGREE - bob, sway, 1.4)
    _hearts(anim, level, bound)
    return anim


def _throw(anim: AnimationTracks, big: float) -> Array:
    """Draw the head back, thrust it forward with the chin up; return the neck's pitch [rad]."""
    n = anim.frames
    back, thrust = [(0.05, 0), (0.29, 23), (0.345, 26)], [(0.44, -26), (0.51, -19), (0.59, -20)]
    throw = big * DEGREE * keys(n, *back, *thrust, (0.74, 5), (0.84, -2), (0.93, 0))
    anim.turn("neck1", up=throw)
    anim.turn("neck2", up=0.6 * delayed(throw, 0.014))
    anim.turn("neck3", up=0.3 * delayed(throw, 0.028))
    drawn, out = [(0.05, 8), (0.29, -15), (0.345, -18)], [(0.455, 56), (0.53, 43), (0.60, 42)]
    chin = keys(n, *drawn, *out, (0.76, 4), (0.86, 13), (0.95, 8))
    lean = keys(n, (0.06, 0), (0.30, -10), (0.45, 19), (0.61, 16), (0.78, -7), (0.90, 0)) * DEGREE
    anim.turn("head", up=big * DEGREE * chin, tilt=lean)
    anim.turn("neck2", tilt=0.4 * delayed(lean, 0.03))
    return throw


def _pucker(anim: AnimationTracks) -> None:
    """Close the eyes, pucker the lips, then smile."""
    n = anim.frames
    anim.show("blink", keys(n, (0.30, 0), (0.355, 1), (0.595, 1), (0.63, 0)))
    lips = [(0.08, 0), (0.25, 0.85), (0.38, 1.0), (0.45, 1.4), (0.50, 1.15), (0.545, 1.2)]
    anim.show("ou", np.maximum(keys(n, *lips, (0.60, 0), (0.98, 0)), 0))
    anim.show(
        "happy", keys(n, (0.0, 0.3), (0.08, 0.3), (0.22, 0), (0.55, 0), (0.63, 1), (0.80, 0.9))
    )


def _crouch(anim: AnimationTracks, rear: float) -> None:
    """Sink back on the hind legs, then push up and forward, the nose up by `rear` [degrees]."""
    n = anim.frames
    anim.move("hips", z=keys(n, (0.10, 0), (0.31, -0.014), (0.45, 0.010), (0.60, 0.006), (0.84, 0)))
    pitch = keys(n, (0.12, 0), (0.31, -8), (0.45, rear), (0.58, 6), (0.82, 0)) * DEGREE
    anim.turn("hips", up=pitch)
    anim.turn("spine2", up=0.4 * delayed(pitch, 0.015))
    anim.turn("chest", up=0.3 * delayed(pitch, 0.03))


def _rise(anim: AnimationTracks) -> None:
    """Crouch, rise on the forelegs with one paw up, and bounce a little."""
    n = anim.frames
    _crouch(anim, 9)
    rise = [(0.12, 0), (0.31, -13), (0.44, 7), (0.52, 3), (0.60, -4), (0.68, 2), (0.80, 0)]
    anim.move("hips", y=keys(n, *rise) / 1000)
    anim.move("hips", x=keys(n, (0.25, 0), (0.45, -0.006), (0.62, -0.005), (0.78, 0)))
    paw = keys(n, (0.33, 0), (0.45, 1), (0.60, 0.9), (0.71, 0), (0.97, 0))
    anim.step("LeftFrontFoot", y=0.036 * paw, z=0.020 * paw, toes=-30 * DEGREE * paw)


def _jump(anim: AnimationTracks) -> None:
    """Crouch deep, jump for joy with the forelegs high, land, and hop once more."""
    n = anim.frames
    _crouch(anim, 16)
    jump = [(0.10, 0), (0.31, -20), (0.37, -4), (0.46, 42), (0.55, -8), (0.59, -14)]
    again = [(0.66, -4), (0.74, 16), (0.82, -9), (0.90, 2)]
    anim.move("hips", y=keys(n, *jump, *again) / 1000)
    for foot in FEET:
        front = "Front" in foot
        top = 0.058 if front else 0.026
        hop = [(0.68, 0), (0.745, 0.014), (0.81, 0), (0.99, 0)]
        leaves = 0.325 if front else 0.37  # the forelegs rear up before the hind legs push off
        up = keys(n, (leaves, 0), (0.46, top), (0.55, 0), *hop)
        anim.step(foot, y=up, z=(0.4 if front else -0.3) * up, toes=(-12 if front else -9) * up)


def _wag(anim: AnimationTracks) -> None:
    """Wag the tail so strongly that the body moves with it."""
    n = anim.frames
    lift = keys(n, (0.0, 14), (0.31, 4), (0.47, 20), (0.8, 15)) * DEGREE
    tail(anim, lift, 18 * DEGREE * wave(n, 5), 1.9, 0.8)
    wiggle = wave(n, 5, -0.03)
    anim.turn("hips", left=7 * DEGREE * wiggle, tilt=3 * DEGREE * wiggle)
    anim.turn("chest", left=-5 * DEGREE * wiggle, tilt=-3 * DEGREE * wiggle)
    anim.move("hips", x=-0.005 * wiggle)


def _hearts(anim: AnimationTracks, level: int, bound: Skeleton) -> None:
    """Send two small hearts, three, or three large ones, each facing where it flies."""
    size, spread = (0.80, 1.0, 1.25)[level], (0.75, 1.0, 1.4)[level]
    third = 0.9 * size if level else 0.0
    up, side, ahead = spread * np.array([0.100, 0.072, 0.060])
    flights = [  # past the face, so as not to cover it
        EffectFlight(0.45, 0.46, (1.55 * side, 1.20 * up, 0.9 * ahead), size, 0.010, 0.15, 0.5),
        EffectFlight(
            0.51, 0.42, (-1.35 * side, 0.90 * up, 0.9 * ahead), 0.8 * size, -0.008, -0.2, -0.5
        ),
        EffectFlight(0.57, 0.40, (1.75 * side, 0.55 * up, 0.8 * ahead), third, 0.008, 0.3, 0.5),
    ]
    animate_effects(anim, HEARTS, flights, bound)
