"""A player: publishes what its character does and feels, until all its robots have received it.

Actions are numbered. Each robot publishes the number of the last one that it took; the player
keeps the later ones, and sends them all again while a robot is behind (go-back-N, as in HDLC).
The emotion is a state: only the latest counts.
"""

import math
from collections import deque
from dataclasses import dataclass, replace
from typing import Any

from msgspec import structs

from cubeling.affect import Emotion
from cubeling.robot.network import messages as m
from cubeling.robot.network.bus import Message
from cubeling.robot.network.endpoint import MemberEndpoint
from cubeling.robot.network.followers import Followers
from cubeling.robot.network.messages import MAX_TEXT_BYTES, encode
from cubeling.robot.network.topics import ROOT, Member

MAX_AGE_S = 10.0
"""Age at which an action expires [s]: a kiss that comes so late answers nothing."""

MAX_PENDING_ACTIONS = 64
"""Most actions kept for robots that have not taken them; a new one replaces the oldest."""

RESEND_AFTER_S = 1.0
"""Actions that no robot took in this time are sent again [s]."""

EMOTION_EVERY_S = 0.1
"""Shortest time between two emotions [s]; the latest wins."""


@dataclass(frozen=True)
class _PendingAction:
    """An action that not every robot has taken."""

    number: int
    name: str
    weight: float
    timestamp: float


class Player(MemberEndpoint):
    """A player, without clock, thread or bus.

    Parameters
    ----------
    member
        Its place in the topic tree.
    session
        Number of its epoch, 1 or more, greater than that of every earlier program of its name; see
        `SessionEpoch`.
    max_age
        Age at which an action expires [s]; `math.inf` for never.
    """

    def __init__(self, member: Member, session: int, max_age: float = MAX_AGE_S) -> None:
        super().__init__(member, session)
        self.followers = Followers(member)
        """The robots that follow."""
        self.counts = {"made": 0, "sent": 0, "overrun": 0, "expired": 0}
        """Actions made; published, repeats included; dropped for newer ones; dropped as too old."""
        self.topic_filters = (
            member.topic("status"),
            f"{ROOT}/+/robot/+/status",
            f"{ROOT}/+/robot/+/taken",
        )
        self._max_age = max_age
        self._pending: deque[_PendingAction] = deque()
        self._number = self._sent = 0
        self._emotion: m.EmotionMessage | None = None
        self._emotion_due = False
        self._last_emotion = self._last_resend = self._last_progress = -math.inf

    def act(self, name: str, weight: float, now: float) -> None:
        """Publish an action once; the robots that follow do it too.

        Parameters
        ----------
        name
            Its name, "kiss": 1 to `MAX_TEXT_BYTES` printable bytes of UTF-8.
        weight
            Its strength, −1 … 1.
        now
            The time [s].

        Raises
        ------
        ValueError
            If its name cannot be sent, or its weight is not from −1 to 1.
        """
        if not (name and m.is_text(name)):
            raise ValueError(f"{name!r} cannot be an action: 1 to {MAX_TEXT_BYTES} printable bytes")
        if not -1.0 <= weight <= 1.0:
            raise ValueError(f"the weight of {name!r} must be from -1 to 1, not {weight!r}")
        if len(self._pending) == MAX_PENDING_ACTIONS:
            self._pending.popleft()
            self.counts["overrun"] += 1
        self._number += 1
        self._pending.append(_PendingAction(self._number, name, weight, now))
        self.counts["made"] += 1

    def feel(self, emotion: Emotion) -> None:
        """Publish an emotion; the latest wins."""
        known = self._emotion
        message = m.EmotionMessage(
            self._epoch.number,
            1 if known is None else known.number,
            round(emotion.valence, 4),
            round(emotion.arousal, 4),
            emotion.word,
        )
        if message == known:
            return
        number = 1 if known is None else known.number + 1
        self._emotion = structs.replace(message, number=number)
        self._emotion_due = True

    @property
    def pending(self) -> int:
        """Number of actions that not every robot has taken."""
        return len(self._pending)

    def on_connect(self, now: float) -> None:
        """Publish everything again, as the broker may have lost it."""
        self._epoch.on_connect(now)
        self._last_heartbeat = self._last_emotion = -math.inf
        self._emotion_due = self._emotion is not None
        self._resend(now)

    def process(self, member: Member, kind: str, message: Any, now: float) -> None:
        """Process a message of a robot, or of another epoch of this player."""
        if kind == "taken":
            self._acknowledge(member, message, now)
        elif kind == "status" and member == self.member:
            if self._epoch.meet_status(message, now):
                self._restart_epoch()
        elif kind == "status":
            self.followers.receive_status(member, message, now)

    def tick(self, now: float) -> None:
        """Drop the actions that all robots took or that expired; resend if a robot is behind."""
        self.followers.find_lost(now)
        taken = self.followers.number_taken_by_all()
        while self._pending and self._pending[0].number <= taken:
            self._pending.popleft()
        while self._pending and now - self._pending[0].timestamp > self._max_age:
            self._pending.popleft()
            self.counts["expired"] += 1
        last_activity = max(self._last_progress, self._last_resend)
        behind = self.followers.any_behind(self._sent)
        if self._pending and behind and now - last_activity >= RESEND_AFTER_S:
            self._resend(now)

    def outgoing_messages(self, now: float) -> list[Message]:
        """Return the messages to be published now."""
        if self._epoch.replaced:
            return []
        out = self._heartbeat(now)
        out += [self._action(one, now) for one in self._pending if one.number > self._sent]
        due = self._emotion_due and now - self._last_emotion >= EMOTION_EVERY_S
        if self._emotion is not None and due:
            self._emotion_due, self._last_emotion = False, now
            topic = self.member.topic("emotion")
            out.append(Message(topic, encode(self._emotion), retain=True))
        return out

    def _acknowledge(self, robot: Member, ack: m.AckMessage, now: float) -> None:
        """Note the last action that a robot took."""
        session, number = ack.players.get(self.member.place, (0, 0))
        if self._epoch.meet(session, now):
            self._restart_epoch()
        ours = session == self._epoch.number
        if ours and self.followers.acknowledge(robot, min(number, self._number)):
            self._last_progress = now

    def _restart_epoch(self) -> None:
        """Continue under the epoch's new number: actions are numbered from 1 again."""
        self._pending = deque(
            replace(one, number=number) for number, one in enumerate(self._pending, start=1)
        )
        self._number, self._sent = len(self._pending), 0
        self.followers.restart_numbers()
        if self._emotion is not None:
            self._emotion = structs.replace(self._emotion, session=self._epoch.number)
            self._emotion_due = True
        self._last_heartbeat = -math.inf

    def _resend(self, now: float) -> None:
        self._last_resend, self._sent = now, 0

    def _action(self, action: _PendingAction, now: float) -> Message:
        self._sent = action.number
        self.counts["sent"] += 1
        content = m.ActionMessage(
            self._epoch.number,
            action.number,
            self._pending[0].number,
            action.name,
            action.weight,
            round(max(0.0, now - action.timestamp), 3),
        )
        return Message(self.member.topic("action"), encode(content))
