"""What the commands that play a character have in common."""

from typing import Annotated

import typer

CHARACTER_GROUP = "The character"

OwnMotionsOption = Annotated[
    bool,
    typer.Option(
        "--own-motions-only",
        help="A character without clips keeps its rest pose, instead of playing those of a bundled "
        "one of its kind.",
        rich_help_panel=CHARACTER_GROUP,
    ),
]
