"""The commands of `cubeling gesture`."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.command_group import CommandGroup, former_spellings
from cubeling.app.commands.make.gesture_library import learn, library
from cubeling.app.commands.make.gesture_marks import marks
from cubeling.app.commands.output import OverwriteOption, chosen_output
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character
from cubeling.app.ui.display import has_display

if TYPE_CHECKING:
    from cubeling.app.workshop.gesture_editor.editing.store import GestureStore
    from cubeling.characters.behaviour import BodyKey, HandKey, SymbolicGesture

SHEET_SUFFIXES = (".png", ".jpg")

GESTURE_FOLDER = Path(typer.get_app_dir("cubeling")) / "gestures"
"""Where the user's own gestures are; each goes before a bundled one of its name."""

app = CommandGroup(
    "Make gestures that every character can perform, look at them, edit them, and learn those "
    "that beat the rhythm of speech."
)
app.command()(learn)
app.command()(library)
app.command()(marks)

FolderOption = Annotated[
    Path, typer.Option("--folder", help="Where your own gestures are.", show_default=False)
]
CharacterOption = Annotated[
    str, typer.Option("--character", "-c", help="Who performs it: bundled, or a file.")
]


@app.command()
def edit(
    name: Annotated[
        str, typer.Argument(help="The gesture; a new name begins a new one.", show_default=False)
    ] = "",
    character: CharacterOption = "human",
    folder: FolderOption = GESTURE_FOLDER,
) -> None:
    """Edit a gesture in a window, while a character performs it.

    Click a sector of the gesture space to put the hand there, choose its shape, and drag the
    borders of the phases. ? shows the keys.

    Example: cubeling gesture edit WAVE
    """
    check_character(character)
    if not has_display():
        raise AppError("the editor needs a window: run it where there is a display")
    from cubeling.app.workshop.gesture_editor.window import edit as edit_in_window

    edit_in_window(folder, character, name)


@app.command("list")
def list_gestures(folder: FolderOption = GESTURE_FOLDER) -> None:
    """List all gestures: those of Cubeling, and your own.

    Example: cubeling gesture list
    """
    from cubeling.app.workshop.gesture_editor.editing.store import GestureStore
    from cubeling.app.workshop.gesture_editor.editing.timing import duration

    store = GestureStore(folder)
    rows = Table(box=SIMPLE_HEAD)
    for heading in ("gesture", "hands", "length", "whose", "what it means"):
        rows.add_column(heading, justify="right" if heading == "length" else "left")
    for name in store.names:
        gesture = store.load(name)
        whose = "yours" if store.is_own(name) else ""
        length = f"{duration(gesture):.1f} s"
        rows.add_row(escape(gesture.name), hands(gesture), length, whose, escape(gesture.summary))
    Console().print(rows)


@app.command()
def show(
    name: Annotated[str, typer.Argument(help="The gesture.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Draw it to this .png or .jpg file.")
    ] = None,
    character: Annotated[
        list[str] | None,
        typer.Option("--character", "-c", help="Who performs it; may be given several times."),
    ] = None,
    folder: FolderOption = GESTURE_FOLDER,
    overwrite: OverwriteOption = False,
) -> None:
    """Show the phases and keys of a gesture, and draw how characters perform it.

    It names the parameters of expressivity that do nothing to this gesture: a wider space does not
    move what a hand touches.

    Example: cubeling gesture show WAVE -o wave.png
    """
    if output is not None:
        chosen_output(output, "", "picture", SHEET_SUFFIXES, overwrite)
    from cubeling.app.workshop.gesture_editor.editing.store import GestureStore
    from cubeling.characters import Character

    gesture = GestureStore(folder).load(name)
    describe(Console(), gesture)
    if output is not None:
        from cubeling.app.workshop.gesture_editor.sheet import draw_sheet

        draw_sheet(output, gesture, character or list(Character.bundled_names()))
        print_written(str(output))


@app.command("import", context_settings=former_spellings({"from": "start", "to": "end"}))
def import_gesture(
    recording: Annotated[
        str, typer.Argument(help="A .bvh, .amc or .glb#CLIP file.", show_default=False)
    ],
    start: Annotated[float, typer.Option("--start", help="Where it starts, in seconds.")] = 0.0,
    end: Annotated[
        float,
        typer.Option(
            "--end",
            help="Where it ends, in seconds; default: the recording's end.",
            show_default=False,
        ),
    ] = float("inf"),
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", help="Its name in your gestures, or a .toml file."),
    ] = None,
    folder: FolderOption = GESTURE_FOLDER,
    overwrite: OverwriteOption = False,
) -> None:
    """Read a gesture off a recording: places, palms and paths of its hands.

    Example: cubeling gesture import greeting.bvh --start 1.2 --end 2.4 -o GREET
    """
    from cubeling.app.workshop.gesture_editor.editing.edits import gesture_name
    from cubeling.app.workshop.gesture_editor.editing.importing import import_gesture
    from cubeling.app.workshop.gesture_editor.editing.store import GestureStore
    from cubeling.characters.behaviour import GESTURE_SUFFIX, save_gesture

    file = output is not None and output.endswith(GESTURE_SUFFIX)
    if file:
        chosen_output(Path(str(output)), "", "gesture", (GESTURE_SUFFIX,), overwrite)
    gesture = import_gesture(recording, start, end)
    if output is not None:
        gesture = replace(gesture, name=gesture_name(Path(output).stem if file else output))
    if file:
        save_gesture(gesture, Path(str(output)))
    else:
        output = _save(GestureStore(folder), gesture, overwrite)
    describe(Console(), gesture)
    print_written(str(output))


def _save(store: GestureStore, gesture: SymbolicGesture, overwrite: bool) -> str:
    """Save a gesture to the library, unless there is one of its name; return where."""
    if store.has(gesture.name) and not overwrite:
        remedy = "choose another name with -o, or add --overwrite"
        raise AppError(f"there is a gesture {gesture.name} already: {remedy}")
    return store.save(gesture)


def describe(console: Console, gesture: SymbolicGesture) -> None:
    """Print the phases and the keys of a gesture, and what of expressivity does nothing to it."""
    from cubeling.app.workshop.gesture_editor.editing.timing import phase_spans
    from cubeling.characters.behaviour import without_effect

    console.print(f"[bold]{escape(gesture.name)}[/]  {escape(gesture.summary)}", highlight=False)
    spans = phase_spans(gesture).items()
    words = ", ".join(f"{phase} {end - start:.2f} s" for phase, (start, end) in spans)
    console.print(f"{hands(gesture)}: {words}", highlight=False, soft_wrap=True)
    for row in ("right", "left"):
        if keys := getattr(gesture, row):
            console.print(_hand_table(row, keys))
    if gesture.body:
        console.print(_body_table(gesture.body))
    if idle := without_effect(gesture):
        console.print(f"no effect here: {', '.join(idle)}")


def hands(gesture: SymbolicGesture) -> str:
    """Return who performs a gesture, such as "right hand" or "trunk and head"."""
    from cubeling.app.workshop.gesture_editor.editing.edits import hands_of

    if not (gesture.right or gesture.left):
        return "trunk and head"
    who = hands_of(gesture)
    return "both hands" if who == "both" else f"{who} hand"


def _hand_table(row: str, keys: tuple[HandKey, ...]) -> Table:
    rows = Table(title=f"{row} hand", title_justify="left", box=SIMPLE_HEAD)
    for heading in ("at", "place", "shape", "palm", "fingers", "path"):
        rows.add_column(heading, justify="right" if heading == "at" else "left")
    for key in keys:
        place = key.place.contact or f"{key.place.x} {key.place.y} {key.place.z}"
        rows.add_row(f"{key.at:g}", place, key.shape, key.palm, key.fingers, key.path)
    return rows


def _body_table(keys: tuple[BodyKey, ...]) -> Table:
    from cubeling.characters.behaviour import BodyKey

    rows = Table(title="trunk and head", title_justify="left", box=SIMPLE_HEAD)
    names = [field.name for field in fields(BodyKey)]
    for name in names:
        rows.add_column(name.removesuffix("_deg"), justify="right")
    for key in keys:
        rows.add_row(*(f"{getattr(key, name):g}" for name in names))
    return rows


def print_written(path: str) -> None:
    """Say where a file was written."""
    Console().print(f"[bold]{escape(path)}[/] is written", soft_wrap=True, highlight=False)
