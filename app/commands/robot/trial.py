"""`cubeling robot try`."""

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from affect import Emotion
from affect.words import WORD_PLACES
from app.ui.literal_text import literal_text
from robot import Robot, RobotError, Telemetry, connect

POLL_INTERVAL_S = 0.05
"""How often the telemetry is read."""

MAX_MOOD_S = 3600.0
"""The longest time for which a mood may be held."""

EMOTION_TOLERANCE = 0.05
"""Largest distance from a requested emotion at which it counts as shown."""


@dataclass(frozen=True)
class Trial:
    """Something that a robot is asked to do, and how its telemetry answers."""

    name: str
    """The mood, emotion, motion or sound."""

    start: Callable[[], None]
    """Asks for it."""

    shown: Callable[[Telemetry], bool]
    """Whether the robot reports that it shows or plays it."""

    emotion: Emotion | None
    """The emotion that the robot acknowledges; None for a motion or a sound."""


def try_(
    port: Annotated[
        str,
        typer.Argument(help="sim, /dev/ttyACM0, pleo:COM3, opencat:/dev/ttyUSB0, sim:pleo …"),
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
    A robot without moods is asked for three emotions, and for its motions and sounds.

    The exit code is 1 if the robot acknowledged and showed nothing at all.

    Example: [cyan]cubeling robot try pleo:/dev/ttyACM0 --settings my-pleo.toml[/]
    """
    console = Console(highlight=False)
    if not 0.1 <= seconds <= MAX_MOOD_S:
        raise RobotError(f"a mood is held for 0.1 to {MAX_MOOD_S:g} seconds, not {seconds:g}")
    successes: list[bool] = []
    with connect(port, settings=settings) as robot:
        trials = _trials(robot, mood or ())
        console.print(_describe(robot), soft_wrap=True)
        with suppress(KeyboardInterrupt):
            for trial in trials:
                succeeded, line = _try(robot, trial, seconds, console)
                successes.append(succeeded)
                console.print(line, soft_wrap=True)
        robot.stop()
        robot.check()
    if successes and not any(successes):
        raise typer.Exit(1)


def _trials(robot: Robot, words: Sequence[str]) -> list[Trial]:
    """Return what to try: the moods of these words, or everything that the robot has."""
    catalogue = robot.catalogue
    moods = catalogue.moods
    for word in words:
        if word not in moods:
            known = ", ".join(moods) or "it has none"
            raise RobotError(f"{catalogue.name} has no mood {word!r}: {known}")
    if moods:
        return [_mood_trial(robot, word) for word in words or (*moods, moods[0])]
    played = [_play_trial(robot, name) for name in catalogue.motions + catalogue.sounds]
    return [*(_emotion_trial(robot, word) for word in ("happy", "angry", "neutral")), *played]


def _mood_trial(robot: Robot, word: str) -> Trial:
    emotion = Emotion(*WORD_PLACES.get(word, (0.0, 0.0)), word)
    return Trial(
        word, lambda: robot.express(emotion), lambda telemetry: telemetry.label == word, emotion
    )


def _emotion_trial(robot: Robot, word: str) -> Trial:
    """Return the trial of the emotion of a word, for a robot that has no moods."""
    emotion = Emotion(*WORD_PLACES[word])

    def shown(telemetry: Telemetry) -> bool:
        observed = telemetry.observed
        return observed is not None and (
            math.dist((observed.valence, observed.arousal), (emotion.valence, emotion.arousal))
            < EMOTION_TOLERANCE
        )

    return Trial(word, lambda: robot.express(emotion), shown, emotion)


def _play_trial(robot: Robot, name: str) -> Trial:
    return Trial(
        name,
        lambda: robot.play(name),
        lambda telemetry: name in (telemetry.motion, telemetry.sound),
        None,
    )


def _describe(robot: Robot) -> Text:
    catalogue = robot.catalogue
    lists = ("moods", catalogue.moods), ("motions", catalogue.motions), ("sounds", catalogue.sounds)
    contents = "; ".join(f"{name} {', '.join(words)}" for name, words in lists if words)
    name = literal_text(catalogue.name)
    name.stylize("bold")
    joints = len(catalogue.joints)
    rest = literal_text(f" ({catalogue.firmware}), {joints} joints; {contents}".rstrip("; "))
    moodless = "\nIt has no moods: its emotions, motions and sounds are tried."
    return Text.assemble(name, rest, "" if catalogue.moods else moodless)


def _try(robot: Robot, trial: Trial, seconds: float, console: Console) -> tuple[bool, Text]:
    """Start a trial and watch the telemetry; return whether it succeeded, and a line about it."""
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
        parts.append(_after("shown" if trial.emotion is not None else "played", shown_s))
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
    counts = telemetry.counts
    table.add_row("retries", str(counts.retries), "damaged", str(counts.crc_errors))
    return table


def _point(emotion: Emotion | None) -> str:
    return "" if emotion is None else f"{emotion.valence:+.2f} {emotion.arousal:+.2f}"
