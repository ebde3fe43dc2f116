"""Draws all sounds as spectrograms and waves: `python -m tools.sound_sheet`.

Prints their figures too: length, peak, loudness, and the centre of the spectrum.
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from rich.console import Console
from rich.table import Table

mpl.use("svg")  # before pyplot: no display is needed
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

from cubeling.app.sound import SAMPLE_RATE, SOUNDS, SoundBank
from cubeling.app.sound.synthesis import Array, loudness

FILE = Path(__file__).parent.parent / "docs" / "pictures" / "sounds.png"

COLUMNS = 6
"""Sounds in a row."""

WIDTH_S = 1.1
"""Every sound is drawn over this time, so that lengths can be compared [s]."""

MAX_HZ, RANGE_DB = 8_000.0, 70.0
"""The drawn frequencies [Hz], and the range of the colours below a sound's loudest place [dB]."""

WINDOW, STEP = 1024, 128
"""Length of the windows of a spectrogram, and the distance between them [samples]."""


def spectrogram(sound: Array) -> Array:
    """Return the power of a sound [dB of its greatest], (frequencies, windows) over `WIDTH_S`."""
    padded = np.zeros(round(WIDTH_S * SAMPLE_RATE) + WINDOW)
    padded[WINDOW // 2 : WINDOW // 2 + len(sound)] = sound
    windows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW)[::STEP] * np.hanning(WINDOW)
    power = np.abs(np.fft.rfft(windows)).T ** 2
    return np.asarray(10.0 * np.log10(np.maximum(power / power.max(), 1e-12)))


def draw_sound(name: str, sound: Array, wave: Axes, picture: Axes) -> None:
    """Draw the wave of a sound, and its spectrogram below."""
    wave.set_title(name.replace("_", " "), fontsize=9, loc="left", pad=3)
    wave.plot(np.arange(len(sound)) / SAMPLE_RATE, sound, linewidth=0.3, color="#b4552d")
    wave.set_axis_off()
    wave.set(xlim=(0.0, WIDTH_S), ylim=(-0.75, 0.75))
    shown = spectrogram(sound)
    picture.imshow(
        shown,
        origin="lower",
        aspect="auto",
        cmap="magma",
        vmin=-RANGE_DB,
        extent=(0.0, WIDTH_S, 0.0, SAMPLE_RATE / 2000.0),
    )
    picture.set(ylim=(0.0, MAX_HZ / 1000.0), xticks=(0.0, 0.5, 1.0), yticks=(0, 4, 8))
    picture.tick_params(labelsize=6, length=2)


def draw(bank: SoundBank, file: Path) -> None:
    """Draw the first variant of every sound."""
    rows = -(-len(SOUNDS) // COLUMNS)
    figure, axes = plt.subplots(
        2 * rows,
        COLUMNS,
        figsize=(12.0, 2.1 * rows),
        height_ratios=[1, 3] * rows,
        layout="constrained",
    )
    for axis in axes.flat:
        axis.set_axis_off()
    for number, name in enumerate(SOUNDS):
        row, column = divmod(number, COLUMNS)
        wave, picture = axes[2 * row, column], axes[2 * row + 1, column]
        picture.set_axis_on()
        draw_sound(name, bank.variants(name)[0], wave, picture)
    figure.supxlabel("time [s]", fontsize=7)
    figure.supylabel("frequency [kHz]", fontsize=7)
    figure.savefig(file, dpi=110, metadata={"Software": None})


def figures(bank: SoundBank) -> Table:
    """Return the figures of the first variant of every sound."""
    table = Table("sound", "length [s]", "peak [dB]", "loudness [dB]", "centre [Hz]")
    for name in SOUNDS:
        sound = bank.variants(name)[0]
        power = np.abs(np.fft.rfft(sound)) ** 2
        centre = (power * np.fft.rfftfreq(len(sound), 1 / SAMPLE_RATE)).sum() / power.sum()
        peak = 20.0 * np.log10(np.abs(sound).max())
        numbers = len(sound) / SAMPLE_RATE, peak, loudness(sound), centre
        formats = (".2f", ".1f", ".1f", ".0f")
        table.add_row(name, *(f"{n:{f}}" for n, f in zip(numbers, formats, strict=True)))
    return table


if __name__ == "__main__":
    sounds = SoundBank()
    draw(sounds, FILE)
    Console().print(figures(sounds))
