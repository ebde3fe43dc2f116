"""Every command that the driver can send; nothing else reaches the console.

None of them writes to Pleo's internal flash, formats, or restarts: a full flash makes it a brick.
A test compares these functions with a list.
"""

from dataclasses import dataclass

from cubeling.robot.drivers.pleo import timing


@dataclass(frozen=True)
class Command:
    """One line for the console."""

    text: str
    """The line without its end."""

    timeout: float = timing.SHORT_TIMEOUT_S
    """Time for its prompt [s]."""

    sets: tuple[str, int] | None = None
    """The value that it sets, if any: ("MOTION SPEED", 100), ("JOINT MOVE 8", -10)."""

    @property
    def line(self) -> bytes:
        """The bytes on the wire."""
        return f"{self.text}\n".encode("latin-1")


NUDGE = Command("", timing.SEARCH_INTERVAL_S)
"""An empty line: it has no effect, and is answered by a prompt."""

APP_UNLOAD = Command("APP UNLOAD", timing.LONG_TIMEOUT_S)
"""Ends Pleo's own behaviour."""

JOINT_NEUTRAL = Command("JOINT NEUTRAL", timing.LONG_TIMEOUT_S)
"""Moves every joint to zero."""

STATS_POWER = Command("STATS POWER")
"""Reports the battery level, among others."""


def joint_move(joint: int, degrees: int) -> Command:
    """Move a joint; the prompt does not wait for the end of the move."""
    return _setting(f"JOINT MOVE {joint}", degrees)


def motion_speed(percent: int) -> Command:
    """Set the speed of motions."""
    return _setting("MOTION SPEED", percent)


def sound_speed(percent: int) -> Command:
    """Set the speed of sounds."""
    return _setting("SOUND SPEED", percent)


def sound_volume(percent: int) -> Command:
    """Set the volume of sounds."""
    return _setting("SOUND VOLUME", percent)


def motion_play(name: str, timeout: float) -> Command:
    """Play the file of a motion from its start; a repetition starts it again."""
    return Command(f"MOTION PLAY {name}", timeout)


def sound_play(name: str, timeout: float) -> Command:
    """Play the file of a sound from its start; a repetition starts it again."""
    return Command(f"SOUND PLAY {name}", timeout)


def _setting(name: str, value: int) -> Command:
    return Command(f"{name} {value}", sets=(name, value))
