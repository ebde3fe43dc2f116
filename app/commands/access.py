"""Options of the commands that use an MQTT broker."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from cubeling.app.errors import AppError
from cubeling.app.ui.literal_text import literal_text

if TYPE_CHECKING:
    from cubeling.app.running.network.players import CastPublisher

BROKER_GROUP = "Other computers, over an MQTT broker"
"""Heading of these options in a help."""

Broker = Annotated[
    str | None,
    typer.Option(
        help="An MQTT broker: mqtt://USER@HOST, mqtts:// for TLS; see docs/many.md.",
        rich_help_panel=BROKER_GROUP,
    ),
]
PlayerName = Annotated[
    str | None,
    typer.Option(
        help="Publish the character's actions and emotions over --mqtt, under this name.",
        rich_help_panel=BROKER_GROUP,
    ),
]
Site = Annotated[
    str,
    typer.Option(
        help="Name of your site on the network, for --mqtt.", rich_help_panel=BROKER_GROUP
    ),
]
PasswordFile = Annotated[
    Path | None,
    typer.Option(
        help="A file whose first line is the broker's password "
        "(or use the environment variable CUBELING_MQTT_PASSWORD).",
        rich_help_panel=BROKER_GROUP,
    ),
]
Ca = Annotated[
    Path | None,
    typer.Option(
        help="Certificate of the authority (PEM) that signed the broker's, for mqtts://.",
        rich_help_panel=BROKER_GROUP,
    ),
]


@contextmanager
def publisher(
    url: str | None, name: str | None, site: str, password_file: Path | None, ca: Path | None
) -> Iterator[tuple[CastPublisher, ...]]:
    """Connect a player if the options ask for one, and disconnect it at the end.

    Raises RobotError or AppError if an option is wrong or missing, or the broker refuses.
    """
    check_publisher(url, name)
    if url is None or name is None:
        yield ()
        return
    from cubeling.app.running.network.connection import Network
    from cubeling.app.running.network.players import CastPublisher
    from cubeling.robot.network import Credentials

    with Network(url, site, Credentials(None, password_file, ca)) as network:
        yield (CastPublisher(network, name, on_problem=report_problem),)


def check_publisher(url: str | None, name: str | None) -> None:
    """Refuse a broker without a player, and a player without a broker; raises AppError."""
    if (url is None) != (name is None):
        raise AppError(
            "--mqtt needs --player NAME, your name on the network"
            if name is None
            else "--player needs --mqtt URL, the address of the broker"
        )


def report_problem(problem: str) -> None:
    """Print in one line why nothing is published; the connection is tried again."""
    Console(stderr=True, soft_wrap=True, highlight=False).print(
        literal_text(f"cubeling: {problem}; nothing is published until it is solved")
    )
