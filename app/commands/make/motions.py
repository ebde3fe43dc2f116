"""The commands of `cubeling motions`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

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
from cubeling.characters.motion import DEFAULT_PROFILE

if TYPE_CHECKING:
    from cubeling.characters.motion import MotionGraph, MotionLibrary, PartGraphs, StoredGraph

app = CommandGroup("Make motion graphs of your own recordings: where one clip can follow another.")


@app.command()
def build(
    clips: Annotated[
        list[str], typer.Argument(help="Motions: .bvh, .amc, FILE.glb#CLIP, or a character.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The .graph file; default: my.graph.")
    ] = None,
    overwrite: OverwriteOption = False,
    character: Annotated[
        str, typer.Option(help="Whose skeleton the clips get: bundled, or a .glb file.")
    ] = "human",
    profile: Annotated[
        str, typer.Option(help="Split profile: SMG, SP2, SP3a, SP3b, SP4a, SP4b or SP5.")
    ] = DEFAULT_PROFILE,
    distance: Annotated[
        str, typer.Option(help="Distance of whole bodies: angles, lee, points or ahn-wohn.")
    ] = "angles",
    threshold: Annotated[
        float | None,
        typer.Option(
            help="Largest distance of joined frames; default: the least that joins all clips."
        ),
    ] = None,
    as_printed: Annotated[
        bool,
        typer.Option(
            "--as-printed",
            help="As the thesis prints it: jumps join the look-alikes themselves, and the parts "
            "share one threshold by their weights.",
        ),
    ] = False,
    skeleton: Annotated[
        Path | None, typer.Option(help="The .asf of .amc files, if it is in another folder.")
    ] = None,
) -> None:
    """Make a motion graph from recordings: where one clip can continue as another.

    The clips are retargeted to one character, and all their frames are compared.

    Example: cubeling motions build walk.bvh run.bvh turn.amc -o my.graph
    """
    if threshold is not None and not threshold > 0:
        raise AppError(f"a threshold of {threshold:g} joins nothing: give a positive one")
    target = chosen_output(output, "my.graph", "motion graph", (".graph",), overwrite)
    check_motions(clips)
    check_character(character)
    from cubeling.app.workshop.motion_graphs.recordings import clip_names, gather
    from cubeling.characters import Character
    from cubeling.characters.model import library_of, with_root_joint
    from cubeling.characters.motion import analyse, check_choices, save_graph

    check_choices(profile, distance)
    body = with_root_joint(Character.load(character))
    names = clip_names(clips)
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    console = Console()
    with Progress(*columns, console=console, transient=True) as bar:
        reading = bar.add_task("reading", total=len(names))

        def read(name: str) -> None:
            bar.update(reading, advance=1, description=f"reading {escape(Path(name).name)}")

        found = gather(names, body, skeleton, read)
        library = library_of(found, body)
        comparing = bar.add_task("comparing", total=None)
        stored = analyse(
            library,
            profile,
            distance,
            threshold,
            lambda part: bar.update(comparing, description=f"comparing {part}"),
            as_printed,
        )
        describe(console, stored)
    save_graph(stored, target)
    name = escape(str(target))
    console.print(
        f"[bold]{name}[/] is written: [cyan]cubeling play follow --controller graph "
        f"--motions {name}[/]",
        soft_wrap=True,
    )


@app.command()
def show(
    graph: Annotated[Path, typer.Argument(help="A file of cubeling motions build.")],
    output: PlotOption = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Show a motion graph: its clips, its jumps, and what was pruned.

    The plot shows the distances of all frames with the jumps, and how the share of connected frames
    grows with the threshold. It needs matplotlib: pip install matplotlib

    Example: cubeling motions show my.graph -o my.png
    """
    if output is not None:
        chosen_output(output, "", "plot", PLOT_SUFFIXES, overwrite)
    from cubeling.characters.motion import load_graph

    stored = load_graph(graph)
    console = Console()
    describe(console, stored)
    if output is None:
        return
    with needs_matplotlib():
        from cubeling.app.workshop.motion_graphs.plot import save_plot
    save_plot(output, stored, graph.name)
    console.print(f"Plotted: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


@app.command()
def transition(
    graph: Annotated[Path, typer.Argument(help="A file of cubeling motions build.")],
    origin: Annotated[str, typer.Argument(help="The clip that plays.")],
    target: Annotated[str, typer.Argument(help="The clip that is asked for.")],
    output: PlotOption = None,
    overwrite: OverwriteOption = False,
    at: Annotated[
        float | None,
        typer.Option(help="When in the clip it is asked for [s]; default: in its middle."),
    ] = None,
    as_printed: Annotated[
        bool,
        typer.Option(
            "--as-printed", help="Show what the search finds as the thesis prints it, too."
        ),
    ] = False,
) -> None:
    """Show a transition: when each part of the body leaves, and which clip it plays.

    The plot has the whole body, and the parts below. It needs matplotlib: pip install matplotlib

    Example: cubeling motions transition my.graph walk run --at 0.5 -o walk-run.svg
    """
    if output is not None:
        chosen_output(output, "", "plot", PLOT_SUFFIXES, overwrite)
    from cubeling.app.workshop.motion_graphs.transition import clips_on_the_way, find_transitions
    from cubeling.characters.motion import load_graph

    stored = load_graph(graph)
    found = find_transitions(stored, origin, target, at, as_printed)
    console = Console()
    for each in found:
        rows = Table(title=each.summary, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
        for heading in ("part", "leaves", "arrives", "frames", "slower", "by way of"):
            rows.add_column(
                heading, justify="left" if heading in ("part", "by way of") else "right"
            )
        for name, move in zip(each.parts, each.transition.moves, strict=True):
            between = ", ".join(clips_on_the_way(stored.library, move))
            times = f"{move.departure}", f"{move.arrival}", f"{move.length}"
            rows.add_row(name, *times, f"{move.scaling - 1:+.0%}", escape(between))
        console.print(rows)
    if output is None:
        return
    with needs_matplotlib():
        from cubeling.app.workshop.motion_graphs.timeline import save_timeline
    save_timeline(output, stored.library, found, f"{origin} → {target}")
    console.print(f"Plotted: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


def describe(console: Console, stored: StoredGraph) -> None:
    """Print what a motion graph holds, and what was pruned."""
    from cubeling.characters.motion import part_graphs, standard_graph

    library = stored.library
    whole, parts = standard_graph(stored), part_graphs(stored)
    console.print(
        f"{quantity(len(library.names), 'clip')}, {quantity(len(library), 'frame')} at "
        f"{library.rate:g} Hz ({len(library) / library.rate:.1f} s), compared by {stored.distance}"
        f"{', as printed' if stored.rule == 'same' else ''}",
        highlight=False,
    )
    console.print(_clips(library, whole))
    console.print(_graphs(whole, parts))
    console.print(
        f"All parts of {stored.profile} together keep {parts.connectivity:.0%} of the frames.",
        highlight=False,
    )
    for graph, what in ((whole, "graph"), (parts, "part graphs")):
        missing = [name for name in library.names if name not in graph.joined_clips]
        if missing:
            console.print(
                f"[yellow]![/] Not in the {what}: {escape(', '.join(missing))}. Record the way "
                "there and back, or raise the threshold.",
                highlight=False,
            )
    describe_capabilities(console, library, whole)


def describe_capabilities(console: Console, library: MotionLibrary, graph: MotionGraph) -> None:
    """Print what a graph can do in play, what it lacks, and which clips are out of balance."""
    from cubeling.characters.motion import capabilities, falling

    rows = Table(title="Can do", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for heading in ("what", "", "best"):
        rows.add_column(heading)
    lacking = []
    for each in capabilities(library, graph.kept):
        if each.there:
            values = f"{each.least:.1f} to {each.most:.1f} {each.unit}"
            rows.add_row(each.name, values, escape(each.clip))
        else:
            lacking.append(f"{each.name} (nearest: {each.clip}, {each.most:.1f} {each.unit})")
    console.print(rows)
    if lacking:
        console.print(
            f"[yellow]![/] Lacks: {escape(', '.join(lacking))}. Record it, or the character does "
            "what is nearest to it.",
            highlight=False,
        )
    for name, share in falling(library).items():
        console.print(
            f"[yellow]![/] {escape(name)}: out of balance, the hips are far beyond the feet in "
            f"{share:.1%} of its frames; these are not played for long.",
            highlight=False,
        )


def _clips(library: MotionLibrary, graph: MotionGraph) -> Table:
    """Return a table of the clips, and of the jumps from and to each."""
    rows = Table(title="Clips", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for heading in ("clip", "frames", "repeats", "kept", "jumps from", "jumps to"):
        rows.add_column(heading, justify="left" if heading in ("clip", "repeats") else "right")
    jumps = library.successors[graph.edges.sources] != graph.edges.targets
    leaving = library.clip_of[graph.edges.sources[jumps]]
    entering = library.clip_of[graph.edges.targets[jumps]]
    for number, name in enumerate(library.names):
        own = library.clip(name)
        rows.add_row(
            escape(name),
            f"{len(own)}",
            "loop" if library.loops[number] else "once",
            f"{graph.kept[own].mean():.0%}",
            f"{(leaving == number).sum()}",
            f"{(entering == number).sum()}",
        )
    return rows


def _graphs(whole: MotionGraph, parts: PartGraphs) -> Table:
    """Return a table of the graph of the whole body and of those of its parts."""
    rows = Table(title="Graphs", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    headings = ("of", "threshold", "clips", "frames kept", "jumps", "other phase", "lead nowhere")
    for heading in headings:
        rows.add_column(heading, justify="left" if heading == "of" else "right")
    named = [("whole body", whole)]
    named += [(part.name, graph) for part, graph in zip(parts.parts, parts.graphs, strict=True)]
    for name, graph in named:
        rows.add_row(
            name,
            f"{graph.threshold:.4f}",
            f"{len(graph.joined_clips)}",
            f"{graph.connectivity:.0%}",
            f"{graph.jumps}",
            f"{graph.barred_jumps}",
            f"{graph.dropped_jumps}",
        )
    return rows
