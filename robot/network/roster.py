"""The members that are online: an observer of the whole network, or of one site."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from cubeling.robot.network.endpoint import LOST_AFTER_S, Endpoint
from cubeling.robot.network.topics import ANY_NAME, ROOT, Member

MAX_MEMBERS = 256
"""Most members in the roster."""

OnMessage = Callable[[Member, str, Any], None]
"""Called with the sender, the kind of topic, and the message."""


@dataclass
class RosterEntry:
    """A member, as far as it is known."""

    last_heartbeat: float
    """Time of its last heartbeat [s]."""

    messages: dict[str, Any] = field(default_factory=dict)
    """Its last message of every kind."""

    def presence(self, now: float) -> str:
        """Return "online", "lost" or "closed"."""
        status = self.messages.get("status")
        if status is None:
            return "lost"
        silent = now - self.last_heartbeat > LOST_AFTER_S
        return "lost" if status.status == "online" and silent else str(status.status)


class Roster(Endpoint):
    """An observer of all members of a site, or of all sites, which publishes nothing.

    Parameters
    ----------
    site
        The site; `ANY` for all of them.
    on_message
        Called with every valid message, except those of an earlier epoch of its sender.
    """

    def __init__(self, site: str = ANY_NAME, on_message: OnMessage | None = None) -> None:
        place = "+" if site == ANY_NAME else site
        self.topic_filters = (f"{ROOT}/{place}/+/+/+",)
        self.members: dict[Member, RosterEntry] = {}
        """The known members."""
        self._on_message = on_message

    def process(self, member: Member, kind: str, message: Any, now: float) -> None:
        """Note a member's message."""
        if member not in self.members and len(self.members) >= MAX_MEMBERS:
            return
        entry = self.members.setdefault(member, RosterEntry(now))
        before = entry.messages.get("status")
        if before is not None and message.session < before.session:
            return  # of an earlier epoch
        entry.messages[kind] = message
        if kind == "status":
            entry.last_heartbeat = now
        if self._on_message is not None:
            self._on_message(member, kind, message)
