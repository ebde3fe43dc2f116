"""`cubeling robot try`."""

import math
import time
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.markup import escape
from rich.table import Table

from affect import Emotion
from affect.words import PLACES
from robot import Robot, RobotError, Telemetry, connect

LOOK_EVERY = 0.05
"""How often the robot is looked at [s]."""

LONGEST = 3600.0
"""A mood is held no longer [s]."""


def try_(
    port: Annotated[
        str,
        typer.Argument(help="/dev/ttyACM0, pleo:COM3, opencat:/dev/ttyUSB0, sim:pleo …"),
    ],
    mood: Annotated[
        list[str] | None, typer.Option(help="Only this mood; may be given again.")
    ] = None,
    seconds: Annotated[float, typer.Option(help="How long each mood is held.")] = 5.0,
    settings: Annotated[
        Path | None, typer.Option(help="A .toml file for the robot: what it does in each mood.")
    ] = None,
) -> None:
    """Let a robot show its moods one after the other, and tell how well it does.

    For each: how soon the robot acknowledged it, how soon it showed it where it says what it shows,
    and what it complains of. Ends with the robot neutral; Ctrl-C ends it earlier.

    Example: [cyan]cubeling robot try pleo:/dev/ttyACM0 --settings my-pleo.toml[/]
    """
    console = Console(highlight=False)
    if not 0.1 <= seconds <= LONGEST:
        raise RobotError(f"a mood is held for 0.1 to {LONGEST:g} seconds, not {seconds:g}")
    with connect(port, settings=settings) as robot:
        words = robot.catalogue.moods
        for one in mood or ():
            if one not in words:
                raise RobotError(f"{robot.catalogue.name} has no mood {one!r}: {', '.join(words)}")
        console.print(_introduction(robot), soft_wrap=True)
        with suppress(KeyboardInterrupt):
            for word in mood or (*words, words[0]):
                console.print(_show(robot, word, seconds, console), soft_wrap=True)
        robot.stop()
        robot.check()


def _introduction(robot: Robot) -> str:
    has = robot.catalogue
    lists = (("moods", has.moods), ("motions", has.motions), ("sounds", has.sounds))
    told = "; ".join(f"{name} {', '.join(words)}" for name, words in lists if words)
    return f"[bold]{has.name}[/] ({has.firmware}), {len(has.joints)} joints; {told}"


def _show(robot: Robot, word: str, seconds: float, console: Console) -> str:
    """Ask for a mood, watch for a while, and say what came of it in a line."""
    emotion = Emotion(*PLACES.get(word, (0.0, 0.0)), word)
    began = time.monotonic()
    robot.express(emotion)
    taken = shown = math.nan
    with Live(console=console, transient=True, refresh_per_second=10) as live:
        while (now := time.monotonic()) < began + seconds:
            known = robot.telemetry
            if math.isnan(taken) and known.acknowledged == emotion:
                taken = now - began
            if math.isnan(shown) and known.label == word:
                shown = now - began
            if console.is_terminal:
                live.update(_state(known))
            time.sleep(LOOK_EVERY)
    known = robot.telemetry
    acknowledged = (
        "[red]not acknowledged[/]" if math.isnan(taken) else f"acknowledged {taken:.2f} s"
    )
    if not math.isnan(shown):
        seen = f"shown {shown:.2f} s"
    else:
        silent = known.observed is None
        seen = "it does not say what it shows" if silent else "[red]not shown[/]"
    limp = "  [red]its motors have no power[/]" if known.limp else ""
    complaint = f"  [red]it complains: {escape(known.complaint)}[/]" if known.complaint else ""
    return f"{word:12} {acknowledged}, {seen}; link {known.state}{limp}{complaint}"


def _state(known: Telemetry) -> Table:
    table = Table(show_header=False, box=None, padding=(0, 2))
    battery = "" if known.battery is None else f"{100 * known.battery:.0f} %"
    table.add_row("link", known.state, "battery", battery)
    table.add_row("asked", _point(known.commanded), "taken", _point(known.acknowledged))
    table.add_row("shown", _point(known.observed), "as", known.label or "")
    table.add_row("motion", known.motion or "", "sound", known.sound or "")
    counts = known.counts
    table.add_row("repeats", str(counts.retries), "damaged", str(counts.crc_errors))
    return table


def _point(emotion: Emotion | None) -> str:
    return "" if emotion is None else f"{emotion.valence:+.2f} {emotion.arousal:+.2f}"
