"""The commands of `cubeling mood`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.affect import LABEL_SETS, LabelSet, Personality, bundled_names, bundled_text
from cubeling.app.command_group import CommandGroup
from cubeling.app.commands.output import (
    PLOT_SUFFIXES,
    OverwriteOption,
    chosen_output,
    needs_matplotlib,
)
from cubeling.app.commands.play.complete import complete_session
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input

app = CommandGroup("Plot and tabulate the moods of recorded sessions; print personalities.")

MAX_PERSONALITIES = 4
"""Personalities that can be told apart in one plot."""

Session = Annotated[Path, typer.Argument(help="A session recorded with --record.")]
Salvage = Annotated[bool, typer.Option(help="Read the intact part of a session that was cut off.")]


@app.command()
def plot(
    session: Session,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The .svg, .pdf or .png; by default SESSION-mood.svg."),
    ] = None,
    overwrite: OverwriteOption = False,
    personality: Annotated[
        list[str] | None,
        typer.Option(
            help="Show what this personality would have felt: a bundled one or a .toml file. "
            "Repeatable."
        ),
    ] = None,
    salvage: Salvage = False,
) -> None:
    """Plot the emotion of a session, its actions, and what the robot acknowledged and showed.

    Needs matplotlib: pip install matplotlib

    Example: cubeling mood plot recordings/companion.mcap --personality shy
    """
    output = chosen_output(output, f"{session.stem}-mood.svg", "plot", PLOT_SUFFIXES, overwrite)
    personalities = [Personality.load(name) for name in personality or ()]
    if len(personalities) > MAX_PERSONALITIES:
        count = f"{len(personalities)} personalities are too many for one plot"
        raise AppError(f"{count}: name at most {MAX_PERSONALITIES}")
    check_input(session, "session")
    with needs_matplotlib():
        from cubeling.app.workshop.moods.plot import save_plot
    from cubeling.app.workshop.moods import read_history, read_robot_traces, replay_with

    with complete_session(session, salvage=salvage) as complete:
        history = read_history(complete, salvage=salvage)
        traces = read_robot_traces(complete)
    others = [replay_with(history, each) for each in personalities]
    fitting = fitting_label_set(history.recorded.labels)
    labels = personalities[0].label_set if personalities else fitting
    save_plot(output, history, others, traces, labels)
    Console().print(f"Plotted: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


@app.command()
def table(
    session: Session,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="By default SESSION-mood.csv.")
    ] = None,
    overwrite: OverwriteOption = False,
    personality: Annotated[
        str | None,
        typer.Option(
            help="Write what this personality would have felt: a bundled one or a .toml file."
        ),
    ] = None,
    salvage: Salvage = False,
) -> None:
    """Write the actions, the emotion and the robot's answers of a session, one row per frame.

    Example: cubeling mood table recordings/companion.mcap -o moods.csv
    """
    output = chosen_output(output, f"{session.stem}-mood.csv", "table", (".csv",), overwrite)
    other = None if personality is None else Personality.load(personality)
    from cubeling.app.workshop.moods import (
        read_history,
        read_robot_traces,
        replay_with,
        write_table,
    )

    with complete_session(session, salvage=salvage) as complete:
        history = read_history(complete, salvage=salvage)
        traces = read_robot_traces(complete)
    track = history.recorded if other is None else replay_with(history, other)
    rows = write_table(output, history, track, traces)
    Console().print(
        f"[bold]{escape(str(output))}[/] has {quantity(rows, 'row')}",
        soft_wrap=True,
        highlight=False,
    )


@app.command("personality")
def personality_(
    name: Annotated[str | None, typer.Argument(help="A bundled personality.")] = None,
) -> None:
    """Print a bundled personality, as a template for your own; without a name, list them.

    Example: cubeling mood personality lively > my-mood.toml
    """
    if name is not None:
        typer.echo(bundled_text(name), nl=False)
        return
    for each in bundled_names():
        typer.echo(f"{each:8} {Personality.load(each).description}")


@app.command()
def emotions(
    personality: Annotated[
        str, typer.Argument(help="A bundled personality, or a .toml file.")
    ] = "heartfelt",
    robot: Annotated[
        str, typer.Option(help="A simulated robot whose labels are shown: sim:opencat, say.")
    ] = "sim",
) -> None:
    """Print what each event and action makes a personality feel, its face and a robot's label.

    The last two columns are face and label without its 24 emotions: by valence and arousal alone.

    Example: cubeling mood emotions heartfelt --robot sim:opencat
    """
    who = Personality.load(personality)
    from cubeling.app.workshop.moods import appraise, without_emotions
    from cubeling.robot import SteppedRobot

    with SteppedRobot(robot) as stepped:
        moods = stepped.catalogue.moods
    rows = appraise(who, moods)
    plain = appraise(without_emotions(who), moods)
    table = Table(box=None, pad_edge=False)
    for title in ("happens", "raises", "face", "robot", "without", ""):
        table.add_column(title, no_wrap=title != "raises")
    for row, other in zip(rows, plain, strict=True):
        raised = " ".join(f"{word} {value:.2f}" for word, value in row.intensities)
        strength = "" if row.face == "neutral" else f" {row.emotion.strength:.2f}"
        cells = (row.happening, raised, f"{row.face}{strength}", row.label)
        table.add_row(*cells, other.face, other.label)
    console = Console(highlight=False)
    console.print(table)
    for name, found in (("With" if who.emotions else "As it is", rows), ("Without", plain)):
        words = quantity(len({each.emotion.label for each in found}), "word")
        faces = quantity(len({each.face for each in found}), "face")
        labels = quantity(len({each.label for each in found}), "label")
        console.print(f"{name}: {words}, {faces}, {labels} of the robot")


def fitting_label_set(labels: tuple[str, ...]) -> LabelSet:
    """Return the first label set that has all of some labels; the thesis' if none has."""
    sets = (each for each in LABEL_SETS.values() if set(labels) <= each.places.keys())
    return next(sets, LABEL_SETS["thesis"])
