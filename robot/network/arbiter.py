"""Which of several players a robot shows: the one who acted last."""

import math
from dataclasses import dataclass

from cubeling.robot.network.endpoint import LOST_AFTER_S
from cubeling.robot.network.messages import EmotionMessage
from cubeling.robot.network.topics import Member

MAX_PLAYERS = 32
"""Most players in a robot's table; as many as fit into a message."""

HOLD_S = 5.0
"""Time for which a robot shows the emotion of a player who is gone, before it is neutral [s]."""


@dataclass
class FollowedPlayer:
    """A player that a robot follows, as far as its node knows."""

    session: int
    """Epoch of the player's program."""

    taken: int | None = None
    """Number of the last action taken; None before the first."""

    heartbeat: int = -1
    """Number of the last heartbeat."""

    online: bool = False
    """Whether the player is online."""

    last_seen: float = -math.inf
    """Time of the last heartbeat or action [s]."""

    offline_since: float = -math.inf
    """When the player was found to be offline [s]."""

    emotion: EmotionMessage | None = None
    """The last emotion that it sent; None before the first."""

    emotion_changed: float = -math.inf
    """When it arrived [s]."""


class PlayerArbiter:
    """The table of the players that one robot follows; selects the active one.

    A player becomes active by an action. If there is no active player, the one who is online and
    whose emotion changed last becomes active. A player who is gone stays active for `hold` [s].
    """

    def __init__(self, hold: float = HOLD_S) -> None:
        self.players: dict[Member, FollowedPlayer] = {}
        """The known players."""
        self.active: Member | None = None
        """The player whose emotion the robot shows."""
        self._hold = hold

    def player(self, member: Member, session: int, now: float) -> FollowedPlayer | None:
        """Return the entry of a player's session; None for an older session, or a full table."""
        known = self.players.get(member)
        if known is not None and session < known.session:
            return None
        if known is None and len(self.players) == MAX_PLAYERS and not self._remove_one():
            return None
        if known is None or session > known.session:
            new = FollowedPlayer(session, offline_since=now)
            if known is not None:
                new.online, new.last_seen = known.online, known.last_seen
            known = self.players[member] = new
        return known

    def set_offline(self, player: FollowedPlayer, now: float) -> None:
        """Note that a player is gone."""
        if player.online:
            player.online, player.offline_since = False, now

    def select(self, now: float) -> EmotionMessage | None:
        """Select the active player, and return the emotion to show; None if there is none."""
        for player in self.players.values():
            if now - player.last_seen > LOST_AFTER_S:
                self.set_offline(player, now)
        active = None if self.active is None else self.players.get(self.active)
        if active is None or (not active.online and now - active.offline_since >= self._hold):
            self.active = self._next()
            active = None if self.active is None else self.players[self.active]
        return None if active is None else active.emotion

    def _next(self) -> Member | None:
        """Return the player who is online and changed the emotion last."""
        players = self.players
        online = [member for member, one in players.items() if one.online and one.emotion]
        return max(online, key=lambda member: players[member].emotion_changed, default=None)

    def _remove_one(self) -> bool:
        """Remove the player who is gone longest, to make room; return whether there was one."""
        players, active = self.players, self.active
        gone = [member for member, one in players.items() if not one.online and member != active]
        if gone:
            del players[min(gone, key=lambda member: players[member].last_seen)]
        return bool(gone)
