"""Personalities as TOML files: every key is known, every number in its range."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from affect.emotion import Emotion
from affect.errors import AffectError
from affect.settings import Table, parse, read
from affect.traits import AffectImpulse, Ocean

FOLDER = Path(__file__).parent / "personalities"
"""Where the bundled ones lie."""

_PLANE = ("valence", "arousal")
_TEXTS = ("name", "description", "labels", "arousal")
_NUMBERS = {"hysteresis": "hysteresis", "dwell_s": "dwell"}
_TABLES = ("temperament", "half_life_s", "gains", "events", "movement", "ocean")


def bundled() -> tuple[str, ...]:
    """Names of the personalities that come with the program, the thesis' first."""
    names = sorted(path.stem for path in FOLDER.glob("*.toml"))
    return tuple(sorted(names, key=lambda name: name != "thesis"))


def bundled_text(name: str) -> str:
    """Return the file of a bundled personality; raises AffectError where there is none."""
    if name not in bundled():
        raise AffectError(
            f"there is no personality {name!r}: choose one of {', '.join(bundled())}, "
            "or give a .toml file"
        )
    return (FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def read_fields(path: Path) -> dict[str, Any]:
    """Return the fields of `Personality` that a .toml file gives."""
    return _fields(read(path), str(path))


def parse_fields(text: str, source: str) -> dict[str, Any]:
    """Return the fields of `Personality` that a TOML text gives; errors name it as `source`."""
    return _fields(parse(text, source), source)


def _fields(document: Mapping[str, Any], source: str) -> dict[str, Any]:
    said = Table(document, source)
    said.only(*_TEXTS, *_NUMBERS, *_TABLES)
    found: dict[str, Any] = {"name": Path(source).stem}
    found |= {key: said.text(key) for key in _TEXTS if key in said}
    found |= {field: said.number(key) for key, field in _NUMBERS.items() if key in said}
    if "ocean" in said:
        traits = said.table("ocean", *vars(Ocean()))
        found["ocean"] = Ocean(**{key: traits.number(key, 0.0, 1.0) for key in traits.names()})
        found["temperament"] = found["ocean"].temperament
    if "temperament" in said:
        home = said.table("temperament", *_PLANE)
        valence, arousal = (home.number(axis, -1.0, 1.0, 0.0) for axis in _PLANE)
        found["temperament"] = Emotion(valence, arousal)
    half_lives = said.table("half_life_s", *_PLANE)
    found |= {f"{axis}_half_life": half_lives.number(axis) for axis in half_lives.names()}
    for key in ("gains", "events"):
        found[key] = {name: _impulse(push) for name, push in said.tables(key, *_PLANE).items()}
    found["movement"] = said.table("movement", "arousal").number("arousal", default=0.0)
    return found


def _impulse(said: Table) -> AffectImpulse:
    return AffectImpulse(**{axis: said.number(axis) for axis in said.names()})
