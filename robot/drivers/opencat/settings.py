"""How each model shows each mood, read from TOML; what may not be sent is refused here already."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from robot.drivers.opencat import tokens
from robot.drivers.opencat.models import MODELS
from robot.drivers.opencat.table import Notes, Table
from robot.errors import RobotError
from robot.feeling.words import PLACES

BAUDS = (57600, 115200)
"""Bits a second that OpenCat boards speak at."""


@dataclass(frozen=True)
class Mood:
    """How a mood is shown."""

    posture: str
    """The skill that is held while the mood lasts."""

    pose: Mapping[int, int]
    """Angles [deg] by the joint's number, taken after the posture and within the joints' limits."""

    gestures: tuple[str, ...]
    """Skills played now and then, in turn."""

    gesture_every: float
    """Time from one gesture to the next [s]; 0 for no gestures."""

    sound: str | None
    """The melody played once when the mood begins."""


@dataclass(frozen=True)
class Behaviour:
    """How a model behaves."""

    moods: Mapping[str, Mood]
    """By the moods' words; "neutral" is the first one."""

    motions: tuple[str, ...]
    """Skills that may be played by name: those named for this, and every posture and gesture."""

    sounds: Mapping[str, Notes]
    """Melodies by name."""

    stop: str
    """The posture taken for a stop."""


@dataclass(frozen=True)
class Settings:
    """Everything that a settings file says."""

    baud: int
    """Bits a second on the serial line."""

    model: str | None
    """Which of `MODELS` it is, whatever the board says; None to ask the board."""

    commands_per_s: float
    """Most lines sent in a second."""

    dwell: float
    """Time from the end of one skill to the beginning of the next [s]."""

    ask_every: float
    """Time without an answer after which a question is asked [s]."""

    rest_after: float
    """Time without a new mood after which the servos lose their power [s]; 0 for never."""

    behaviours: Mapping[str, Behaviour]
    """By model, one for each of `MODELS`."""


def load(path: Path | None = None) -> Settings:
    """Read a settings file; what it does not say is as in the bundled one.

    Raises
    ------
    RobotError
        If it cannot be read, or says something that makes no sense or may not be sent.
    """
    if path is None:
        return settings_of({}, "opencat.toml")
    try:
        said = tomllib.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise RobotError(f"cannot read the settings {path}: {error}") from error
    return settings_of(said, str(path))


@cache
def _bundled() -> Mapping[str, Any]:
    return tomllib.loads(resources.files(__package__).joinpath("opencat.toml").read_text("utf-8"))


def settings_of(said: Mapping[str, Any], source: str) -> Settings:
    """Return the settings that a TOML document says, over the bundled ones."""
    document = Table(_merged(_bundled(), said), source, "")
    top = document.table("opencat")
    model = top.text("model")
    if model and model not in MODELS:
        raise top.wrong(f"model {model!r} is none of {', '.join(MODELS)}")
    baud = top.number("baud", min(BAUDS), max(BAUDS))
    if baud not in BAUDS:
        raise top.wrong(f"baud {baud:g} is none of {', '.join(map(str, BAUDS))}")
    settings = Settings(
        baud=int(baud),
        model=model or None,
        commands_per_s=top.number("commands_per_s", 0.1, 10.0),
        dwell=top.number("dwell_s", 0.5, 60.0),
        ask_every=top.number("ask_every_s", 1.0, 600.0),
        rest_after=top.number("rest_after_s", 0.0, 86400.0),
        behaviours={name: _behaviour(document.table(name), name) for name in MODELS},
    )
    top.end()
    document.end()
    return settings


def _behaviour(table: Table, model: str) -> Behaviour:
    sounds = {}
    told = table.table("sounds", {})
    for name in list(told.left):
        sounds[name] = told.melody(name)
    moods = {}
    listed = table.table("moods")
    for word in sorted(listed.left, key=lambda word: (word != "neutral", word)):
        if word not in PLACES:
            raise listed.wrong(f"{word!r} is no mood; there are {', '.join(PLACES)}")
        moods[word] = _mood(listed.table(word), model, sounds)
    if "neutral" not in moods:
        raise listed.wrong("'neutral' is missing")
    stop = table.skill("stop")
    motions = dict.fromkeys(table.skills("motions"))
    for mood in moods.values():
        motions |= dict.fromkeys((mood.posture, *mood.gestures))
    table.end()
    if both := motions.keys() & sounds.keys():
        raise table.wrong(f"{min(both)!r} is a skill and a sound; give the sound another name")
    return Behaviour(moods, tuple(motions), sounds, stop)


def _mood(table: Table, model: str, sounds: Mapping[str, Notes]) -> Mood:
    joints = {joint.name: joint for joint in MODELS[model]}
    pose = {}
    angles = table.table("pose", {})
    for name in list(angles.left):
        if name not in joints:
            known = ", ".join(joints) or "no joint that is known"
            raise angles.wrong(f"{name!r} is no joint; a {model} has {known}")
        pose[joints[name].number] = joints[name].clamped(angles.number(name, -360.0, 360.0))
    if pose:
        angles.may_send(lambda: tokens.pose(pose))
    sound = table.text("sound", "")
    if sound and sound not in sounds:
        raise table.wrong(f"there is no sound {sound!r}; there is {', '.join(sounds) or 'none'}")
    mood = Mood(
        posture=table.skill("posture"),
        pose=pose,
        gestures=table.skills("gestures"),
        gesture_every=table.number("gesture_every_s", 0.0, 3600.0, 0.0),
        sound=sound or None,
    )
    if 0 < mood.gesture_every < 5:
        raise table.wrong("gesture_every_s must be 0, or 5 at least: servos get hot")
    table.end()
    return mood


def _merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with what `over` says, table by table; a mood that names a posture whole."""
    merged = dict(base)
    for key, value in over.items():
        old = merged.get(key)
        deeper = isinstance(old, Mapping) and isinstance(value, Mapping) and "posture" not in value
        merged[key] = _merged(old, value) if deeper else value  # type: ignore[arg-type] # see above
    return merged
