"""Vleo's yes and no: short clips that begin and end in the idle pose."""

from dataclasses import replace

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import Array, delayed, keys, spring_follow
from tools.authoring.modelling.quadruped import DEGREE, FRAME_RATE_HZ, AnimationTracks
from tools.authoring.vleo.clips import clip, tail

HEAD_PITCH_DEG = 8.0
"""Pitch of the head at the start and end of a gesture [degrees]."""


def gestures(bound: Skeleton) -> list[Clip]:
    """Return all gestures; they play once."""
    made = (clip("nod", _nod(), bound), clip("shake", _shake(), bound))
    return [replace(each, loop=False) for each in made]


def _nod() -> AnimationTracks:
    """Raise the head, then nod twice, less the second time."""
    anim = AnimationTracks(round(1.6 * FRAME_RATE_HZ))
    n, seconds = anim.frames, 1.6
    down = keys(
        n, (0, 0), (0.11, -10), (0.27, 20), (0.42, -7), (0.56, 13), (0.72, -3), (0.86, 1), (0.97, 0)
    )
    dip = down * DEGREE
    _neck(anim, -0.55 * dip, 0.0 * dip)
    anim.turn("head", up=HEAD_PITCH_DEG * DEGREE - 0.9 * delayed(dip, 0.02))
    anim.move("hips", y=-0.00022 * spring_follow(down, seconds, 2.6, 0.6))
    anim.turn("hips", up=-0.10 * spring_follow(dip, seconds, 2.4, 0.6))
    anim.show("happy", keys(n, (0, 0.2), (0.2, 0.85), (0.70, 0.8), (0.97, 0.2)))
    tail(anim, 4 * DEGREE + 0.35 * spring_follow(dip, seconds, 2.2, 0.5), 0.0 * dip, 1.5)
    return anim


def _shake() -> AnimationTracks:
    """Turn the head to and fro, decreasingly, with the tail in the opposite direction."""
    anim = AnimationTracks(round(1.9 * FRAME_RATE_HZ))
    n, seconds = anim.frames, 1.9
    aside = keys(
        n,
        (0, 0), (0.08, -7), (0.23, 30), (0.38, -28), (0.52, 20), (0.66, -12), (0.78, 4),
        (0.94, 0),
    )  # fmt: skip
    turn = aside * DEGREE
    _neck(anim, 0.0 * turn, 0.45 * turn)
    late = delayed(turn, 0.022)
    anim.turn("head", up=HEAD_PITCH_DEG * DEGREE, left=0.8 * late, tilt=-0.22 * late)
    anim.turn("chest", left=0.10 * spring_follow(turn, seconds, 2.6, 0.6))
    anim.show("sad", keys(n, (0, 0), (0.15, 0.8), (0.70, 0.7), (0.95, 0)))
    anim.show("happy", keys(n, (0, 0.2), (0.12, 0), (0.80, 0), (0.97, 0.2)))
    tail(anim, 0.0 * turn + 4 * DEGREE, -0.35 * spring_follow(turn, seconds, 2.2, 0.5), 1.6)
    return anim


def _neck(anim: AnimationTracks, up: Array, left: Array) -> None:
    """Bend the neck; each joint is delayed against the one below it."""
    for number, (joint, share) in enumerate((("neck1", 0.45), ("neck2", 0.35), ("neck3", 0.2))):
        anim.turn(
            joint,
            up=share * delayed(up, 0.012 * number),
            left=share * delayed(left, 0.012 * number),
        )
