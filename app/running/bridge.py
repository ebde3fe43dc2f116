"""The bridge: robots that follow players on other computers, and recorded sessions as players."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, nullcontext
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.running.network import Network
from cubeling.app.running.players import PlayerPublisher
from cubeling.app.session import SessionFile, session_info
from cubeling.characters import CharacterCommand
from cubeling.robot import Closeable, connect
from cubeling.robot.network import (
    ANY_NAME,
    HOLD_S,
    MAX_AGE_S,
    MAX_ENTRIES,
    BusClient,
    OnMessage,
    Pattern,
    RobotNode,
    Roster,
)

PUBLISHED_TOPICS: dict[str, type[Any]] = {
    "/character/command": CharacterCommand,
    "/robot/emotion": EmotionTarget,
}
"""Topics of a recorded session that are published, and their types."""


class RecordedPlayer:
    """Publishes a recorded session in its own time."""

    def __init__(self, publisher: PlayerPublisher, path: Path) -> None:
        self._publisher = publisher
        self._messages = _messages(path)
        self._next = next(self._messages, None)
        self._time_offset: float | None = None

    def advance(self, now: float) -> bool:
        """Publish the messages due at time `now` [s]; return whether there are more."""
        while self._next is not None:
            time, message = self._next
            if self._time_offset is None:
                self._time_offset = now - time
            if time + self._time_offset > now:
                return True
            if isinstance(message, CharacterCommand):
                self._publisher.publish_action(message)
            else:
                self._publisher.publish_emotion(message)
            self._next = next(self._messages, None)
        return False


def _messages(path: Path) -> Iterator[tuple[float, CharacterCommand | EmotionTarget]]:
    with SessionFile(path) as session:
        for _, time, message in session.decode_messages(PUBLISHED_TOPICS):
            yield time, message


class Bridge(Closeable):
    """Robots and recorded players on a network. Close it, or use it in a `with` statement.

    `robots` has the URLs of the robots to drive, `sessions` the sessions to publish, by name;
    `complete` opens a session with every channel, after all that may be wrong has been checked;
    `follow` names players as `Pattern.parse` takes them. For `hold` [s] a robot keeps the emotion
    of a player who is gone; actions expire at the age of `max_age` [s]. `on_message` is called
    with every message of the site, on a thread of the network.

    Raises RobotError or AppError if a name, a robot, a session or the broker cannot be used.
    Nothing is left open then; otherwise the bridge closes the network.
    """

    def __init__(
        self,
        network: Network,
        robots: dict[str, str],
        sessions: dict[str, Path],
        *,
        complete: Callable[[Path], AbstractContextManager[Path]] = nullcontext,
        follow: Iterable[str] = (ANY_NAME,),
        hold: float = HOLD_S,
        max_age: float = MAX_AGE_S,
        on_message: OnMessage | None = None,
    ) -> None:
        follows = tuple(Pattern.parse(one, network.site) for one in follow)
        if len(follows) > MAX_ENTRIES:
            raise AppError(f"a robot follows at most {MAX_ENTRIES}; use * for all of a site")
        for name in robots:
            network.member("robot", name)  # raises RobotError if it is not a valid name
        for name in sessions:
            network.member("player", name)
        for path in sessions.values():
            session_info(path)  # raises AppError if it is not a session
        self.network = network
        """The network."""
        self.clients: dict[str, BusClient[Any]] = {}
        """Connections of its members by role and name: "robot rex"."""
        self.robots: dict[str, RobotNode] = {}
        """The nodes of its robots by name."""
        self._recorded: list[RecordedPlayer] = []
        self._closing = ExitStack()
        try:
            # Before the others hear of it: what cannot be opened never was online.
            opened = {
                name: self._closing.enter_context(connect(url)) for name, url in robots.items()
            }
            files = {
                name: self._closing.enter_context(complete(path)) for name, path in sessions.items()
            }
            self.roster: BusClient[Roster] = network.join(
                Roster(on_message=on_message), f"{network.site}:roster"
            )
            """All members of the network."""
            for name, robot in opened.items():
                member = network.member("robot", name)
                node = RobotNode(member, robot, network.session, follows, hold)
                self.robots[name] = node
                self.clients[f"robot {name}"] = network.join(node, f"{member.site}:robot:{name}")
            for name, path in files.items():
                publisher = PlayerPublisher(network, name, max_age)
                self.clients[f"player {name}"] = publisher.client
                self._recorded.append(RecordedPlayer(publisher, path))
        except BaseException:
            self.close()
            raise

    def advance(self, now: float) -> bool:
        """Publish the recorded messages due at time `now` [s]; return whether there are more."""
        more = [player.advance(now) for player in self._recorded]
        return any(more)

    def close(self) -> None:
        """Disconnect all members, then the robots. A second call does nothing."""
        self.network.close()
        self._recorded.clear()  # they read files that are removed now
        self._closing.close()
