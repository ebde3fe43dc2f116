"""Options of every command that meets others over a broker."""

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from app.errors import AppError
from app.running.network import Access, Network
from app.running.players import PlayerLine
from robot.network import Credentials

Broker = Annotated[
    str | None,
    typer.Option(help="An MQTT broker: mqtt://USER@HOST, mqtts:// for TLS; see docs/many.md."),
]
PlayerName = Annotated[
    str | None,
    typer.Option(help="Publish over --mqtt, under this name, what the character does and feels."),
]
Site = Annotated[str, typer.Option(help="The place that we are at, for --mqtt.")]
PasswordFile = Annotated[
    Path | None,
    typer.Option(
        help="A file whose first line is the broker's password "
        "(or the environment variable CUBELING_MQTT_PASSWORD)."
    ),
]
Ca = Annotated[
    Path | None,
    typer.Option(help="The authority that signed the broker's certificate (PEM), for mqtts://."),
]


def publisher(
    url: str | None, name: str | None, site: str, credentials: Credentials, closing: ExitStack
) -> PlayerLine | None:
    """Connect a player where one is asked for; `closing` closes it.

    Raises
    ------
    RobotError, AppError
        If an option is wrong or missing, or the broker refuses.
    """
    if url is None and name is None:
        return None
    if url is None or name is None:
        raise AppError(
            "--mqtt needs --player NAME, so that others know who plays"
            if name is None
            else "--player needs --mqtt URL, the broker where others are"
        )
    network = closing.enter_context(Network(Access(url, site, credentials)))
    return PlayerLine(network, name, say=away)


def away(trouble: str) -> None:
    """Say in one line why nothing is published; a broker that is away is looked for."""
    Console(stderr=True, soft_wrap=True, highlight=False, markup=False).print(
        f"cubeling: {trouble}; until that is right, nobody hears the player"
    )
