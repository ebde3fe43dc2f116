"""What a symbolic gesture is: places, palms and shapes of hands in a space about the body.

A gesture has no metres and no joints: sectors of McNeill's gesture space (Huang 2013, section 8.7)
become places for the proportions of whoever performs it.
"""

from dataclasses import dataclass
from typing import Literal

from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity

SECTORS_X = ("XEP", "XP", "XC", "XOppC")
"""Across: extreme periphery, periphery and centre of the hand's own side, and the other centre."""

SECTORS_Y = ("YUpperEP", "YUpperP", "YUpperC", "YCC", "YLowerC", "YLowerP", "YLowerEP")
"""Up and down, from above the head to the thighs."""

SECTORS_Z = ("ZNear", "ZMiddle", "ZFar")
"""Away from the body."""

Vector3 = tuple[float, float, float]

Path = Literal["line", "arc", "circle", "wave", "keys"]
"""How a hand gets from key to key; see `cubeling.characters.behaviour.gestures.targeting`."""


@dataclass(frozen=True)
class Place:
    """A place of a hand in the gesture space, or on the body."""

    x: str = "XC"
    """One of `SECTORS_X`."""

    y: str = "YLowerC"
    """One of `SECTORS_Y`."""

    z: str = "ZMiddle"
    """One of `SECTORS_Z`."""

    offset: Vector3 = (0.0, 0.0, 0.0)
    """Outward, up and forward from the centre of the cell, in parts of the arm's length."""

    contact: str = ""
    """What the hand touches instead: "forehead", "chest", "hip", "mouth", "other hand" …"""


@dataclass(frozen=True)
class HandKey:
    """A hand at one moment of a stroke."""

    at: float
    """When: 0 where the stroke starts … 1 where it ends."""

    place: Place = Place()
    """Where the hand is."""

    shape: str = "relaxed"
    """Name of a hand shape: "relaxed", "flat", "fist", "point", "thumb", "ok", "claw" …"""

    palm: str = "down"
    """Where the palm faces: up, down, in, out, forward, back, or two of them ("down-in")."""

    fingers: str = "forward"
    """Where the fingers point, in the same words."""

    path: Path = "line"
    """How the hand gets here from the key before."""

    radius: Vector3 = (0.0, 0.0, 0.0)
    """Amplitude of the path outward, up and forward, in parts of the arm's length."""

    turns: float = 1.0
    """How many times a circle goes round, or a wave goes to and fro."""


@dataclass(frozen=True)
class BodyKey:
    """Trunk, shoulders and head at one moment of a stroke; angles are in degrees."""

    at: float
    """When: 0 where the stroke starts … 1 where it ends."""

    lean_deg: float = 0.0
    """Of the trunk, forward."""

    side_deg: float = 0.0
    """Of the trunk, to its left."""

    turn_deg: float = 0.0
    """Of the trunk about its length, to its left."""

    shrug: float = 0.0
    """How far the shoulders are raised, 0…1."""

    nod_deg: float = 0.0
    """Of the head, down."""

    tilt_deg: float = 0.0
    """Of the head, to its left."""

    shake_deg: float = 0.0
    """Of the head about its length, to its left."""


@dataclass(frozen=True)
class SymbolicGesture:
    """A gesture that anybody with arms can perform."""

    name: str
    """Its name, the lexeme of BML: "BEAT", "WAVE" …"""

    summary: str = ""
    """What it means, one line."""

    right: tuple[HandKey, ...] = ()
    """Keys of the right hand in the order of time; () if it takes no part."""

    left: tuple[HandKey, ...] = ()
    """Keys of the left hand."""

    body: tuple[BodyKey, ...] = ()
    """Keys of trunk, shoulders and head."""

    one_handed: bool = False
    """Whether either hand may perform it: `right` then is for the hand that does."""

    preparation: float = 0.5
    """Time from the start to the first key [s]."""

    stroke: float = 0.6
    """Time from the first key to the last [s]."""

    apex: float = 1.0
    """Moment of the stroke that falls on a stressed syllable, 0…1: the sync point `stroke`."""

    hold: float = 0.2
    """Time that the hands stay after the stroke [s]."""

    retraction: float = 0.6
    """Time to come to rest [s]."""

    repeats: int = 1
    """How many times the stroke is performed."""

    expressivity: GestureExpressivity = NEUTRAL
    """How it is performed unless an intent says otherwise."""
