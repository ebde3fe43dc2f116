"""Vleo's idle clip: breathe, sway, look around, and wonder."""

from tools.authoring.modelling.curves import keys, spring_follow, wave
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.vleo.clips import breathe, tail

DURATION_S = 7.0


def idle() -> AnimationTracks:
    """Breathe, sway, look around, and wonder."""
    anim = AnimationTracks(round(DURATION_S * FRAME_RATE_HZ))
    n, seconds = anim.frames, DURATION_S
    breathe(anim, 3)
    shift = keys(n, (0.05, 1), (0.36, 1), (0.52, -1), (0.86, -1)) * 0.005
    anim.move("hips", x=shift, y=-0.0015 + 0.0015 * wave(n, 6))
    anim.turn("hips", up=1.5 * DEGREE * wave(n, 1, 0.1), tilt=-5 * shift, left=6 * shift)
    # Overlapping action of the gaze: eyes first, then head, then neck.
    look = keys(n, (0.02, 0), (0.10, 17), (0.26, 14), (0.33, -15), (0.50, -17), (0.56, 0)) * DEGREE
    wonder = keys(n, (0.54, 0), (0.62, 1), (0.82, 1), (0.90, 0))
    nod = keys(n, (0, 0), (0.10, 4), (0.30, -5), (0.46, 3), (0.62, 8), (0.82, 6)) * DEGREE
    neck = spring_follow(look, seconds, 0.9, 0.7)
    for joint, share in (("neck1", 0.35), ("neck2", 0.35), ("neck3", 0.3)):
        anim.turn(joint, up=0.3 * spring_follow(nod, seconds, 1.0, 0.7), left=share * neck)
    anim.turn("neck2", tilt=5 * DEGREE * wonder)
    anim.turn("head", up=10 * DEGREE + nod, left=0.6 * spring_follow(look, seconds, 1.5, 0.7))
    anim.turn("head", tilt=17 * DEGREE * spring_follow(wonder, seconds, 1.6, 0.45))
    for eye in ("LeftEye", "RightEye"):
        anim.turn(eye, left=0.9 * (look - neck), up=4 * DEGREE * wonder)
    anim.show("happy", keys(n, (0, 0.2), (0.2, 0.1), (0.4, 0.25), (0.62, 0.0), (0.84, 0.35)))
    anim.show("surprised", 0.12 * wonder)
    anim.show("ou", 0.3 * wonder)
    tail(anim, 3 * DEGREE * wave(n, 4, 0.1) + 4 * DEGREE, 6.5 * DEGREE * wave(n, 3), 1.5)
    return anim
