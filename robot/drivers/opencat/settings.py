"""The settings: how each model shows each mood. Lines that may not be sent are refused here."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

from cubeling.affect.words import WORD_PLACES
from cubeling.robot.contract.catalogue import MAX_NAME_BYTES, Catalogue
from cubeling.robot.drivers.opencat import tokens
from cubeling.robot.drivers.opencat.models import MODELS
from cubeling.robot.errors import RobotError
from cubeling.toml_file import TomlTable, bundled, excerpt, read, toml_kind

SETTINGS_FILE = toml_kind(
    "OpenCat settings", RobotError, "cubeling.robot.drivers.opencat.settings:load_settings"
)
"""A file of settings."""

BUNDLED_SETTINGS = Path(__file__).with_name("opencat.toml")
"""The bundled settings; a person's own file overrides parts of them."""

BAUDS = (57600, 115200)
"""Bits per second of OpenCat boards."""

MIN_GESTURE_INTERVAL_S = 5.0
"""Shortest time between two gestures [s]."""

Notes = tuple[tuple[int, int], ...]
"""Notes of a melody with their values: 4 is a quarter of a second, 8 an eighth."""


@dataclass(frozen=True)
class OpenCatMood:
    """How a mood is shown."""

    posture: str
    """The skill that is held while the mood lasts."""

    pose: Mapping[int, int]
    """Angles [°] by joint number, taken after the posture and within the limits of the joints."""

    gestures: tuple[str, ...]
    """Skills that are played now and then, in turn."""

    gesture_every: float
    """Time between two gestures [s]; 0 for no gestures."""

    sound: str | None
    """The melody that is played once when the mood begins."""


@dataclass(frozen=True)
class ModelBehaviour:
    """How a model behaves."""

    moods: Mapping[str, OpenCatMood]
    """Its moods by word, "neutral" first."""

    motions: tuple[str, ...]
    """Skills that can be played by name: those of the settings, and every posture and gesture."""

    sounds: Mapping[str, Notes]
    """Melodies by the name that `play` takes."""

    stop: str
    """The posture for a stop."""

    def catalogue(self, model: str, name: str, version: str) -> Catalogue:
        """Return the catalogue of a board that reports this name and version, or empty ones."""
        return Catalogue(
            name=(name or "OpenCat").encode()[:MAX_NAME_BYTES].decode(errors="ignore"),
            firmware=f"OpenCat {version}".strip(),
            joints=tuple(joint.limits for joint in MODELS[model]),
            motions=self.motions,
            sounds=tuple(self.sounds),
            moods=tuple(self.moods),
        )


@dataclass(frozen=True)
class OpenCatSettings:
    """What a settings file of a board says, checked; defaults come from the bundled file."""

    baud: int
    """Bits per second on the serial line."""

    model: str | None
    """One of `MODELS`, whatever the board reports; None to ask the board."""

    commands_per_s: float
    """Most lines per second."""

    dwell: float
    """Time from the end of a skill to the start of the next [s]."""

    ask_every: float
    """Time without an answer after which a question is asked [s]."""

    rest_after: float
    """Time without a new request after which the servos are switched off [s]; 0 for never."""

    behaviours: Mapping[str, ModelBehaviour]
    """The behaviour of each of `MODELS`."""


def load_settings(path: Path | None = None) -> OpenCatSettings:
    """Return the settings in a TOML file; what it does not set is as in the bundled file.

    Raises RobotError if it cannot be read, or a value is wrong or may not be sent.
    """
    if path is None:
        return parse_settings({}, BUNDLED_SETTINGS.name)
    return parse_settings(read(path, SETTINGS_FILE), str(path))


@cache
def _read_bundled() -> Mapping[str, Any]:
    return bundled(BUNDLED_SETTINGS)


def parse_settings(document: Mapping[str, Any], source: str) -> OpenCatSettings:
    """Return the settings in a TOML document, over the bundled ones."""
    top = TomlTable(_merge(_read_bundled(), document), source, error=RobotError)
    top.only("opencat", *MODELS)
    common = top.table("opencat")
    common.only("baud", "model", "commands_per_s", "dwell_s", "ask_every_s", "rest_after_s")
    model = common.choice("model", ("", *MODELS))
    baud = common.whole("baud", min(BAUDS), max(BAUDS))
    if baud not in BAUDS:
        raise common.unlike("baud", f"one of {', '.join(map(str, BAUDS))}")
    return OpenCatSettings(
        baud=baud,
        model=model or None,
        commands_per_s=common.number("commands_per_s", 0.1, 10.0),
        dwell=common.number("dwell_s", 0.5, 60.0),
        ask_every=common.number("ask_every_s", 1.0, 600.0),
        rest_after=common.number("rest_after_s", 0.0, 86400.0),
        behaviours={name: _behaviour(top.table(name), name) for name in MODELS},
    )


def _behaviour(table: TomlTable, model: str) -> ModelBehaviour:
    table.only("stop", "motions", "sounds", "moods")
    melodies = table.table("sounds")
    sounds = {name: _melody(melodies, name) for name in melodies.names(MAX_NAME_BYTES)}
    listed = table.table("moods")
    moods = {}
    for word in sorted(listed.names(), key=lambda word: (word != "neutral", word)):
        if word not in WORD_PLACES:
            raise listed.wrong(word, f"no mood is called that; there are {', '.join(WORD_PLACES)}")
        moods[word] = _mood(listed.table(word), model, sounds)
    if "neutral" not in moods:
        raise listed.unlike("neutral", "there, for every robot shows it")
    stop = _skill(table, "stop")
    motions = dict.fromkeys(_skills(table, "motions"))
    for mood in moods.values():
        motions |= dict.fromkeys((mood.posture, *mood.gestures))
    if both := motions.keys() & sounds.keys():
        raise melodies.wrong(min(both), "a skill has this name too; give the sound another name")
    return ModelBehaviour(moods, tuple(motions), sounds, stop)


def _mood(table: TomlTable, model: str, sounds: Mapping[str, Notes]) -> OpenCatMood:
    table.only("posture", "pose", "gestures", "gesture_every_s", "sound")
    sound = table.text("sound", "")
    if sound and sound not in sounds:
        known = ", ".join(sounds) or "none"
        raise table.wrong("sound", f"there is no sound {excerpt(sound)}; there is {known}")
    mood = OpenCatMood(
        posture=_skill(table, "posture"),
        pose=_pose(table, model),
        gestures=_skills(table, "gestures"),
        gesture_every=table.number("gesture_every_s", 0.0, 3600.0, 0.0),
        sound=sound or None,
    )
    if 0 < mood.gesture_every < MIN_GESTURE_INTERVAL_S:
        allowed = f"0, or at least {MIN_GESTURE_INTERVAL_S:g}: servos get hot"
        raise table.unlike("gesture_every_s", allowed)
    return mood


def _pose(table: TomlTable, model: str) -> Mapping[int, int]:
    joints = {joint.name: joint for joint in MODELS[model]}
    angles = table.table("pose")
    pose = {}
    for name in angles.names():
        if name not in joints:
            known = ", ".join(joints) or "none that is known"
            raise angles.wrong(name, f"no joint is called that; a {model} has {known}")
        pose[joints[name].number] = joints[name].clamp(angles.number(name, -360.0, 360.0))
    if pose:
        _check_line(table, "pose", lambda: tokens.pose(pose))
    return pose


def _skill(table: TomlTable, key: str) -> str:
    name = table.text(key)
    _check_line(table, key, lambda: tokens.skill(name))
    return name


def _skills(table: TomlTable, key: str) -> tuple[str, ...]:
    names = table.texts(key)
    for name in names:
        _check_line(table, key, partial(tokens.skill, name))
    return names


def _melody(table: TomlTable, key: str) -> Notes:
    notes = table.list(key, "[note, value] pairs")
    if not notes or not all(_is_note(note) for note in notes):
        raise table.unlike(key, "a list of [note, value] pairs")
    if not re.fullmatch(r"[\w -]+", key):
        raise table.wrong(key, "a sound's name is of letters, digits, spaces, - and _")
    melody = tuple((note, value) for note, value in notes)
    _check_line(table, key, lambda: tokens.melody(melody))
    return melody


def _is_note(note: Any) -> bool:
    pair = isinstance(note, list) and len(note) == 2
    return pair and all(type(number) is int and 0 <= number < 1000 for number in note)


def _check_line(table: TomlTable, key: str, make: Callable[[], bytes]) -> None:
    """Make a line for the board; raise its refusal with the place in the file."""
    try:
        make()
    except RobotError as error:
        raise table.wrong(key, str(error)) from error


def _merge(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` overridden by `over`, key by key; a mood with a posture is replaced whole."""
    merged = dict(base)
    for key, value in over.items():
        old = merged.get(key)
        deeper = isinstance(old, Mapping) and isinstance(value, Mapping) and "posture" not in value
        merged[key] = _merge(old, value) if deeper else value  # type: ignore[arg-type] # see above
    return merged
