"""The command `cubeling robot try`."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from cubeling.affect import Emotion
from cubeling.app.counted import quantity
from cubeling.app.ui.literal_text import literal_text

if TYPE_CHECKING:
    from cubeling.app.commands.robots.robot.trials import RobotTrial
    from cubeling.robot import Robot, Telemetry

POLL_INTERVAL_S = 0.05
"""How often the telemetry is read."""

MAX_MOOD_S = 3600.0
"""The longest time for which a mood may be held."""

SEVERITY_STYLES = {"information": "dim", "warning": "yellow", "error": "red"}
"""How each severity of a robot's log is printed."""


def try_(
    port: Annotated[
        str,
        typer.Argument(help="sim, /dev/ttyACM0, pleo:COM3, opencat:/dev/ttyUSB0, sim:pleo …"),
    ],
    mood: Annotated[list[str] | None, typer.Option(help="Try only this mood. Repeatable.")] = None,
    seconds: Annotated[float, typer.Option(help="How long each mood is held.")] = 5.0,
    joint: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=ANGLE", help="Try only this joint, as in 'neck up=10deg'. Repeatable."
        ),
    ] = None,
    settings: Annotated[
        Path | None,
        typer.Option(
            "--robot-settings", help="A .toml file for the robot: what it does for each mood."
        ),
    ] = None,
) -> None:
    """Let a robot show its moods one after the other, and report the result of each.

    The result says how soon the robot acknowledged the mood, how soon it showed it if the robot
    reports that, and the robot's own error messages; lines of its log appear as they come. A robot
    without moods is asked for three emotions, and for its motions and sounds. A joint turns to its
    angle within a second and is held there until the end. Ctrl-C ends the trial early; the robot
    ends neutral.

    The exit code is 1 if the robot acknowledged and showed nothing at all.

    Example: cubeling robot try sim:pleo --mood happy
    """
    from cubeling.app.commands.robots.robot.trials import trials_of
    from cubeling.robot import RobotError, connect

    console = Console(highlight=False)
    if not 0.1 <= seconds <= MAX_MOOD_S:
        raise RobotError(f"a mood is held for 0.1 to {MAX_MOOD_S:g} seconds, not {seconds:g}")
    successes: list[bool] = []
    with connect(port, settings=settings) as robot:
        trials = trials_of(robot, mood or (), joint or ())
        log = LogPrinter(console, time.monotonic())
        console.print(_describe(robot), soft_wrap=True)
        with suppress(KeyboardInterrupt):
            for trial in trials:
                succeeded, line = _try(robot, trial, seconds, log)
                successes.append(succeeded)
                console.print(line, soft_wrap=True)
        robot.stop()
        robot.check()
    if successes and not any(successes):
        raise typer.Exit(1)


def _describe(robot: Robot) -> Text:
    catalogue = robot.catalogue
    lists = ("moods", catalogue.moods), ("motions", catalogue.motions), ("sounds", catalogue.sounds)
    contents = "; ".join(f"{name} {', '.join(words)}" for name, words in lists if words)
    name = literal_text(catalogue.name)
    name.stylize("bold")
    joints = quantity(len(catalogue.joints), "joint")
    rest = literal_text(f" ({catalogue.firmware}), {joints}; {contents}".rstrip("; "))
    moodless = "\nIt has no moods: its emotions, motions and sounds are tried."
    return Text.assemble(name, rest, "" if catalogue.moods else moodless)


class LogPrinter:
    """Prints the lines of a robot's log, each once."""

    def __init__(self, console: Console, start: float) -> None:
        self.console = console
        """Where it prints."""
        self._start = start
        self._last = 0

    def update(self, telemetry: Telemetry) -> None:
        """Print the lines that are new."""
        for line in telemetry.log:
            if line.number > self._last:
                self._last = line.number
                lost = f" ({line.lost} before it lost)" if line.lost else ""
                self.console.print(
                    Text.assemble(
                        (f"log {line.timestamp - self._start:+8.2f} s  ", "dim"),
                        (f"{line.severity}: ", SEVERITY_STYLES[line.severity]),
                        literal_text(line.text + lost),
                    ),
                    soft_wrap=True,
                )


def _try(robot: Robot, trial: RobotTrial, seconds: float, log: LogPrinter) -> tuple[bool, Text]:
    """Start a trial and watch the telemetry; return whether it succeeded, and a line about it."""
    console = log.console
    began = time.monotonic()
    trial.start()
    acknowledged_s = shown_s = math.nan
    with Live(console=console, transient=True, refresh_per_second=10) as live:
        while (now := time.monotonic()) < began + seconds:
            telemetry = robot.telemetry
            if math.isnan(acknowledged_s) and telemetry.acknowledged == trial.emotion:
                acknowledged_s = now - began
            if math.isnan(shown_s) and trial.shown(telemetry):
                shown_s = now - began
            log.update(telemetry)
            if console.is_terminal:
                live.update(_table(telemetry))
            time.sleep(POLL_INTERVAL_S)
    telemetry = robot.telemetry
    parts: list[str | tuple[str, str]] = []
    if trial.emotion is not None:
        parts += [_after("acknowledged", acknowledged_s), ", "]
    if math.isnan(shown_s) and telemetry.observed is None:
        parts.append("it does not say what it shows")
    else:
        parts.append(_after(trial.answer, shown_s))
    parts.append(f"; link {telemetry.state}")
    if telemetry.limp:
        parts.append(("  its motors have no power", "red"))
    if telemetry.complaint:
        parts.append((f"  it complains: {literal_text(telemetry.complaint).plain}", "red"))
    took = trial.emotion is not None and not math.isnan(acknowledged_s)
    name = literal_text(f"{trial.name:12} ")
    return took or not math.isnan(shown_s), Text.assemble(name, *parts)


def _after(what: str, seconds: float) -> str | tuple[str, str]:
    return (f"not {what}", "red") if math.isnan(seconds) else f"{what} {seconds:.2f} s"


def _table(telemetry: Telemetry) -> Table:
    table = Table(show_header=False, box=None, padding=(0, 2))
    battery = "" if telemetry.battery is None else f"{100 * telemetry.battery:.0f} %"
    table.add_row("link", telemetry.state, "battery", battery)
    table.add_row(
        "requested", _point(telemetry.commanded), "acknowledged", _point(telemetry.acknowledged)
    )
    table.add_row("shown", _point(telemetry.observed), "as", literal_text(telemetry.label or ""))
    motion, sound = (literal_text(name or "") for name in (telemetry.motion, telemetry.sound))
    table.add_row("motion", motion, "sound", sound)
    clock = telemetry.clock
    if clock is not None:
        drift, error = f"{1e6 * clock.drift:+z.0f} ppm", f"{1000 * clock.error:.1f} ms"
        table.add_row("its clock drifts by", drift, "known within", error)
    counts = telemetry.counts
    table.add_row("retries", str(counts.retries), "damaged", str(counts.crc_errors))
    return table


def _point(emotion: Emotion | None) -> str:
    return "" if emotion is None else f"{emotion.valence:+z.2f} {emotion.arousal:+z.2f}"
