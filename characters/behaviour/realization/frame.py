"""What is known of a body, and what the body does in one frame."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from cubeling.characters.behaviour.bml import (
    CUBELING as CUBELING,
    Behaviour,
    CannotRealize,
    Scheduled,
)
from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.intents import (
    BehaviourIntent,
    ClipIntent,
    FaceIntent,
    GazeIntent,
    GestureIntent,
    HeadIntent,
    PostureIntent,
    ReachIntent,
    StrokeTimes,
    Times,
)
from cubeling.characters.behaviour.realization.face_names import FaceNames
from cubeling.characters.behaviour.realization.stances import StanceJoints
from cubeling.characters.behaviour.realization.surroundings import NamedPlaces, numbers_of
from cubeling.characters.ik.reaching.hands import find_hand
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.anatomy import SIDES
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.speech import Utterance

Manner = Literal["walk", "run"]
"""How a character goes somewhere."""

UtteranceOf = Callable[[str, str], Utterance | None]
"""Returns what a voice says of a text in a language ("" for the usual one); None if not known."""


@dataclass(frozen=True, eq=False)
class Going:
    """A way to go."""

    key: str
    """Tells it from other ways."""

    end: float
    """When it is planned to end [s]; inf if that is not known."""

    target: Array
    """Where to, (x, z) in the table frame [m]."""

    manner: Manner = "walk"


@dataclass(frozen=True, eq=False)
class Saying:
    """Something that is being said."""

    key: str
    """Tells it from other speeches."""

    utterance: Utterance

    start: float
    """When its sound begins [s]."""


@dataclass(eq=False)
class RealizedFrame:
    """What a character does in one frame."""

    now: float
    """The time of the frame [s]."""

    gestures: list[GestureIntent] = field(default_factory=list)
    reaches: list[ReachIntent] = field(default_factory=list)
    heads: list[HeadIntent] = field(default_factory=list)
    faces: list[FaceIntent] = field(default_factory=list)
    gazes: list[GazeIntent] = field(default_factory=list)
    postures: list[PostureIntent] = field(default_factory=list)
    clips: list[ClipIntent] = field(default_factory=list)

    going: Going | None = None
    """Where it goes; None to stay."""

    facing: Array | None = None
    """A point that it turns to when standing, (3,) in the table frame [m]; None for any."""

    sayings: list[Saying] = field(default_factory=list)
    """What it says; the mouth follows the last one."""

    @property
    def intent(self) -> BehaviourIntent:
        """What layers perform of it."""
        return BehaviourIntent(
            tuple(self.gestures),
            tuple(self.reaches),
            tuple(self.heads),
            tuple(self.faces),
            tuple(self.gazes),
            tuple(self.postures),
            tuple(self.clips),
        )


# Functions with a name, no lambdas: a checkpoint copies the context of who speaks.
def _say_nothing(text: str, language: str) -> None:
    """Return no utterance: there is no voice."""


def _assumed_walk_time(target: Array, manner: Manner) -> float:
    """Return two seconds, wherever it goes."""
    return 2.0


@dataclass(eq=False)
class RealizationContext:
    """Who plays it: the body with its abilities, its surroundings and its voice."""

    character: Character

    collection: GestureCollection
    """The gestures that it may be asked for."""

    surroundings: NamedPlaces
    """Where it is, and the places that may be named."""

    utterance_of: UtteranceOf = _say_nothing
    """What its voice says."""

    expressivity: GestureExpressivity = NEUTRAL
    """How it performs gestures unless they say it themselves."""

    walk_time: Callable[[Array, Manner], float] = _assumed_walk_time
    """Returns how long it takes to go to a place (x, z) from where it is [s]."""

    estimated: set[tuple[str, str]] = field(default_factory=set)
    """Texts and languages of speeches that were planned before the voice had answered."""

    late: dict[str, float] = field(default_factory=dict)
    """When the voice of speeches that had begun without it was there [s]; inf: it is not yet."""

    @cached_property
    def faces(self) -> FaceNames:
        """What its face can show."""
        return FaceNames(self.character.morphs)

    @cached_property
    def stances(self) -> StanceJoints:
        """How it can stand."""
        return StanceJoints(self.character.skeleton, self.character.anatomy)

    @cached_property
    def arms(self) -> tuple[str, ...]:
        """The sides on which it has an arm, or a front leg to use as one."""
        body = self.character
        return tuple(s for s in SIDES if find_hand(body.skeleton, body.anatomy, s) is not None)

    def require_head(self) -> None:
        """Refuse what a body without a head cannot do."""
        if self.character.anatomy.joint("head") is None:
            raise CannotRealize(f"{self.character.name} has no head")

    def require_arms(self, mode: str = "") -> None:
        """Refuse what needs arms that the body lacks."""
        if not self.arms:
            raise CannotRealize(f"{self.character.name} has no arms")
        side = mode.lower().removesuffix("_hand")
        if side in SIDES and side not in self.arms:
            raise CannotRealize(f"{self.character.name} has no {side} arm")

    def how(self, scheduled: Scheduled) -> GestureExpressivity:
        """Return how a behaviour is performed: as it says, or its block, or as usual."""
        given = {
            name: _share(value, name)
            for attributes in (scheduled.block_attributes, scheduled.behaviour.attributes)
            for name in NEUTRAL.__dict__
            if (value := attributes.get(f"{{{CUBELING}}}{name}")) is not None
        }
        return replace(self.expressivity, **given) if given else self.expressivity


def number(behaviour: Behaviour, name: str, default: float, low: float, high: float) -> float:
    """Return an attribute that is a number, within limits.

    Raises
    ------
    CannotRealize
        If it is no number.
    """
    text = behaviour.get(name)
    if not text:
        return default
    found = numbers_of(text)
    if len(found) != 1:
        raise CannotRealize(f'{name}="{text}" is no number')
    return min(max(found[0], low), high)


def tempo_of(behaviour: Behaviour) -> float:
    """Return how fast a behaviour is: 2 for its `tempo` of 1, half for −1 (Greta's TMP)."""
    found = numbers_of(behaviour.get("tempo", namespace=CUBELING))
    return 2.0 ** min(max(found[0], -1.0), 1.0) if len(found) == 1 else 1.0


def times_of(scheduled: Scheduled, ready: str = "ready") -> Times:
    """Return the times of something that rises to one sync point and falls from "relax"."""
    times, start = scheduled.times, scheduled.start
    relax, end = (_finite(times.get(sync)) for sync in ("relax", "end"))
    return Times(start, times.get(ready, start), relax, end)


def shift_times_of(scheduled: Scheduled) -> Times:
    """Return the times of something that stays, unless it "relax"es because another one comes."""
    times = scheduled.times
    return Times(scheduled.start, scheduled.end, times.get("relax"), times.get("gone"))


def stroke_times_of(scheduled: Scheduled) -> StrokeTimes:
    """Return the times of something with a stroke."""
    times, plain = scheduled.times, times_of(scheduled)
    strokes = [times[sync] for sync in ("strokeStart", "stroke", "strokeEnd")]
    return StrokeTimes(plain.start, plain.ready, plain.relax, plain.end, *strokes)


def _finite(time: float | None) -> float | None:
    return None if time is None or time == float("inf") else time


def _share(text: str, name: str) -> float:
    """Return a parameter of expressivity, −1…1; 0…1 for openness and power."""
    found = numbers_of(text)
    low = 0.0 if name in ("openness", "power") else -1.0
    return min(max(found[0], low), 1.0) if len(found) == 1 else getattr(NEUTRAL, name)
