"""Whether a gesture can be performed: words that are known, keys in order, finite numbers."""

import difflib
import math
from collections.abc import Iterable
from dataclasses import fields
from itertools import pairwise

from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.place.contacts import CONTACTS
from cubeling.characters.behaviour.gestures.place.directions import DIRECTIONS, across
from cubeling.characters.behaviour.symbolic_gesture import (
    SECTORS_X,
    SECTORS_Y,
    SECTORS_Z,
    BodyKey,
    HandKey,
    SymbolicGesture,
)
from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.reaching import HAND_SHAPES

MAX_SECONDS = 60.0
"""Longest phase of a gesture [s]."""

MAX_REPEATS = 100
"""A stroke is performed at most so many times."""

MAX_KEYS = 200
"""Keys of a hand or of the body."""

MAX_TURNS = 20.0
"""Turns of a path from key to key."""


def check_gesture(gesture: SymbolicGesture) -> None:
    """Refuse a gesture that nobody can perform.

    Raises
    ------
    CharacterError
        Says in one line what is wrong.
    """
    if not gesture.name.strip() or not gesture.name.isprintable():
        raise CharacterError("a gesture needs a name of letters, such as WAVE")
    if not (gesture.right or gesture.left or gesture.body):
        raise CharacterError(f"{gesture.name}: nothing moves; add a key to right, left or body")
    if gesture.one_handed and gesture.left:
        raise CharacterError(f"{gesture.name}: one_handed has keys in right only; move them there")
    for phase in ("preparation", "stroke", "hold", "retraction"):
        _check_range(f"{gesture.name}: {phase}", getattr(gesture, phase), 0.0, MAX_SECONDS)
    for field in fields(GestureExpressivity):
        value = getattr(gesture.expressivity, field.name)
        _check_range(f"{gesture.name}: expressivity: {field.name}", value, -1.0, 1.0)
    _check_range(f"{gesture.name}: apex", gesture.apex, 0.0, 1.0)
    _check_range(f"{gesture.name}: repeats", gesture.repeats, 1, MAX_REPEATS)
    for kind in ("right", "left", "body"):
        keys = getattr(gesture, kind)
        _check_order(f"{gesture.name}: {kind}", [key.at for key in keys])
        for number, key in enumerate(keys, 1):
            _check_key(f"{gesture.name}: {kind} key {number}", key)


def check_known(what: str, words: Iterable[str], known: Iterable[str]) -> None:
    """Refuse words that are not known.

    >>> check_known("palm", ["dwn"], ["up", "down"])
    Traceback (most recent call last):
    ...
    cubeling.characters.errors.CharacterError: palm 'dwn'; did you mean 'down'? There are up, down
    """
    known = list(known)
    for word in words:
        if word not in known:
            near = difflib.get_close_matches(str(word), known, 1)
            hint = f"; did you mean {near[0]!r}? There are" if near else "; there are"
            raise CharacterError(f"{what} {word!r}{hint} {', '.join(known)}")


def _check_order(what: str, times: list[float]) -> None:
    if len(times) > MAX_KEYS:
        raise CharacterError(f"{what}: {len(times)} keys, of at most {MAX_KEYS}")
    for time in times:
        _check_range(f"{what}: at", time, 0.0, 1.0)
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise CharacterError(f"{what}: keys are not in the order of time; sort them by `at`")


def _check_key(what: str, key: HandKey | BodyKey) -> None:
    if isinstance(key, BodyKey):
        for field in fields(key):
            _check_range(f"{what}: {field.name}", getattr(key, field.name), -180.0, 180.0)
        return
    place = key.place
    check_known(f"{what}: x is", [place.x], SECTORS_X)
    check_known(f"{what}: y is", [place.y], SECTORS_Y)
    check_known(f"{what}: z is", [place.z], SECTORS_Z)
    check_known(f"{what}: contact is", [place.contact], ["", *CONTACTS])
    check_known(f"{what}: shape is", [key.shape], HAND_SHAPES)
    check_known(f"{what}: palm is", key.palm.split("-"), DIRECTIONS)
    check_known(f"{what}: fingers is", key.fingers.split("-"), DIRECTIONS)
    if not across(key.fingers, key.palm, left=True):
        raise CharacterError(
            f"{what}: fingers {key.fingers!r} are not across the palm {key.palm!r}; a hand whose "
            "palm faces down has its fingers forward, back, in or out"
        )
    _check_range(f"{what}: turns", key.turns, 0.0, MAX_TURNS)
    for number in (*place.offset, *key.radius):
        _check_range(f"{what}: offset or radius", number, -2.0, 2.0)


def _check_range(what: str, value: float, low: float, high: float) -> None:
    if not (math.isfinite(value) and low <= value <= high):
        raise CharacterError(f"{what} is {value:g}; give {low:g} to {high:g}")
