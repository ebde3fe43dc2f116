"""`cubeling robot`."""

import time
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table

from robot import SimulatedPort, list_ports

app = typer.Typer(
    help="Simulated robots and real ports.", no_args_is_help=True, rich_markup_mode="rich"
)


@app.command()
def simulate(
    seed: Annotated[int, typer.Option(help="Which robot of the litter it is.")] = 0,
    seconds: Annotated[float | None, typer.Option(help="End after this long; without, at Ctrl-C.")] = None,
) -> None:
    """Put a simulated dinosaur robot behind a real serial port of this computer.

    The port is a pseudo-terminal (on Windows a TCP port); any program that speaks robot/PROTOCOL.md can open it.

    Example: [cyan]cubeling robot simulate[/], then in another terminal
    [cyan]cubeling play companion --robot PORT[/] with the port that it printed.
    """
    console = Console()
    with SimulatedPort(seed=seed, clock=time.monotonic) as port:
        console.print(f"A robot listens on [bold]{port.url}[/]", soft_wrap=True)
        console.print(f"[dim]cubeling play companion --robot {port.url}      Ctrl-C ends it[/]", soft_wrap=True)
        end = None if seconds is None else time.monotonic() + seconds
        try:
            with Live(console=console, refresh_per_second=8, transient=True) as live:
                while end is None or time.monotonic() < end:
                    if console.is_terminal:
                        live.update(_portrait(port))
                    time.sleep(0.125)
        except KeyboardInterrupt:
            pass


@app.command("list")
def list_() -> None:
    """List the serial ports of this computer and what may be behind them.

    Example: [cyan]cubeling robot list[/]
    """
    ports = list_ports()
    console = Console()
    if not ports:
        console.print("No serial port here. A robot to try with: [cyan]cubeling robot simulate[/]")
        return
    table = Table("port", "what", "probably")
    for port in ports:
        table.add_row(port.device, port.description, port.guess or "")
    console.print(table)


def _portrait(port: SimulatedPort) -> Table:
    """How the robot is, as a small table."""
    table = Table.grid(padding=(0, 2))
    for name, value in port.portrait().items():
        table.add_row(f"[dim]{name}[/]", value)
    return table
