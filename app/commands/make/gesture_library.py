"""`cubeling gesture learn` and `library`: gestures that beat the rhythm of speech."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.commands.output import OverwriteOption, chosen_output
from cubeling.app.counted import quantity
from cubeling.app.input_path import check_character, check_motions

if TYPE_CHECKING:
    from cubeling.characters import Character
    from cubeling.characters.motion import GestureLibrary

SHEET_SUFFIXES = (".png", ".jpg")

CELL_PX = 140, 150
"""Size of a picture on the sheet [px]."""

UPPER_BODY = 0.62, 0.36
"""Height of the middle of the upper body, and its radius, over the height of the body."""

SWEPT_THRESHOLDS = (0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0)
"""Similarity thresholds in the table of connectivity."""


def learn(
    recordings: Annotated[
        list[str],
        typer.Argument(help="Recordings of somebody who talks: .bvh, .amc, .glb#CLIP, folders."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The .gestures file; default: my.gestures."),
    ] = None,
    overwrite: OverwriteOption = False,
    character: Annotated[
        str, typer.Option(help="Whose skeleton they get: bundled, or a .glb file.")
    ] = "human",
    marks: Annotated[
        Path | None,
        typer.Option(help="Times that a person marked: .csv, .eaf, .anvil or .bml."),
    ] = None,
) -> None:
    """Learn beat gestures: their phases, their apices and how strong they are.

    Without marks, gestures are what hands do between two rests; a clip that is cut tightly rests
    in its edges. Recordings without any are left out, with the reason.

    Example: cubeling gesture learn talk.bvh -o anna.gestures
    """
    target = chosen_output(output, "my.gestures", "gesture library", (".gestures",), overwrite)
    check_motions(recordings)
    check_character(character)
    from cubeling.characters import Character, read_motions
    from cubeling.characters.model import with_root_joint
    from cubeling.characters.motion import find_gestures, library_of, marks_of, read_marks

    table = {} if marks is None else read_marks(marks)
    body = with_root_joint(Character.load(character))
    console = Console()
    with console.status("reading"):
        clips = read_motions(recordings, body)
        found = [
            find_gestures(clip, body.skeleton, body.anatomy, marks_of(table, clip.name))
            for clip in clips
        ]
    rows = gesture_table("Recordings", "recording", "length", "phrases")
    for clip, each in zip(clips, found, strict=True):
        rows.add_row(escape(clip.name), f"{clip.duration:.1f} s", f"{len(each.phrases)}")
    console.print(rows)
    for each in found:
        if not each.phrases:
            console.print(f"{escape(each.name)}: no gesture; {each.reason}", highlight=False)
    library = library_of(found, body.skeleton, body.anatomy)
    describe(console, library)
    library.save(target)
    console.print(f"[bold]{escape(str(target))}[/] is written", soft_wrap=True, highlight=False)


def library(
    file: Annotated[
        Path, typer.Argument(help="A file of cubeling gesture learn, or a bundled character.")
    ] = Path("human"),
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Draw strokes and apices to this .png or .jpg file."),
    ] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Show a library of gestures: phrases by hand and strength, and how well they are connected.

    Example: cubeling gesture library human -o gestures.png
    """
    if output is not None:
        chosen_output(output, "", "picture", SHEET_SUFFIXES, overwrite)
    console = Console()
    from cubeling.characters.motion import GestureLibrary

    found = GestureLibrary.load(_file(file))
    describe(console, found)
    if output is not None:
        draw(output, found)
        console.print(f"Drawn: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


def describe(console: Console, library: GestureLibrary) -> None:
    """Print what is in a library, and Table 4.2 of its graph (M7)."""
    import numpy as np

    from cubeling.characters.motion import GestureGraph, sweep

    seconds = sum(len(each.turns) for each in library.recordings) / library.rate
    console.print(
        f"{len(library.phrases)} gesture phrases in {seconds:.0f} s of motion", highlight=False
    )
    rows = gesture_table(
        "Strength", "hand", "phrases", "weakest", "25 %", "median", "75 %", "strongest"
    )
    for hand in ("left", "right", "both", "all"):
        own = [e.strength for e in library.phrases if hand in (e.hand, "all")]
        if own:
            quartiles = np.quantile(own, (0.0, 0.25, 0.5, 0.75, 1.0)).tolist()
            rows.add_row(hand, f"{len(own)}", *(f"{each:.1f}" for each in quartiles))
    console.print(rows)
    rows = gesture_table("Graph", "threshold", "branches", "connected", "branches of these")
    for row in sweep(library, SWEPT_THRESHOLDS):
        rows.add_row(
            f"{row.threshold:g}",
            f"{row.branching:.2f}",
            f"{row.component}",
            f"{row.component_branching:.2f}",
        )
    console.print(rows)
    graph = GestureGraph.of(library)
    console.print(
        f"Threshold {graph.threshold:g}: {quantity(len(graph.nodes) + 1, 'node')} with strokes "
        f"alone and rest, {graph.branching:.1f} branches each",
        highlight=False,
    )


def draw(path: Path, library: GestureLibrary) -> None:
    """Draw where each stroke of a library starts, and its apex."""
    import numpy as np

    from cubeling.app.ui.contact_sheets import frame_sheet, save
    from cubeling.characters.rendering import PortraitRenderer, create_context, side_by_side

    body = _body(library)
    centre = np.array([0.0, UPPER_BODY[0] * body.height, 0.0])
    focus = centre, UPPER_BODY[1] * body.height
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        renderer = PortraitRenderer(context, CELL_PX)
        closing.callback(renderer.release)
        cells = []
        for number, phrase in enumerate(library.phrases, 1):
            turns = library.recordings[phrase.recording].turns
            shown = [library.poses(turns[frame]) for frame in (phrase.stroke[0], phrase.apex)]
            shown = [replace(each, scales=body.skeleton.rest.scales) for each in shown]
            pair = [renderer.portrait(body, each, azimuth=0.5, focus=focus) for each in shown]
            text = f"{number}: {phrase.hand}, {phrase.strength:.1f}"
            cells.append((text, side_by_side(pair)))
        save(frame_sheet("Strokes and their apices", cells), path)


def _body(library: GestureLibrary) -> Character:
    """Return the bundled character of the library's skeleton, or a stick figure."""
    from cubeling.characters import Character
    from cubeling.characters.model import stick_figure
    from cubeling.characters.motion import skeleton_identity

    for name in Character.bundled_names():
        character = Character.load(name)
        if skeleton_identity(character.skeleton) == library.skeleton_identity:
            return character
    return stick_figure("gestures", library.skeleton)


def _file(library: Path) -> Path:
    """Return the file of a library; the one beside a bundled character of that name."""
    from cubeling.characters import Character

    if str(library) not in Character.bundled_names() or library.exists():
        return library
    return Path(str(resources.files("cubeling.characters") / "assets" / f"{library}.gestures"))


def gesture_table(title: str, *headings: str) -> Table:
    """Return an empty table with these headings; all but the first are numbers."""
    rows = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for number, heading in enumerate(headings):
        rows.add_column(heading, justify="right" if number else "left")
    return rows
