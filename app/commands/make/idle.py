"""The commands of `cubeling idle`."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.affect import WORD_PLACES, Emotion, Region, region_of
from cubeling.app.command_group import CommandGroup
from cubeling.app.commands.output import (
    PLOT_SUFFIXES,
    OverwriteOption,
    PlotOption,
    chosen_output,
    needs_matplotlib,
)
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character, check_motions
from cubeling.characters.motion import Alignment

if TYPE_CHECKING:
    from cubeling.characters.motion import IdleDatabase, Person

app = CommandGroup("Learn how a person stands, from recordings, and let a character stand so.")


@app.command()
def learn(
    recordings: Annotated[
        list[str],
        typer.Argument(
            help="Recordings of one standing person: .bvh, .amc, .glb#CLIP; sad=FILE if she is sad."
        ),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The .idle file; default: my.idle.")
    ] = None,
    overwrite: OverwriteOption = False,
    character: Annotated[
        str, typer.Option(help="Whose skeleton they get: bundled, or a .glb file.")
    ] = "human",
    align: Annotated[
        Alignment, typer.Option(help="What places a recording; see docs/idle.md.")
    ] = "feet",
    shifts_from: Annotated[
        Path | None,
        typer.Option(help="Another person's .idle file, whose balance shifts she borrows."),
    ] = None,
) -> None:
    """Learn the idle motion of a person: where she rests, and how she shifts her balance.

    Rests, balance shifts and small variations are found without marks, in the parts between two
    steps; of somebody who sits, in how the trunk leans. A recording with the word
    of an emotion before it, such as happy=FILE, plays while the character feels so; the last
    shift of happy>sad=FILE plays as it turns from happy to sad.

    Example: cubeling idle learn anna.bvh -o anna.idle
    """
    target = chosen_output(output, "my.idle", "idle motion", (".idle",), overwrite)
    felt = [_split_emotion(each) for each in recordings]
    check_motions(name for name, *_ in felt)
    check_character(character)
    from cubeling.characters import Character, read_motions
    from cubeling.characters.model import with_root_joint
    from cubeling.characters.motion import (
        IdleDatabase,
        PostureVectors,
        borrow_shifts,
        load_person,
        read_parts,
        save_person,
        skeleton_identity,
    )

    lender = None if shifts_from is None else load_person(shifts_from)
    body = with_root_joint(Character.load(character))
    console = Console()
    with console.status("reading"):
        found = tuple(
            part
            for name, feeling, before in felt
            for clip in read_motions([name], body)
            for part in read_parts(clip, body.skeleton, body.anatomy, feeling, align, before)
        )
    if lender is not None:
        if skeleton_identity(lender[0]) != skeleton_identity(body.skeleton):
            raise AppError(f"'{shifts_from}' is on another skeleton: learn it with --character too")
        found = borrow_shifts(found, lender[2])
    person = body.skeleton, body.anatomy, found
    vectors = PostureVectors.of(body.skeleton, body.anatomy)
    describe(console, person, IdleDatabase.of(found, vectors))
    save_person(person, target)
    name = escape(str(target))
    console.print(
        f"[bold]{name}[/] is written: [cyan]cubeling play follow --idle {name}[/]", soft_wrap=True
    )


@app.command()
def show(
    person: Annotated[
        Path, typer.Argument(help="A file of cubeling idle learn, or a bundled character.")
    ],
    output: PlotOption = None,
    overwrite: OverwriteOption = False,
    mood: Annotated[
        str,
        typer.Option(
            help="How she stands in this mood, if she was recorded in it; without it, in all."
        ),
    ] = "",
) -> None:
    """Show a person's idle motion: her rests, pauses and balance shifts.

    The plot also shows her postures and small variations. It needs matplotlib:
    pip install matplotlib

    Example: cubeling idle show anna.idle -o anna.png
    """
    if output is not None:
        chosen_output(output, "", "plot", PLOT_SUFFIXES, overwrite)
    if mood:
        region_of(mood)  # refuses what is no emotion
    console = Console()
    from cubeling.characters.motion import IdleDatabase, PostureVectors, load_person

    found = load_person(_file(person))
    skeleton, anatomy, recordings = found
    database = IdleDatabase.of(recordings, PostureVectors.of(skeleton, anatomy))
    if mood:
        database = database.for_emotion(Emotion(*WORD_PLACES[mood], mood))
    describe(console, found, database, mood)
    if output is None:
        return
    with needs_matplotlib():
        from cubeling.app.workshop.idle_plot import save_plot
    title = f"How {person.stem} stands" + (f", {mood}" if mood else "")
    save_plot(output, database, title)
    console.print(f"Plotted: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


def _file(person: Path) -> Path:
    """Return the file of a person; the one beside a bundled character of that name."""
    from cubeling.characters import Character

    if str(person) not in Character.bundled_names() or person.exists():
        return person
    return Path(str(resources.files("cubeling.characters") / "assets" / f"{person}.idle"))


def _split_emotion(recording: str) -> tuple[str, Region | None, Region | None]:
    """Return the file of a recording, the emotions that it shows, and those that it leaves."""
    words, equals, name = recording.partition("=")
    before, becomes, word = words.rpartition(">")
    if not equals or not words.replace(">", "", 1).isalpha():
        return recording, None, None
    return name, region_of(word), region_of(before) if becomes else None


def describe(console: Console, person: Person, database: IdleDatabase, mood: str = "") -> None:
    """Print what is known of a person's idle motion: all of it, or what suits a mood."""
    from cubeling.characters.motion import BALANCES, COMPONENTS

    recordings = person[2]
    length = sum(len(each.vectors) / each.rate for each in recordings)
    spread = database.space.variances
    explained = spread[:COMPONENTS].sum() / max(spread.sum(), 1e-12)
    console.print(
        f"Recorded for {length:.1f} s, with {quantity(len(database.shifts), 'balance shift')}; "
        f"{COMPONENTS} components hold {explained:.1%} of the postures",
        highlight=False,
    )
    felt = {posture.feeling for posture in database.postures}
    if mood and felt == {None}:
        console.print(f"She was not recorded in moods: {mood}, she stands as always")
    rows = Table(
        title=f"Rests, {mood}" if mood else "Rests",
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
    )
    for heading in ("on", "rests", "shortest", "longest", *(f"then {each}" for each in BALANCES)):
        rows.add_column(heading, justify="left" if heading == "on" else "right")
    for name in BALANCES:
        own = database.by_balance.get(name)
        if own:
            chances = database.probabilities(name)
            shortest, longest = database.pause_limits(name)
            shares = [f"{chances[each]:.0%}" if each in chances else "" for each in BALANCES]
            rows.add_row(name, f"{len(own)}", f"{shortest:.1f} s", f"{longest:.1f} s", *shares)
    console.print(rows)
    if not database.shifts:
        console.print(
            "[yellow]![/] She never shifts her balance: her character stays where it stands. "
            "Shifts can be borrowed: --shifts-from FILE",
            highlight=False,
        )
