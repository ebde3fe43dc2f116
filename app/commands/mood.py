"""`cubeling mood`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from affect import LABEL_SETS, Personality
from affect.labels import LabelSet
from affect.personality_file import bundled, bundled_text
from app.errors import AppError
from app.moods import felt_by, read_history, read_wire, write_table

app = typer.Typer(
    help="Moods of recorded sessions, and the personalities that have them.",
    no_args_is_help=True,
    rich_markup_mode="rich",
)

MAX_PERSONALITIES = 4
"""Personalities that can be told apart in one plot."""

FORMATS = (".svg", ".pdf", ".png")
"""Suffixes of the files that a plot can be written to."""

Session = Annotated[Path, typer.Argument(help="A session recorded with --record.")]
Salvage = Annotated[bool, typer.Option(help="Take what is whole of a session that was cut off.")]


@app.command()
def plot(
    session: Session,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Write this .svg, .pdf or .png file."),
    ] = None,
    personality: Annotated[
        list[str] | None,
        typer.Option(
            help="Let this one feel what was done again: a bundled personality or a .toml file. "
            "May be given several times."
        ),
    ] = None,
    salvage: Salvage = False,
) -> None:
    """Plot what a session felt over time, what it did, and what the robot confirmed and showed.

    Needs matplotlib, which comes with the extra "plots" of cubeling.

    Example: [cyan]cubeling mood plot today.mcap --personality lively --personality shy[/]
    """
    output = output or Path(f"{session.stem}-mood.svg")
    if output.suffix.lower() not in FORMATS:
        raise AppError(f"moods are plotted as {', '.join(FORMATS)}, not as '{output}'")
    who = [Personality.load(name) for name in personality or ()]
    if len(who) > MAX_PERSONALITIES:
        raise AppError(
            f"{len(who)} personalities are too many for one plot: {MAX_PERSONALITIES} at most"
        )
    try:
        from app.moods.plot import save_plot
    except ImportError as error:
        if (error.name or "").split(".")[0] != "matplotlib":
            raise
        raise AppError('a plot needs matplotlib: pip install "cubeling[plots]"') from error
    history = read_history(session, salvage=salvage)
    again = [felt_by(history, each) for each in who]
    labels = who[0].label_set if who else fitting(history.felt.labels)
    save_plot(output, history, again, read_wire(session), labels)
    Console().print(f"Plotted: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


@app.command()
def table(
    session: Session,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write into this .csv file.")
    ] = None,
    personality: Annotated[
        str | None, typer.Option(help="Let this one feel what was done again.")
    ] = None,
    salvage: Salvage = False,
) -> None:
    """Write what a session did, felt, and what the robot confirmed and showed: a row a frame.

    Example: [cyan]cubeling mood table today.mcap -o today.csv[/]
    """
    output = output or Path(f"{session.stem}-mood.csv")
    if output.suffix.lower() != ".csv":  # the session itself, it may be
        raise AppError(f"moods are tabled as .csv, not as '{output}'")
    who = None if personality is None else Personality.load(personality)
    history = read_history(session, salvage=salvage)
    felt = history.felt if who is None else felt_by(history, who)
    rows = write_table(output, history, felt, read_wire(session))
    Console().print(
        f"[bold]{escape(str(output))}[/] has {rows} rows", soft_wrap=True, highlight=False
    )


@app.command("personality")
def personality_(
    name: Annotated[str | None, typer.Argument(help="A bundled personality.")] = None,
) -> None:
    """Print a bundled personality with comments, to make your own from; without a name, list them.

    Example: [cyan]cubeling mood personality lively > my.toml[/]
    """
    if name is not None:
        typer.echo(bundled_text(name), nl=False)
        return
    for each in bundled():
        typer.echo(f"{each:8} {Personality.load(each).description}")


def fitting(words: tuple[str, ...]) -> LabelSet:
    """Return the first label set that has all these words; the thesis' where none has."""
    said = set(words)
    sets = (labels for labels in LABEL_SETS.values() if said <= labels.places.keys())
    return next(sets, LABEL_SETS["thesis"])
