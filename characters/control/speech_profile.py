"""How a character speaks with its body: the profile of BodySpeech, as a value and as a file.

Source: Fernández-Baena, PhD thesis, La Salle – URL, 2015, section 4.5 (M9).
"""

from __future__ import annotations

import tomllib
from dataclasses import asdict, dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from cubeling.characters.errors import CharacterError
from cubeling.characters.face.visemes.sets import viseme_sets
from cubeling.characters.model.files import read_file
from cubeling.characters.synthesis.choices import Database

if TYPE_CHECKING:  # a profile is read and checked before anything that plays it is loaded
    from cubeling.characters.speech.accents import AccentSettings
    from cubeling.characters.synthesis.gestures.library import GestureLibrary
    from cubeling.characters.synthesis.gestures.planning import GesturePlanner

DATABASES: tuple[str, ...] = get_args(Database)
"""Parts of a gesture library: the stronger gestures, the weaker ones, or all."""

MAX_BYTES = 100_000
"""Larger files are no profiles."""

MAX_DISTANCE_S = 5.0
"""Greatest time between two accents that can be asked for [s]."""


@dataclass(frozen=True)
class SpeechProfile:
    """How a character speaks; a command holds the profile of what is being said.

    Raises CharacterError if a value is out of its range.
    """

    database: Database = "full"
    """Which gestures are used: one of `DATABASES`."""

    threshold: float = 0.0
    """Similarity threshold of the gesture graph; 0 for the smallest that keeps every gesture."""

    neck_weight: float = 1.0
    """Weight of the neck where postures are compared."""

    spine_weight: float = 1.0
    """Weight of the spine there."""

    arm_weight: float = 1.0
    """Weight of the upper arms there."""

    forearm_weight: float = 1.0
    """Weight of the forearms there."""

    gesture_emphasis: float = 0.0
    """Added to the strength of accents for the hands, −1…1."""

    face_emphasis: float = 0.0
    """Added to the strength of accents for the mouth, −1…1."""

    visemes: str = "oculus"
    """The set of visemes."""

    accent_threshold: float = 0.5
    """Least strength of an accent, as a share of the strongest, 0…1."""

    accent_distance: float = 0.3
    """Least time between two accents [s]."""

    def __post_init__(self) -> None:
        for name, choices in (("database", DATABASES), ("visemes", tuple(viseme_sets()))):
            if getattr(self, name) not in choices:
                known = ", ".join(choices)
                raise CharacterError(f"{name} {getattr(self, name)!r}: choose one of {known}")
        for name, (low, high) in RANGES.items():
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise CharacterError(f"{name} {value!r}: give a number")
            if not low <= value <= high:
                raise CharacterError(f"{name} {value:g}: give {low:g} to {high:g}")

    @property
    def accents(self) -> AccentSettings:
        """How accents are found."""
        from cubeling.characters.speech.accents import AccentSettings

        return AccentSettings(self.accent_threshold, self.accent_distance)

    def planner(self, library: GestureLibrary) -> GesturePlanner:
        """Return what plans gestures of a library; making one takes a while, so once."""
        weights = (
            *((part, self.spine_weight) for part in ("spine", "chest", "upperChest")),
            ("neck", self.neck_weight),
            *((f"{side}UpperArm", self.arm_weight) for side in ("left", "right")),
            *((f"{side}LowerArm", self.forearm_weight) for side in ("left", "right")),
        )
        return _planner(library, self.database, self.threshold or None, weights)

    @staticmethod
    def load(path: Path) -> SpeechProfile:
        """Read a .toml file; what it leaves out is usual.

        Raises
        ------
        CharacterError
            If it cannot be read, or has other keys or values.
        """
        try:
            content: dict[str, Any] = tomllib.loads(read_file(path, MAX_BYTES).decode())
            unknown = set(content) - {field.name for field in fields(SpeechProfile)}
            if unknown:
                raise CharacterError(f"no setting is called {', '.join(sorted(unknown))}")
            return SpeechProfile(**content)
        except (ValueError, CharacterError) as error:  # no TOML, or no UTF-8
            raise CharacterError(f"{path}: {error}") from None

    def save(self, path: Path) -> None:
        """Write it as a .toml file."""
        lines = [f"{name} = {value!r}\n" for name, value in asdict(self).items()]
        try:
            path.write_text("".join(lines).replace("'", '"'), "utf-8")
        except OSError as error:
            raise CharacterError(f"{path}: cannot be written ({error.strerror})") from None

    def with_setting(self, setting: str, value: str | float) -> SpeechProfile:
        """Return the profile with another value of a setting."""
        return replace(self, **{setting: value})  # type: ignore[arg-type]


RANGES: dict[str, tuple[float, float]] = {
    "threshold": (0.0, 10.0),
    "neck_weight": (0.0, 10.0),
    "spine_weight": (0.0, 10.0),
    "arm_weight": (0.0, 10.0),
    "forearm_weight": (0.0, 10.0),
    "gesture_emphasis": (-1.0, 1.0),
    "face_emphasis": (-1.0, 1.0),
    "accent_threshold": (0.0, 1.0),
    "accent_distance": (0.0, MAX_DISTANCE_S),
}
"""Least and greatest value of each number."""

DEFAULT_PROFILE = SpeechProfile()
"""How the bundled characters speak."""


@lru_cache(maxsize=8)
def _planner(
    library: GestureLibrary,
    database: Database,
    threshold: float | None,
    weights: tuple[tuple[str, float], ...],
) -> GesturePlanner:
    from cubeling.characters.synthesis.gestures.graph import GestureGraph
    from cubeling.characters.synthesis.gestures.planning import GesturePlanner, GestureSettings

    graph = GestureGraph.of(library.database(database), threshold, dict(weights))
    return GesturePlanner.of(graph, GestureSettings(database=database, threshold=threshold))
