"""`cubeling robot`: a file for each of its commands."""

from cubeling.app.command_group import CommandGroup, former_spellings
from cubeling.app.commands.robots.robot.conform import conform
from cubeling.app.commands.robots.robot.ports import list_
from cubeling.app.commands.robots.robot.simulate import simulate
from cubeling.app.commands.robots.robot.trial import try_

app = CommandGroup("Simulate, try out and test robots, and list the serial ports.")

app.command()(conform)
app.command("try", context_settings=former_spellings({"settings": "robot-settings"}))(try_)
app.command()(simulate)
app.command("list")(list_)
