"""A player's part: what its character does and feels, until every robot that follows has it.

Actions are numbered. Each robot publishes the number of the last one that it has taken; the player
keeps the later ones, and sends them all again whenever a robot is behind (go-back-N, as in HDLC).
Emotions are a state: only the latest counts.
"""

import math
from collections import deque
from dataclasses import dataclass, replace

from affect.emotion import Emotion
from robot.network import messages as m
from robot.network.bus import Letter
from robot.network.endpoint import BEAT_EVERY, REPLACED, Run
from robot.network.followers import Followers
from robot.network.schema import TEXT_BYTES, MalformedError, decode, encode
from robot.network.topics import ROOT, Member, member_of

MAX_AGE = 10.0
"""An action older than this is given up [s]: a kiss that comes so late answers nothing."""

CAPACITY = 64
"""Most actions kept for robots that have not taken them; the oldest is given up for a new one."""

RESEND_AFTER = 1.0
"""Actions that no robot has taken in this time are sent again [s]."""

EMOTION_EVERY = 0.1
"""Emotions are published at most this often [s]; the latest wins."""


@dataclass(frozen=True)
class _Kept:
    """An action that not every robot has taken."""

    number: int
    name: str
    weight: float
    made: float


@dataclass(frozen=True)
class PlayerCounts:
    """What became of a player's actions and of what it heard."""

    made: int = 0
    """Actions made."""

    sent: int = 0
    """Actions published, repeats included."""

    overrun: int = 0
    """Actions given up because `CAPACITY` newer ones waited."""

    expired: int = 0
    """Actions given up because they became older than the age limit."""

    malformed: int = 0
    """Messages that could not be understood, and were left alone."""


class Player:
    """A player's end of the tree, without clock, thread or bus; an `Endpoint`.

    Parameters
    ----------
    member
        Who it is.
    session
        Number of this run, ≥ 1, greater than that of every earlier run. If the clock it was made
        from went back, the player learns of the later one from the broker and goes beyond it.
    max_age
        After which time an action is given up [s]; `math.inf` for never.
    """

    def __init__(self, member: Member, session: int, max_age: float = MAX_AGE) -> None:
        self.member = member
        """Who it is."""
        self.followers = Followers(member)
        """The robots that follow."""
        self.counts = PlayerCounts()
        """What became of all."""
        self.filters = (
            member.topic("status"),
            f"{ROOT}/+/robot/+/status",
            f"{ROOT}/+/robot/+/taken",
        )
        self._run = Run(session)
        self._max_age = max_age
        self._kept: deque[_Kept] = deque()
        self._number = self._sent = 0
        self._feeling: m.Feeling | None = None
        self._feeling_due = False
        self._felt = -math.inf
        self._beat = 0
        self._beaten = self._resent = self._progress = -math.inf

    @property
    def will(self) -> Letter | None:
        """What the broker says when the connection breaks."""
        return self._status("lost")

    @property
    def trouble(self) -> str:
        """Why it has fallen silent for good; "" as long as it has not."""
        return REPLACED.format(self.member) if self._run.replaced else ""

    # --- What the character does and feels -----------------------------------------------------

    def act(self, name: str, weight: float, now: float) -> None:
        """Do something once; robots that follow will do it too.

        Raises
        ------
        ValueError
            If the name cannot be sent, or the weight is not from −1 to 1.
        """
        if not (name.isprintable() and 0 < len(name.encode()) <= TEXT_BYTES):
            raise ValueError(f"{name!r} cannot be an action: 1 to {TEXT_BYTES} printable bytes")
        if not -1.0 <= weight <= 1.0:
            raise ValueError(f"the weight of {name!r} must be from -1 to 1, not {weight!r}")
        if len(self._kept) == CAPACITY:
            self._kept.popleft()
            self._count(overrun=1)
        self._number += 1
        self._kept.append(_Kept(self._number, name, weight, now))
        self._count(made=1)

    def feel(self, emotion: Emotion, label: str | None = None) -> None:
        """Feel this from now on; the latest wins."""
        known = self._feeling
        feeling = m.Feeling(
            self._run.number,
            1 if known is None else known.number,
            round(emotion.valence, 4),
            round(emotion.arousal, 4),
            label,
        )
        if feeling == known:
            return
        self._feeling = feeling if known is None else replace(feeling, number=known.number + 1)
        self._feeling_due = True

    @property
    def waiting(self) -> int:
        """How many actions not every robot has taken."""
        return len(self._kept)

    # --- What the bus brings -------------------------------------------------------------------

    def connected(self, now: float) -> None:
        """Say everything again."""
        self._run.connected(now)
        self._beaten = self._felt = -math.inf
        self._feeling_due = self._feeling is not None
        self._send_again(now)

    def receive(self, topic: str, payload: bytes, now: float) -> None:
        """Take a message."""
        found = member_of(topic)
        if found is None:
            return
        member, kind = found
        try:
            if member == self.member:
                if self._run.meet_status(decode(m.Status, payload), now):
                    self._begin_anew()
            elif kind == "status":
                self.followers.hear(member, decode(m.Status, payload), now)
            elif kind == "taken":
                self._acknowledge(member, decode(m.Taken, payload), now)
        except MalformedError:
            self._count(malformed=1)

    def tick(self, now: float) -> None:
        """Give up what everyone has, or what is too late; find who is silent."""
        self.followers.settle(now)
        done = self.followers.done()
        while self._kept and self._kept[0].number <= done:
            self._kept.popleft()
        while self._kept and now - self._kept[0].made > self._max_age:
            self._kept.popleft()
            self._count(expired=1)
        behind = self.followers.is_behind(self._sent)
        if self._kept and behind and now - max(self._progress, self._resent) >= RESEND_AFTER:
            self._send_again(now)

    def letters(self, now: float) -> list[Letter]:
        """Return what is to be published now."""
        out: list[Letter] = []
        if self._run.replaced:
            return out
        if now - self._beaten >= BEAT_EVERY:
            self._beaten = now
            self._beat += 1
            out.append(self._status("online"))
        for kept in self._kept:
            if kept.number > self._sent:
                out.append(self._action(kept, now))
        if self._feeling_due and now - self._felt >= EMOTION_EVERY:
            self._feeling_due, self._felt = False, now
            out.append(Letter(self.member.topic("emotion"), encode(self._feeling), retain=True))
        return out

    def farewell(self) -> tuple[Letter, ...]:
        """Return the last words."""
        self._beat += 1
        return () if self._run.replaced else (self._status("closed"),)

    # --- Small things --------------------------------------------------------------------------

    def _acknowledge(self, robot: Member, taken: m.Taken, now: float) -> None:
        """Take note of how far a robot has got."""
        session, number = taken.players.get(self.member.place, (0, 0))
        if self._run.meet(session, now):
            self._begin_anew()
        mine = session == self._run.number
        if mine and self.followers.acknowledge(robot, min(number, self._number)):
            self._progress = now

    def _begin_anew(self) -> None:
        """Count from 1 again, in a session that has just got another number."""
        self._kept = deque(
            replace(kept, number=number) for number, kept in enumerate(self._kept, start=1)
        )
        self._number, self._sent = len(self._kept), 0
        self.followers.begin_anew()
        if self._feeling is not None:
            self._feeling = replace(self._feeling, session=self._run.number)
            self._feeling_due = True
        self._beaten = -math.inf

    def _send_again(self, now: float) -> None:
        self._resent, self._sent = now, 0

    def _action(self, kept: _Kept, now: float) -> Letter:
        self._sent = kept.number
        self._count(sent=1)
        oldest = self._kept[0].number
        age = round(max(0.0, now - kept.made), 3)
        action = m.Action(self._run.number, kept.number, oldest, kept.name, kept.weight, age)
        return Letter(self.member.topic("action"), encode(action))

    def _status(self, status: str) -> Letter:
        return Letter(
            self.member.topic("status"),
            encode(m.Status(self._run.number, self._beat, status)),
            retain=True,
        )

    def _count(self, **more: int) -> None:
        known = {name: getattr(self.counts, name) + by for name, by in more.items()}
        self.counts = replace(self.counts, **known)
