"""The robots that follow a player, and how far each has taken its actions."""

from dataclasses import dataclass

from robot.network import messages as m
from robot.network.endpoint import SILENT_AFTER
from robot.network.topics import Member, Pattern

ROBOTS_MAX = 64
"""Most robots that one player keeps account of."""


@dataclass
class Follower:
    """A robot that follows the player, as far as the player knows."""

    session: int
    """The run of its node."""

    status: str
    """"online", "lost" or "closed"."""

    heard: float
    """When it last said that it was there [s]."""

    taken: int = 0
    """Number of the last action of this session that it has taken."""


class Followers:
    """Keeps account of the robots that follow one player.

    Parameters
    ----------
    player
        The player.
    """

    def __init__(self, player: Member) -> None:
        self.robots: dict[Member, Follower] = {}
        """Those that are known."""
        self._player = player

    def hear(self, robot: Member, status: m.Status, now: float) -> None:
        """Take note of what a robot says of itself."""
        known = self.robots.get(robot)
        if known is not None and status.session < known.session:
            return  # of a run that is over
        if status.status != "online":
            if known is not None:
                known.session, known.status = status.session, status.status
        elif not any(self._is_meant(pattern) for pattern in status.follows):
            self.robots.pop(robot, None)
        elif known is not None:
            known.session, known.status, known.heard = status.session, "online", now
        elif len(self.robots) < ROBOTS_MAX or self._forget_one():
            self.robots[robot] = Follower(status.session, "online", now)

    def acknowledge(self, robot: Member, number: int) -> bool:
        """Take note of how far a robot has got; whether that is further than it was."""
        known = self.robots.get(robot)
        if known is None or number <= known.taken:
            return False
        known.taken = number
        return True

    def settle(self, now: float) -> None:
        """Find who is silent."""
        for one in self.robots.values():
            if one.status == "online" and now - one.heard > SILENT_AFTER:
                one.status = "lost"

    def done(self) -> int:
        """Return the number up to which all have taken the actions; a lost one is waited for."""
        taken = [one.taken for one in self.robots.values() if one.status != "closed"]
        return min(taken, default=0)

    def is_behind(self, number: int) -> bool:
        """Whether one that is there has not taken the action of this number."""
        return any(one.status == "online" and one.taken < number for one in self.robots.values())

    def begin_anew(self) -> None:
        """Take note that the player counts from 1 again."""
        for one in self.robots.values():
            one.taken = 0

    def _is_meant(self, pattern: str) -> bool:
        site, _, name = pattern.partition("/")
        return Pattern(site, name).matches(self._player)

    def _forget_one(self) -> bool:
        """Forget a robot that is not there, to make room; whether there was one."""
        gone = [robot for robot, one in self.robots.items() if one.status != "online"]
        for robot in gone[:1]:
            del self.robots[robot]
        return bool(gone)
