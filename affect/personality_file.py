"""Reads the TOML files of personalities; refuses unknown keys and numbers out of range."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cubeling.affect.emotion import Emotion
from cubeling.affect.emotion_settings import read_emotion_settings
from cubeling.affect.errors import AffectError
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.occ import OCC_PLACES
from cubeling.affect.traits import Ocean
from cubeling.toml_file import TomlTable

BUNDLED_FOLDER = Path(__file__).parent / "personalities"
"""Folder of the bundled personalities."""

_AXES = ("valence", "arousal")
_TEXT_KEYS = ("name", "description", "labels", "arousal")
_NUMBER_FIELDS = {"hysteresis": "hysteresis", "dwell_s": "dwell"}
_TABLE_KEYS = ("temperament", "half_life_s", "gains", "events", "movement", "ocean", "emotions")


def bundled_names() -> tuple[str, ...]:
    """Return the names of the bundled personalities, that of the thesis first."""
    names = sorted(path.stem for path in BUNDLED_FOLDER.glob("*.toml"))
    return tuple(sorted(names, key=lambda name: name != "thesis"))


def bundled_text(name: str) -> str:
    """Return the file of a bundled personality; raise AffectError if there is none."""
    if name not in bundled_names():
        raise AffectError(
            f"there is no personality {name!r}: choose one of {', '.join(bundled_names())}, "
            "or give a .toml file"
        )
    return (BUNDLED_FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def fields_of(document: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return the fields of `Personality` in a TOML document; errors name it as `source`."""
    table = TomlTable(document, source, error=AffectError)
    table.only(*_TEXT_KEYS, *_NUMBER_FIELDS, *_TABLE_KEYS)
    fields: dict[str, Any] = {"name": Path(source).stem}
    fields |= {key: table.text(key) for key in _TEXT_KEYS if key in table}
    fields |= {field: table.number(key) for key, field in _NUMBER_FIELDS.items() if key in table}
    if "ocean" in table:
        traits = table.table("ocean", *vars(Ocean()))
        fields["ocean"] = Ocean(**{key: traits.number(key, 0.0, 1.0) for key in traits.names()})
        fields["temperament"] = fields["ocean"].temperament
    if "temperament" in table:
        home = table.table("temperament", *_AXES)
        valence, arousal = (home.number(axis, -1.0, 1.0, 0.0) for axis in _AXES)
        fields["temperament"] = Emotion(valence, arousal)
    half_lives = table.table("half_life_s", *_AXES)
    for axis in half_lives.names():  # infinite: no decay; `Personality` checks the range
        fields[f"{axis}_half_life"] = half_lives.number(axis, -math.inf, math.inf)
    for key in ("gains", "events"):
        pushes = table.tables(key, *_AXES, *OCC_PLACES)
        fields[key] = {name: _impulse(push) for name, push in pushes.items()}
    fields["movement"] = table.table("movement", "arousal").number("arousal", default=0.0)
    if "emotions" in table:
        fields["emotions"] = read_emotion_settings(table.table("emotions"))
    return fields


def _impulse(table: TomlTable) -> AffectImpulse:
    values = {name: table.number(name) for name in table.names()}
    axes = {axis: values.pop(axis) for axis in _AXES if axis in values}
    return AffectImpulse(**axes, emotions=values)
