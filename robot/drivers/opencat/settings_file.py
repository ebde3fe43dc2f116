"""Reads the settings from TOML; what may not be sent to a board is refused here already."""

import re
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

from affect.settings import Table, read, shown
from affect.words import PLACES
from robot.contract.catalogue import MAX_NAME_BYTES
from robot.drivers.opencat import tokens
from robot.drivers.opencat.models import MODELS
from robot.drivers.opencat.settings import BAUDS, Behaviour, Mood, Notes, Settings
from robot.errors import RobotError

BUNDLED = Path(__file__).with_name("opencat.toml")
"""The settings over which a person's own are laid."""

GESTURES_APART = 5.0
"""Gestures follow each other no faster [s]."""


def load_settings(path: Path | None = None) -> Settings:
    """Read a settings file; what it does not say is as in the bundled one.

    Raises
    ------
    RobotError
        If it cannot be read, or says something that makes no sense or may not be sent.
    """
    if path is None:
        return settings_of({}, BUNDLED.name)
    return settings_of(read(path, RobotError), str(path))


@cache
def _bundled() -> Mapping[str, Any]:
    return read(BUNDLED, RobotError)


def settings_of(said: Mapping[str, Any], source: str) -> Settings:
    """Return the settings that a TOML document says, over the bundled ones."""
    document = Table(_merged(_bundled(), said), source, error=RobotError)
    document.only("opencat", *MODELS)
    top = document.table("opencat")
    top.only("baud", "model", "commands_per_s", "dwell_s", "ask_every_s", "rest_after_s")
    model = top.text("model")
    if model and model not in MODELS:
        raise top.unlike("model", f"one of {', '.join(MODELS)}")
    baud = top.whole("baud", min(BAUDS), max(BAUDS))
    if baud not in BAUDS:
        raise top.unlike("baud", f"one of {', '.join(map(str, BAUDS))}")
    return Settings(
        baud=baud,
        model=model or None,
        commands_per_s=top.number("commands_per_s", 0.1, 10.0),
        dwell=top.number("dwell_s", 0.5, 60.0),
        ask_every=top.number("ask_every_s", 1.0, 600.0),
        rest_after=top.number("rest_after_s", 0.0, 86400.0),
        behaviours={name: _behaviour(document.table(name), name) for name in MODELS},
    )


def _behaviour(table: Table, model: str) -> Behaviour:
    table.only("stop", "motions", "sounds", "moods")
    told = table.table("sounds")
    sounds = {name: _melody(told, name) for name in told.names(MAX_NAME_BYTES)}
    listed = table.table("moods")
    moods = {}
    for word in sorted(listed.names(), key=lambda word: (word != "neutral", word)):
        if word not in PLACES:
            raise listed.wrong(word, f"no mood is called that; there are {', '.join(PLACES)}")
        moods[word] = _mood(listed.table(word), model, sounds)
    if "neutral" not in moods:
        raise listed.unlike("neutral", "there, for every robot shows it")
    stop = _skill(table, "stop")
    motions = dict.fromkeys(_skills(table, "motions"))
    for mood in moods.values():
        motions |= dict.fromkeys((mood.posture, *mood.gestures))
    if both := motions.keys() & sounds.keys():
        raise told.wrong(min(both), "a skill has this name too; give the sound another name")
    return Behaviour(moods, tuple(motions), sounds, stop)


def _mood(table: Table, model: str, sounds: Mapping[str, Notes]) -> Mood:
    table.only("posture", "pose", "gestures", "gesture_every_s", "sound")
    sound = table.text("sound", "")
    if sound and sound not in sounds:
        there = ", ".join(sounds) or "none"
        raise table.wrong("sound", f"there is no sound {shown(sound)}; there is {there}")
    mood = Mood(
        posture=_skill(table, "posture"),
        pose=_pose(table, model),
        gestures=_skills(table, "gestures"),
        gesture_every=table.number("gesture_every_s", 0.0, 3600.0, 0.0),
        sound=sound or None,
    )
    if 0 < mood.gesture_every < GESTURES_APART:
        raise table.unlike("gesture_every_s", f"0, or at least {GESTURES_APART:g}: servos get hot")
    return mood


def _pose(table: Table, model: str) -> Mapping[int, int]:
    joints = {joint.name: joint for joint in MODELS[model]}
    angles = table.table("pose")
    pose = {}
    for name in angles.names():
        if name not in joints:
            known = ", ".join(joints) or "none that is known"
            raise angles.wrong(name, f"no joint is called that; a {model} has {known}")
        pose[joints[name].number] = joints[name].clamped(angles.number(name, -360.0, 360.0))
    if pose:
        _may_send(table, "pose", lambda: tokens.pose(pose))
    return pose


def _skill(table: Table, key: str) -> str:
    """Return the name of a skill that may be sent."""
    name = table.text(key)
    _may_send(table, key, lambda: tokens.skill(name))
    return name


def _skills(table: Table, key: str) -> tuple[str, ...]:
    names = table.texts(key)
    for name in names:
        _may_send(table, key, partial(tokens.skill, name))
    return names


def _melody(table: Table, key: str) -> Notes:
    """Return a melody that may be sent."""
    notes = table.list(key, "[note, value] pairs")
    if not notes or not all(_is_note(note) for note in notes):
        raise table.unlike(key, "a list of [note, value] pairs")
    if not re.fullmatch(r"[\w -]+", key):
        raise table.wrong(key, "a sound's name is of letters, digits, spaces, - and _")
    melody = tuple((note, value) for note, value in notes)
    _may_send(table, key, lambda: tokens.melody(melody))
    return melody


def _is_note(note: Any) -> bool:
    pair = isinstance(note, list) and len(note) == 2
    return pair and all(type(one) is int and 0 <= one < 1000 for one in note)


def _may_send(table: Table, key: str, make: Callable[[], bytes]) -> None:
    """Try to make a line for the board, and say where its refusal comes from."""
    try:
        make()
    except RobotError as error:
        raise table.wrong(key, str(error)) from error


def _merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with what `over` says, table by table; a mood that names a posture whole."""
    merged = dict(base)
    for key, value in over.items():
        old = merged.get(key)
        deeper = isinstance(old, Mapping) and isinstance(value, Mapping) and "posture" not in value
        merged[key] = _merged(old, value) if deeper else value  # type: ignore[arg-type] # see above
    return merged
