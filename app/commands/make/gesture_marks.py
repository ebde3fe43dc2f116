"""`cubeling gesture marks`: when gestures of recordings do what, and how far that is from marks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.make.gesture_library import gesture_table
from cubeling.app.commands.output import OverwriteOption, chosen_output
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character, check_motions

if TYPE_CHECKING:
    from cubeling.characters.motion import Agreement

MARKS_SUFFIXES = (".csv", ".eaf", ".anvil", ".bml")


def marks(
    recordings: Annotated[
        list[str], typer.Argument(help="Recordings: .bvh, .amc, .glb#CLIP, folders.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Write the times to this .csv, .eaf, .anvil or .bml."),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(help="Compare them with the marks of a person: .csv, .eaf, .anvil or .bml."),
    ] = None,
    overwrite: OverwriteOption = False,
    character: Annotated[
        str, typer.Option(help="On whose skeleton they are found: bundled, or a .glb file.")
    ] = "human",
) -> None:
    """Find when gestures are prepared, make their stroke, and go back to rest.

    Example: cubeling gesture marks talk.bvh --against talk.eaf
    """
    if output is not None:
        chosen_output(output, "", "marks of gestures", MARKS_SUFFIXES, overwrite)
    check_motions(recordings)
    check_character(character)
    from cubeling.characters import Character, read_motions
    from cubeling.characters.model import with_root_joint
    from cubeling.characters.motion import (
        Agreement,
        find_gestures,
        marks_of,
        read_marks,
        write_marks,
    )

    table = {} if against is None else read_marks(against)
    body = with_root_joint(Character.load(character))
    console = Console()
    with console.status("reading"):
        clips = read_motions(recordings, body)
        found = [find_gestures(clip, body.skeleton, body.anatomy) for clip in clips]
    times = {each.name: each.marks for each in found}
    rows = gesture_table("Gestures", "recording", "hand", "start", "stroke", "apex", "to", "relax")
    for each in found:
        for phrase, own in zip(each.phrases, times[each.name], strict=True):
            shown = own.start, own.stroke_start, own.stroke, own.stroke_end, own.relax
            rows.add_row(
                escape(each.name), phrase.hand, *(f"{time or 0.0:.2f} s" for time in shown)
            )
    console.print(rows)
    for each in found:
        if not each.phrases:
            console.print(f"{escape(each.name)}: no gesture; {each.reason}", highlight=False)
    if against is not None:
        pairs = [(marks_of(table, name), own) for name, own in times.items()]
        marked = [Agreement.of(*pair) for pair in pairs if pair[0]]
        if not marked:
            raise AppError(f"{against}: it marks {', '.join(table)[:200]}; give these recordings")
        _print_agreement(console, sum(marked, start=Agreement()), len(marked), len(found))
    if output is not None:
        write_marks(output, times)
        console.print(f"[bold]{escape(str(output))}[/] is written", soft_wrap=True)


def _print_agreement(console: Console, agreement: Agreement, marked: int, clips: int) -> None:
    """Print how found strokes agree with those of a person."""
    strokes = f"{agreement.marked} marked, {agreement.found} found"
    console.print(
        f"{marked} of {quantity(clips, 'recording')} with marks; strokes: {strokes}",
        highlight=False,
    )
    figures = {
        "missed": f"{agreement.miss_share:.1%}",
        "F1 of strokes that overlap": f"{agreement.overlap_f1:.2f}",
        "F1 of strokes that share half of their time": f"{agreement.same_f1:.2f}",
        "F1 of the time in strokes": f"{agreement.time_f1:.2f}",
        "apex within 0.1 s": f"{agreement.apex_share:.1%}",
    }
    for name, value in figures.items():
        console.print(f"  {name}: [bold]{value}[/]", highlight=False)
