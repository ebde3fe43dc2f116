"""`cubeling bridge`."""

import threading
import time
from collections.abc import Iterable
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.live import Live

from app.commands.access import Broker, Ca, PasswordFile, Site
from app.errors import AppError
from app.running.bridge import Bridge, Order
from app.running.network import SITE, Access, Network
from app.ui.roster import line, table
from robot.network import Credentials, Member
from robot.network.following import HOLD
from robot.network.messages import Status
from robot.network.player import MAX_AGE
from robot.network.topics import EVERYONE

TURN_EVERY = 0.02
"""Recorded players are looked after this often [s]."""

DRAW_EVERY = 0.25
"""The table is drawn this often [s]."""

FAREWELL = 1.0
"""Wait after the last recorded session's end, so that robots take the last actions [s]."""


def bridge(
    mqtt: Broker = None,
    robot: Annotated[
        list[str] | None,
        typer.Option(help="NAME=URL: drive this robot, as --robot of `play` takes it; repeatable."),
    ] = None,
    play: Annotated[
        list[str] | None,
        typer.Option(help="NAME=SESSION.mcap: a recorded session is this player; repeatable."),
    ] = None,
    follow: Annotated[
        list[str] | None,
        typer.Option(help="Whom the robots follow: PLAYER, SITE/PLAYER, SITE/*; all of the site."),
    ] = None,
    site: Site = SITE,
    user: Annotated[str | None, typer.Option(help="The broker's user, if not in the URL.")] = None,
    password_file: PasswordFile = None,
    ca: Ca = None,
    cert: Annotated[
        Path | None, typer.Option(help="Our own certificate (PEM), if the broker asks for one.")
    ] = None,
    key: Annotated[Path | None, typer.Option(help="Its private key (PEM).")] = None,
    hold: Annotated[
        float, typer.Option(min=0.0, help="Seconds for which a gone player's mood is kept.")
    ] = HOLD,
    max_age: Annotated[
        float, typer.Option(min=0.0, help="Seconds after which an action is too late.")
    ] = MAX_AGE,
    watch: Annotated[bool, typer.Option("--watch", help="Print every message in a line.")] = False,
    seconds: Annotated[
        float | None, typer.Option(min=0.0, help="End after this long; without, at Ctrl-C.")
    ] = None,
) -> None:
    """Let robots follow players in other places, over an MQTT broker; docs/many.md tells how.

    Without --mqtt, players and robots meet within this one program. With neither robots nor
    players it shows who is there.

    Example: [cyan]cubeling bridge --mqtt mqtt://museum.local --robot rex=/dev/ttyACM0[/]
    """
    order = Order(
        named(robot or (), "--robot", "rex=sim"),
        {name: Path(path) for name, path in named(play or (), "--play", "ann=a.mcap").items()},
        tuple(follow or (EVERYONE,)),
        hold,
        max_age,
    )
    if mqtt is None and not (order.robots and order.sessions):
        raise AppError(
            "without --mqtt there is nobody else here: give both --robot and --play, "
            "or the broker with --mqtt URL"
        )
    access = Access(mqtt, site, Credentials(user, password_file, ca, cert, key))
    console = Console()
    lines = Lines(console, every=watch)
    with Network(access) as network, Bridge(order, network, lines.message) as at_work:
        where = "within this program" if network.address is None else f"over {network.address}"
        console.print(f"[dim]The site {site} meets {where}.      Ctrl-C ends it[/]")
        with suppress(KeyboardInterrupt):
            run(at_work, console, lines, seconds, live=console.is_terminal and not watch)
        lines.quiet = True


def run(
    bridge: Bridge, console: Console, lines: "Lines", seconds: float | None, *, live: bool
) -> None:
    """Keep a bridge at work until its time is over, or, without a broker, its players are done."""
    began = time.monotonic()
    end = None if seconds is None else began + seconds
    drawn = began - DRAW_EVERY
    with (
        Live(console=console, transient=True, auto_refresh=False) if live else nullcontext() as view
    ):
        while end is None or time.monotonic() < end:
            now = time.monotonic()
            if not bridge.advance(now) and bridge.network.address is None and end is None:
                end = now + FAREWELL
            lines.connections(bridge)
            if isinstance(view, Live) and now - drawn >= DRAW_EVERY:
                drawn = now
                with bridge.roster.lock:
                    view.update(table(bridge.roster.endpoint, now), refresh=True)
            time.sleep(TURN_EVERY)


class Lines:
    """Prints in single lines who comes and goes, how the connections are, and what is said.

    Parameters
    ----------
    console
        Where.
    every
        Whether to print every message.
    """

    def __init__(self, console: Console, *, every: bool) -> None:
        self._console = console
        self.quiet = False
        """Whether nothing more is to be said."""
        self._every = every
        self._lock = threading.Lock()
        self._present: dict[Member, str] = {}
        self._told: dict[str, str] = {}

    def message(self, member: Member, kind: str, message: Any) -> None:
        """Take a message; called from a thread of the network's."""
        if self.quiet:
            return
        if self._every:
            self._print(line(member, kind, message))
        elif isinstance(message, Status) and self._present.get(member) != message.status:
            if member in self._present or message.status == "online":
                self._print(line(member, kind, message))
            self._present[member] = message.status

    def connections(self, bridge: Bridge) -> None:
        """Say in one line each what is wrong with a connection, or is right again."""
        shared = bridge.roster.trouble
        for name, station in {"": bridge.roster, **bridge.stations}.items():
            trouble = station.trouble
            told, self._told[name] = self._told.get(name, ""), trouble
            if name and trouble == shared:
                continue  # the onlooker says it for all
            if trouble and (not told or (station.state == "refused" and trouble != told)):
                again = "; trying again" if station.state == "away" else ""
                self._print(f"{trouble}{again}")
            elif told and not trouble:
                self._print("connected again")

    def _print(self, text: str) -> None:
        with self._lock:
            self._console.print(text, markup=False, highlight=False, soft_wrap=True)


def named(given: Iterable[str], option: str, example: str) -> dict[str, str]:
    """Return what options of the form NAME=VALUE say.

    Raises
    ------
    AppError
        If one has another form, or a name is given twice.
    """
    values: dict[str, str] = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise AppError(f"{option} {text}: a name and what it is, as in {option} {example}")
        if name in values:
            raise AppError(f"{option}: {name} is named twice")
        values[name] = value
    return values
