"""Personality: the numbers that make one character lively and another shy."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from cubeling.affect.emotion import Emotion
from cubeling.affect.emotion_settings import EmotionSettings
from cubeling.affect.errors import AffectError
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.labels import LabelSet, label_set
from cubeling.affect.personality_file import bundled_text, fields_of
from cubeling.affect.traits import Ocean
from cubeling.toml_file import parse, read, toml_kind

MAX_GAIN_PER_S = 10.0
"""Largest gain of an action [1/s]: it crosses the whole plane in 0.2 s."""

MAX_DWELL_S = 60.0
"""Longest dwell time of a label [s]."""

PERSONALITY_FILE = toml_kind(
    "personality", AffectError, "cubeling.affect.personality:Personality.load"
)
"""The file of a personality."""

_ORIGIN = Emotion(0.0, 0.0)


@dataclass(frozen=True)
class Personality:
    """Everything that sets how the emotion of one character changes; see `affect.Feelings`.

    Raises
    ------
    AffectError
        If a number is out of its range: one line that names it.
    """

    name: str

    description: str = ""
    """A sentence about it."""

    temperament: Emotion = _ORIGIN
    """The emotion that it decays to when nothing happens."""

    valence_half_life: float = 15.0
    """Time in which half of the distance to the temperament is covered [s]; infinite: no decay."""

    arousal_half_life: float = 6.0
    """The same for arousal [s]."""

    gains: Mapping[str, AffectImpulse] = field(default_factory=dict)
    """Rate at which an action of full intensity moves the emotion, by its name [1/s]."""

    events: Mapping[str, AffectImpulse] = field(default_factory=dict)
    """How far an event moves the emotion at once, by its name."""

    movement: float = 0.0
    """How far top speed raises the arousal that it decays to."""

    arousal: Literal["own", "magnitude"] = "own"
    """"own": arousal has a state of its own. "magnitude": it is the magnitude of the valence, or
    that of the movement where that is larger; the law of the thesis."""

    labels: str = "thesis"
    """Name of its label set."""

    hysteresis: float = 0.05
    """How far past a border an emotion must be for the next label (thesis: to return)."""

    dwell: float = 0.0
    """Shortest time for which a label lasts [s]."""

    ocean: Ocean | None = None
    """Traits; they scale every gain and event by their response (specification S17)."""

    emotions: EmotionSettings | None = None
    """How it feels 24 emotions, each with an intensity; None for valence and arousal alone."""

    def __post_init__(self) -> None:
        for name in ("gains", "events"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        label_set(self.labels)
        if self.arousal not in ("own", "magnitude"):
            raise AffectError(f"arousal must be 'own' or 'magnitude', not {self.arousal!r}")
        for key, push in self.gains.items():
            _within(f"gains.{key}", push, MAX_GAIN_PER_S)
        for key, push in self.events.items():
            _within(f"events.{key}", push, 2.0)
        for key, value, low, high in (
            ("half_life_s.valence", self.valence_half_life, 0.05, math.inf),
            ("half_life_s.arousal", self.arousal_half_life, 0.05, math.inf),
            ("movement.arousal", self.movement, -2.0, 2.0),
            ("hysteresis", self.hysteresis, 0.0, 0.25),
            ("dwell_s", self.dwell, 0.0, MAX_DWELL_S),
        ):
            check_range(key, value, low, high)
        if self.ocean is not None:
            for trait, value in vars(self.ocean).items():
                check_range(f"ocean.{trait}", value, 0.0, 1.0)

    @property
    def label_set(self) -> LabelSet:
        """The labels that a robot or an overlay shows for its emotions; see `labels`."""
        return label_set(self.labels)

    def gain(self, action: str) -> AffectImpulse:
        """Return how an action of full intensity moves valence and arousal [1/s].

        Zero for an unknown action.
        """
        return self._in_plane(self.gains.get(action, AffectImpulse()))

    def event(self, name: str) -> AffectImpulse:
        """Return how far an event moves valence and arousal; zero for an unknown event."""
        return self._in_plane(self.events.get(name, AffectImpulse()))

    def influence(self, word: str, value: float) -> AffectImpulse:
        """Return how far one of the 24 emotions moves valence and arousal."""
        return self._in_plane(AffectImpulse(emotions={word: value}))

    def _in_plane(self, push: AffectImpulse) -> AffectImpulse:
        valence, arousal = push.plane
        if self.ocean is None:
            return AffectImpulse(valence, arousal)
        good, bad = self.ocean.responses
        factor = bad if valence < 0 else good
        return AffectImpulse(valence * factor, arousal * factor)

    @classmethod
    def load(cls, name_or_path: str | Path) -> "Personality":
        """Read a bundled personality by its name, or one of your own from a .toml file.

        Parameters
        ----------
        name_or_path
            Its name, "lively", or the path of a file that ends in ".toml".

        Raises
        ------
        AffectError
            In one line: which file, which key, and what it may be.
        """
        name = str(name_or_path)
        if name.endswith(".toml"):
            return cls._of(read(Path(name), PERSONALITY_FILE), name)
        return cls.parse(bundled_text(name), f"{name}.toml")

    @classmethod
    def parse(cls, text: str, source: str) -> "Personality":
        """Return the personality that a TOML text describes.

        Parameters
        ----------
        text
            The content of a personality's file.
        source
            Name of the file, for messages; without its suffix it is the default name.

        Raises
        ------
        AffectError
            In one line: which file, which key, and what it may be.
        """
        return cls._of(parse(text, source, AffectError), source)

    @classmethod
    def _of(cls, document: dict[str, Any], source: str) -> "Personality":
        fields = fields_of(document, source)
        try:
            return cls(**fields)
        except AffectError as error:
            raise AffectError(f"{source}: {error}") from None


def check_range(key: str, value: float, low: float, high: float) -> None:
    """Refuse a number outside its range, or NaN, in one line that names its key."""
    if not low <= value <= high:
        raise AffectError(f"{key} must be from {low:g} to {high:g}, not {value:g}")


def _within(key: str, push: AffectImpulse, most: float) -> None:
    check_range(f"{key}.valence", push.valence, -most, most)
    check_range(f"{key}.arousal", push.arousal, -most, most)
    for word, value in push.emotions.items():
        check_range(f"{key}.{word}", value, 0.0, most)
