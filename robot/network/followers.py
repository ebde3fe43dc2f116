"""The robots that follow a player, and the last action that each of them took."""

from dataclasses import dataclass

from cubeling.robot.network.endpoint import LOST_AFTER_S
from cubeling.robot.network.messages import StatusMessage
from cubeling.robot.network.topics import Member, Pattern

MAX_ROBOTS = 64
"""Most robots in a player's table."""


@dataclass
class Follower:
    """A robot that follows the player, as far as the player knows."""

    session: int
    """Epoch of its node."""

    status: str
    """ "online", "lost" or "closed"."""

    last_heartbeat: float
    """Time of its last heartbeat [s]."""

    taken: int = 0
    """Number of the last action of this session that it took."""


class Followers:
    """The table of the robots that follow one player."""

    def __init__(self, player: Member) -> None:
        self.robots: dict[Member, Follower] = {}
        """The known robots."""
        self._player = player

    def receive_status(self, robot: Member, status: StatusMessage, now: float) -> None:
        """Process a robot's status."""
        known = self.robots.get(robot)
        if known is not None and status.session < known.session:
            return  # of an earlier epoch
        if status.status != "online":
            if known is not None:
                known.session, known.status = status.session, status.status
        elif not any(self._includes_player(pattern) for pattern in status.follows):
            self.robots.pop(robot, None)
        elif known is not None:
            known.session, known.status, known.last_heartbeat = status.session, "online", now
        elif len(self.robots) < MAX_ROBOTS or self._remove_one():
            self.robots[robot] = Follower(status.session, "online", now)

    def acknowledge(self, robot: Member, number: int) -> bool:
        """Note the last action that a robot took; return whether it is a later one than before."""
        known = self.robots.get(robot)
        if known is None or number <= known.taken:
            return False
        known.taken = number
        return True

    def find_lost(self, now: float) -> None:
        """Mark the robots without heartbeat as lost."""
        for one in self.robots.values():
            if one.status == "online" and now - one.last_heartbeat > LOST_AFTER_S:
                one.status = "lost"

    def number_taken_by_all(self) -> int:
        """Return the number up to which all robots took the actions, also those that are lost."""
        taken = [one.taken for one in self.robots.values() if one.status != "closed"]
        return min(taken, default=0)

    def any_behind(self, number: int) -> bool:
        """Whether a robot that is online has not taken the action of this number."""
        return any(one.status == "online" and one.taken < number for one in self.robots.values())

    def restart_numbers(self) -> None:
        """Note that the player numbers its actions from 1 again."""
        for one in self.robots.values():
            one.taken = 0

    def _includes_player(self, pattern: str) -> bool:
        site, _, name = pattern.partition("/")
        return Pattern(site, name).matches(self._player)

    def _remove_one(self) -> bool:
        """Remove a robot that is not online, to make room; return whether there was one."""
        for robot, one in self.robots.items():
            if one.status != "online":
                del self.robots[robot]
                return True
        return False
