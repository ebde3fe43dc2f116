"""The command `cubeling character inspect`."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table
from rich.tree import Tree

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError

if TYPE_CHECKING:
    from cubeling.characters import Character, Skeleton
    from cubeling.characters.model import ClipStats, FootContactStats, Inspection, RecordedMotion

MIN_FOLDED_JOINTS = 4
"""Branches of at least this number of unrecognised joints are shown as one line."""

MIN_NAME_WIDTH = 32
"""Longer names of clips are folded at this width before other columns become narrower."""


def inspect_command(
    character: Annotated[
        str,
        typer.Argument(
            help="A bundled character, a .glb, .gltf, .vrm or .fbx file, or a motion: .bvh or .amc."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Draw it from all sides, into this folder."),
    ] = None,
    clips: Annotated[
        bool,
        typer.Option("--clips", help="Draw frames of every clip too; without -o to NAME-pictures."),
    ] = False,
    skeleton: Annotated[
        Path | None, typer.Option(help="The .asf of an .amc, if it is in another folder.")
    ] = None,
    scale: Annotated[
        float | None, typer.Option(help="Unit of a motion in metres, if it is recognised wrongly.")
    ] = None,
    fps: Annotated[
        float | None,
        typer.Option(help="Frames a second of a .bvh or .amc file, if it states them wrongly."),
    ] = None,
    up: Annotated[
        str | None,
        typer.Option(help="Vertical axis of a motion (y, z, -y …), if it is recognised wrongly."),
    ] = None,
) -> None:
    """Show the skeleton, size, clips and problems of a character; with -o draw it from all sides.

    The skeleton shows the recognised body part of each joint. A motion without a body is drawn as
    a stick figure: left is blue, right is red.

    Example: cubeling character inspect human --clips -o human-pictures
    """
    console = Console()
    folder = output or (Path(f"{Path(character).stem}-pictures") if clips else None)
    if folder is not None and folder.exists() and not folder.is_dir():
        raise AppError(f"{folder} is a file: choose another folder with --output")
    from cubeling.characters import load_motion

    read_motion = partial(load_motion, skeleton=skeleton, rate=fps, scale=scale, up=up)
    with _progress(f"Reading {Path(character).name}"):
        inspection, has_body = _load(character, read_motion)
    _print(console, inspection)
    if folder is None:
        return
    for path in _draw(inspection.character, folder, clips, has_body):
        console.print(f"Written: [bold]{escape(str(path))}[/]", soft_wrap=True)


def _load(
    name: str, read_motion: Callable[[str, str | None], RecordedMotion]
) -> tuple[Inspection, bool]:
    """Return the inspection of a character or motion, and whether it has a body."""
    from cubeling.characters import Character, CharacterWarning
    from cubeling.characters.model import inspect, is_motion_only, stick_figure

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        file, _, clip = name.partition("#")
        if is_motion_only(file):
            motion = read_motion(file, clip or None)
            body = stick_figure(Path(file).stem, motion.skeleton, [motion.clip])
            notes, has_body = list(motion.notes), False
        else:
            body, notes, has_body = Character.load(name), [], True
    repairs = [str(each.message) for each in caught if each.category is CharacterWarning]
    sentences = [sentence(note, name) for note in (*repairs, *notes)]
    return inspect(body, sentences, has_body), has_body


def sentence(note: str, name: str) -> str:
    """Return a note as a sentence without the name of its file.

    >>> sentence("x.glb: node 'a' is odd; left it", "x.glb")
    "Node 'a' is odd; left it."
    """
    note = note.removeprefix(f"{name}: ").rstrip(".")
    return f"{note[:1].upper()}{note[1:]}."


def _draw(character: Character, folder: Path, clips: bool, has_body: bool) -> list[Path]:
    """Draw a character as it stands in play, or a motion; return the paths of the pictures."""
    from cubeling.app.ui.contact_sheets import CLIP_COLUMNS, TURNTABLE_COLUMNS, ContactSheets, save
    from cubeling.characters import with_lent_motions
    from cubeling.characters.rendering import create_context

    standing = with_lent_motions(character) if has_body else character
    faces = character.anatomy.joint("head") is not None and bool(character.morphs)
    shown = list(character.clips.values()) if clips or not has_body else []
    count = TURNTABLE_COLUMNS + faces * (1 + len(character.morphs)) + CLIP_COLUMNS * len(shown)
    with ExitStack() as closing:
        advance = closing.enter_context(_progress("Drawing", count))
        context = create_context()
        closing.callback(context.release)
        sheets = ContactSheets(context, advance)
        closing.callback(sheets.release)
        pictures = {"turntable.png": sheets.turntable(standing)}
        if faces:
            pictures["faces.png"] = sheets.faces(character)
        if shown:
            pictures["clips.png"] = sheets.clips(character, shown)
    for name, picture in pictures.items():
        save(picture, folder / name)
    return [folder / name for name in pictures]


@contextmanager
def _progress(what: str, steps: int | None = None) -> Iterator[Callable[[], None]]:
    """Show a bar on a terminal's error output; what it yields is called after each step."""
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(escape(what), total=steps)
        yield lambda: progress.advance(task)


def _print(console: Console, inspection: Inspection) -> None:
    character, stats = inspection.character, inspection.stats
    console.print(f"[bold]{escape(character.name)}[/], {character.anatomy.kind}", highlight=False)
    console.print(
        f"{stats.height:.3g} m tall, {quantity(stats.joints, 'joint')}, "
        f"{quantity(stats.meshes, 'mesh', 'meshes')}, "
        f"{quantity(stats.vertices, 'vertex', 'vertices')}, "
        f"{quantity(stats.triangles, 'triangle')}, {quantity(stats.materials, 'material')}, "
        f"{quantity(stats.textures, 'texture')}",
        highlight=False,
    )
    if stats.morphs:
        console.print(f"Morphs: {', '.join(stats.morphs)}", highlight=False, markup=False)
    console.print(_tree(character))
    if inspection.clips:
        console.print(_table(inspection.clips))
    if not inspection.problems:
        console.print("[green]No problems found.[/]")
    for problem in inspection.problems:
        console.print("[yellow]![/]", end=" ")
        console.print(problem, markup=False, highlight=False, soft_wrap=True)


def _tree(character: Character) -> Tree:
    """Return the skeleton as a tree with recognised body parts."""
    skeleton, parts = character.skeleton, character.anatomy.parts
    sizes, known = _branches(skeleton, set(parts))
    tree = Tree("[bold]Skeleton[/]", guide_style="dim")
    branches = {-1: tree}
    for joint, parent in enumerate(skeleton.parents):
        if parent not in branches:
            continue  # folded with an ancestor
        folded = joint not in known and sizes[joint] >= MIN_FOLDED_JOINTS
        name = escape(skeleton.names[joint])
        part = f" [cyan]{parts[joint]}[/]" if joint in parts else ""
        more = f" [dim]and {sizes[joint] - 1} joints below it[/]" if folded else ""
        branch = branches[parent].add(name + part + more, highlight=False)
        if not folded:
            branches[joint] = branch
    return tree


def _branches(skeleton: Skeleton, recognised: set[int]) -> tuple[list[int], set[int]]:
    """Return the number of joints in each joint's branch, and the branches with recognised ones."""
    sizes = [1] * len(skeleton)
    known = set(recognised)
    for joint, parent in reversed(list(enumerate(skeleton.parents))):
        if parent >= 0:
            sizes[parent] += sizes[joint]
            if joint in known:
                known.add(parent)
    return sizes, known


def _table(clips: Sequence[ClipStats]) -> Table:
    table = Table(title="Clips", title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    longest = max(len(clip_stats.clip.name) for clip_stats in clips)
    # A name is what other commands are called with: it is folded rather than cut off.
    table.add_column("clip", overflow="fold", min_width=min(longest, MIN_NAME_WIDTH))
    for heading in ("seconds", "Hz", "repeats", "speed [m/s]", "feet down"):
        table.add_column(
            escape(heading), justify="right" if heading in ("seconds", "Hz") else "left"
        )
    for clip_stats in clips:
        clip = clip_stats.clip
        table.add_row(
            escape(clip.name),
            f"{clip.duration:.2f}",
            f"{clip.rate:.4g}",
            "loop" if clip.loop else "once",
            _speed(clip_stats),
            _contacts(clip_stats.contacts),
        )
    return table


def _speed(clip_stats: ClipStats) -> str:
    if clip_stats.speed < 5e-3:
        return "[dim]stays[/]"
    suffix = (
        " in place" if clip_stats.in_place else "" if clip_stats.clip.root_motion else " no root"
    )
    return f"{clip_stats.speed:.2f}{suffix}"


def _contacts(contacts: Sequence[FootContactStats]) -> str:
    """Return the contact share of each foot, or "always" for all of them."""
    if contacts and all(foot.share == 1.0 for foot in contacts):
        return "[dim]always[/]"
    each = []
    for foot in contacts:
        name = escape(foot.foot).replace("Foot", "").replace("Front", " front") or foot.foot
        landings = f" in {foot.landings}" if foot.landings > 1 else ""
        each.append(f"{name} {100 * foot.share:.0f} %{landings}")
    return ", ".join(each)
