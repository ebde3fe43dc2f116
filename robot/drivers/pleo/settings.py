"""The settings: what Pleo plays for each mood."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from cubeling.robot.contract.catalogue import MAX_NAME_BYTES, Catalogue
from cubeling.robot.drivers.pleo import timing
from cubeling.robot.drivers.pleo.joints import JOINT_NUMBERS, JOINTS
from cubeling.robot.errors import RobotError
from cubeling.toml_file import TomlTable, read, toml_kind

SETTINGS_FILE = toml_kind(
    "Pleo settings", RobotError, "cubeling.robot.drivers.pleo.settings:load_settings"
)
"""A file of settings."""

BUNDLED_SETTINGS = Path(__file__).with_name("pleo.toml")
"""The bundled settings; a person's own file replaces them."""

MAX_FILE_NAME_CHARS = 64
"""Longest name of a file on Pleo [characters]."""


@dataclass(frozen=True)
class MotionFile:
    """A motion file and its length."""

    file: str
    """Its name in Pleo's memory or on the SD card, "a:happy.umf"."""

    length: float
    """Its length at full speed [s]."""


@dataclass(frozen=True)
class PleoMood:
    """How a mood is shown: by a motion or by a pose, optionally with a sound."""

    motion: MotionFile | None = None
    """The motion; None for a pose."""

    loop: bool = True
    """Whether the motion is repeated."""

    motion_speed: int = 100
    """Speed of the motion [%]."""

    joints: Mapping[int, int] = field(default_factory=lambda: MappingProxyType({}))
    """The pose: angles [°] by joint number, within limits and on steps; all others are 0."""

    sound: str | None = None
    """A sound file that is played once when the mood begins."""

    sound_speed: int = 100
    """Speed of the sound [%]."""

    volume: int = 70
    """Volume of the sound [%]."""

    @property
    def round(self) -> float:
        """Length of the motion at its speed [s]; 0 for a pose."""
        return 0.0 if self.motion is None else self.motion.length * 100.0 / self.motion_speed


@dataclass(frozen=True)
class PleoSettings:
    """What a settings file of a Pleo says, checked; defaults come from the bundled file."""

    moods: Mapping[str, PleoMood]
    """The moods by word, neutral first."""

    motions: Mapping[str, MotionFile]
    """The motions of `play`, by name."""

    sounds: Mapping[str, str]
    """The sound files of `play`, by name."""

    volume: int = 70
    """Volume that is set when a session begins [%]."""

    battery_every: float = 30.0
    """Interval at which the battery is read [s]."""

    mood_every: float = 0.5
    """Shortest time between two moods [s]."""

    play_within: float = timing.LONG_TIMEOUT_S
    """Time for the answer to a PLAY [s]."""

    boot_text: tuple[str, ...] = ("Pleo Monitor", "Booting")
    """Texts of which one is in a line after a restart. Assumed: no source has Pleo's own."""

    @property
    def catalogue(self) -> Catalogue:
        """The catalogue, as far as it is known: the console does not report one."""
        return Catalogue(
            name="Pleo",
            firmware="Pleo Monitor",
            joints=tuple(joint.limits for joint in JOINTS),
            motions=tuple(self.motions),
            sounds=tuple(self.sounds),
            moods=tuple(self.moods),
        )


def load_settings(path: Path | None = None) -> PleoSettings:
    """Return the settings in a TOML file; None for the bundled file.

    Raises RobotError if it cannot be read, is not TOML, or a value is wrong.
    """
    path = BUNDLED_SETTINGS if path is None else path
    top = TomlTable(read(path, SETTINGS_FILE), str(path), error=RobotError)
    top.only("console", "moods", "motions", "sounds")
    console = top.table("console")
    console.only("volume", "battery_every_s", "mood_every_s", "play_within_s", "boot_text")
    volume = console.whole("volume", 0, 100, 70)
    tables = top.tables("moods", longest=MAX_NAME_BYTES)
    if "neutral" not in tables:
        raise top.wrong("moods", "there must be a mood called neutral: write [moods.neutral]")
    moods = {name: _mood(table, volume) for name, table in tables.items()}
    files = top.tables("motions", longest=MAX_NAME_BYTES)
    motions = {name: _motion_file(table) for name, table in files.items()}
    sounds = top.table("sounds")
    names = sounds.names(MAX_NAME_BYTES)
    both = set(motions) & set(names)
    if both:
        raise sounds.wrong(min(both), "a motion has this name too; call one of them otherwise")
    return PleoSettings(
        moods={"neutral": moods.pop("neutral"), **moods},
        motions=motions,
        sounds={name: _file(sounds, name) for name in names},
        volume=volume,
        battery_every=console.number("battery_every_s", 1, 3600, 30.0),
        mood_every=console.number("mood_every_s", 0, 60, 0.5),
        play_within=console.number("play_within_s", 0.5, 60, timing.LONG_TIMEOUT_S),
        boot_text=console.texts("boot_text", ("Pleo Monitor", "Booting")),
    )


def _mood(table: TomlTable, volume: int) -> PleoMood:
    table.only(
        "motion", "length_s", "loop", "motion_speed", "joints", "sound", "sound_speed", "volume"
    )
    if ("motion" in table) == ("joints" in table):
        raise table.wrong("motion", "a mood needs either a motion or joints")
    if "joints" in table and any(key in table for key in ("length_s", "loop", "motion_speed")):
        raise table.wrong("joints", "length_s, loop and motion_speed are for a motion")
    motion = None
    if "motion" in table:
        motion = MotionFile(_file(table, "motion"), table.number("length_s", 0.5, 600))
    return PleoMood(
        motion=motion,
        loop=table.truth("loop", True),
        motion_speed=table.whole("motion_speed", 1, 200, 100),
        joints=_joints(table.table("joints")),
        sound=_file(table, "sound") if "sound" in table else None,
        sound_speed=table.whole("sound_speed", 1, 200, 100),
        volume=table.whole("volume", 0, 100, volume),
    )


def _joints(table: TomlTable) -> dict[int, int]:
    angles = {}
    for name in table.names():
        if name not in JOINT_NUMBERS:
            known = ", ".join(JOINT_NUMBERS)
            raise table.wrong(name, f"no joint is called that; there are {known}")
        joint = JOINTS[JOINT_NUMBERS[name]]
        angles[JOINT_NUMBERS[name]] = joint.nearest(table.number(name, joint.low, joint.high))
    return angles


def _motion_file(table: TomlTable) -> MotionFile:
    table.only("file", "length_s")
    return MotionFile(_file(table, "file"), table.number("length_s", 0.1, 600))


def _file(table: TomlTable, key: str) -> str:
    """Return a file name: one word of ISO-8859-1, so that it is one argument of a command."""
    name = table.text(key)
    if (
        not 1 <= len(name) <= MAX_FILE_NAME_CHARS
        or any(char.isspace() for char in name)
        or not name.isprintable()
        or max(map(ord, name)) > 0xFF
    ):
        allowed = f"one word of 1 to {MAX_FILE_NAME_CHARS} printable characters of ISO-8859-1"
        raise table.unlike(key, allowed)
    return name
