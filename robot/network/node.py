"""A robot's node: takes the actions and emotions of players, and publishes the robot's state."""

import math
from typing import Any, Protocol

from cubeling.affect import NEUTRAL, Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.telemetry import Telemetry
from cubeling.robot.errors import RobotError
from cubeling.robot.network import messages as m
from cubeling.robot.network.arbiter import HOLD_S, FollowedPlayer, PlayerArbiter
from cubeling.robot.network.bus import Message
from cubeling.robot.network.endpoint import MemberEndpoint
from cubeling.robot.network.messages import encode
from cubeling.robot.network.state_publisher import StatePublisher
from cubeling.robot.network.topics import Member, Pattern


class RobotControl(Protocol):
    """The part of `cubeling.robot.Robot` that a node uses; no method blocks."""

    @property
    def catalogue(self) -> Catalogue:
        """The robot's motions, sounds and moods; RobotError while they are unknown."""

    @property
    def telemetry(self) -> Telemetry:
        """What is known of the robot now; see `Telemetry`."""

    def express(self, emotion: Emotion) -> None:
        """Show an emotion from now on."""

    def play(self, name: str) -> None:
        """Play a motion or sound once; RobotError if that is not possible."""


class RobotNode(MemberEndpoint):
    """The node of a robot, without clock, thread or bus.

    Parameters
    ----------
    member
        Its place in the topic tree.
    robot
        The robot; the caller closes it.
    session
        Number of its epoch, 1 or more, greater than that of every earlier program of its name; see
        `SessionEpoch`.
    follows
        The players whose actions and emotions it takes.
    hold
        How long the emotion of a player who is gone is kept [s].
    """

    def __init__(
        self,
        member: Member,
        robot: RobotControl,
        session: int,
        follows: tuple[Pattern, ...],
        hold: float = HOLD_S,
    ) -> None:
        super().__init__(member, session, follows)
        self.arbiter = PlayerArbiter(hold)
        """The players."""
        self.counts = {"played": 0, "unknown": 0, "missed": 0}
        """Counters of the actions taken; see `messages.StateMessage`."""
        self._ack_topic = member.topic("taken")
        # Our own acknowledgements come first: they say what an earlier epoch took.
        self.topic_filters = (self._ack_topic, member.topic("status")) + tuple(
            pattern.filter("player", kind)
            for kind in ("status", "emotion", "action")
            for pattern in follows
        )
        self.unknown_actions: list[str] = []
        """The actions that the robot lacks, each once and `MAX_ENTRIES` of them at most."""
        self._robot = robot
        self._expressed: Emotion | None = None
        self._state_publisher = StatePublisher()
        self._acks = 0
        self._ack_due = False

    def on_connect(self, now: float) -> None:
        """Publish everything again, as the broker may have lost it."""
        self._epoch.on_connect(now)
        self._state_publisher.reset()
        self._announce()

    def process(self, member: Member, kind: str, message: Any, now: float) -> None:
        """Process a message of a player, or of an earlier epoch of this robot's node."""
        if member == self.member:
            if kind == "taken":
                self._take_over(message, now)
            elif kind == "status" and self._epoch.meet_status(message, now):
                self._announce()
        elif self._epoch.replaced:
            return  # the other program controls the robot
        elif member.role == "player" and any(one.matches(member) for one in self._follows):
            self._process_player(member, kind, message, now)

    def tick(self, now: float) -> None:
        """Show the emotion of the active player."""
        emotion = self.arbiter.select(now)
        if emotion is not None:
            self._express(Emotion(emotion.valence, emotion.arousal, emotion.label))
        elif self.arbiter.active is None and self._expressed is not None:
            self._express(NEUTRAL)

    def outgoing_messages(self, now: float) -> list[Message]:
        """Return the messages to be published now."""
        if self._epoch.replaced:
            return []
        out = self._heartbeat(now)
        if self._ack_due:
            self._ack_due = False
            out.append(self._ack())
        state = self._state_publisher.update(
            self._epoch.number, self._robot.telemetry, self.arbiter.active, self.counts, now
        )
        if state is not None:
            out.append(Message(self.member.topic("state"), encode(state), retain=True))
        return out

    def _process_player(self, member: Member, kind: str, message: Any, now: float) -> None:
        player = self.arbiter.player(member, message.session, now)
        if player is None:
            return
        if kind == "emotion":
            known = player.emotion
            if known is None or (message.session, message.number) > (known.session, known.number):
                player.emotion, player.emotion_changed = message, now
        elif kind == "action":
            player.online, player.last_seen = True, now
            self._take(member, player, message)
        elif message.status != "online":
            self.arbiter.set_offline(player, now)
        elif message.number > player.heartbeat:
            player.heartbeat = message.number
            player.online, player.last_seen = True, now

    def _take(self, member: Member, player: FollowedPlayer, action: m.ActionMessage) -> None:
        """Take an action if it is the next one; acknowledge it, also if it was taken before.

        Without an acknowledgement the player sends it again, which is soon enough for an action
        that arrived out of order, and for a busy robot.
        """
        last = action.oldest - 1 if player.taken is None else max(player.taken, action.oldest - 1)
        if action.number <= last:
            self._ack_due = True
        elif action.number == last + 1 and self._play(action.name):
            self._ack_due = True
            player.taken = action.number
            self.arbiter.active = member

    def _play(self, name: str) -> bool:
        """Pass an action to the robot; False if it must be sent again, as the robot is busy."""
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
            if name not in self.unknown_actions and len(self.unknown_actions) < m.MAX_ENTRIES:
                self.unknown_actions.append(name)
            return True
        try:
            self._robot.play(name)
        except RobotError:
            return False
        self.counts["played"] += 1
        return True

    def _express(self, emotion: Emotion) -> None:
        if emotion != self._expressed:
            self._expressed = emotion
            self._robot.express(emotion)

    def _take_over(self, ack: m.AckMessage, now: float) -> None:
        """Take over the acknowledgements of an earlier epoch, so that no action is done twice."""
        if ack.session == self._epoch.number:
            return  # our own message
        if self._epoch.meet(ack.session, now):
            self._announce()
        for place, (session, number) in ack.players.items():
            site, _, name = place.partition("/")
            player = self.arbiter.player(Member(site, "player", name), session, now)
            if player is not None:
                player.taken = max(number, player.taken or 0)
        self._ack_due = True

    def _announce(self) -> None:
        """Publish status and acknowledgements as soon as possible."""
        self._last_heartbeat = -math.inf
        self._ack_due = True

    def _ack(self) -> Message:
        self._acks += 1
        players = {
            member.place: (one.session, one.taken)
            for member, one in self.arbiter.players.items()
            if one.taken is not None
        }
        content = m.AckMessage(self._epoch.number, self._acks, players)
        return Message(self._ack_topic, encode(content), retain=True)
