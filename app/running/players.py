"""A session's character as a player in the network: what it does and feels, for everyone."""

import time
from collections.abc import Callable
from contextlib import suppress

from app.pipeline.scenario import EmotionTarget
from app.running.network import Network
from characters import CharacterCommand
from robot.network import Player, Station
from robot.network.bus import BusState
from robot.network.player import MAX_AGE

STANDING = frozenset({"idle", "move"})
"""What a character does when it does nothing that a robot could do with it."""


class PlayerLine:
    """Publishes what a character does and feels. Nothing here waits for the network.

    Parameters
    ----------
    network
        Where to publish; whoever opened it closes it, and this line with it.
    name
        What the player is called.
    max_age
        After which time an action is too late for a robot that was away [s].
    say
        Is told in one line when the connection breaks; called within `tell`.
    """

    def __init__(
        self,
        network: Network,
        name: str,
        max_age: float = MAX_AGE,
        say: Callable[[str], None] = lambda line: None,
    ) -> None:
        member = network.member("player", name)
        self._station: Station[Player] = network.join(
            Player(member, network.session, max_age), f"{member.site}:player:{name}"
        )
        self._doing = "idle"
        self._say = say
        self._told = False

    @property
    def state(self) -> BusState:
        """How the connection is."""
        return self._station.state

    @property
    def trouble(self) -> str:
        """Why there is none, in one line; "" when nothing is wrong."""
        return self._station.trouble

    def tell(self, command: CharacterCommand, emotion: EmotionTarget) -> None:
        """Publish a frame's command, if it begins an action, and its emotion, if it has changed."""
        self.command(command)
        self.feel(emotion)
        broken = self.state in ("away", "refused")
        if broken and not self._told:
            self._say(self.trouble)
        self._told = broken

    def command(self, command: CharacterCommand) -> None:
        """Publish an action if this command begins one; a hidden character does nothing."""
        doing = command.action if command.visible else "idle"
        if doing == self._doing:
            return
        self._doing = doing
        if doing not in STANDING:
            # A name that cannot be sent is no reason for the picture to end.
            with self._station.lock, suppress(ValueError):
                self._station.endpoint.act(doing, command.weight, time.monotonic())
            self._station.wake()

    def feel(self, target: EmotionTarget) -> None:
        """Publish an emotion if it has changed."""
        with self._station.lock:
            self._station.endpoint.feel(target.emotion, target.label)

    @property
    def station(self) -> Station[Player]:
        """Where it stands."""
        return self._station
