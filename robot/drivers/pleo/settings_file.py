"""Reads the settings from TOML; refuses what cannot be, in one line that says where and why."""

from pathlib import Path

from affect.settings import Table, read
from robot.contract.catalogue import MAX_NAME_BYTES
from robot.drivers.pleo import timing
from robot.drivers.pleo.joints import JOINT_NUMBERS, JOINTS
from robot.drivers.pleo.settings import BUNDLED, Clip, Mood, Settings
from robot.errors import RobotError

FILE_MAX = 64
"""Longest name of a file on Pleo [characters]."""


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
    top = Table(read(path, RobotError), str(path), error=RobotError)
    top.only("console", "moods", "motions", "sounds")
    console = top.table("console")
    console.only("volume", "battery_every_s", "mood_every_s", "play_within_s", "boot_text")
    volume = console.whole("volume", 0, 100, 70)
    moods = top.tables("moods", longest=MAX_NAME_BYTES)
    if "neutral" not in moods:
        raise top.wrong("moods", "there must be a mood called neutral: write [moods.neutral]")
    named = {name: _mood(table, volume) for name, table in moods.items()}
    motions = {
        name: _clip(table) for name, table in top.tables("motions", longest=MAX_NAME_BYTES).items()
    }
    sounds = top.table("sounds")
    names = sounds.names(MAX_NAME_BYTES)
    both = set(motions) & set(names)
    if both:
        raise sounds.wrong(min(both), "a motion has this name too; call one of them otherwise")
    return Settings(
        moods={"neutral": named.pop("neutral"), **named},
        motions=motions,
        sounds={name: _file(sounds, name) for name in names},
        volume=volume,
        battery_every=console.number("battery_every_s", 1, 3600, 30.0),
        mood_every=console.number("mood_every_s", 0, 60, 0.5),
        play_within=console.number("play_within_s", 0.5, 60, timing.LONG_WITHIN),
        boot_text=console.texts("boot_text", ("Pleo Monitor", "Booting")),
    )


def _mood(table: Table, volume: int) -> Mood:
    table.only(
        "motion", "length_s", "loop", "motion_speed", "joints", "sound", "sound_speed", "volume"
    )
    if ("motion" in table) == ("joints" in table):
        raise table.wrong("motion", "a mood needs either a motion or joints")
    if "joints" in table and any(key in table for key in ("length_s", "loop", "motion_speed")):
        raise table.wrong("joints", "length_s, loop and motion_speed are for a motion")
    motion = None
    if "motion" in table:
        motion = Clip(_file(table, "motion"), table.number("length_s", 0.5, 600))
    return Mood(
        motion=motion,
        loop=table.truth("loop", True),
        motion_speed=table.whole("motion_speed", 1, 200, 100),
        joints=_joints(table.table("joints")),
        sound=_file(table, "sound") if "sound" in table else None,
        sound_speed=table.whole("sound_speed", 1, 200, 100),
        volume=table.whole("volume", 0, 100, volume),
    )


def _joints(table: Table) -> dict[int, int]:
    angles = {}
    for name in table.names():
        if name not in JOINT_NUMBERS:
            raise table.wrong(
                name, f"no joint is called that; there are {', '.join(JOINT_NUMBERS)}"
            )
        joint = JOINTS[JOINT_NUMBERS[name]]
        angles[JOINT_NUMBERS[name]] = joint.nearest(table.number(name, joint.low, joint.high))
    return angles


def _clip(table: Table) -> Clip:
    table.only("file", "length_s")
    return Clip(_file(table, "file"), table.number("length_s", 0.1, 600))


def _file(table: Table, key: str) -> str:
    """Return the name of a file on Pleo: one word of ISO-8859-1, so that it is one argument."""
    name = table.text(key)
    if not _is_word(name):
        allowed = f"one word of 1 to {FILE_MAX} printable characters of ISO-8859-1"
        raise table.unlike(key, allowed)
    return name


def _is_word(text: str) -> bool:
    if not 1 <= len(text) <= FILE_MAX or any(one.isspace() for one in text):
        return False
    return text.isprintable() and max(map(ord, text)) <= 0xFF
