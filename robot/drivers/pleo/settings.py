"""What Pleo plays for each mood: the settings, as they are used."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from robot.contract.catalogue import Catalogue
from robot.drivers.pleo import timing
from robot.drivers.pleo.joints import JOINTS

BUNDLED = Path(__file__).with_name("pleo.toml")
"""The settings that are used where a person gives none."""


@dataclass(frozen=True)
class Clip:
    """A motion's file and how long it lasts."""

    file: str
    """Its name in Pleo's memory or on the SD card, "a:happy.umf"."""

    length: float
    """How long it lasts at full speed [s]."""


@dataclass(frozen=True)
class Mood:
    """How one mood shows: by a motion or by a pose, perhaps with a sound."""

    motion: Clip | None = None
    """What the body plays; None where it takes a pose."""

    loop: bool = True
    """Whether the motion is played again when it has ended."""

    motion_speed: int = 100
    """How fast it is played [%]."""

    joints: Mapping[int, int] = field(default_factory=lambda: MappingProxyType({}))
    """The pose: angles [°] by the joints' numbers, within limits and on steps; others are 0."""

    sound: str | None = None
    """A sound's file, played once when the mood begins."""

    sound_speed: int = 100
    """How fast it is played [%]."""

    volume: int = 70
    """How loud it is played [%]."""

    @property
    def round(self) -> float:
        """How long one round of its motion takes [s]; 0 for a pose."""
        return 0.0 if self.motion is None else self.motion.length * 100.0 / self.motion_speed


@dataclass(frozen=True)
class Settings:
    """All of it."""

    moods: Mapping[str, Mood]
    """The moods by name, neutral first."""

    motions: Mapping[str, Clip]
    """What `play` can play, by name."""

    sounds: Mapping[str, str]
    """Sounds' files that `play` can play, by name."""

    volume: int = 70
    """How loud Pleo is at first [%]."""

    battery_every: float = 30.0
    """How often the battery is asked for [s]."""

    mood_every: float = 0.5
    """Shortest time between two moods [s]."""

    play_within: float = timing.LONG_WITHIN
    """How long the answer to a PLAY may take before it is asked for [s]."""

    boot_text: tuple[str, ...] = ("Pleo Monitor", "Booting")
    """Texts of which one stands in a line when the console has just started. Assumed: no source
    tells Pleo's own."""

    @property
    def catalogue(self) -> Catalogue:
        """What the robot has, as far as it can be known: the console does not tell."""
        return Catalogue(
            name="Pleo",
            firmware="Pleo Monitor",
            joints=tuple(joint.limits for joint in JOINTS),
            motions=tuple(self.motions),
            sounds=tuple(self.sounds),
            moods=tuple(self.moods),
        )
