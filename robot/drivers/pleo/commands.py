"""Every command that the driver can send. There is no other way to the console.

Nothing here writes to Pleo's internal flash, formats, or restarts: a full flash makes it a brick.
A test holds these functions against a list.
"""

from dataclasses import dataclass

from robot.drivers.pleo import timing


@dataclass(frozen=True)
class Command:
    """One line for the console."""

    text: str
    """What it says, without its end."""

    within: float = timing.SHORT_WITHIN
    """How long to wait for its prompt [s]."""

    sets: tuple[str, int] | None = None
    """What it sets to which number, if it does: ("MOTION SPEED", 100), ("JOINT MOVE 8", -10)."""

    @property
    def line(self) -> bytes:
        """The bytes on the wire."""
        return f"{self.text}\n".encode("latin-1")


NUDGE = Command("", timing.SEEK_EVERY)
"""An empty line: does nothing, and is answered by a prompt."""

APP_UNLOAD = Command("APP UNLOAD", timing.LONG_WITHIN)
"""Ends Pleo's own behaviour."""

JOINT_NEUTRAL = Command("JOINT NEUTRAL", timing.LONG_WITHIN)
"""Takes every joint to zero."""

STATS_POWER = Command("STATS POWER")
"""Tells, among much else, how full the battery is."""


def joint_move(joint: int, degrees: int) -> Command:
    """Send a joint on its way; the prompt does not wait until it is there."""
    return _setting(f"JOINT MOVE {joint}", degrees)


def motion_speed(percent: int) -> Command:
    """Set how fast motions are played."""
    return _setting("MOTION SPEED", percent)


def sound_speed(percent: int) -> Command:
    """Set how fast sounds are played."""
    return _setting("SOUND SPEED", percent)


def sound_volume(percent: int) -> Command:
    """Set how loud sounds are."""
    return _setting("SOUND VOLUME", percent)


def motion_play(name: str, within: float) -> Command:
    """Play a motion's file from its beginning, so that twice is not the same as once."""
    return Command(f"MOTION PLAY {name}", within)


def sound_play(name: str, within: float) -> Command:
    """Play a sound's file from its beginning, so that twice is not the same as once."""
    return Command(f"SOUND PLAY {name}", within)


def _setting(what: str, value: int) -> Command:
    return Command(f"{what} {value}", sets=(what, value))
