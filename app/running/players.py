"""The character of a session as a player: publishes its actions and emotions on the network."""

import time
from collections.abc import Callable
from contextlib import suppress

from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.running.network import Network
from cubeling.characters import CharacterCommand
from cubeling.robot.network import MAX_AGE_S, BusClient, Player

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
        """Publish an action if this command begins one; a hidden character does nothing."""
        action = command.activity if command.visible else "idle"
        if action == self._action:
            return
        self._action = action
        if action not in UNPUBLISHED_ACTIONS:
            # The picture goes on if a name cannot be sent.
            with self.client.lock, suppress(ValueError):
                self.client.endpoint.act(action, command.weight, time.monotonic())
            self.client.wake()

    def publish_emotion(self, target: EmotionTarget) -> None:
        """Publish an emotion if it has changed."""
        with self.client.lock:
            self.client.endpoint.feel(target.emotion)
