"""The commands of `cubeling stimuli`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from cubeling.app.command_group import CommandGroup
from cubeling.app.commands.play.preference_options import size_of
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input
from cubeling.app.output_path import check_output_folder, output_folder

app = CommandGroup("Make the films that bundled studies show, from recordings of your own.")

OutputOption = Annotated[Path, typer.Option("--output", "-o", help="Folder for the films.")]
OverwriteOption = Annotated[bool, typer.Option("--overwrite", help="Overwrite earlier films.")]
SizeOption = Annotated[str, typer.Option(help="Size of the films.")]
RateOption = Annotated[float, typer.Option(help="Frames a second.", min=1.0, max=120.0)]
SeedOption = Annotated[int, typer.Option(help="Of what is drawn at random.", min=0)]


@app.command()
def gestures(
    sounds: Annotated[Path, typer.Argument(help="Folder of .wav files, named by their speech.")],
    output: OutputOption,
    library: Annotated[
        Path | None,
        typer.Option("--gestures", help="A file of cubeling gesture learn; default: the bundled."),
    ] = None,
    captured: Annotated[
        Path | None,
        typer.Option(help="Folder of what was captured with the speech: .bvh or .amc by its name."),
    ] = None,
    size: SizeOption = "480x480",
    rate: RateOption = 25.0,
    seed: SeedOption = 0,
    overwrite: OverwriteOption = False,
) -> None:
    """Make the films of gesture-and-speech: captured, by strength and time, by time, at random.

    A film in which a gesture costs 10 or more is left out, and so are its pairs: manifest.csv and
    pairs.csv say which. The files are named as the protocol names them.

    Example: cubeling stimuli gestures recordings -o videos --captured captured
    """
    pixels = size_of(size)
    for folder in (sounds, captured):
        if folder is not None and not folder.is_dir():
            raise AppError(f"there is no folder '{folder}'")
    check_input(library, "gesture library")
    check_output_folder(output, ["manifest.csv"], "films", overwrite=overwrite)
    from cubeling.app.workshop.reproduction.gesturing.spoken import bundled_library
    from cubeling.app.workshop.stimuli.film import FilmLook
    from cubeling.app.workshop.stimuli.gesture_films import write_gesture_films
    from cubeling.characters import Character
    from cubeling.characters.model import gestures_for

    body = Character.load("human")
    chosen = bundled_library() if library is None else gestures_for(library, body.skeleton, "human")
    console = Console(highlight=False, soft_wrap=True)
    with output_folder(output), console.status("reading") as status:
        films, pairs = write_gesture_films(
            sounds,
            output,
            body,
            chosen,
            FilmLook("hands", pixels, rate),
            captured=captured,
            seed=seed,
            drawn=status.update,
        )
    console.print(
        Text.assemble(
            (str(output), "bold"), f": {quantity(films, 'film')}, {quantity(pairs, 'pair')} of them"
        )
    )


@app.command()
def idle(
    recordings: Annotated[Path, typer.Argument(help="Folder of .bvh files, one of each person.")],
    output: OutputOption,
    seconds: Annotated[float, typer.Option(help="Length of a film.", min=1.0, max=600.0)] = 15.0,
    size: SizeOption = "360x480",
    rate: RateOption = 25.0,
    seed: SeedOption = 0,
    overwrite: OverwriteOption = False,
) -> None:
    """Make the films of whose-idle-motion: each person as recorded, and as generated.

    The people are P1, P2 … in the order of their files, as the protocol names them; manifest.csv
    says whose recording each is.

    Example: cubeling stimuli idle people -o films
    """
    pixels = size_of(size)
    if not recordings.is_dir():
        raise AppError(f"there is no folder '{recordings}'")
    check_output_folder(output, ["manifest.csv"], "films", overwrite=overwrite)
    from cubeling.app.workshop.stimuli.film import FilmLook
    from cubeling.app.workshop.stimuli.idle_films import write_idle_films

    console = Console(highlight=False, soft_wrap=True)
    with output_folder(output), console.status("reading") as status:
        films = write_idle_films(
            recordings,
            output,
            FilmLook("body", pixels, rate),
            seconds=seconds,
            seed=seed,
            drawn=status.update,
        )
    console.print(Text.assemble((str(output), "bold"), f": {quantity(films, 'film')}"))
