"""`cubeling robot`."""

import time
from contextlib import suppress
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from robot import SimulatedPort, Simulator, serial_ports

app = typer.Typer(
    help="Simulated robots and real ports.", no_args_is_help=True, rich_markup_mode="rich"
)


@app.command()
def simulate(
    seed: Annotated[int, typer.Option(help="Which robot of the litter it is.")] = 0,
    seconds: Annotated[
        float | None, typer.Option(help="End after this long; without, at Ctrl-C.")
    ] = None,
) -> None:
    """Put a simulated dinosaur robot behind a real serial port of this computer.

    The port is a pseudo-terminal (on Windows a TCP port); any program that speaks
    robot/PROTOCOL.md can open it.

    Example: [cyan]cubeling robot simulate[/], then in another terminal
    [cyan]cubeling play companion --robot PORT[/] with the port that it printed.
    """
    console = Console()
    simulator = Simulator(seed)
    with SimulatedPort(simulator) as port:
        console.print(f"A robot listens on [bold]{port.url}[/]", soft_wrap=True)
        console.print(
            f"[dim]cubeling play companion --robot {port.url}      Ctrl-C ends it[/]",
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


def _portrait(simulator: Simulator) -> Text:
    """How the robot feels now, in a line."""
    feeling = simulator.body.feeling
    bar = "".join(
        "●" if abs(place - 10 * (feeling.valence + 1)) <= 0.5 else "·" for place in range(21)
    )
    return Text.assemble(("angry ", "red"), bar, (" happy", "green"), f"   {feeling.label}")
