"""`cubeling robot`: a file for each of its commands."""

import typer

from cubeling.app.commands.robot.conform import conform
from cubeling.app.commands.robot.ports import list_
from cubeling.app.commands.robot.simulate import simulate
from cubeling.app.commands.robot.trial import try_

app = typer.Typer(
    help="Simulate, try out and test robots, and list the serial ports.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
)

app.command()(conform)
app.command("try")(try_)
app.command()(simulate)
app.command("list")(list_)
