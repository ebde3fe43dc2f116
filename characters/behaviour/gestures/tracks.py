"""Where a hand is, how it is turned and what shape it has, over the time of a stroke."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np

from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.gathering import PartKeys
from cubeling.characters.behaviour.gestures.place.directions import direction
from cubeling.characters.behaviour.gestures.place.space import GestureSpace
from cubeling.characters.behaviour.gestures.style.easing import ease_time
from cubeling.characters.behaviour.gestures.style.splines import TcbSpline
from cubeling.characters.behaviour.gestures.targeting import PathFormula, ramp, samples
from cubeling.characters.behaviour.gestures.timing import Repeats
from cubeling.characters.behaviour.intents import Hand
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, SymbolicGesture
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.skeleton.scalar_quaternions import cross
from cubeling.characters.smoothing import smoothstep

Key = TypeVar("Key", HandKey, BodyKey)

POSITION, ORIENTATION, SHAPES = slice(0, 3), slice(3, 7), slice(7, None)
"""Columns of a track: place [m], frame of the hand as a quaternion, weight of each shape."""


@dataclass(frozen=True)
class Overshoot:
    """A hand that goes beyond a key, in rotations, and comes back."""

    start: float
    """Time of the key that it comes from."""

    end: float
    """Time of the key that it goes to."""

    times: Array
    """Times of the stroke at which it is sampled, ascending, (n,)."""

    shares: Array
    """By how much of the way from key to key, (n,)."""


@dataclass(frozen=True, eq=False)
class HandTrack:
    """A hand over the time of a stroke, 0…1."""

    keys: PartKeys
    """Dense keys; places are from the middle of the chest, in its upright frame."""

    shapes: tuple[str, ...]
    """Names of the shapes that the last columns are the weights of."""

    overshoots: tuple[Overshoot, ...]
    """Where power lets it overshoot."""


def choose_side(gesture: SymbolicGesture, hand: Hand) -> tuple[SymbolicGesture, bool]:
    """Return a gesture for the hand that performs it, and whether its body is mirrored."""
    if not gesture.one_handed or hand in ("right", "nearest"):
        return gesture, False
    if hand == "both":
        return replace(gesture, left=gesture.right), False
    return replace(gesture, right=(), left=gesture.right), True


def one_period(keys: tuple[Key, ...], repeats: Repeats) -> tuple[Key, ...]:
    """Return the keys of one stroke and of the way back to its first key, if there is one."""
    if not (keys and repeats.returns):
        return keys
    stroke = tuple(replace(key, at=key.at * repeats.share) for key in keys)
    return stroke + (replace(keys[0], at=1.0),)


def hand_track(
    keys: Sequence[HandKey],
    places: Sequence[Array],
    space: GestureSpace,
    left: bool,
    expressivity: GestureExpressivity,
) -> HandTrack:
    """Return the way of a hand through its keys.

    Parameters
    ----------
    keys
        In the order of time.
    places
        Where each is from the middle of the chest, (3,) in its upright frame [m].
    space
        Scales the amplitudes of paths.
    """
    shapes = tuple(dict.fromkeys(key.shape for key in keys))
    times = np.array([key.at for key in keys])
    spline = TcbSpline.of(times, np.array(places), expressivity)
    frames = np.array([orientation(key, left) for key in keys])
    weights = np.array([[float(shape == key.shape) for shape in shapes] for key in keys])
    parts = [np.concatenate([spline.points[:1], frames[:1], weights[:1]], axis=1)]
    dense, overshoots = [times[:1]], []
    for number, (before, key) in enumerate(pairwise(keys)):
        u = np.linspace(0.0, 1.0, samples(key, expressivity.power) + 1)[1:]
        way = ease_time(u, expressivity)
        beyond, reached = np.maximum(way - 1.0, 0.0), np.clip(way, 0.0, 1.0)
        line = spline if key.path == "keys" else spline.straighten(number)
        formula = PathFormula.of(key, space.radius(key.radius, left))
        round_trip = key.path in ("circle", "wave")
        way_there = line.segment(number, reached)
        way_there += formula.offsets(ramp(reached) if round_trip else reached)
        share = smoothstep(reached)
        turned = rotations.slerp(frames[number], frames[number + 1], share)
        shaped = weights[number] + (weights[number + 1] - weights[number]) * share[:, None]
        parts.append(np.concatenate([way_there, turned, shaped], axis=1))
        at = before.at + (key.at - before.at) * u
        at[-1] = key.at
        dense.append(at)
        if beyond.any() and not key.place.contact:
            over = beyond > 0.0
            overshoots.append(Overshoot(before.at, key.at, at[over], beyond[over]))
    rows = np.concatenate(parts)
    rows[:, ORIENTATION] = rotations.continuous(rows[:, ORIENTATION])
    return HandTrack(PartKeys(np.concatenate(dense), rows), shapes, tuple(overshoots))


def orientation(key: HandKey, left: bool) -> Array:
    """Return the frame of a hand: its columns are fingers, thumb or little finger, and palm."""
    fingers, palm = direction(key.fingers, left), direction(key.palm, left)
    across = np.array(cross(palm, fingers))
    across /= np.linalg.norm(across)
    along = np.array(fingers)
    return rotations.from_matrix(np.stack([along, across, np.cross(along, across)], axis=-1))
