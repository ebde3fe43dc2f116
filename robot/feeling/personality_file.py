"""Personalities as TOML files: every key is known, every number in its range."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from robot.emotion import Emotion
from robot.errors import RobotError
from robot.feeling.personality import Ocean, Personality, Push, in_range

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


def text_of(name: str) -> str:
    """Return the file of a bundled personality; raises RobotError where there is none."""
    if name not in bundled():
        raise RobotError(
            f"there is no personality {name!r}: choose one of {', '.join(bundled())}, "
            "or give a .toml file"
        )
    return (FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def load(name: str) -> Personality:
    """Read a bundled personality, or a .toml file; see `Personality.load`."""
    if not name.endswith(".toml"):
        return parse(text_of(name), f"{name}.toml")
    try:
        text = Path(name).read_text(encoding="utf-8")
    except OSError as error:
        raise RobotError(f"cannot read the personality '{name}': {error.strerror}") from None
    except UnicodeDecodeError:
        raise RobotError(f"cannot read the personality '{name}': it is not UTF-8") from None
    return parse(text, name)


def parse(text: str, source: str) -> Personality:
    """Return the personality that a TOML text describes; `source` names it in what is refused."""
    try:
        return _personality(tomllib.loads(text), Path(source).stem)
    except tomllib.TOMLDecodeError as error:
        raise RobotError(f"{source}: {error}") from None
    except RobotError as error:
        raise RobotError(f"{source}: {error}") from None


def _personality(said: dict[str, Any], name: str) -> Personality:
    _only(said, (*_TEXTS, *_NUMBERS, *_TABLES), "")
    found: dict[str, Any] = {"name": name}
    for key in _TEXTS:
        if key in said:
            if not isinstance(said[key], str):
                raise RobotError(f"{key} must be a text, not {said[key]!r}")
            found[key] = said[key]
    for key, field in _NUMBERS.items():
        if key in said:
            found[field] = _number(said[key], key)
    for key in _TABLES:
        if not isinstance(said.get(key, {}), dict):
            raise RobotError(f"{key} must be a table, not {said[key]!r}")
    traits = said.get("ocean")
    if traits is not None:
        found["ocean"] = _ocean(traits)
        found["temperament"] = found["ocean"].temperament
    if "temperament" in said:
        found["temperament"] = _home(said["temperament"])
    for axis, value in _plane(said.get("half_life_s", {}), "half_life_s").items():
        found[f"{axis}_half_life"] = value
    for key in ("gains", "events"):
        found[key] = {
            each: Push(**_plane(push, f"{key}.{each}")) for each, push in said.get(key, {}).items()
        }
    movement = said.get("movement", {})
    _only(movement, ("arousal",), "movement.")
    found["movement"] = _number(movement.get("arousal", 0.0), "movement.arousal")
    return Personality(**found)


def _ocean(traits: Mapping[str, Any]) -> Ocean:
    _only(traits, tuple(vars(Ocean())), "ocean.")
    numbers = {key: _number(value, f"ocean.{key}") for key, value in traits.items()}
    for key, value in numbers.items():
        in_range(f"ocean.{key}", value, 0.0, 1.0)
    return Ocean(**numbers)


def _home(said: Mapping[str, Any]) -> Emotion:
    place = {"valence": 0.0, "arousal": 0.0, **_plane(said, "temperament")}
    for axis, value in place.items():
        in_range(f"temperament.{axis}", value, -1.0, 1.0)
    return Emotion(**place)


def _plane(said: Any, key: str) -> dict[str, float]:
    if not isinstance(said, dict):
        raise RobotError(f"{key} must have valence and arousal, not be {said!r}")
    _only(said, _PLANE, f"{key}.")
    return {axis: _number(value, f"{key}.{axis}") for axis, value in said.items()}


def _number(value: Any, key: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise RobotError(f"{key} must be a number, not {value!r}")
    return float(value)


def _only(said: Mapping[str, Any], known: tuple[str, ...], prefix: str) -> None:
    for key in said:
        if key not in known:
            raise RobotError(f"unknown key {prefix}{key!s}: known are {', '.join(known)}")
