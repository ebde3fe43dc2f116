"""The command `cubeling robot simulate`."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.text import Text

if TYPE_CHECKING:
    from cubeling.robot import Simulated


def simulate(
    name: Annotated[
        str, typer.Argument(metavar="NAME[?FAULTS]", help="Which robot, and its faults.")
    ] = "cubeling",
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the random faults.")] = None,
    seconds: Annotated[
        float | None, typer.Option(help="End after this many seconds; without it, at Ctrl-C.")
    ] = None,
) -> None:
    """Put a simulated robot behind a real serial port of this computer.

    The port is a pseudo-terminal (on Windows a TCP port). Any program that speaks the robot's
    protocol can open it.

    Example: cubeling robot simulate, then in another terminal
    cubeling play companion --robot PORT with the port that it printed.

    Faults, as in cubeling robot simulate "cubeling?drop=0.05&stall=1s/10s":

    drop=0.05, dup=0.02, split=0.1   probability that a frame is lost,
    duplicated, split in two

    flip=0.001   probability for each byte that one of its bits is flipped

    babble=200   noise between the frames, in bytes a second

    delay=20ms, delay=20ms~5ms   latency, with jitter

    stall=1s, stall=1s/10s   it hangs for 1 s, on average every 20 s or every 10 s

    unplug=30s, unplug=30s/2s   it is unplugged on average every 30 s, for 1 s or
    for 2 s; here the line is silent meanwhile, as a pseudo-terminal cannot disappear and come back

    reboot=60s   it reboots, on average every 60 s

    seed=7   seed of the random numbers

    The same options work in every URL: --robot "sim:cubeling?drop=0.05".
    """
    from cubeling.robot import RobotError, SimulatedPort, simulator_of

    console = Console()
    if seconds is not None and not seconds >= 0:  # also refuses NaN
        raise RobotError(f"a robot can be simulated for 0 seconds or more, not for {seconds:g}")
    if seed is not None:
        name += f"{'&' if '?' in name else '?'}seed={seed}"
    simulator = simulator_of(name)
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
                "[dim]While it is unplugged the line is silent: this port cannot disappear and "
                "come back[/]",
                soft_wrap=True,
            )
        end = None if seconds is None else time.monotonic() + seconds
        with suppress(KeyboardInterrupt), Live(console=console, transient=True) as live:
            while end is None or time.monotonic() < end:
                if console.is_terminal:
                    live.update(_emotion_line(simulator))
                time.sleep(0.1)


def _emotion_line(simulator: Simulated) -> Text:
    valence, label = simulator.portrait()
    bar = "".join("●" if abs(place - 10 * (valence + 1)) <= 0.5 else "·" for place in range(21))
    return Text.assemble(("angry ", "red"), bar, (" happy", "green"), f"   {label}")
