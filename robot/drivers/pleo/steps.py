"""The commands that it takes to show a mood, and what each of them is for."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

from robot.drivers.pleo import commands
from robot.drivers.pleo.commands import Command
from robot.drivers.pleo.known import Known
from robot.drivers.pleo.settings import Mood


class Step(NamedTuple):
    """One command, and what it is for."""

    command: Command
    """What is sent."""

    part: Literal["tone", "body", "sound", "action"]
    """tone: the motion's speed. body: what shows a mood. sound: what goes with it. action: what
    `play` asked for."""

    length: float = 0.0
    """How long a motion that it starts lasts [s]; 0 if it starts none."""


def body_steps(mood: Mood | None, known: Known, within: float) -> Iterator[Step]:
    """Yield what makes the body show a mood, or, for None, take the neutral pose.

    Parameters
    ----------
    mood
        The mood.
    known
        What the console has been told, so that no speed and no angle is told twice.
    within
        How long the answer to a PLAY may take [s].
    """
    if mood is None:
        yield Step(commands.JOINT_NEUTRAL, "body")
    elif mood.motion is None:
        yield from (Step(command, "body") for command in known.way_to(mood.joints))
    else:
        speed = commands.motion_speed(mood.motion_speed)
        if not known.holds(speed):
            yield Step(speed, "tone")
        yield Step(commands.motion_play(mood.motion.file, within), "body", mood.round)


def sound_steps(mood: Mood | None, known: Known, within: float) -> Iterator[Step]:
    """Yield what makes the sound that goes with a mood, if one does; as for `body_steps`."""
    if mood is None or mood.sound is None:
        return
    for tone in (commands.sound_speed(mood.sound_speed), commands.sound_volume(mood.volume)):
        if not known.holds(tone):
            yield Step(tone, "sound")
    yield Step(commands.sound_play(mood.sound, within), "sound")
