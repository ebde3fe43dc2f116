"""The bridge: robots that follow players elsewhere, and recorded sessions that are players."""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from app.errors import AppError
from app.pipeline.scenario import EmotionTarget
from app.running.network import Network
from app.running.players import PlayerLine
from app.session import messages, session_info
from app.session.encoding import decode
from characters import CharacterCommand
from robot import connect
from robot.network import Pattern, RobotNode, Roster, Station
from robot.network.following import HOLD
from robot.network.player import MAX_AGE
from robot.network.roster import Watcher
from robot.network.schema import LIST_MAX
from robot.network.topics import EVERYONE

ARROWS: dict[str, type[Any]] = {
    "/character/command": CharacterCommand,
    "/robot/emotion": EmotionTarget,
}
"""What of a recorded session is published."""


@dataclass(frozen=True)
class Order:
    """What a bridge is to do."""

    robots: dict[str, str]
    """URL of every robot to drive, by its name."""

    sessions: dict[str, Path]
    """Session of every player to play, by its name."""

    follow: tuple[str, ...] = (EVERYONE,)
    """Whom the robots follow, as `Pattern.parse` takes it."""

    hold: float = HOLD
    """How long a robot keeps the mood of a player who is gone [s]."""

    max_age: float = MAX_AGE
    """After which time an action is too late for a robot that was away [s]."""


class RecordedPlayer:
    """Lets a recorded session act and feel again, at the speed at which it was recorded.

    Parameters
    ----------
    line
        Where to publish.
    path
        The session.

    Raises
    ------
    AppError
        If the file is no session.
    """

    def __init__(self, line: PlayerLine, path: Path) -> None:
        self.line = line
        """Where it is published."""
        session_info(path)  # what is no session is refused here
        self._arrows = _arrows(path)
        self._next = next(self._arrows, None)
        self._shift: float | None = None

    def advance(self, now: float) -> bool:
        """Publish what is due at time `now` [s]; whether there is more to come."""
        while self._next is not None:
            time, arrow = self._next
            if self._shift is None:
                self._shift = now - time
            if time + self._shift > now:
                return True
            if isinstance(arrow, CharacterCommand):
                self.line.command(arrow)
            else:
                self.line.feel(arrow)
            self._next = next(self._arrows, None)
        return False


def _arrows(path: Path) -> Iterator[tuple[float, CharacterCommand | EmotionTarget]]:
    for topic, time, data in messages(path, *ARROWS):
        try:
            yield time, decode(ARROWS[topic], data)
        except ValueError as error:
            raise AppError(f"the session '{path}' holds something else on {topic}") from error


class Bridge:
    """Robots and recorded players on a network. Close it, or use it in a `with` statement.

    Parameters
    ----------
    order
        What to do.
    network
        Where; whoever opened it closes it.
    watcher
        Is given every message of the site, from a thread of the network's.

    Raises
    ------
    RobotError, AppError
        If a name, a robot, a session or the broker cannot be used. Nothing is left open then.
    """

    def __init__(self, order: Order, network: Network, watcher: Watcher | None = None) -> None:
        follows = tuple(Pattern.parse(one, network.site) for one in order.follow)
        if len(follows) > LIST_MAX:
            raise AppError(f"a robot follows {LIST_MAX} at most; use * for all of a site")
        for role, names in (("robot", order.robots), ("player", order.sessions)):
            for name in names:
                network.member("robot" if role == "robot" else "player", name)
        self.network = network
        """Where its members meet the others."""
        self.stations: dict[str, Station[Any]] = {}
        """Its members by role and name: "robot rex"."""
        self._recorded: list[RecordedPlayer] = []
        self._closing = ExitStack()
        try:
            self.roster: Station[Roster] = network.join(
                Roster(watcher=watcher), f"{network.site}:onlooker"
            )
            """Who is there."""
            for name, url in order.robots.items():
                self._drive(name, url, follows, order.hold)
            for name, path in order.sessions.items():
                line = PlayerLine(network, name, order.max_age)
                self.stations[f"player {name}"] = line.station
                self._recorded.append(RecordedPlayer(line, path))
        except BaseException:
            self.close()
            raise

    def advance(self, now: float) -> bool:
        """Let recorded players do what is due at time `now` [s]; whether any has more to do."""
        more = [player.advance(now) for player in self._recorded]
        return any(more)

    def close(self) -> None:
        """Say goodbye, then let the robots go. A second call does nothing."""
        self.network.close()
        self._closing.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _drive(self, name: str, url: str, follows: tuple[Pattern, ...], hold: float) -> None:
        network = self.network
        member = network.member("robot", name)
        robot = self._closing.enter_context(connect("sim:cubeling" if url == "sim" else url))
        node = RobotNode(member, robot, network.session, follows, hold)
        self.stations[f"robot {name}"] = network.join(node, f"{member.site}:robot:{name}")
