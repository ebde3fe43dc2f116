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
from affect.words import WORD_PLACES
from robot import Robot, RobotError, Telemetry, connect

POLL_INTERVAL_S = 0.05
"""How often the telemetry is read."""

MAX_MOOD_S = 3600.0
"""The longest time for which a mood may be held."""


def try_(
    port: Annotated[
        str,
        typer.Argument(help="/dev/ttyACM0, pleo:COM3, opencat:/dev/ttyUSB0, sim:pleo …"),
    ],
    mood: Annotated[list[str] | None, typer.Option(help="Only this mood; repeatable.")] = None,
    seconds: Annotated[float, typer.Option(help="How long each mood is held.")] = 5.0,
    settings: Annotated[
        Path | None, typer.Option(help="A .toml file for the robot: what it does for each mood.")
    ] = None,
) -> None:
    """Let a robot show its moods one after the other, and report the result of each.

    The result says how soon the robot acknowledged the mood, how soon it showed it if the robot
    reports that, and the robot's own error messages. It ends with the robot neutral, or at Ctrl-C.

    Example: [cyan]cubeling robot try pleo:/dev/ttyACM0 --settings my-pleo.toml[/]
    """
    console = Console(highlight=False)
    if not 0.1 <= seconds <= MAX_MOOD_S:
        raise RobotError(f"a mood is held for 0.1 to {MAX_MOOD_S:g} seconds, not {seconds:g}")
    with connect(port, settings=settings) as robot:
        moods = robot.catalogue.moods
        for name in mood or ():
            if name not in moods:
                raise RobotError(f"{robot.catalogue.name} has no mood {name!r}: {', '.join(moods)}")
        console.print(_describe(robot), soft_wrap=True)
        with suppress(KeyboardInterrupt):
            for name in mood or (*moods, moods[0]):
                console.print(_try_mood(robot, name, seconds, console), soft_wrap=True)
        robot.stop()
        robot.check()


def _describe(robot: Robot) -> str:
    catalogue = robot.catalogue
    lists = ("moods", catalogue.moods), ("motions", catalogue.motions), ("sounds", catalogue.sounds)
    contents = "; ".join(f"{name} {', '.join(words)}" for name, words in lists if words)
    joints = len(catalogue.joints)
    return f"[bold]{catalogue.name}[/] ({catalogue.firmware}), {joints} joints; {contents}"


def _try_mood(robot: Robot, word: str, seconds: float, console: Console) -> str:
    """Request a mood, watch the telemetry, and return the result in a line."""
    emotion = Emotion(*WORD_PLACES.get(word, (0.0, 0.0)), word)
    began = time.monotonic()
    robot.express(emotion)
    acknowledged_s = shown_s = math.nan
    with Live(console=console, transient=True, refresh_per_second=10) as live:
        while (now := time.monotonic()) < began + seconds:
            telemetry = robot.telemetry
            if math.isnan(acknowledged_s) and telemetry.acknowledged == emotion:
                acknowledged_s = now - began
            if math.isnan(shown_s) and telemetry.label == word:
                shown_s = now - began
            if console.is_terminal:
                live.update(_table(telemetry))
            time.sleep(POLL_INTERVAL_S)
    telemetry = robot.telemetry
    acknowledged, shown = f"acknowledged {acknowledged_s:.2f} s", f"shown {shown_s:.2f} s"
    if math.isnan(acknowledged_s):
        acknowledged = "[red]not acknowledged[/]"
    if math.isnan(shown_s):
        has_feedback = telemetry.observed is not None
        shown = "[red]not shown[/]" if has_feedback else "it does not say what it shows"
    limp = "  [red]its motors have no power[/]" if telemetry.limp else ""
    complaint = telemetry.complaint
    error = f"  [red]it complains: {escape(complaint)}[/]" if complaint else ""
    return f"{word:12} {acknowledged}, {shown}; link {telemetry.state}{limp}{error}"


def _table(telemetry: Telemetry) -> Table:
    table = Table(show_header=False, box=None, padding=(0, 2))
    battery = "" if telemetry.battery is None else f"{100 * telemetry.battery:.0f} %"
    table.add_row("link", telemetry.state, "battery", battery)
    table.add_row(
        "requested", _point(telemetry.commanded), "acknowledged", _point(telemetry.acknowledged)
    )
    table.add_row("shown", _point(telemetry.observed), "as", telemetry.label or "")
    table.add_row("motion", telemetry.motion or "", "sound", telemetry.sound or "")
    counts = telemetry.counts
    table.add_row("retries", str(counts.retries), "damaged", str(counts.crc_errors))
    return table


def _point(emotion: Emotion | None) -> str:
    return "" if emotion is None else f"{emotion.valence:+.2f} {emotion.arousal:+.2f}"
