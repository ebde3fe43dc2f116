"""The characters of a session as players: publishes actions and emotions on the network."""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress

from cubeling.app.pipeline.scenario import EmotionTarget, Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.spoken_line import LEAD
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.network.connection import Network
from cubeling.characters import Character, CharacterCommand
from cubeling.robot import RobotError
from cubeling.robot.network import FURTHER, MAX_AGE_S, BusClient, Player

WEIGHT_STEP = 0.2
"""An action is published again when its weight has changed by so much."""

WEIGHT_NOISE = 0.02
"""A weight that changes by less rests: nobody holds a knob still."""

WEIGHT_RESTS_S = 0.5
"""How long a weight must rest before it is published [s]: robots do the action again, so they are
not to do it all the time while the knob turns."""

UNPUBLISHED_ACTIONS = frozenset({"idle", "move"})
"""Actions of a character that robots do not repeat."""


class PlayerPublisher:
    """Publishes the actions and emotions of a character. Never blocks on the network.

    The owner of the network closes it, and the player with it. Actions older than `max_age` [s]
    are too late for a robot that was away. `on_problem` is called with one line when the connection
    breaks, within `publish`.
    """

    def __init__(
        self,
        network: Network,
        name: str,
        max_age: float = MAX_AGE_S,
        on_problem: Callable[[str], None] = lambda line: None,
    ) -> None:
        member = network.member("player", name)
        self.client: BusClient[Player] = network.join(
            Player(member, network.session, max_age), f"{member.site}:player:{name}"
        )
        """The player's connection."""
        self._action = "idle"
        self._published = 0.0  # the weight that was published last
        self._weight, self._rests_since = 0.0, 0.0
        self._on_problem = on_problem
        self._reported = False

    def publish(self, command: CharacterCommand, emotion: EmotionTarget) -> None:
        """Publish a frame's action, if it begins one, and its emotion, if it has changed."""
        self.publish_action(command)
        self.publish_emotion(emotion)
        broken = self.client.state in ("away", "refused")
        if broken and not self._reported:
            self._on_problem(self.client.problem)
        self._reported = broken

    def publish_action(self, command: CharacterCommand) -> None:
        """Publish an action that begins, and again when the hand has changed its weight.

        A hidden character does nothing.
        """
        action = command.activity if command.visible else "idle"
        begins, self._action = action != self._action, action
        if not (begins or self._is_changed(command)) or action in UNPUBLISHED_ACTIONS:
            return
        self._published = self._weight = command.weight
        # The picture goes on if a name cannot be sent.
        with self.client.lock, suppress(ValueError):
            self.client.endpoint.act(action, command.weight, time.monotonic())
        self.client.wake()

    def _is_changed(self, command: CharacterCommand) -> bool:
        """Return whether the weight of the action has changed, and rests."""
        if abs(command.weight - self._weight) > WEIGHT_NOISE:
            self._weight, self._rests_since = command.weight, command.timestamp
        rests = command.timestamp - self._rests_since >= WEIGHT_RESTS_S
        return rests and abs(command.weight - self._published) >= WEIGHT_STEP

    def publish_emotion(self, target: EmotionTarget) -> None:
        """Publish an emotion if it has changed."""
        with self.client.lock:
            self.client.endpoint.feel(target.emotion)


class CastPublisher(Instrument):
    """Publishes what each of a cast does: the first as the player, the others as PLAYER:NAME.

    The parameters are those of `PlayerPublisher`.
    """

    def __init__(
        self,
        network: Network,
        name: str,
        max_age: float = MAX_AGE_S,
        on_problem: Callable[[str], None] = lambda line: None,
    ) -> None:
        self.lead = PlayerPublisher(network, name, max_age, on_problem)
        """Publishes the first character."""
        self._network, self._name, self._max_age = network, name, max_age
        self._on_problem = on_problem
        self._others: dict[str, PlayerPublisher | None] = {}

    def of(self, name: str) -> PlayerPublisher | None:
        """Return what publishes one of the cast, by its name as `Lines` have it.

        None for one whose name cannot be one in the network, which is reported once.
        """
        if name == LEAD:
            return self.lead
        if name not in self._others:
            self._others[name] = None
            try:
                self._others[name] = PlayerPublisher(
                    self._network, f"{self._name}{FURTHER}{name}", self._max_age, self._on_problem
                )
            except RobotError as error:
                self._on_problem(str(error))
        return self._others[name]

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Publish what the cast does in a frame, the first one first; nobody asks for anything."""
        for number, seen in enumerate(step.cast):
            publisher = self.of(seen.name if number else LEAD)
            if publisher is not None:
                publisher.publish(seen.command, seen.emotion)
        return Inputs()
