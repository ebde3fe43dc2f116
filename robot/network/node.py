"""A robot's part: takes what players do and feel, drives the robot, and says how it is."""

import math
from dataclasses import replace
from typing import Protocol

from affect.emotion import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.telemetry import Telemetry
from robot.errors import RobotError
from robot.network import messages as m
from robot.network.bus import Letter
from robot.network.endpoint import BEAT_EVERY, REPLACED, Run
from robot.network.following import HOLD, Followed, Following
from robot.network.schema import MalformedError, decode, encode
from robot.network.telling import Telling
from robot.network.topics import Member, Pattern, member_of

NEUTRAL = Emotion(0.0, 0.0)


class Drivable(Protocol):
    """The part of `robot.Robot` that a node uses; no method waits."""

    @property
    def catalogue(self) -> Catalogue:
        """What the robot has; RobotError while that is unknown."""

    @property
    def telemetry(self) -> Telemetry:
        """What is known of it."""

    def express(self, emotion: Emotion, label: str | None = None) -> None:
        """Let it feel this."""

    def play(self, name: str) -> None:
        """Let it play this once; RobotError if it cannot."""


class RobotNode:
    """A robot's end of the tree, without clock, thread or bus; an `Endpoint`.

    Parameters
    ----------
    member
        Which robot it is.
    robot
        The robot; whoever made it closes it.
    session
        Number of this run, ≥ 1, greater than that of every earlier run.
    follows
        Whose actions and emotions it takes.
    hold
        How long the mood of a player who is gone is kept [s].
    """

    def __init__(
        self,
        member: Member,
        robot: Drivable,
        session: int,
        follows: tuple[Pattern, ...],
        hold: float = HOLD,
    ) -> None:
        self.member = member
        """Which robot it is."""
        self.following = Following(hold)
        """The players."""
        self.malformed = 0
        """Messages that could not be understood, and were left alone."""
        self.counts = {"played": 0, "unknown": 0, "missed": 0}
        """What became of the actions that were taken; see `messages.RobotState`."""
        self._own_taken = member.topic("taken")  # first: what an earlier run of ours has taken
        self.filters = (self._own_taken, member.topic("status")) + tuple(
            pattern.filter("player", kind)
            for kind in ("status", "emotion", "action")
            for pattern in follows
        )
        self._robot = robot
        self._run = Run(session)
        self._follows = follows
        self._expressed: Emotion | None = None
        self._label: str | None = None
        self._telling = Telling()
        self._beaten = -math.inf
        self._beat = self._taken_number = 0
        self._taken_due = False

    @property
    def will(self) -> Letter | None:
        """What the broker says when the connection breaks."""
        return self._status("lost")

    @property
    def trouble(self) -> str:
        """Why it has fallen silent for good; "" as long as it has not."""
        return REPLACED.format(self.member) if self._run.replaced else ""

    # --- What the bus brings -------------------------------------------------------------------

    def connected(self, now: float) -> None:
        """Say everything again."""
        self._run.connected(now)
        self._beaten = -math.inf
        self._telling.again()
        self._taken_due = True

    def receive(self, topic: str, payload: bytes, now: float) -> None:
        """Take a message."""
        found = member_of(topic)
        if found is None:
            return
        member, kind = found
        try:
            if topic == self._own_taken:
                self._remember(decode(m.Taken, payload), now)
            elif member == self.member:
                if self._run.meet_status(decode(m.Status, payload), now):
                    self._begin_anew()
            elif self._run.replaced:
                return  # the robot is the other program's now
            elif member.role == "player" and any(one.matches(member) for one in self._follows):
                self._hear(member, kind, payload, now)
        except MalformedError:
            self.malformed += 1

    def tick(self, now: float) -> None:
        """Let the robot feel what it should by now."""
        feeling = self.following.settle(now)
        if feeling is not None:
            self._express(Emotion(feeling.valence, feeling.arousal), feeling.label)
        elif self.following.holder is None and self._expressed is not None:
            self._express(NEUTRAL, "neutral")

    def letters(self, now: float) -> list[Letter]:
        """Return what is to be published now."""
        out: list[Letter] = []
        if self._run.replaced:
            return out
        if now - self._beaten >= BEAT_EVERY:
            self._beaten = now
            self._beat += 1
            out.append(self._status("online"))
        if self._taken_due:
            self._taken_due = False
            out.append(self._taken())
        holder = self.following.holder
        state = self._telling.state(self._robot.telemetry, holder, self.counts, now)
        if state is not None:
            state = replace(state, session=self._run.number)
            out.append(Letter(self.member.topic("state"), encode(state), retain=True))
        return out

    def farewell(self) -> tuple[Letter, ...]:
        """Return the last words."""
        self._beat += 1
        return () if self._run.replaced else (self._status("closed"),)

    # --- Players -------------------------------------------------------------------------------

    def _hear(self, member: Member, kind: str, payload: bytes, now: float) -> None:
        if kind == "status":
            status = decode(m.Status, payload)
            player = self.following.player(member, status.session, now)
            if player is None:
                return
            if status.status != "online":
                self.following.absent(player, now)
            elif status.number > player.beat:
                player.beat = status.number
                self.following.present(player, now)
        elif kind == "emotion":
            feeling = decode(m.Feeling, payload)
            player = self.following.player(member, feeling.session, now)
            if player is not None and _is_later(feeling, player.feeling):
                player.feeling, player.felt = feeling, now
        elif kind == "action":
            action = decode(m.Action, payload)
            player = self.following.player(member, action.session, now)
            if player is not None:
                self.following.present(player, now)
                self._take(member, player, action)

    def _take(self, member: Member, player: Followed, action: m.Action) -> None:
        """Take an action if it is the next one; answer that, and one that was taken before.

        Without an answer it comes again, which is soon enough for one that came too early, and for
        a robot that is busy.
        """
        last = action.oldest - 1 if player.taken is None else max(player.taken, action.oldest - 1)
        if action.number <= last:
            self._taken_due = True
        elif action.number == last + 1 and self._play(action.name):
            self._taken_due = True
            player.taken = action.number
            self.following.holder = member

    def _play(self, name: str) -> bool:
        """Hand an action to the robot; False if it must come again, as the robot is too busy."""
        if self._robot.telemetry.state not in ("ready", "degraded"):
            self.counts["missed"] += 1
            return True
        try:
            catalogue = self._robot.catalogue
        except RobotError:
            self.counts["missed"] += 1
            return True
        if name not in catalogue.motions + catalogue.sounds:
            self.counts["unknown"] += 1
            return True
        try:
            self._robot.play(name)
        except RobotError:
            return False
        self.counts["played"] += 1
        return True

    def _express(self, emotion: Emotion, label: str | None) -> None:
        if (emotion, label) != (self._expressed, self._label):
            self._expressed, self._label = emotion, label
            self._robot.express(emotion, label)

    # --- An earlier run of ours ----------------------------------------------------------------

    def _remember(self, taken: m.Taken, now: float) -> None:
        """Take over from an earlier run how far it got, so that nothing is done twice."""
        if taken.session == self._run.number:
            return  # our own words
        if self._run.meet(taken.session, now):
            self._begin_anew()
        for place, (session, number) in taken.players.items():
            site, _, name = place.partition("/")
            player = self.following.player(Member(site, "player", name), session, now)
            if player is not None:
                player.taken = max(number, player.taken or 0)
        self._taken_due = True

    def _begin_anew(self) -> None:
        """Say who we are under the number that this run has got just now."""
        self._beaten = -math.inf
        self._taken_due = True

    # --- What is said --------------------------------------------------------------------------

    def _status(self, status: str) -> Letter:
        said = m.Status(self._run.number, self._beat, status, tuple(map(str, self._follows)))
        return Letter(self.member.topic("status"), encode(said), retain=True)

    def _taken(self) -> Letter:
        self._taken_number += 1
        players = {
            member.place: (one.session, one.taken)
            for member, one in self.following.players.items()
            if one.taken is not None
        }
        taken = m.Taken(self._run.number, self._taken_number, players)
        return Letter(self._own_taken, encode(taken), retain=True)


def _is_later(feeling: m.Feeling, known: m.Feeling | None) -> bool:
    if known is None:
        return True
    return (feeling.session, feeling.number) > (known.session, known.number)
