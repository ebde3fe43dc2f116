"""What Vleo's clips have in common: its face, its tail that drags behind, and what flies away."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from characters import rotations
from characters.authoring.loops import Array, follow, keys, later, phases
from characters.authoring.vleo_rig import HIDDEN, TAIL, Performance, poses
from characters.clip import Clip
from characters.pose import Pose, Skeleton

DEGREE = np.pi / 180
RATE = 30.0
"""Frames a second [Hz]."""
SHUT, LOWER_SHUT = 1.36, 1.20
"""How far an upper and a lower lid roll to meet [rad]."""
MOUTH_SHUT = 0.13
"""Turn of the jaw that closes the mouth, which rests in an open smile [rad]."""


def clip(name: str, performance: Performance, bound: Skeleton) -> Clip:
    """Return a performance as a loop: its last frame is its first."""
    pose = poses(performance, bound)
    again = np.append(np.arange(performance.frames), 0)
    turns = rotations.continuous(pose.rotations[again])
    scales = None if pose.scales is None else pose.scales[again]
    return Clip(name, RATE, Pose(pose.translations[again], turns, scales))


def blink(frames: int, *starts: float, seconds: float = 0.24) -> Array:
    """Return how shut the eyes are, 0…1, with blinks at phases: quick down, slower up."""
    length = seconds * RATE / frames
    shut = np.zeros(frames)
    for start in starts:
        lid = keys(frames, (0, 0), (0.4 * length, 1), (0.55 * length, 1), (length, 0), (0.99, 0))
        shut = np.maximum(shut, later(lid, start))
    return shut


def lids(act: Performance, shut: Array | float, smile: Array | float, anger: Array | float) -> None:
    """Close the eyes (0…1), push the lower lids up in a smile (0…1), slant them in anger (0…1)."""
    upper = np.minimum(1.0, shut + 0.50 * np.asarray(anger) * (1 - np.asarray(shut)))
    lower = np.maximum(shut, 0.44 * np.asarray(smile) + 0.18 * np.asarray(anger))
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        slant = 0.42 * np.asarray(anger) - 0.28 * np.asarray(shut)  # inward is fierce, outward kind
        act.turn(f"{side}UpperLid", up=-SHUT * upper, tilt=sign * slant)
        level = -0.28 * sign * np.asarray(shut)
        act.turn(f"{side}LowerLid", up=LOWER_SHUT * lower, tilt=level)
        deep = 0.014 * (1 - np.clip(anger, 0, 1))  # out of sight in the head unless angry
        act.move(f"{side}Brow", y=-0.4 * deep, z=-deep)
        grown = np.clip(anger, HIDDEN, 1.2) + np.zeros(act.frames)
        act.scales[f"{side}Brow"] = grown


def corners(act: Performance, grin: Array | float, pucker: Array | float) -> None:
    """Raise (1) or drop (−1) the corners of the mouth, or draw them together (0…1)."""
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        up = 0.004 * np.maximum(grin, 0) - 0.021 * np.maximum(-np.asarray(grin), 0)
        act.move(
            f"{side}MouthCorner",
            x=-0.012 * sign * np.asarray(pucker),
            y=up - 0.006 * np.asarray(pucker),
            z=0.010 * np.asarray(pucker),
        )


def tail(act: Performance, up: Array, left: Array, tip: float = 1.6, drag: float = 1.0) -> None:
    """Swing the tail from its root; every joint hangs behind the one before it.

    Parameters
    ----------
    up, left : turn of the first joint (frames,) [rad]; up lifts the tail
    tip : turn of the last joint over that of the first
    drag : how late the joints are; 1 is the natural tail
    """
    seconds = act.frames / RATE
    for number, joint in enumerate(TAIL):
        share = 1 + (tip - 1) * number / (len(TAIL) - 1)
        if number:
            hertz = 4.2 / (drag * (1 + 0.12 * number))
            up, left = follow(up, seconds, hertz, 0.55), follow(left, seconds, hertz, 0.55)
        act.turn(joint, up=-share * up, left=-share * left)


def breathe(act: Performance, cycles: int, depth: float = 0.035) -> None:
    """Let the belly fill and the chest rise a little."""
    breath = 0.5 - 0.5 * np.cos(2 * np.pi * cycles * phases(act.frames))
    act.scales["belly"] = 1 + depth * breath[:, None] * np.array([1.0, 1.0, 0.5])
    act.turn("chest", up=0.25 * depth * breath)
    act.turn("neck1", up=-0.3 * depth * breath)


@dataclass(frozen=True)
class Flight:
    """The way of one heart or one burst."""

    start: float
    """Phase at which it leaves the mouth."""

    life: float
    """Part of the loop that it lives."""

    way: tuple[float, float, float]
    """Where it gets to, from the mouth [m]."""

    size: float
    """Its scale when fully grown; 0 for one that only goes along, so that blends agree."""

    swirl: float = 0.0
    """How far it swings to the side on its way [m]."""

    facing: float = 0.0
    """Where it faces half way, to the left of ahead [rad]."""

    spin: float = 0.0
    """How far it turns about the upright [rad]."""


def fly(
    act: Performance, joints: Sequence[str], flights: Sequence[Flight], bound: Skeleton
) -> None:
    """Send effects out of the mouth as it is when each leaves."""
    pose = poses(act, bound)
    mouth = pose.globals(bound)[:, bound.index("lips"), :3, 3]
    home = bound.rest.translations
    for joint, flight in zip(joints, flights, strict=True):
        leaves = mouth[round(flight.start * act.frames) % act.frames]
        age = ((phases(act.frames) - flight.start) % 1.0) / flight.life
        alive = age < 1
        age = np.minimum(age, 1.0)
        out = 1 - (1 - age) ** 2
        sideways = flight.swirl * np.sin(2 * np.pi * age)
        rise = np.stack([out, age, out], axis=1) * np.array(flight.way)
        offset = leaves - home[bound.index(joint)] + rise + sideways[:, None] * np.array([1, 0, 0])
        act.moves[joint] = np.where(alive[:, None], offset, leaves - home[bound.index(joint)])
        act.scales[joint] = np.where(alive, np.maximum(flight.size * _pop(age), HIDDEN), HIDDEN)
        act.turn(
            joint,
            left=(flight.facing + flight.spin * (age - 0.5)) * alive,
            tilt=0.3 * np.sin(6 * age) * alive,
        )


def _pop(age: Array) -> Array:
    """Return the size over a life: quickly past full size, then full, then gone."""
    grown = 1.18 * np.sin(np.pi / 2 * np.clip(age / 0.22, 0, 1))
    settle = 0.18 * np.clip((age - 0.22) / 0.2, 0, 1)
    return np.asarray((grown - settle) * np.clip((1 - age) / 0.3, 0, 1) ** 0.8)
