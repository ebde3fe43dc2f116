"""Endpoints of the bus: a player, a robot's node or an observer, without clock, thread or bus."""

import math
from typing import Any, Literal

from cubeling.robot.network.bus import Message
from cubeling.robot.network.messages import (
    MAX_INTEGER,
    MESSAGE_TYPES,
    MalformedError,
    StatusMessage,
    decode,
    encode,
)
from cubeling.robot.network.topics import Member, Pattern, member_of

HEARTBEAT_EVERY_S = 2.0
"""Time between two heartbeats of a member [s]."""

LOST_AFTER_S = 6.0
"""Silence after which a member counts as lost [s]: three heartbeats; a last will is faster."""

SETTLING_TIME_S = 1.0
"""Time after the first connection in which a member learns of earlier epochs of its name [s]."""


class SessionEpoch:
    """The epoch of a member's program: a number ≥ 1 that is greater for a later start.

    The number comes from the time of day. Where that went back, the program learns of the earlier
    epoch from retained messages, and takes a greater number. A program that meets a greater number
    after that has been replaced, and stops publishing.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        """The session in every message."""
        self.replaced = False
        """Whether another program, started later, publishes under the same name."""
        self._first_connected: float | None = None

    def on_connect(self, now: float) -> None:
        """Note the time of the first connection [s]."""
        if self._first_connected is None:
            self._first_connected = now

    def meet(self, other: int, now: float, *, alive: bool = False) -> bool:
        """Note another epoch of our name; return whether our number has changed."""
        if not self.number < other < MAX_INTEGER:
            return False
        if self._first_connected is None or now - self._first_connected <= SETTLING_TIME_S:
            self.number = other + 1
            return True
        self.replaced |= alive
        return False

    def meet_status(self, status: StatusMessage, now: float) -> bool:
        """Note a status under our name; return whether our number has changed."""
        return self.meet(status.session, now, alive=status.status == "online")


class Endpoint:
    """A member's part of the communication, driven by the owner of clock and bus. Never blocks."""

    topic_filters: tuple[str, ...] = ()
    """Its subscriptions, in the order in which it needs the retained messages."""

    malformed = 0
    """Messages that were not valid, and were ignored."""

    @property
    def will(self) -> Message | None:
        """The message that the broker publishes when the connection breaks."""
        return None

    @property
    def problem(self) -> str:
        """Why it stopped publishing, in one line; "" while it publishes."""
        return ""

    def on_connect(self, now: float) -> None:
        """Publish everything again: the broker may have lost it."""

    def receive(self, topic: str, payload: bytes, now: float) -> None:
        """Decode a message and pass it to `process`; never raises, whatever the message is."""
        found = member_of(topic)
        if found is None:
            return
        member, kind = found
        message_type = MESSAGE_TYPES.get((member.role, kind))
        if message_type is None:
            return  # of a later version
        try:
            message = decode(message_type, payload)
        except MalformedError:
            self.malformed += 1
            return
        self.process(member, kind, message, now)

    def process(self, member: Member, kind: str, message: Any, now: float) -> None:
        """Process a member's message of a kind."""

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]."""

    def outgoing_messages(self, now: float) -> list[Message]:
        """Return the messages to be published now, each once."""
        return []

    def closing_messages(self) -> tuple[Message, ...]:
        """Return the last messages."""
        return ()


class MemberEndpoint(Endpoint):
    """Base of players and robots' nodes: session epoch, heartbeat, last will."""

    def __init__(self, member: Member, session: int, follows: tuple[Pattern, ...] = ()) -> None:
        self.member = member
        """The member."""
        self._epoch = SessionEpoch(session)
        self._follows = follows
        self._heartbeats = 0
        self._last_heartbeat = -math.inf

    @property
    def will(self) -> Message | None:
        """The message that the broker publishes when the connection breaks."""
        return self._status("lost")

    @property
    def problem(self) -> str:
        """Why it stopped publishing; "" while it publishes."""
        if not self._epoch.replaced:
            return ""
        return (
            f"another program, started later, publishes as {self.member}: give one of them "
            "another name"
        )

    def closing_messages(self) -> tuple[Message, ...]:
        """Return the last messages."""
        self._heartbeats += 1
        return () if self._epoch.replaced else (self._status("closed"),)

    def _heartbeat(self, now: float) -> list[Message]:
        """Return the heartbeat if it is due."""
        if now - self._last_heartbeat < HEARTBEAT_EVERY_S:
            return []
        self._last_heartbeat = now
        self._heartbeats += 1
        return [self._status("online")]

    def _status(self, status: Literal["online", "lost", "closed"]) -> Message:
        follows = tuple(map(str, self._follows))
        content = StatusMessage(self._epoch.number, self._heartbeats, status, follows)
        return Message(self.member.topic("status"), encode(content), retain=True)
