"""Reads the settings from TOML; refuses what cannot be, in one line that says where and why."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from robot.drivers.pleo import timing
from robot.drivers.pleo.joints import JOINT_NUMBERS, JOINTS
from robot.drivers.pleo.settings import BUNDLED, Clip, Mood, Settings
from robot.errors import RobotError

LARGEST = 100_000
"""Most bytes of a file; more was not written by hand."""

NAME_MAX = 16
"""Longest name of a mood, a motion or a sound [bytes of UTF-8], as on our own protocol's wire."""

FILE_MAX = 64
"""Longest name of a file on Pleo [characters]."""

ENTRIES_MAX = 64
"""Most moods, motions, sounds or boot texts."""


def load_settings(path: Path | None = None) -> Settings:
    """Read a settings file.

    Parameters
    ----------
    path
        The TOML file; None for the bundled one.

    Raises
    ------
    RobotError
        If it cannot be read, is not TOML, or says something that cannot be.
    """
    path = BUNDLED if path is None else path
    top = _Table(_document(path), str(path), "")
    top.knows("console", "moods", "motions", "sounds")
    console = top.table("console")
    console.knows("volume", "battery_every_s", "mood_every_s", "play_within_s", "boot_text")
    volume = console.whole("volume", 0, 100, 70)
    moods = top.entries("moods")
    if "neutral" not in moods:
        raise top.wrong("moods", "there must be a mood called neutral: write [moods.neutral]")
    named = {name: _mood(table, volume) for name, table in moods.items()}
    motions = {name: _clip(table) for name, table in top.entries("motions").items()}
    sounds = top.table("sounds")
    names = sounds.names()
    both = set(motions) & set(names)
    if both:
        raise sounds.wrong(min(both), "a motion has this name too; call one of them otherwise")
    return Settings(
        moods={"neutral": named.pop("neutral"), **named},
        motions=motions,
        sounds={name: sounds.file(name) for name in names},
        volume=volume,
        battery_every=console.number("battery_every_s", 1, 3600, 30.0),
        mood_every=console.number("mood_every_s", 0, 60, 0.5),
        play_within=console.number("play_within_s", 0.5, 60, timing.LONG_WITHIN),
        boot_text=console.texts("boot_text", ("Pleo Monitor", "Booting")),
    )


def _document(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            text = file.read(LARGEST + 1)
    except (OSError, ValueError) as error:  # ValueError: a name that can be none
        reason = getattr(error, "strerror", None) or error
        raise RobotError(f"cannot read the settings {path}: {reason}") from None
    if len(text) > LARGEST:
        raise RobotError(f"{path}: larger than {LARGEST} bytes; these are no settings for Pleo")
    try:
        return tomllib.loads(text.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:  # no TOML, no UTF-8, a number without an end
        raise RobotError(f"{path}: not TOML ({error}); mend that line") from None


def _mood(table: "_Table", volume: int) -> Mood:
    table.knows(
        "motion", "length_s", "loop", "motion_speed", "joints", "sound", "sound_speed", "volume"
    )
    if ("motion" in table) == ("joints" in table):
        raise table.wrong("motion", "a mood needs either a motion or joints")
    if "joints" in table and any(key in table for key in ("length_s", "loop", "motion_speed")):
        raise table.wrong("joints", "length_s, loop and motion_speed are for a motion")
    motion = None
    if "motion" in table:
        motion = Clip(table.file("motion"), table.number("length_s", 0.5, 600))
    return Mood(
        motion=motion,
        loop=table.truth("loop", True),
        motion_speed=table.whole("motion_speed", 1, 200, 100),
        joints=_joints(table.table("joints")),
        sound=table.file("sound") if "sound" in table else None,
        sound_speed=table.whole("sound_speed", 1, 200, 100),
        volume=table.whole("volume", 0, 100, volume),
    )


def _joints(table: "_Table") -> dict[int, int]:
    angles = {}
    for name in table.names():
        if name not in JOINT_NUMBERS:
            raise table.wrong(
                name, f"no joint is called that; there are {', '.join(JOINT_NUMBERS)}"
            )
        joint = JOINTS[JOINT_NUMBERS[name]]
        angles[JOINT_NUMBERS[name]] = joint.nearest(table.number(name, joint.low, joint.high))
    return angles


def _clip(table: "_Table") -> Clip:
    table.knows("file", "length_s")
    return Clip(table.file("file"), table.number("length_s", 0.1, 600))


class _Table:
    """One table of the file: looks its values up, and says where a wrong one stands."""

    def __init__(self, values: Mapping[str, Any], path: str, name: str) -> None:
        self._values = values
        self._path = path
        self._name = name

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def names(self) -> list[str]:
        """Return its keys, which a person made up."""
        if len(self._values) > ENTRIES_MAX:
            raise self.wrong("", f"at most {ENTRIES_MAX} entries")
        for key in self._values:
            if not key or not key.isprintable() or len(key.encode()) > NAME_MAX:
                raise self.wrong(key, f"a name has 1 to {NAME_MAX} bytes, all of them printable")
        return list(self._values)

    def knows(self, *keys: str) -> None:
        """Refuse every other key."""
        for key in self._values:
            if key not in keys:
                raise self.wrong(key, f"means nothing here; there are {', '.join(keys)}")

    def table(self, key: str) -> "_Table":
        """Return a table in it; an empty one if there is none."""
        values = self._values.get(key, {})
        if not isinstance(values, dict):
            raise self.wrong(key, "must be a table")
        return _Table(values, self._path, self._at(key))

    def entries(self, key: str) -> dict[str, "_Table"]:
        """Return the tables in a table, by name."""
        table = self.table(key)
        return {name: table.table(name) for name in table.names()}

    def number(self, key: str, low: float, high: float, default: float | None = None) -> float:
        """Return a number from `low` to `high`."""
        value = self._values.get(key, default)
        if type(value) not in (int, float) or not low <= value <= high:  # refuses NaN and true
            raise self.wrong(key, f"must be a number from {low:g} to {high:g}", value)
        return float(value)

    def whole(self, key: str, low: int, high: int, default: int) -> int:
        """Return a whole number from `low` to `high`."""
        value = self._values.get(key, default)
        if type(value) is not int or not low <= value <= high:
            raise self.wrong(key, f"must be a whole number from {low} to {high}", value)
        return value

    def truth(self, key: str, default: bool) -> bool:
        """Return true or false."""
        value = self._values.get(key, default)
        if not isinstance(value, bool):
            raise self.wrong(key, "must be true or false", value)
        return value

    def file(self, key: str) -> str:
        """Return the name of a file on Pleo: one word of ISO-8859-1, so that it is one argument."""
        value = self._values.get(key)
        if not isinstance(value, str) or not _is_word(value):
            allowed = f"one word of 1 to {FILE_MAX} printable characters of ISO-8859-1"
            raise self.wrong(key, f"must be {allowed}", value)
        return value

    def texts(self, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
        """Return a list of texts."""
        value = self._values.get(key, list(default))
        if not isinstance(value, list) or len(value) > ENTRIES_MAX:
            raise self.wrong(key, f"must be a list of at most {ENTRIES_MAX} texts", value)
        for text in value:
            if not isinstance(text, str) or not text.strip() or not text.isprintable():
                raise self.wrong(key, "must hold printable texts, none of them empty", text)
        return tuple(value)

    def wrong(self, key: str, allowed: str, value: object = None) -> RobotError:
        """Make the one line that says what is wrong, where, and what is allowed."""
        said = "" if value is None else f", not {_short(value)}"
        return RobotError(f"{self._path}: {self._at(key)}: {allowed}{said}")

    def _at(self, key: str) -> str:
        key = key if key.isprintable() else repr(key)
        return ".".join(part for part in (self._name, key) if part)


def _is_word(text: str) -> bool:
    if not 1 <= len(text) <= FILE_MAX or any(one.isspace() for one in text):
        return False
    return text.isprintable() and max(map(ord, text)) <= 0xFF


def _short(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else f"{shown[:60]}…"
