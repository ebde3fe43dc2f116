"""The command `cubeling bridge`."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.live import Live

from cubeling.app.commands.access import BROKER_GROUP, Broker, Ca, PasswordFile, Site
from cubeling.app.commands.play.complete import complete_session
from cubeling.app.errors import AppError
from cubeling.app.ui.literal_text import literal_text
from cubeling.robot.network import ANY_NAME, DEFAULT_SITE, HOLD_S, MAX_AGE_S

if TYPE_CHECKING:
    from cubeling.app.running.network.bridge import Bridge
    from cubeling.robot.network import Member

STEP_EVERY_S = 0.02
"""Time between two steps of the recorded players [s]."""

DRAW_EVERY_S = 0.25
"""Time between two updates of the table [s]."""

FINAL_WAIT_S = 1.0
"""Time for the robots to take the last actions after the end of the last session [s]."""


def bridge(
    mqtt: Broker = None,
    robot: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME=URL: drive this robot; the URL is as for play --robot. Repeatable."
        ),
    ] = None,
    play: Annotated[
        list[str] | None,
        typer.Option(help="NAME=FILE.mcap: publish a session as this player. Repeatable."),
    ] = None,
    follow: Annotated[
        list[str] | None,
        typer.Option(
            help="Which players to follow: PLAYER, SITE/PLAYER or SITE/*; by default all of your "
            "site. PLAYER:NAME is a further character of a player's cast, and ROBOT=PLAYER is for "
            "one of the robots only. Repeatable."
        ),
    ] = None,
    site: Site = DEFAULT_SITE,
    user: Annotated[
        str | None, typer.Option(help="User name, if not in the URL.", rich_help_panel=BROKER_GROUP)
    ] = None,
    password_file: PasswordFile = None,
    ca: Ca = None,
    cert: Annotated[
        Path | None,
        typer.Option(
            help="Client certificate (PEM), if the broker requires one.",
            rich_help_panel=BROKER_GROUP,
        ),
    ] = None,
    key: Annotated[
        Path | None,
        typer.Option(help="Private key of the certificate (PEM).", rich_help_panel=BROKER_GROUP),
    ] = None,
    hold: Annotated[
        float,
        typer.Option(min=0.0, help="How long the mood of a player who left is kept, in seconds."),
    ] = HOLD_S,
    max_age: Annotated[
        float,
        typer.Option(min=0.0, help="How old an action may be when a robot takes it, in seconds."),
    ] = MAX_AGE_S,
    watch: Annotated[bool, typer.Option("--watch", help="Print every message as a line.")] = False,
    seconds: Annotated[
        float | None,
        typer.Option(min=0.0, help="End after this many seconds; without it, at Ctrl-C."),
    ] = None,
) -> None:
    """Let robots follow players on other computers, over an MQTT broker; see docs/many.md.

    Without --mqtt, players and robots communicate within this program. With --mqtt alone, it shows
    the members of the network.

    Example: cubeling bridge --play ann=recordings/companion.mcap --robot rex=sim
    """
    robots = values_by_name(robot or (), "--robot", "rex=sim")
    files = values_by_name(play or (), "--play", "ann=a.mcap")
    sessions = {name: Path(path) for name, path in files.items()}
    if mqtt is None and not (robots and sessions):
        raise AppError(
            "without --mqtt there are no other members: give both --robot and --play, "
            "or a broker with --mqtt URL"
        )
    from cubeling.app.running.network.bridge import Bridge
    from cubeling.app.running.network.connection import Network
    from cubeling.robot.network import Credentials

    credentials = Credentials(user, password_file, ca, cert, key)
    console = Console()
    printer = EventPrinter(console, every=watch)
    with (
        Network(mqtt, site, credentials) as network,
        Bridge(
            network,
            robots,
            sessions,
            complete=complete_session,
            follow=follow or (ANY_NAME,),
            hold=hold,
            max_age=max_age,
            on_message=printer.message,
        ) as running,
    ):
        where = "within this program" if network.address is None else f"over {network.address}"
        console.print(f"[dim]Site {site}, {where}.      Ctrl-C ends it[/]")
        with suppress(KeyboardInterrupt):
            run(running, console, printer, seconds, live=console.is_terminal and not watch)
        printer.quiet = True


def run(
    bridge: Bridge, console: Console, printer: EventPrinter, seconds: float | None, *, live: bool
) -> None:
    """Run a bridge until its time is over or, without a broker, until its players are done."""
    from cubeling.app.ui.roster import table

    began = time.monotonic()
    end = None if seconds is None else began + seconds
    drawn = began - DRAW_EVERY_S
    with (
        Live(console=console, transient=True, auto_refresh=False) if live else nullcontext() as view
    ):
        while end is None or time.monotonic() < end:
            now = time.monotonic()
            if not bridge.advance(now) and bridge.network.address is None and end is None:
                end = now + FINAL_WAIT_S
            printer.connections(bridge)
            printer.unknown_actions(bridge)
            if isinstance(view, Live) and now - drawn >= DRAW_EVERY_S:
                drawn = now
                with bridge.roster.lock:
                    view.update(table(bridge.roster.endpoint, now), refresh=True)
            time.sleep(STEP_EVERY_S)


class EventPrinter:
    """Prints every message, or only changes of presence, and problems of connections, in lines."""

    def __init__(self, console: Console, *, every: bool) -> None:
        self._console = console
        self.quiet = False
        """Whether to print nothing more."""
        self._every = every
        self._lock = threading.Lock()
        self._present: dict[Member, str] = {}
        self._problems: dict[str, str] = {}
        self._unknown: dict[str, list[str]] = {}

    def message(self, member: Member, kind: str, message: Any) -> None:
        """Print a message if it matters; called on a thread of the network."""
        from cubeling.app.ui.roster import line
        from cubeling.robot.network import StatusMessage

        if self.quiet:
            return
        if self._every:
            self._print(line(member, kind, message))
        elif isinstance(message, StatusMessage) and self._present.get(member) != message.status:
            if member in self._present or message.status == "online":
                self._print(line(member, kind, message))
            self._present[member] = message.status

    def connections(self, bridge: Bridge) -> None:
        """Print the problems of connections, and their end."""
        shared = bridge.roster.problem
        for name, client in {"": bridge.roster, **bridge.clients}.items():
            problem = client.problem
            before, self._problems[name] = self._problems.get(name, ""), problem
            if name and problem == shared:
                continue  # the roster's connection reports it for all
            if problem and (not before or (client.state == "refused" and problem != before)):
                retry = "; trying again" if client.state == "away" else ""
                self._print(f"{problem}{retry}")
            elif before and not problem:
                self._print("connected again")

    def unknown_actions(self, bridge: Bridge) -> None:
        """Print once for each action that a robot of this bridge lacks that it does nothing."""
        for name, robot in bridge.robots.items():
            for action in robot.unknown_actions[len(self._unknown.setdefault(name, [])) :]:
                self._unknown[name].append(action)
                self._print(f"{name} has no motion or sound '{action}': it does nothing then")

    def _print(self, text: str) -> None:
        with self._lock:
            self._console.print(literal_text(text), highlight=False, soft_wrap=True)


def values_by_name(given: Iterable[str], option: str, example: str) -> dict[str, str]:
    """Return the values of NAME=VALUE options by name; AppError for another form or a repeat."""
    values: dict[str, str] = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise AppError(f"{option} {text}: needs a name and a value, as in {option} {example}")
        if name in values:
            raise AppError(f"{option}: {name} is named twice")
        values[name] = value
    return values
