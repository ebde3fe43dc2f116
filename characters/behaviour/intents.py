"""What a body is asked to do at given times: gestures, reaching, head, face, gaze and posture.

A BML realizer and scenarios make them; the layers of an `Animator` perform them. Times are
absolute: they are those of `CharacterCommand.timestamp`. An intent that goes on says the same in
every frame; one whose times change is re-timed without a jump; one that is left out fades.
"""

import math
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture

Hand = Literal["left", "right", "both", "nearest"]
"""Which hand; "nearest" chooses by the target, or by what is free."""

Influence = Literal["EYES", "HEAD", "NECK", "SHOULDER", "WAIST", "WHOLE"]
"""How much of the body joins in a gaze, as in BML."""

UNKNOWN = math.nan
"""A time that is not known."""


@dataclass(frozen=True)
class Times:
    """When the phases of something begin and end [s]: rising to `ready`, falling from `relax`."""

    start: float

    ready: float
    """When it is fully there."""

    relax: float | None = None
    """When it begins to go; None for not yet known."""

    end: float | None = None
    """When it is gone; None for not yet known."""


@dataclass(frozen=True)
class StrokeTimes(Times):
    """When the phases of a gesture begin and end [s]: it is held where they leave a gap."""

    stroke_start: float = UNKNOWN
    """When the stroke begins, not before `ready`."""

    stroke: float = UNKNOWN
    """The moment of the stroke's apex."""

    stroke_end: float = UNKNOWN
    """When the stroke is over, not after `relax`."""


@dataclass(frozen=True)
class GestureIntent:
    """A gesture to perform."""

    key: str
    """Tells it from others, from frame to frame."""

    gesture: SymbolicGesture

    times: StrokeTimes

    hand: Hand = "right"
    """Which hand, if the gesture is one-handed."""

    expressivity: GestureExpressivity = NEUTRAL
    """How wide, fast, smooth and strong it is."""


@dataclass(frozen=True)
class ReachIntent:
    """A place to put a hand, or to point to."""

    key: str
    """Tells it from others, from frame to frame."""

    target: NDArray[np.float64]
    """(x, y, z) in the table frame [m]; may move from frame to frame."""

    times: Times

    kind: Literal["reach", "touch", "point", "grasp", "hold"] = "reach"
    """Palm there, fingertips there, index finger along the line to it, a hand about it, or a flat
    hand against it."""

    hand: Hand = "nearest"
    """Which hand; "nearest": the one that reaches the target with less effort."""

    expressivity: GestureExpressivity = NEUTRAL
    """How: openness and power."""

    palm: NDArray[np.float64] | None = None
    """Where the palm faces, (3,) in the table frame; None as it comes."""


@dataclass(frozen=True)
class HeadIntent:
    """A movement of the head: BML's `head` and `headDirectionShift`."""

    key: str
    """Tells it from others, from frame to frame."""

    lexeme: str
    """"NOD", "SHAKE", "TILT", "TOSS", "UP", "DOWN", "LEFT", "RIGHT" …"""

    times: StrokeTimes

    amount: float = 0.5
    """How large, 0…1."""

    repeats: int = 1
    """How many times to and fro."""


@dataclass(frozen=True)
class FaceIntent:
    """An expression or action units: BML's `face`, `faceLexeme`, `faceFacs` and `faceShift`."""

    key: str
    """Tells it from others, from frame to frame."""

    names: tuple[str, ...]
    """Names of expressions, or of morphs of the character's meshes."""

    weights: tuple[float, ...]
    """How much of each, 0…1."""

    times: Times
    """When: `ready` is BML's attackPeak."""


@dataclass(frozen=True)
class GazeIntent:
    """A look at a place: BML's `gaze` and `gazeShift`."""

    key: str
    """Tells it from others, from frame to frame."""

    target: NDArray[np.float64]
    """(x, y, z) in the table frame [m]."""

    times: Times

    influence: Influence = "NECK"
    """Which joints join in."""


@dataclass(frozen=True)
class PostureIntent:
    """A posture: BML's `posture` and `postureShift`."""

    key: str
    """Tells it from others, from frame to frame."""

    name: str
    """"STANDING", "CROUCHING", "SITTING", "LEANING_FORWARD", "ARMS_AKIMBO", "ARMS_CROSSED" …"""

    times: Times


@dataclass(frozen=True)
class ClipIntent:
    """A clip of the character, laid over the joints that it is for."""

    key: str
    """Tells it from others, from frame to frame."""

    name: str
    """Name of the clip among those of the character; one that it lacks does nothing."""

    times: StrokeTimes
    """When; it is stretched from `start` to `end`."""


@dataclass(frozen=True)
class BehaviourIntent:
    """All that a body is asked to do besides going, acting and speaking."""

    gestures: tuple[GestureIntent, ...] = ()
    """Gestures; later ones lie over earlier ones."""

    reaches: tuple[ReachIntent, ...] = ()
    """Places for hands; at most one for each hand, a later one takes over."""

    heads: tuple[HeadIntent, ...] = ()
    """Movements of the head; they add up."""

    faces: tuple[FaceIntent, ...] = ()
    """Expressions of the face, each rising and falling by its own times."""

    gazes: tuple[GazeIntent, ...] = ()
    """Looks; the last one counts."""

    postures: tuple[PostureIntent, ...] = ()
    """Postures; the last one counts."""

    clips: tuple[ClipIntent, ...] = ()
    """Clips; later ones lie over earlier ones."""

    def joined(self, first: "BehaviourIntent | None") -> "BehaviourIntent":
        """Return all that another intent and, over it, this one ask for."""
        if first is None:
            return self
        return BehaviourIntent(
            *(getattr(first, each.name) + getattr(self, each.name) for each in fields(self))
        )
