"""`cubeling character`: a file for each of its commands."""

from cubeling.app.command_group import CommandGroup
from cubeling.app.commands.look.character.graph import graph
from cubeling.app.commands.look.character.inspection import inspect_command
from cubeling.app.commands.look.character.locomotion import locomotion

app = CommandGroup("Inspect characters and motions, and make clips to walk with.")

app.command("inspect")(inspect_command)
app.command()(graph)
app.command()(locomotion)
