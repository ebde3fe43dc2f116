"""The command `cubeling export`."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.play.complete import complete_session
from cubeling.app.errors import AppError
from cubeling.app.output_path import check_output_folder, output_folder

Labels = Annotated[
    list[str] | None,
    typer.Option(
        help="Instead of what the session says: once for all sessions, or once for each, in the "
        "same order."
    ),
]


def export(
    sessions: Annotated[list[Path], typer.Argument(help="Sessions recorded with --record.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the tables.")],
    participant: Labels = None,
    condition: Labels = None,
    bvh: Annotated[
        bool, typer.Option("--bvh", help="Write the motion of each character as a .bvh file too.")
    ] = False,
    foxglove: Annotated[
        bool,
        typer.Option("--foxglove", help="Write each session as Foxglove shows it, with a layout."),
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Overwrite the files of an earlier export.")
    ] = False,
    salvage: Annotated[
        bool, typer.Option(help="Export the intact part of sessions that were cut off.")
    ] = False,
) -> None:
    """Write recorded sessions as tables, in CSV and JSON Lines, with a data dictionary.

    Every row names its session, its participant and its condition. See docs/exporting.md.

    Example: cubeling export recordings/follow.mcap recordings/sketch.mcap -o study
    --participant P1 --participant P2
    """
    from cubeling.app.workshop.exporting import ExportedSession, export as write_tables
    from cubeling.app.workshop.exporting.writing import EXPORT_FILES

    check_output_folder(output, EXPORT_FILES, "tables", overwrite=overwrite)
    for wanted, pattern in ((bvh, "*.bvh"), (foxglove, "*.mcap")):
        if wanted and not overwrite and next(output.glob(pattern), None):
            raise AppError(
                f"'{output}' holds {pattern} files already: choose another one or add --overwrite"
            )
    people = labels(participant, len(sessions), "--participant")
    conditions = labels(condition, len(sessions), "--condition")
    names = [path.stem for path in sessions]
    for name in names:
        if names.count(name) > 1:
            raise AppError(f"two sessions are called '{name}': rename one to tell their rows apart")
    exported = [
        ExportedSession.read(path, *of, salvage=salvage)
        for path, *of in zip(sessions, people, conditions, strict=True)
    ]
    with ExitStack() as closing:
        complete = [
            each.with_channels(
                closing.enter_context(complete_session(each.path, salvage=salvage, appearance=True))
            )
            for each in exported
        ]
        with output_folder(output):
            rows = write_tables(complete, output)
            motions = {}
            if bvh:
                from cubeling.app.workshop.exporting.motion import write_motions

                for each in complete:
                    motions.update(
                        write_motions(each.complete or each.path, output, each.path.stem)
                    )
            if foxglove:
                from cubeling.app.workshop.exporting.foxglove import (
                    LAYOUT_FILE,
                    write_foxglove,
                    write_layout,
                )

                for each in complete:
                    shown = output / f"{each.path.stem}-foxglove.mcap"
                    write_foxglove(each.complete or each.path, shown)
                write_layout(output / LAYOUT_FILE)
    console = Console(highlight=False, soft_wrap=True)
    for name, count in rows.items():
        console.print(f"{name:11} {count:8} {'row' if count == 1 else 'rows'}")
    for name, count in motions.items():
        console.print(f"{escape(name)} {count:8} frames")
    console.print(f"[bold]{escape(str(output))}[/] holds the tables as .csv and .jsonl")


def labels(given: Sequence[str] | None, count: int, option: str) -> list[str]:
    """Return one label for each session; "" where none is given."""
    if not given:
        return [""] * count
    if len(given) not in (1, count):
        raise AppError(
            f"{option} was given {len(given)} times: give it once, or once for each session"
        )
    return list(given) * (count if len(given) == 1 else 1)
