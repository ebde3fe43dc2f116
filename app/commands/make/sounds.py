"""The command `cubeling sounds`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.output_path import check_output_folder, output_folder


def sounds(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the files.")],
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Overwrite the sounds that the folder holds.")
    ] = False,
) -> None:
    """Write all sounds as .wav files, to listen to them and to replace them.

    Each sound has variants that take turns: kiss-1.wav, kiss-2.wav … Change or replace what you
    like, delete the rest, and play with --sounds FOLDER. See docs/sound.md.

    Example: cubeling sounds -o sounds
    """
    check_output_folder(output, (), "sounds", overwrite=overwrite)
    from cubeling.app.sound import SAMPLE_RATE, SOUNDS, SoundBank, write_wave

    bank = SoundBank()
    files = {
        f"{name}-{number}.wav": samples
        for name in SOUNDS
        for number, samples in enumerate(bank.variants(name), start=1)
    }
    check_output_folder(output, files, "sounds", overwrite=overwrite)
    with output_folder(output):
        for name, samples in files.items():
            write_wave(output / name, samples)
    table = Table("sound", "is heard when", "seconds")
    for name, sound in SOUNDS.items():
        seconds = len(bank.variants(name)[0]) / SAMPLE_RATE
        table.add_row(name, sound.meaning, f"{seconds:.2f}")
    console = Console(highlight=False, soft_wrap=True)
    console.print(table)
    console.print(f"[bold]{escape(str(output))}[/] holds {len(files)} files")
