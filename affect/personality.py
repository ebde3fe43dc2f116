"""Who feels: the numbers that make one character lively and another shy."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from affect.emotion import Emotion
from affect.errors import AffectError
from affect.labels import LabelSet, label_set
from affect.personality_file import bundled_text, parse_fields, read_fields
from affect.traits import Ocean, Push

ArousalLaw = Literal["own", "magnitude"]

GAIN_MAX = 10.0
"""Fastest that an action may move a feeling [1/s]: across the whole plane in 0.2 s."""

NEUTRAL = Emotion(0.0, 0.0)
"""The origin of the plane."""

DWELL_MAX = 60.0
"""Longest time that a label may be held [s]."""


@dataclass(frozen=True)
class Personality:
    """Everything that sets how one character feels; `affect.Feelings` lives by it.

    Raises
    ------
    AffectError
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
            raise AffectError(f"arousal must be 'own' or 'magnitude', not {self.arousal!r}")
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
        AffectError
            In one line: which file, which key, and what it may be.
        """
        if name.endswith(".toml"):
            return cls._of(read_fields(Path(name)), name)
        return cls.parse(bundled_text(name), f"{name}.toml")

    @classmethod
    def parse(cls, text: str, source: str) -> "Personality":
        """Return the personality that a TOML text describes; errors name it as `source`."""
        return cls._of(parse_fields(text, source), source)

    @classmethod
    def _of(cls, fields: dict[str, Any], source: str) -> "Personality":
        try:
            return cls(**fields)
        except AffectError as error:
            raise AffectError(f"{source}: {error}") from None


def in_range(key: str, value: float, low: float, high: float) -> None:
    """Refuse a number outside its range, or NaN, in one line that names its key."""
    if not low <= value <= high:
        raise AffectError(f"{key} must be from {low:g} to {high:g}, not {value:g}")


def _within(key: str, push: Push, most: float) -> None:
    in_range(f"{key}.valence", push.valence, -most, most)
    in_range(f"{key}.arousal", push.arousal, -most, most)
