"""The command `cubeling character locomotion`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.commands.output import OverwriteOption, chosen_output
from cubeling.app.errors import AppError

if TYPE_CHECKING:
    from cubeling.characters.model import GaitReport, LocomotionResult

Files = Annotated[
    list[str] | None,
    typer.Option(help="A motion: .bvh, .amc, .vrma, .fbx, or FILE.glb#CLIP; straight or curved."),
]


def locomotion(
    character: Annotated[
        str, typer.Argument(help="A bundled character, or a .glb, .gltf or .vrm file.")
    ],
    walk: Files = None,
    run: Files = None,
    idle: Annotated[str | None, typer.Option(help="The same for a motion of idling.")] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The .glb to write; default: NAME-walks.glb."),
    ] = None,
    overwrite: OverwriteOption = False,
    skeleton: Annotated[
        Path | None, typer.Option(help="The .asf of .amc files, if it is in another folder.")
    ] = None,
    up: Annotated[
        str | None,
        typer.Option(help="Vertical axis of .bvh and .amc files: x, y, z, -x, -y or -z."),
    ] = None,
    fps: Annotated[
        float | None,
        typer.Option(help="Frames a second of a .bvh or .amc file, if it states them wrongly."),
    ] = None,
    rest: Annotated[
        str | None,
        typer.Option(
            help="Where .bvh and .amc files stand straight: zero (all angles) or frame:N. "
            "Default: zero, or the most upright frame if that does not stand."
        ),
    ] = None,
) -> None:
    """Make the walking and running clips of a character from your own recordings.

    One walk is enough. The best cycle of each recording is retargeted to the character and varied
    for all the curves that steering needs, without sliding feet. Repeat --walk and
    --run for recordings of curves.

    Example: cubeling character locomotion me.glb --walk walk.bvh --run run.bvh -o my.glb
    """
    if not walk:
        raise AppError("no walk: give at least one recording with --walk")
    default = f"{Path(character).stem}-walks.glb"
    target = chosen_output(output, default, "character", (".glb",), overwrite)
    for given in (character, *walk, *(run or ()), idle or ""):
        if _same(target, Path(given.partition("#")[0])):
            raise AppError(f"'{target}' would overwrite one of its inputs: choose another -o")
    from cubeling.characters import Character
    from cubeling.characters.model import load_recording, make_locomotion

    original = Character.load(character)
    read = partial(load_recording, skeleton=skeleton, up=up, rest=rest, rate=fps)
    walks, runs = ([read(name) for name in names or ()] for names in (walk, run))
    standing = read(idle) if idle else None
    result = make_locomotion(original, walks, runs, standing)
    result.character.save(target)
    console = Console()
    console.print(table("Found in the recordings", result.recordings, seams=True))
    console.print(table("Made for the movement trees", result.clips))
    for warning in _warnings(result):
        console.print(f"[yellow]![/] {escape(warning)}", soft_wrap=True)
    speeds = {each.name: each.speed for each in result.clips}
    if speeds.get("Run", math.inf) < speeds["Walk"]:
        console.print("[yellow]![/] It runs slower than it walks: did you swap the recordings?")
    name = escape(str(target))
    console.print(f"[bold]{name}[/] walks: [cyan]cubeling play follow --character {name}[/]")


def _warnings(result: LocomotionResult) -> list[str]:
    """Return what a person would see of the gaits: each fault once, where it is seen first."""
    gaits = [*result.recordings, *result.clips]
    found: dict[str, str] = {}
    for gait in gaits:
        for fault, text in gait.warnings.items():
            found.setdefault(fault, f"{gait.name}: {text}")
    return list(found.values())


def _same(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except (OSError, ValueError):  # one of them does not exist
        return False


def table(title: str, gaits: Sequence[GaitReport], seams: bool = False) -> Table:
    """Return a table of gaits."""
    rows = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    rows.add_column("recording" if seams else "clip", no_wrap=not seams, overflow="fold")
    if not seams:
        rows.add_column("from", overflow="fold")
    for heading in ("cycle", "speed", "turns", "slide"):
        rows.add_column(heading, justify="right", no_wrap=True)
    if seams:
        rows.add_column("seam", justify="right")
    for each in gaits:
        cells = [each.name] if seams else [each.name, each.origin]
        cells += [f"{each.duration:.2f} s", f"{each.speed:.2f} m/s", _turn(each.angular)]
        cells.append(f"{100 * each.slide:.1f} cm/s")
        if seams:
            cells.append(f"{100 * each.seam:.1f} cm")
        rows.add_row(*(cell.replace("[", "\\[") for cell in cells))
    return rows


def _turn(angular: float) -> str:
    """Return a turn as text, from the parameter Angular."""
    from cubeling.characters.model import YAW_RATE_PER_ANGULAR

    degrees = round(YAW_RATE_PER_ANGULAR * abs(angular))
    if degrees < 2:
        return "straight"
    return f"{degrees}°/s {'right' if angular > 0 else 'left'}"
