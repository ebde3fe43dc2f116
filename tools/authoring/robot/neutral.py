"""The robot's neutral clips: look around, blink, shift the weight, and sway the tail."""

from tools.authoring.modelling.curves import keys, spring_follow, wave
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.robot.motion import blink, keys_deg, neck, tail, turn_eyes
from tools.authoring.robot.rig import set_lamps, set_lids, set_mouth


def neutral(level: int, seconds: float = 4.8, taps: bool = True) -> AnimationTracks:
    """Look about, blink, and wait.

    Parameters
    ----------
    level : 0 head only, 1 head and legs, 2 whole body
    seconds : duration of the loop [s]
    taps : whether a front foot taps twice, with the legs and the whole body
    """
    anim = AnimationTracks(round(seconds * FRAME_RATE_HZ))
    n = anim.frames
    set_lamps(anim, "neutral")
    # Overlapping action of the gaze: eyes first, then head, then neck.
    wide = (1.0, 1.3, 1.6)[level]
    aside = wide * keys_deg(
        n, (0.03, 0), (0.10, 17), (0.36, 15), (0.45, -15), (0.72, -17), (0.82, 0)
    )
    turned = spring_follow(aside, seconds, 1.1, 0.75)
    nod = keys_deg(n, (0.0, 0), (0.14, 4), (0.34, -3), (0.52, 4), (0.74, 2), (0.9, -1))
    neck(anim, 0.6 * spring_follow(nod, seconds, 1.0, 0.7) + 2 * DEGREE, 0.9 * turned)
    anim.turn("head", up=nod, left=0.55 * spring_follow(aside, seconds, 1.6, 0.7))
    anim.turn("head", tilt=keys_deg(n, (0.12, 0), (0.22, 7), (0.38, 7), (0.50, 0), (0.9, 0)))
    turn_eyes(anim, 0.8 * (aside - turned))
    set_lids(anim, blink(n, 0.43), 0.12)
    set_mouth(anim, keys(n, (0.1, 0.0), (0.2, 0.05), (0.4, 0.0)), 0.22)
    if level >= 1:
        shift = keys(n, (0.05, 1), (0.30, 1), (0.45, -1), (0.88, -1)) * 0.010
        anim.move("hips", x=shift, y=-0.004 + 0.003 * wave(n, 4))
        anim.turn("hips", tilt=-4 * shift, left=5 * shift, up=2.5 * DEGREE * wave(n, 2, 0.1))
        anim.turn("chest", left=4 * shift, up=-1.5 * DEGREE * wave(n, 2, 0.16))
    if level >= 1 and taps:  # while the weight is on the other side
        tap = keys(n, (0.58, 0), (0.63, 1), (0.67, 0), (0.70, 0), (0.74, 0.7), (0.78, 0))
        anim.step("LeftFrontFoot", y=0.020 * tap, z=0.010 * tap, toes=0.3 * tap)
    swing = (5.0, 11.0, 18.0)[level] * DEGREE
    lift = (2.0, 5.0, 10.0)[level] * DEGREE
    tail(anim, lift + 0.3 * lift * wave(n, 4, 0.1), swing * wave(n, 2), 1.3)
    return anim
