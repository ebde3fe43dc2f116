"""How a character speaks with its body: the profile of BodySpeech, as a value and as a file.

Source: Fernández-Baena, PhD thesis, La Salle – URL, 2015, section 4.5 (M9).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from cubeling.characters.errors import CharacterError
from cubeling.characters.face.visemes.sets import viseme_sets
from cubeling.characters.synthesis.choices import Database
from cubeling.files import write_whole
from cubeling.toml_file import TomlTable, read, toml_kind

if TYPE_CHECKING:  # a profile is read and checked before anything that plays it is loaded
    from cubeling.characters.speech.prosody.accents import AccentSettings
    from cubeling.characters.synthesis.gestures.library import GestureLibrary
    from cubeling.characters.synthesis.gestures.planning import GesturePlanner

DATABASES: tuple[str, ...] = get_args(Database)
"""Parts of a gesture library: the stronger gestures, the weaker ones, or all."""

PROFILE_FILE = toml_kind(
    "profile", CharacterError, "cubeling.characters.control.speech_profile:SpeechProfile.load"
)
"""The file of a profile."""

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

    liveliness: float = 1.0
    """How far weight, hips, trunk, arms at rest, eyes and face join in; 0 leaves them still."""

    cube_emphasis: float = 0.0
    """How far a turn of the cube emphasises what is being said, 0…1; 0 for not at all."""

    visemes: str = "oculus"
    """The set of visemes."""

    accent_threshold: float = 0.35
    """Least strength of an accent, as a share of the strongest, 0…1; see `AccentSettings`."""

    accent_distance: float = 0.3
    """Least time between two accents [s]."""

    def __post_init__(self) -> None:
        for name, choices in (("database", DATABASES), ("visemes", tuple(viseme_sets()))):
            if (value := getattr(self, name)) not in choices:
                raise CharacterError(f"{name} must be one of {', '.join(choices)}, not {value!r}")
        for name, (low, high) in RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise CharacterError(f"{name} must be from {low:g} to {high:g}, not {value:g}")

    @property
    def accents(self) -> AccentSettings:
        """How accents are found."""
        from cubeling.characters.speech.prosody.accents import AccentSettings

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
    def load(name_or_path: str | Path) -> SpeechProfile:
        """Return the bundled profile of a name, or read a .toml file; what that lacks is usual.

        Raises
        ------
        CharacterError
            If there is none, it cannot be read, or has other fields or values.
        """
        name = str(name_or_path)
        if name in PROFILES:
            return PROFILES[name]
        if not name.endswith(".toml"):
            raise CharacterError(
                f"there is no profile {name!r}: choose one of {', '.join(PROFILES)}, "
                "or give a .toml file"
            )
        content = read(Path(name), PROFILE_FILE)
        return TomlTable(content, name, error=CharacterError).fill(SpeechProfile)

    def with_settings(self, settings: Iterable[str]) -> SpeechProfile:
        """Return the profile with other values of fields, each "name=value".

        Raises
        ------
        CharacterError
            If a field or its value is unknown; it says what there is.
        """
        values: dict[str, Any] = asdict(self)
        for setting in settings:
            name, equals, text = setting.partition("=")
            if not equals:
                raise CharacterError(f"--set {setting}: write {name}=VALUE")
            try:
                values[name] = float(text) if name in RANGES else text
            except ValueError:
                values[name] = text  # the table says what it must be
        return TomlTable(values, "--set", error=CharacterError).fill(SpeechProfile)

    def save(self, path: Path) -> None:
        """Write it as a .toml file."""
        lines = [f"{name} = {value!r}\n" for name, value in asdict(self).items()]
        write_whole(path, "".join(lines).replace("'", '"'), CharacterError)

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
    "liveliness": (0.0, 1.5),
    "cube_emphasis": (0.0, 1.0),
    "accent_threshold": (0.0, 1.0),
    "accent_distance": (0.0, MAX_DISTANCE_S),
}
"""Least and greatest value of each number."""

DEFAULT_PROFILE = SpeechProfile()
"""How the bundled characters speak."""

PROFILES: Mapping[str, SpeechProfile] = {
    "usual": DEFAULT_PROFILE,
    "lively": SpeechProfile("aggressive", gesture_emphasis=0.5, face_emphasis=0.5),
    "calm": SpeechProfile("neutral", gesture_emphasis=-0.5, face_emphasis=-0.3),
}
"""The profiles that `--profile` takes by name: how a line is said with face, head and hands."""


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
