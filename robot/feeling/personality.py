"""Who feels: the numbers that make one character lively and another shy."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from robot.emotion import Emotion
from robot.errors import RobotError
from robot.feeling.labels import LabelSet, label_set

ArousalLaw = Literal["own", "magnitude"]

GAIN_MAX = 10.0
"""Fastest that an action may move a feeling [1/s]: across the whole plane in 0.2 s."""

NEUTRAL = Emotion(0.0, 0.0)
"""The origin of the plane."""

DWELL_MAX = 60.0
"""Longest time that a label may be held [s]."""


@dataclass(frozen=True)
class Push:
    """A way in the plane: of an action [1/s], or of an event, at once."""

    valence: float = 0.0
    """Towards pleasant; negative towards unpleasant."""

    arousal: float = 0.0
    """Towards excited; negative towards calm."""

    def times(self, factor: float) -> "Push":
        """Return a push so many times as strong."""
        return Push(self.valence * factor, self.arousal * factor)


@dataclass(frozen=True)
class Ocean:
    """The five traits of a personality, each 0…1 (specification S17: its example has all five)."""

    openness: float = 0.5
    """Imaginative rather than unimaginative."""

    conscientiousness: float = 0.5
    """Organised rather than careless."""

    extraversion: float = 0.5
    """Outgoing rather than reserved."""

    agreeableness: float = 0.5
    """Kind rather than hostile."""

    neuroticism: float = 0.5
    """Moody and nervous rather than even-tempered."""

    @property
    def responses(self) -> tuple[float, float]:
        """How strongly it takes what pleases and what displeases, (u₊, u₋), each 0…1.

        u = P₀ p (Egges, as in specification S17, which gives the rows of P₀).

        >>> Ocean(0.8, 0.1, 0.7, 0.5, 0.05).responses  # the thesis' example
        (0.62, 0.175)
        """
        o, c, e, a, n = (
            self.openness,
            self.conscientiousness,
            self.extraversion,
            self.agreeableness,
            self.neuroticism,
        )
        good = 0.15 * o + 0.45 * e + 0.40 * a - 0.30 * n
        bad = 0.10 * o + 0.10 * c + 0.10 * a + 0.70 * n
        return round(min(max(good, 0.0), 1.0), 9), round(min(max(bad, 0.0), 1.0), 9)

    @property
    def temperament(self) -> Emotion:
        """Where it is at home: pleasure and arousal by Mehrabian (1996), a third of the way out.

        A third, so that the ordinary word at rest is still "neutral" (ours).
        """
        o, e, a = (
            2.0 * trait - 1.0 for trait in (self.openness, self.extraversion, self.agreeableness)
        )
        stable = 1.0 - 2.0 * self.neuroticism
        pleasure = 0.21 * e + 0.59 * a + 0.19 * stable
        arousal = 0.15 * o + 0.30 * a - 0.57 * stable
        return Emotion(pleasure / 3.0, arousal / 3.0)


@dataclass(frozen=True)
class Personality:
    """Everything that sets how one character feels; `robot.feeling.Feelings` lives by it.

    Raises
    ------
    RobotError
        Where a number is out of its range: one line that names it.
    """

    name: str
    """What it is called."""

    description: str = ""
    """What it is like, in a sentence."""

    temperament: Emotion = NEUTRAL
    """Where it is at home, and comes back to when nothing happens."""

    valence_half_life: float = 15.0
    """Time in which half the way home is made [s]; infinite: what was done stays."""

    arousal_half_life: float = 6.0
    """The same for the arousal [s]."""

    gains: Mapping[str, Push] = field(default_factory=dict)
    """What an action of full intensity does, by its name [1/s]. Others leave the feeling alone."""

    events: Mapping[str, Push] = field(default_factory=dict)
    """What happens once, by its name, and how far it moves the feeling at once."""

    movement: float = 0.0
    """How far moving at top speed shifts the home of the arousal."""

    arousal: ArousalLaw = "own"
    """"own": arousal has its own state. "magnitude": it is the magnitude of the valence, or what
    movement makes of it where that is more; the law of the thesis."""

    labels: str = "thesis"
    """Name of the label set that it is described by."""

    hysteresis: float = 0.05
    """How far past a border a feeling must be for the next label (thesis: to come back)."""

    dwell: float = 0.0
    """Shortest time that a label lasts [s]."""

    ocean: Ocean | None = None
    """Traits; with them every gain and event is taken times their response (specification S17)."""

    def __post_init__(self) -> None:
        for name in ("gains", "events"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        label_set(self.labels)
        if self.arousal not in ("own", "magnitude"):
            raise RobotError(f"arousal must be 'own' or 'magnitude', not {self.arousal!r}")
        for key, push in self.gains.items():
            _within(f"gains.{key}", push, GAIN_MAX)
        for key, push in self.events.items():
            _within(f"events.{key}", push, 2.0)
        for key, value, low, high in (
            ("half_life_s.valence", self.valence_half_life, 0.05, math.inf),
            ("half_life_s.arousal", self.arousal_half_life, 0.05, math.inf),
            ("movement.arousal", self.movement, -2.0, 2.0),
            ("hysteresis", self.hysteresis, 0.0, 0.25),
            ("dwell_s", self.dwell, 0.0, DWELL_MAX),
        ):
            in_range(key, value, low, high)
        if self.ocean is not None:
            for trait, value in vars(self.ocean).items():
                in_range(f"ocean.{trait}", value, 0.0, 1.0)

    @property
    def label_set(self) -> LabelSet:
        """The words that it is described by."""
        return label_set(self.labels)

    def gain(self, action: str) -> Push:
        """Return what an action of full intensity does [1/s]; nothing where it is not known."""
        return self._taken(self.gains.get(action, Push()))

    def event(self, name: str) -> Push:
        """Return how far an event moves the feeling; nowhere where it is not known."""
        return self._taken(self.events.get(name, Push()))

    def _taken(self, push: Push) -> Push:
        if self.ocean is None:
            return push
        good, bad = self.ocean.responses
        return push.times(bad if push.valence < 0 else good)

    @classmethod
    def load(cls, name: str) -> "Personality":
        """Read a bundled personality by its name, or one of your own from a .toml file.

        Raises
        ------
        RobotError
            In one line: which file, which key, and what it may be.
        """
        from robot.feeling.personality_file import load  # it builds what is defined here

        return load(name)


def in_range(key: str, value: float, low: float, high: float) -> None:
    """Refuse a number outside its range, or NaN, in one line that names its key."""
    if not low <= value <= high:
        raise RobotError(f"{key} must be from {low:g} to {high:g}, not {value:g}")


def _within(key: str, push: Push, most: float) -> None:
    in_range(f"{key}.valence", push.valence, -most, most)
    in_range(f"{key}.arousal", push.arousal, -most, most)
