"""Who is there: an onlooker of the whole tree, or of one site."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from robot.network import messages as m
from robot.network.bus import Letter
from robot.network.endpoint import SILENT_AFTER
from robot.network.schema import MalformedError, decode
from robot.network.topics import EVERYONE, ROOT, Member, member_of

MEMBERS_MAX = 256
"""Most members that are kept account of."""

Watcher = Callable[[Member, str, Any], None]
"""Is given who speaks, the kind of topic, and the message."""


@dataclass
class Seen:
    """A member, as far as it has been heard."""

    heard: float
    """When it was last heard [s]."""

    said: dict[str, Any] = field(default_factory=dict)
    """Its last message of every kind."""

    def presence(self, now: float) -> str:
        """Return "online", "lost" or "closed"."""
        status = self.said.get("status")
        if not isinstance(status, m.Status):
            return "lost"
        silent = now - self.heard > SILENT_AFTER
        return "lost" if status.status == "online" and silent else status.status


class Roster:
    """Hears everyone and says nothing; an `Endpoint`.

    Parameters
    ----------
    site
        Whose members, or `EVERYONE`.
    watcher
        Is given every message as it comes.
    """

    will: Letter | None = None
    trouble = ""

    def __init__(self, site: str = EVERYONE, watcher: Watcher | None = None) -> None:
        place = "+" if site == EVERYONE else site
        self.filters: tuple[str, ...] = (f"{ROOT}/{place}/+/+/+",)
        self.members: dict[Member, Seen] = {}
        """Who has been heard."""
        self.malformed = 0
        """Messages that could not be understood."""
        self._watcher = watcher

    def connected(self, now: float) -> None:
        """Nothing is to be said."""

    def receive(self, topic: str, payload: bytes, now: float) -> None:
        """Take a message."""
        found = member_of(topic)
        if found is None:
            return
        member, kind = found
        form = m.KINDS.get((member.role, kind))
        if form is None:
            return  # a later version says more
        try:
            message = decode(form, payload)
        except MalformedError:
            self.malformed += 1
            return
        if member not in self.members and len(self.members) >= MEMBERS_MAX:
            return
        seen = self.members.setdefault(member, Seen(now))
        before = seen.said.get("status")
        if before is not None and message.session < before.session:
            return  # of a run that is over
        seen.said[kind] = message
        if kind == "status":
            seen.heard = now
        if self._watcher is not None:
            self._watcher(member, kind, message)

    def tick(self, now: float) -> None:
        """Nothing is ever due."""

    def letters(self, now: float) -> list[Letter]:
        """Nothing is said."""
        return []

    def farewell(self) -> tuple[Letter, ...]:
        """Nothing is said."""
        return ()
