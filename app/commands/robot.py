"""`cubeling robot`."""

import time
from contextlib import suppress
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from app.commands.robot_conform import conform
from app.commands.robot_try import try_
from robot import RobotError, SimulatedPort, serial_ports
from robot.simulators.base import Simulated
from robot.simulators.memory import simulator_of

app = typer.Typer(
    help="Simulated robots and real ports.", no_args_is_help=True, rich_markup_mode="rich"
)

app.command()(conform)
app.command("try")(try_)


@app.command()
def simulate(
    name: Annotated[
        str, typer.Argument(metavar="NAME[?FAULTS]", help="Which robot, and what goes wrong.")
    ] = "cubeling",
    seed: Annotated[
        int | None, typer.Option(min=0, help="Which robot of the litter it is.")
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="End after this long; without, at Ctrl-C.")
    ] = None,
) -> None:
    """Put a simulated robot behind a real serial port of this computer.

    The port is a pseudo-terminal (on Windows a TCP port); any program that speaks the robot's
    protocol can open it.

    Example: [cyan]cubeling robot simulate[/], then in another terminal
    [cyan]cubeling play companion --robot PORT[/] with the port that it printed.

    What may go wrong, as in [cyan]cubeling robot simulate "cubeling?drop=0.05&stall=1s/10s"[/]:

    [bold]drop=0.05[/], [bold]dup=0.02[/], [bold]split=0.1[/]   chance that a frame is lost, comes
    twice, comes in two pieces

    [bold]flip=0.001[/]   chance of every byte that one of its bits is wrong

    [bold]babble=200[/]   noise between the frames, bytes a second

    [bold]delay=20ms[/], [bold]delay=20ms~5ms[/]   everything is so late, with jitter

    [bold]stall=1s[/], [bold]stall=1s/10s[/]   it hangs for 1 s, on average every 20 s, or every 10

    [bold]unplug=30s[/], [bold]unplug=30s/2s[/]   on average every 30 s it is unplugged, for 1 s or
    for 2; here the line is silent then, for a pseudo-terminal cannot vanish and come back

    [bold]reboot=60s[/]   it reboots, on average every 60 s

    [bold]seed=7[/]   of all that is drawn

    The same words work in every URL: [cyan]--robot "sim:cubeling?drop=0.05"[/].
    """
    console = Console()
    if seconds is not None and not seconds >= 0:  # also refuses NaN
        raise RobotError(f"a robot can be simulated for 0 seconds or more, not for {seconds:g}")
    simulator = simulator_of(_with_seed(name, seed))
    with SimulatedPort(simulator) as port:
        protocol = name.removeprefix("sim:").partition("?")[0]
        shown = port.url if protocol == "cubeling" else f"{protocol}:{port.url}"
        console.print(f"A robot listens on [bold]{port.url}[/]", soft_wrap=True)
        console.print(
            f"[dim]cubeling play companion --robot {shown}      Ctrl-C ends it[/]",
            soft_wrap=True,
        )
        if "unplug=" in name:
            console.print(
                "[dim]While it is unplugged the line is silent: this port cannot vanish and come "
                "back[/]",
                soft_wrap=True,
            )
        end = None if seconds is None else time.monotonic() + seconds
        with suppress(KeyboardInterrupt), Live(console=console, transient=True) as live:
            while end is None or time.monotonic() < end:
                if console.is_terminal:
                    live.update(_portrait(simulator))
                time.sleep(0.1)


@app.command("list")
def list_() -> None:
    """List the serial ports of this computer and what may be behind them.

    Example: [cyan]cubeling robot list[/]
    """
    ports = serial_ports()
    console = Console()
    if not ports:
        console.print("No serial port here. A robot to try with: [cyan]cubeling robot simulate[/]")
        return
    table = Table("port", "what", "probably")
    for port in ports:
        table.add_row(port.url, port.description.replace("n/a", ""), port.guess or "")
    console.print(table)


def _with_seed(name: str, seed: int | None) -> str:
    """Write `--seed` into the robot's name."""
    return name if seed is None else f"{name}{'&' if '?' in name else '?'}seed={seed}"


def _portrait(simulator: Simulated) -> Text:
    """How the robot feels now, in a line."""
    valence, label = simulator.portrait()
    bar = "".join("●" if abs(place - 10 * (valence + 1)) <= 0.5 else "·" for place in range(21))
    return Text.assemble(("angry ", "red"), bar, (" happy", "green"), f"   {label}")
