"""What was sent to the console so far, and the commands that a mood still needs.

It is what was sent, not what Pleo does: the console reports neither speeds nor angles.
"""

from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

from cubeling.robot.drivers.pleo import commands
from cubeling.robot.drivers.pleo.commands import Command
from cubeling.robot.drivers.pleo.joints import JOINTS
from cubeling.robot.drivers.pleo.settings import PleoMood

_MOVES = tuple(f"JOINT MOVE {number}" for number in range(len(JOINTS)))


class DeviceState:
    """The speeds, the volume and the angles that were sent; at first nothing is known."""

    def __init__(self) -> None:
        self._values: dict[str, int] = {}
        self._arrival: dict[str, float] = {}  # when a joint can have reached its angle [s]

    def has(self, command: Command) -> bool:
        """Return whether the value of this command is set already."""
        return command.sets is not None and self._values.get(command.sets[0]) == command.sets[1]

    def may_send(self, command: Command, now: float) -> bool:
        """Return whether a command may be sent: a joint must have reached its last angle."""
        return command.sets is None or now >= self._arrival.get(command.sets[0], now)

    def record_send(self, command: Command, now: float) -> None:
        """Record a command that is sent at time `now` [s]."""
        if command.sets is not None:
            self._set(*command.sets, now)
        elif command is commands.JOINT_NEUTRAL:
            for move in _MOVES:
                self._set(move, 0, now)

    def record_refusal(self, command: Command) -> None:
        """Forget the values of a command that was answered with an error."""
        if command.sets is not None:
            self._values.pop(command.sets[0], None)
        elif command is commands.JOINT_NEUTRAL:
            self.forget_angles()

    def forget_angles(self) -> None:
        """Forget the angles: a motion moves the joints anywhere."""
        for move in _MOVES:
            self._values.pop(move, None)
            self._arrival.pop(move, None)

    def moves_to(self, pose: Mapping[int, int]) -> list[Command]:
        """Return the commands that move every joint to its angle [°], or to 0 without one.

        There is at least one, so that the console has something to confirm.
        """
        known = any(move in self._values for move in _MOVES)
        moves = [commands.joint_move(joint, pose.get(joint, 0)) for joint in range(len(JOINTS))]
        if known:
            new = [move for move in moves if not self.has(move)]
            new.sort(key=lambda move: self._arrival.get(move.sets[0] if move.sets else "", 0.0))
            if new:
                return new
        named = [move for move in moves if move.sets and move.sets[1]]
        return named if known and named else [commands.JOINT_NEUTRAL, *named]

    def _set(self, name: str, value: int, now: float) -> None:
        if name in _MOVES:
            took = JOINTS[_MOVES.index(name)].time(self._values.get(name), value)
            self._arrival[name] = now + took
        self._values[name] = value


class CommandStep(NamedTuple):
    """One command of a mood or an action."""

    command: Command

    part: Literal["tone", "body", "sound", "action"]
    """tone: the speed of the motion. body: it shows the mood. sound: the sound of the mood.
    action: requested by `play`."""

    length: float = 0.0
    """Length of the motion that it starts [s]; 0 for none."""


def body_steps(mood: PleoMood | None, device: DeviceState, timeout: float) -> Iterator[CommandStep]:
    """Yield the steps of the body that show a mood, or, for None, take the neutral pose.

    Speeds and angles that are set already are not sent again; `timeout` is that of a PLAY [s].
    """
    if mood is None:
        yield CommandStep(commands.JOINT_NEUTRAL, "body")
    elif mood.motion is None:
        yield from (CommandStep(command, "body") for command in device.moves_to(mood.joints))
    else:
        speed = commands.motion_speed(mood.motion_speed)
        if not device.has(speed):
            yield CommandStep(speed, "tone")
        yield CommandStep(commands.motion_play(mood.motion.file, timeout), "body", mood.round)


def sound_steps(
    mood: PleoMood | None, device: DeviceState, timeout: float
) -> Iterator[CommandStep]:
    """Yield the steps of a mood's sound, if it has one; as for `body_steps`."""
    if mood is None or mood.sound is None:
        return
    for tone in (commands.sound_speed(mood.sound_speed), commands.sound_volume(mood.volume)):
        if not device.has(tone):
            yield CommandStep(tone, "sound")
    yield CommandStep(commands.sound_play(mood.sound, timeout), "sound")
