"""`cubeling character`: a file for each of its commands."""

import typer

from cubeling.app.commands.character.graph import graph
from cubeling.app.commands.character.inspection import inspect_command
from cubeling.app.commands.character.locomotion import locomotion

app = typer.Typer(
    help="Inspect characters and motions, and make clips to walk with.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
)

app.command("inspect")(inspect_command)
app.command()(graph)
app.command()(locomotion)
