"""What the console has been told so far, so that nothing is told twice, or sooner than it can be.

It is what was sent, not what Pleo does: the console tells neither speeds nor angles.
"""

from collections.abc import Mapping

from robot.drivers.pleo import commands
from robot.drivers.pleo.commands import Command
from robot.drivers.pleo.joints import JOINTS

_MOVES = tuple(f"JOINT MOVE {number}" for number in range(len(JOINTS)))


class Known:
    """Speeds, volume and angles by what sets them; nothing is known at first."""

    def __init__(self) -> None:
        self._values: dict[str, int] = {}
        self._there_at: dict[str, float] = {}  # when a joint can be where it was sent [s]

    def holds(self, command: Command) -> bool:
        """Whether what this command would set is known to be set."""
        return command.sets is not None and self._values.get(command.sets[0]) == command.sets[1]

    def free(self, command: Command, now: float) -> bool:
        """Whether it may be sent now: a joint gets no new angle before it can be at the last."""
        return command.sets is None or now >= self._there_at.get(command.sets[0], now)

    def sent(self, command: Command, now: float) -> None:
        """Write down what a command does that is sent at time `now` [s]."""
        if command.sets is not None:
            self._set(*command.sets, now)
        elif command is commands.JOINT_NEUTRAL:
            for move in _MOVES:
                self._set(move, 0, now)

    def refused(self, command: Command) -> None:
        """Forget what a command has set, which was answered with an error."""
        if command.sets is not None:
            self._values.pop(command.sets[0], None)
        elif command is commands.JOINT_NEUTRAL:
            self.motion_played()

    def motion_played(self) -> None:
        """Forget the pose: a motion takes the joints wherever it likes."""
        for move in _MOVES:
            self._values.pop(move, None)
            self._there_at.pop(move, None)

    def way_to(self, pose: Mapping[int, int]) -> list[Command]:
        """Return the commands that take every joint to its angle [°], or to 0 if it has none.

        There is always one, so that the console has something to confirm.
        """
        known = any(move in self._values for move in _MOVES)
        moves = [commands.joint_move(joint, pose.get(joint, 0)) for joint in range(len(JOINTS))]
        if known:
            new = [move for move in moves if not self.holds(move)]
            new.sort(key=lambda move: self._there_at.get(move.sets[0] if move.sets else "", 0.0))
            if new:
                return new
        named = [move for move in moves if move.sets and move.sets[1]]
        return named if known and named else [commands.JOINT_NEUTRAL, *named]

    def _set(self, what: str, value: int, now: float) -> None:
        if what in _MOVES:
            took = JOINTS[_MOVES.index(what)].time(self._values.get(what), value)
            self._there_at[what] = now + took
        self._values[what] = value
