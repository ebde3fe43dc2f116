"""`cubeling character locomotion`."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from app.errors import AppError
from characters import Character
from characters.retargeting import GaitReport, load_recording, make_locomotion

Files = Annotated[
    list[str] | None,
    typer.Option(help="A motion of it: .bvh, .amc, or FILE.glb#CLIP; straight or curved."),
]


def locomotion(
    character: Annotated[
        str, typer.Argument(help="A bundled character, or a .glb, .gltf or .vrm file.")
    ],
    walk: Files = None,
    run: Files = None,
    idle: Annotated[str | None, typer.Option(help="A motion of standing.")] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The .glb to write; NAME-walks.glb without."),
    ] = None,
    skeleton: Annotated[
        Path | None, typer.Option(help="The .asf of .amc files that do not lie beside one.")
    ] = None,
) -> None:
    """Teach a character to walk and run where the cube sends it, from your own recordings.

    One walk is enough. The best cycle of each recording is cut out, put on the character's
    skeleton and bent to all the curves that steering needs, with feet that hold. Repeat
    [bold]--walk[/] and [bold]--run[/] for recordings of curves.

    Example: [cyan]cubeling character locomotion me.glb --walk walk.bvh --run run.bvh -o my.glb[/]
    """
    if not walk:
        raise AppError("nothing to walk with: give at least one recording with --walk")
    target = output or Path(f"{Path(character).stem}-walks.glb")
    if target.suffix.lower() != ".glb":
        raise AppError(f"a character is written as a .glb file, not as '{target}'")
    for given in (character, *walk, *(run or ()), idle or ""):
        if _same(target, Path(given.partition("#")[0])):
            raise AppError(f"'{target}' would be written over what it is made of: name another -o")
    body = Character.load(character)
    walks, runs = (
        [load_recording(name, skeleton) for name in names or ()] for names in (walk, run)
    )
    standing = load_recording(idle, skeleton) if idle else None
    made = make_locomotion(body, walks, runs, standing)
    made.character.save(target)
    console = Console()
    console.print(table("Found in the recordings", made.recordings, seams=True))
    console.print(table("Made for the movement tree", made.clips))
    speeds = {each.name: each.speed for each in made.clips}
    if speeds.get("Run", math.inf) < speeds["Walk"]:
        console.print("[yellow]![/] It runs slower than it walks: were the two exchanged?")
    _say_joints(console, made.character, target)
    name = escape(str(target))
    console.print(f"[bold]{name}[/] walks: [cyan]cubeling play follow --character {name}[/]")


def _same(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except (OSError, ValueError):  # one of them does not exist
        return False


def table(title: str, found: Sequence[GaitReport], seams: bool = False) -> Table:
    """Return what was found or made, one a row."""
    rows = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    rows.add_column("recording" if seams else "clip", no_wrap=not seams)
    if not seams:
        rows.add_column("from")
    for heading in ("cycle", "speed", "turns", "slide"):
        rows.add_column(heading, justify="right", no_wrap=True)
    if seams:
        rows.add_column("seam", justify="right")
    for each in found:
        cells = [each.name] if seams else [each.name, each.origin]
        cells += [f"{each.duration:.2f} s", f"{each.speed:.2f} m/s", _side(each.angular)]
        cells.append(f"{100 * each.slide:.1f} cm/s")
        if seams:
            cells.append(f"{100 * each.seam:.1f} cm")
        rows.add_row(*(cell.replace("[", "\\[") for cell in cells))
    return rows


def _side(angular: float) -> str:
    """Return how sharply something turns, for a person."""
    degrees = round(1.5 * abs(angular))
    if degrees < 2:
        return "straight"
    return f"{degrees}°/s {'right' if angular > 0 else 'left'}"


def _say_joints(console: Console, character: Character, target: Path) -> None:
    """Keep what the joints are, where it was said, in a file beside the character."""
    if not character.semantics:
        return
    beside = target.with_suffix(".toml")
    name = escape(str(beside))
    if beside.exists():
        console.print(f"[yellow]![/] {name} is there already: see that its joints are right.")
        return
    lines = [f"{part} = {_quoted(joint)}" for part, joint in character.semantics.items()]
    beside.write_text("[joints]\n" + "\n".join(lines) + "\n", encoding="utf-8")
    console.print(f"[bold]{name}[/] keeps which joint is which part.")


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
