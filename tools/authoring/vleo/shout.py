"""Vleo's shouts: with the head, the legs too, or the whole body; sparks fly.

The three intensities have the same accents, so that they blend at equal phase.
"""

import numpy as np

from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import Array, delayed, keys, wave
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.vleo.clips import EffectFlight, animate_effects, tail
from tools.authoring.vleo.rig import BURSTS

DURATION_S = 2.0
"""Duration of the loop [s]."""
TREMBLES = 16
"""Vibrations of the head and the jaw in a loop: 8 Hz."""
TREMBLE_DEG = 4.0
"""How far the head vibrates up and down while it shouts [degrees]."""
StompPhases = tuple[float, float, float]
"""Phases at which a foot leaves the ground, is highest, and is back."""


def shout(level: int, bound: Skeleton) -> AnimationTracks:
    """Glower, draw back, and thrust the head out with the mouth wide open.

    Parameters
    ----------
    level : 0 head only, 1 head and legs, 2 whole body
    bound : the skeleton in its bind pose
    """
    anim = AnimationTracks(round(DURATION_S * FRAME_RATE_HZ))
    n = anim.frames
    breath = keys(n, (0.0, 0), (0.22, 1), (0.34, 0.1), (0.66, 0)) * 0.07
    anim.scales["belly"] = np.repeat(1 + breath[:, None], 3, axis=1)
    _thrust(anim, (1.0, 0.85, 0.75)[level])  # the body's lunge adds to it
    raging = keys(n, (0.27, 0), (0.34, 1), (0.68, 1), (0.79, 0), (0.97, 0))
    _rage(anim, raging)
    if level >= 1:
        _lunge(anim, rear=level == 2)
        _stomp(anim, rear=level == 2)
    if level == 2:
        _slam_and_whip(anim)
    else:
        stiff = keys(n, (0.0, 2), (0.22, 5 + 4 * level), (0.33, -3 - 2 * level), (0.6, 1)) * DEGREE
        tail(anim, stiff, (1 + 2 * level) * DEGREE * wave(n, 2), 1.2)
    _sparks(anim, level, bound)
    return anim


def _thrust(anim: AnimationTracks, big: float) -> None:
    """Draw the neck back, then thrust it forward and low with the face up."""
    n = anim.frames
    back, out = [(0.0, -10), (0.20, 22)], [(0.30, -40), (0.37, -31), (0.72, -33)]
    thrust = big * DEGREE * keys(n, *back, *out, (0.87, -8))
    anim.turn("neck1", up=thrust)
    anim.turn("neck2", up=0.5 * delayed(thrust, 0.01))
    anim.turn("neck3", up=0.1 * delayed(thrust, 0.02))
    chin = keys(n, (0.0, 12), (0.20, -22), (0.31, 78), (0.38, 66), (0.72, 70), (0.89, 8))
    anim.turn("head", up=DEGREE * chin)


def _rage(anim: AnimationTracks, raging: Array) -> None:
    """Open the mouth wide, shake the head while `raging` (0…1), and scowl all the time."""
    n = anim.frames
    shake = raging * wave(n, 8, 0.30)
    tremble = raging * wave(n, TREMBLES)
    anim.turn("head", left=12 * DEGREE * shake, tilt=7 * DEGREE * raging * wave(n, 8, 0.33))
    anim.turn("head", up=TREMBLE_DEG * DEGREE * tremble)
    anim.turn("chest", up=-0.25 * TREMBLE_DEG * DEGREE * delayed(tremble, 0.01))
    anim.turn("neck2", left=-5 * DEGREE * delayed(shake, 0.01))
    roar = [(0.0, 0.0), (0.21, 0.0), (0.30, 1.1), (0.37, 0.92), (0.71, 1.0), (0.82, 0.0)]
    anim.show("aa", keys(n, *roar) + 0.16 * tremble)
    anim.show("angry", keys(n, (0.0, 0.8), (0.22, 1.0), (0.34, 1.0), (0.80, 0.8)))


def _lunge(anim: AnimationTracks, rear: bool) -> None:
    """Draw back (at full intensity rear up) and lunge; each stomp jolts the body."""
    n = anim.frames
    brace, lunge = [(0.0, -5), (0.20, 2 + 4 * rear)], [(0.30, -13), (0.36, -7), (0.44, -4)]
    jolts = [(0.485, -12), (0.54, -5), (0.585, -4), (0.625, -11), (0.68, -5), (0.725, -4)]
    anim.move("hips", y=keys(n, *brace, *lunge, *jolts, (0.765, -11), (0.86, -6)) / 1000)
    back = -0.016 - 0.006 * rear
    anim.move("hips", z=keys(n, (0.0, 0), (0.20, back), (0.31, 0.016), (0.72, 0.014), (0.92, 0)))
    up, down = [(0.0, -3), (0.20, 7 + 10 * rear)], [(0.30, -7), (0.40, -4), (0.74, -5)]
    pitch = DEGREE * keys(n, *up, *down, (0.90, -3))
    anim.turn("hips", up=pitch)
    anim.turn("chest", up=0.3 * delayed(pitch, 0.01))


def _stomp(anim: AnimationTracks, rear: bool) -> None:
    """Stomp alternately, at full intensity with both feet first, leaning to the standing one."""
    first: StompPhases = (0.06, 0.19, 0.30)
    left: list[StompPhases] = [(0.38, 0.435, 0.485), (0.66, 0.715, 0.765)]
    right: list[StompPhases] = [first, (0.53, 0.58, 0.625)]
    lean = np.zeros(anim.frames)
    for foot, side, times in (
        ("LeftFrontFoot", 1.0, [first, *left] if rear else left),
        ("RightFrontFoot", -1.0, right),
    ):
        raised = np.sum([_raised(anim.frames, stomp) for stomp in times], axis=0)
        anim.step(foot, y=(0.034 + 0.016 * rear) * raised, z=0.016 * raised, toes=0.2 * raised)
        lean = lean - side * raised
    anim.move("hips", x=0.005 * lean)
    anim.turn("hips", tilt=-2.5 * DEGREE * lean)


def _raised(frames: int, stomp: StompPhases) -> Array:
    """Return the height of a foot, 0…1: slow up, hold, slam; the first stomp is the highest."""
    start, top, down = stomp
    high = 1.0 if start < 0.1 else 0.75
    hold = 0.5 * (top + down) + 0.01
    return high * keys(frames, (start, 0), (top, 1), (hold, 0.9), (down, 0), (0.99, 0))


def _slam_and_whip(anim: AnimationTracks) -> None:
    """Slam the tail down twice, and whip it from side to side otherwise."""
    n = anim.frames
    lift, slam = [(0.0, 9), (0.21, 32)], [(0.31, -13), (0.40, 24), (0.53, 22), (0.625, -12)]
    up = keys(n, *lift, *slam, (0.71, 20), (0.80, 16))
    still, whip = [(0.0, 0), (0.10, -7), (0.21, 4), (0.31, 0)], [(0.40, 21), (0.49, -23)]
    left = keys(n, *still, *whip, (0.59, 14), (0.70, -18), (0.80, 14), (0.90, -8))
    tail(anim, DEGREE * up, DEGREE * left, 1.1, 0.55)


def _sparks(anim: AnimationTracks, level: int, bound: Skeleton) -> None:
    """Burst two small sparks out of the mouth, three, or three large ones."""
    size, spread = (0.80, 1.15, 1.6)[level], (0.75, 1.0, 1.4)[level]
    third = 0.9 * size if level else 0.0
    up, side, ahead = spread * np.array([0.055, 0.090, 0.060])
    flights = [
        EffectFlight(0.30, 0.26, (0.010, 0.3 * up, 1.7 * ahead), size, spin=1.2),
        EffectFlight(0.42, 0.26, (side, up, 0.85 * ahead), 0.8 * size, spin=-1.2),
        EffectFlight(0.55, 0.26, (-side, 1.1 * up, 0.85 * ahead), third, spin=1.2),
    ]
    animate_effects(anim, BURSTS, flights, bound)
