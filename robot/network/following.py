"""Who has a robot that several players follow with: the one who acted last."""

import math
from dataclasses import dataclass

from robot.network import messages as m
from robot.network.endpoint import SILENT_AFTER
from robot.network.topics import Member

PLAYERS_MAX = 32
"""Most players that one robot keeps account of; as many as fit into a message."""

HOLD = 5.0
"""A robot whose player is gone keeps its mood so long [s], then it is neutral."""


@dataclass
class Followed:
    """A player that a robot follows, as far as its node knows."""

    session: int
    """The run of the player's program."""

    taken: int | None = None
    """Number of the last action taken; None before the first."""

    beat: int = -1
    """Number of the last heartbeat."""

    online: bool = False
    """Whether it is there."""

    heard: float = -math.inf
    """When it last gave a sign of life [s]."""

    gone: float = -math.inf
    """When it was found not to be there [s]."""

    feeling: m.Feeling | None = None
    """What it feels."""

    felt: float = -math.inf
    """When it last said so [s]."""


class Following:
    """Keeps account of the players, and says whose feeling the robot shows.

    An action gives the robot to the player who did it. A robot that nobody has goes to the player
    who is there and whose feeling changed last. A player who is gone keeps it for `hold`.

    Parameters
    ----------
    hold
        How long a player who is gone keeps the robot [s].
    """

    def __init__(self, hold: float = HOLD) -> None:
        self.players: dict[Member, Followed] = {}
        """Those who are known."""
        self.holder: Member | None = None
        """Who has the robot."""
        self._hold = hold

    def player(self, member: Member, session: int, now: float) -> Followed | None:
        """Return the account of a player's session; None for an older session, or one too many."""
        known = self.players.get(member)
        if known is not None and session < known.session:
            return None
        if known is None and len(self.players) == PLAYERS_MAX and not self._forget_one():
            return None
        if known is None or session > known.session:
            fresh = Followed(session, gone=now)
            if known is not None:
                fresh.online, fresh.heard = known.online, known.heard
            known = self.players[member] = fresh
        return known

    def present(self, player: Followed, now: float) -> None:
        """Take a sign of life."""
        player.online, player.heard = True, now

    def absent(self, player: Followed, now: float) -> None:
        """Take note that a player is gone."""
        if player.online:
            player.online, player.gone = False, now

    def settle(self, now: float) -> m.Feeling | None:
        """Find who is silent and who has the robot; return what it should feel, if anybody says."""
        for player in self.players.values():
            if now - player.heard > SILENT_AFTER:
                self.absent(player, now)
        holding = None if self.holder is None else self.players.get(self.holder)
        if holding is None or (not holding.online and now - holding.gone >= self._hold):
            self.holder = self._next()
            holding = None if self.holder is None else self.players[self.holder]
        return None if holding is None else holding.feeling

    def _next(self) -> Member | None:
        """Return who is there and changed its feeling last."""
        feeling = [
            member for member, one in self.players.items() if one.online and one.feeling is not None
        ]
        return max(feeling, key=lambda member: self.players[member].felt, default=None)

    def _forget_one(self) -> bool:
        """Forget the player who has been gone longest, to make room; whether there was one."""
        gone = [
            member
            for member, one in self.players.items()
            if not one.online and member != self.holder
        ]
        if gone:
            del self.players[min(gone, key=lambda member: self.players[member].heard)]
        return bool(gone)
