"""Where a hand is, how it is turned and what shape it has, over the time of a stroke."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np

from cubeling.characters.behaviour.gestures.gathering import PartKeys
from cubeling.characters.behaviour.gestures.place.directions import direction
from cubeling.characters.behaviour.gestures.place.space import GestureSpace
from cubeling.characters.behaviour.gestures.targeting import PathFormula, path_points
from cubeling.characters.behaviour.gestures.timing import Repeats
from cubeling.characters.behaviour.intents import Hand
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, SymbolicGesture
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.skeleton.scalar_quaternions import cross

Key = TypeVar("Key", HandKey, BodyKey)

POSITION, ORIENTATION, SHAPES = slice(0, 3), slice(3, 7), slice(7, None)
"""Columns of a track: place [m], frame of the hand as a quaternion, weight of each shape."""


@dataclass(frozen=True, eq=False)
class HandTrack:
    """A hand over the time of a stroke, 0…1."""

    keys: PartKeys
    """Its keys and points of its paths; places are from the middle of the chest, in its upright
    frame."""

    shapes: tuple[str, ...]
    """Names of the shapes that the last columns are the weights of."""


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


def track_times(keys: Sequence[HandKey], places: Sequence[Array], arm: float) -> Array:
    """Return the times of keys and of the points of their paths, (n,); `arm` is its length [m]."""
    times = [np.array([key.at for key in keys])]
    for number, (before, key) in enumerate(pairwise(keys)):
        length = float(np.linalg.norm(places[number + 1] - places[number])) / arm
        times.append(before.at + (key.at - before.at) * path_points(key, length))
    return np.unique(np.concatenate(times))


def hand_track(
    keys: Sequence[HandKey],
    places: Sequence[Array],
    times: Array,
    space: GestureSpace,
    left: bool,
) -> HandTrack:
    """Return the way of a hand through its keys.

    Parameters
    ----------
    keys
        In the order of time.
    places
        Where each is from the middle of the chest, (3,) in its upright frame [m].
    times
        When, (n,) ascending, 0…1.
    space
        Scales the amplitudes of paths.
    """
    shapes = tuple(dict.fromkeys(key.shape for key in keys))
    at = np.array([key.at for key in keys])
    frames = np.array([orientation(key, left) for key in keys])
    weights = np.array([[float(shape == key.shape) for shape in shapes] for key in keys])
    rows = []
    for time in times:
        after = min(int(np.searchsorted(at, time)), len(keys) - 1)
        before = max(after - 1, 0) if time < at[after] else after
        low, high = at[before], at[after]
        share = (time - low) / (high - low) if high > low else 0.0
        place = places[before] + (places[after] - places[before]) * share
        if share > 0.0:
            formula = PathFormula.of(keys[after], space.radius(keys[after].radius, left))
            place = place + formula.offsets(np.array([share]))[0]
        turned = rotations.slerp(frames[before], frames[after], share)
        shaped = weights[before] + (weights[after] - weights[before]) * share
        rows.append(np.concatenate([place, turned, shaped]))
    track = np.array(rows)
    track[:, ORIENTATION] = rotations.continuous(track[:, ORIENTATION])
    return HandTrack(PartKeys(times, track), shapes)


def touches(keys: Sequence[HandKey], time: float) -> str:
    """Return what a hand touches at a time: "" between keys, and where a key touches nothing."""
    if time <= keys[0].at:
        return keys[0].place.contact
    if time >= keys[-1].at:
        return keys[-1].place.contact
    return next((key.place.contact for key in keys if key.at == time), "")


def orientation(key: HandKey, left: bool) -> Array:
    """Return the frame of a hand: its columns are fingers, thumb or little finger, and palm."""
    fingers, palm = direction(key.fingers, left), direction(key.palm, left)
    across = np.array(cross(palm, fingers))
    across /= np.linalg.norm(across)
    along = np.array(fingers)
    return rotations.from_matrix(np.stack([along, across, np.cross(along, across)], axis=-1))
