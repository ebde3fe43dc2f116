"""Vleo says yes and no: short clips that begin and end where it stands."""

from dataclasses import replace

from characters.motion.clip import Clip
from characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import Array, follow, keys, later
from tools.authoring.modelling.quadruped import DEGREE, RATE, Performance
from tools.authoring.vleo.clips import clip, tail

HEAD_UP = 8.0
"""How high Vleo holds its head where a gesture begins and ends [degrees]."""


def gestures(bound: Skeleton) -> list[Clip]:
    """Return all gestures; they play once."""
    made = (clip("nod", _nod(), bound), clip("shake", _shake(), bound))
    return [replace(each, loop=False) for each in made]


def _nod() -> Performance:
    """Breathe in with the nose up, then nod twice, the second time less."""
    act = Performance(round(1.6 * RATE))
    n, seconds = act.frames, 1.6
    down = keys(
        n, (0, 0), (0.11, -10), (0.27, 20), (0.42, -7), (0.56, 13), (0.72, -3), (0.86, 1), (0.97, 0)
    )
    dip = down * DEGREE
    _neck(act, -0.55 * dip, 0.0 * dip)
    act.turn("head", up=HEAD_UP * DEGREE - 0.9 * later(dip, 0.02))
    act.move("hips", y=-0.00022 * follow(down, seconds, 2.6, 0.6))
    act.turn("hips", up=-0.10 * follow(dip, seconds, 2.4, 0.6))
    act.show("happy", keys(n, (0, 0.2), (0.2, 0.85), (0.70, 0.8), (0.97, 0.2)))
    tail(act, 4 * DEGREE + 0.35 * follow(dip, seconds, 2.2, 0.5), 0.0 * dip, 1.5)
    return act


def _shake() -> Performance:
    """Turn the head to and fro, less and less, the tail against it."""
    act = Performance(round(1.9 * RATE))
    n, seconds = act.frames, 1.9
    aside = keys(
        n,
        (0, 0),
        (0.08, -7),
        (0.23, 30),
        (0.38, -28),
        (0.52, 20),
        (0.66, -12),
        (0.78, 4),
        (0.94, 0),
    )
    turn = aside * DEGREE
    _neck(act, 0.0 * turn, 0.45 * turn)
    late = later(turn, 0.022)
    act.turn("head", up=HEAD_UP * DEGREE, left=0.8 * late, tilt=-0.22 * late)
    act.turn("chest", left=0.10 * follow(turn, seconds, 2.6, 0.6))
    act.show("sad", keys(n, (0, 0), (0.15, 0.8), (0.70, 0.7), (0.95, 0)))
    act.show("happy", keys(n, (0, 0.2), (0.12, 0), (0.80, 0), (0.97, 0.2)))
    tail(act, 0.0 * turn + 4 * DEGREE, -0.35 * follow(turn, seconds, 2.2, 0.5), 1.6)
    return act


def _neck(act: Performance, up: Array, left: Array) -> None:
    """Bend the neck; each joint comes a little after the one below it."""
    for number, (joint, share) in enumerate((("neck1", 0.45), ("neck2", 0.35), ("neck3", 0.2))):
        act.turn(
            joint, up=share * later(up, 0.012 * number), left=share * later(left, 0.012 * number)
        )
