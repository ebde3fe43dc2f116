"""The bridge: robots that follow players on other computers, and recorded sessions as players."""

from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, nullcontext
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.pipeline.table.spoken_line import LEAD
from cubeling.app.running.network.connection import Network
from cubeling.app.running.network.players import CastPublisher
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

FURTHER_TOPICS: dict[str, type[Any]] = {"command": CharacterCommand, "emotion": EmotionTarget}
"""The same of each further character, /cast/NAME/PART, by the last part."""


class RecordedPlayer:
    """Publishes a recorded session in its own time: its first character, and each further one."""

    def __init__(self, publisher: CastPublisher, path: Path) -> None:
        self._publisher = publisher
        self._messages = _messages(path)
        self._next = next(self._messages, None)
        self._time_offset: float | None = None

    def advance(self, now: float) -> bool:
        """Publish the messages due at time `now` [s]; return whether there are more."""
        while self._next is not None:
            time, name, message = self._next
            if self._time_offset is None:
                self._time_offset = now - time
            if time + self._time_offset > now:
                return True
            publisher = self._publisher.of(name)
            if publisher is not None and isinstance(message, CharacterCommand):
                publisher.publish_action(message)
            elif publisher is not None and isinstance(message, EmotionTarget):
                publisher.publish_emotion(message)
            self._next = next(self._messages, None)
        return False


def _messages(path: Path) -> Iterator[tuple[float, str, CharacterCommand | EmotionTarget]]:
    """Yield time [s], name as `Lines` have it, and what is published, of a session."""
    with SessionFile(path) as session:
        names = dict.fromkeys(PUBLISHED_TOPICS, LEAD)
        kinds = dict(PUBLISHED_TOPICS)
        for topic in session.channels:
            folder, _, part = topic.rpartition("/")
            if folder.startswith("/cast/") and part in FURTHER_TOPICS:
                names[topic], kinds[topic] = folder.removeprefix("/cast/"), FURTHER_TOPICS[part]
        for topic, time, message in session.decode_messages(kinds):
            yield time, names[topic], message


def patterns_of(
    follow: Iterable[str], robots: Collection[str], site: str
) -> dict[str, tuple[Pattern, ...]]:
    """Return whom each robot follows: those that are named for it, else those for all.

    Raises RobotError or AppError if a player or a robot cannot be meant.
    """
    found: dict[str, list[Pattern]] = {name: [] for name in ("", *robots)}
    for text in follow:
        name, equals, players = text.rpartition("=")
        if name not in found or (equals and not name):
            raise AppError(f"--follow {text}: no robot of this bridge is called '{name}'")
        found[name].append(Pattern.parse(players, site))
        if len(found[name]) > MAX_ENTRIES:
            raise AppError(f"a robot follows at most {MAX_ENTRIES}; use * for all of a site")
    usual = found[""] or [Pattern.parse(ANY_NAME, site)]
    return {name: tuple(found[name] or usual) for name in robots}


class Bridge(Closeable):
    """Robots and recorded players on a network. Close it, or use it in a `with` statement.

    `robots` has the URLs of the robots to drive, `sessions` the sessions to publish, by name;
    `complete` opens a session with every channel, after all that may be wrong has been checked;
    `follow` names players as `Pattern.parse` takes them, after ROBOT= for one of the robots. For
    `hold` [s] a robot keeps the emotion of a player who is gone; actions expire at the age of
    `max_age` [s]. `on_message` is called with every message of the site, on a thread of the
    network.

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
        follows = patterns_of(follow, robots, network.site)
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
                node = RobotNode(member, robot, network.session, follows[name], hold)
                self.robots[name] = node
                self.clients[f"robot {name}"] = network.join(node, f"{member.site}:robot:{name}")
            for name, path in files.items():
                publisher = CastPublisher(network, name, max_age)
                self.clients[f"player {name}"] = publisher.lead.client
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
