"""The plot of a speech: waveform, pitch, intensity, words, phones, accents and gestures.

Needs matplotlib, the extra `[plots]`; only `cubeling speech show` and `cubeling speak` import it.
"""

import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from cubeling.app.workshop.moods.colors import BORDER_COLOR, GRID_COLOR, SECONDARY_COLOR, TEXT_COLOR
from cubeling.app.workshop.moods.plot import write_figure
from cubeling.app.workshop.moods.plot_layout import MATPLOTLIB_STYLE, printable
from cubeling.characters.speech import (
    SILENCE,
    Accent,
    AccentSettings,
    Prosody,
    SoundClass,
    Speech,
    accents_of,
    measure_prosody,
    sound_class,
)

INCHES_PER_S, WIDTHS_IN = 2.2, (11.0, 60.0)
"""Width of a second, and smallest and largest width of the plot [in]."""

LETTER_IN = 0.105
"""Width of a letter [in]; what does not fit is left out."""

WAVE_COLUMNS = 4000
"""Columns of the waveform, each from its lowest to its highest sample."""

ACCENT_COLOR, PITCH_COLOR, INTENSITY_COLOR = "#d55e00", "#0072b2", "#009e73"

_PHONE_COLORS: dict[SoundClass, str] = {
    "vowel": "#f6cfa6",
    "glide": "#f3e6b5",
    "nasal": "#d9e7c3",
    "stop": "#cfd8ea",
    "fricative": "#d8e9ee",
    "affricate": "#d3dfee",
    "silence": "#ffffff",
}
_PHASE_COLORS = {
    "preparation": "#cfe3f2",
    "stroke": "#e69f66",
    "hold": "#f0e2b6",
    "retraction": "#dfe3ec",
}
_OTHER_PHASE = "#e7dcea"


@dataclass(frozen=True)
class GestureMark:
    """A gesture in the plot."""

    name: str
    """What it is called."""

    start: float
    """When it begins, from the start of the speech [s]."""

    apex: float
    """When its stroke is at its height [s]."""

    end: float
    """When it ends [s]."""

    phases: tuple[tuple[str, float, float], ...] = ()
    """Name, start and end of each phase [s], such as "stroke"."""


def save_plot(
    path: Path,
    speech: Speech,
    title: str,
    gestures: Sequence[GestureMark] = (),
    settings: AccentSettings | None = None,
) -> None:
    """Write the plot of a speech; the suffix of the path says how.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    with matplotlib.rc_context(MATPLOTLIB_STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # the font lacks some scripts: boxes
        write_figure(draw(speech, title, gestures, settings), path, title)


def draw(
    speech: Speech,
    title: str,
    gestures: Sequence[GestureMark] = (),
    settings: AccentSettings | None = None,
) -> Figure:
    """Return the figure; see `save_plot`."""
    settings = settings or AccentSettings()
    prosody = measure_prosody(speech.samples, speech.rate, settings.prosody)
    accents = accents_of(prosody, speech.phones, settings)
    lanes = _lanes(gestures)
    panels: list[tuple[float, Callable[[Axes], None]]] = [
        (1.0, lambda axes: _draw_waveform(axes, speech, prosody)),
        (1.7, lambda axes: _draw_pitch(axes, prosody, accents)),
        (1.1, lambda axes: _draw_intensity(axes, prosody)),
    ]
    width = float(np.clip(speech.duration * INCHES_PER_S, *WIDTHS_IN))
    scale = (width - 2.0) / max(speech.duration, 1e-3)  # [in/s]
    if speech.words:
        panels.append((0.3, lambda axes: _draw_words(axes, speech, scale)))
    if speech.phones:
        panels.append((0.3, lambda axes: _draw_phones(axes, speech, scale)))
    panels.append((0.55, lambda axes: _draw_accents(axes, accents)))
    if lanes:
        panels.append((0.34 * len(lanes), lambda axes: _draw_gestures(axes, lanes, scale)))
    heights = [height for height, _ in panels]
    figure = Figure(figsize=(width, 1.1 + 1.15 * sum(heights)), layout="constrained")
    figure.suptitle(printable(title), fontweight="bold", color=TEXT_COLOR, fontsize=14)
    rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for axes, (_, draw_panel) in zip(rows, panels, strict=True):
        draw_panel(axes)
        axes.set_xlim(0.0, max(speech.duration, 1e-3))
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(axis="x", length=0 if axes is not rows[-1] else 3)
        for accent in accents:
            axes.axvline(accent.time, color=ACCENT_COLOR, alpha=0.28, linewidth=1.0, zorder=0)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels(rows)
    return figure


def _lanes(gestures: Sequence[GestureMark]) -> list[list[GestureMark]]:
    """Return gestures in as few rows as hold them side by side."""
    lanes: list[list[GestureMark]] = []
    for gesture in sorted(gestures, key=lambda each: each.start):
        free = next((lane for lane in lanes if lane[-1].end <= gesture.start + 1e-6), None)
        if free is None:
            lanes.append([gesture])
        else:
            free.append(gesture)
    return lanes


def _draw_waveform(axes: Axes, speech: Speech, prosody: Prosody) -> None:
    """Draw the sound, with its pauses in grey."""
    for start, end in prosody.pauses:
        axes.axvspan(start, end, color=GRID_COLOR, alpha=0.45, linewidth=0)
    columns = min(WAVE_COLUMNS, len(speech.samples))
    starts = np.linspace(0, len(speech.samples), columns, endpoint=False).astype(int)
    low = np.minimum.reduceat(speech.samples, starts)
    high = np.maximum.reduceat(speech.samples, starts)
    axes.fill_between(starts / speech.rate, low, high, color=SECONDARY_COLOR, linewidth=0.3)
    peak = max(float(np.abs(speech.samples).max()), 1e-3)
    axes.set_ylim(-1.1 * peak, 1.1 * peak)
    axes.set_yticks([])
    _name(axes, "sound")


def _draw_pitch(axes: Axes, prosody: Prosody, accents: Sequence[Accent]) -> None:
    """Draw the pitch of voiced frames on a logarithmic scale, and the voiced regions below."""
    voiced = prosody.f0 > 0
    axes.set_yscale("log")
    heard = prosody.f0[voiced] if voiced.any() else np.array([100.0, 200.0])
    low, high = 0.84 * float(np.quantile(heard, 0.01)), 1.16 * float(np.quantile(heard, 0.99))
    axes.set_ylim(low, high)
    pitch = np.where(voiced, prosody.f0, np.nan)
    axes.plot(prosody.times, pitch, color=PITCH_COLOR, linewidth=1.8)
    strip = low * (high / low) ** 0.03
    for start, end in prosody.voiced:
        axes.fill_between([start, end], low, strip, color=PITCH_COLOR, alpha=0.55, linewidth=0)
    times = [accent.time for accent in accents]
    if times:
        at_accents = np.interp(times, prosody.times[voiced], prosody.f0[voiced])
        axes.plot(times, at_accents, "o", color=ACCENT_COLOR, markersize=5, zorder=3)
    ticks = [f for f in (50, 75, 100, 125, 150, 200, 250, 300, 400, 500) if low <= f <= high]
    axes.set_yticks(ticks, [f"{tick}" for tick in ticks])
    axes.minorticks_off()
    axes.grid(True, axis="y", color=GRID_COLOR, linewidth=0.7)
    _name(axes, "pitch [Hz]\nand voicing")


def _draw_intensity(axes: Axes, prosody: Prosody) -> None:
    """Draw the intensity down to 60 dB below its peak."""
    top = float(prosody.intensity.max()) if len(prosody.intensity) else 0.0
    axes.plot(prosody.times, prosody.intensity, color=INTENSITY_COLOR, linewidth=1.4)
    axes.set_ylim(top - 60.0, top + 4.0)
    axes.grid(True, axis="y", color=GRID_COLOR, linewidth=0.7)
    _name(axes, "intensity\n[dB]")


def _draw_words(axes: Axes, speech: Speech, scale: float) -> None:
    boxes = ((word.start, word.end, word.text, "#eceef3") for word in speech.words)
    _draw_boxes(axes, boxes, scale, 11.0)
    _name(axes, "words")


def _draw_phones(axes: Axes, speech: Speech, scale: float) -> None:
    boxes = (
        (phone.start, phone.end, phone.symbol, _PHONE_COLORS[sound_class(phone.symbol)])
        for phone in speech.phones
        if phone.symbol != SILENCE
    )
    _draw_boxes(axes, boxes, scale, 10.0)
    _name(axes, "phones")


def _draw_accents(axes: Axes, accents: Sequence[Accent]) -> None:
    """Draw a stem for each accent, as high as it is strong."""
    times = [accent.time for accent in accents]
    strengths = [accent.strength for accent in accents]
    axes.vlines(times, 0.0, strengths, color=ACCENT_COLOR, linewidth=3.0)
    for time, strength in zip(times, strengths, strict=True):
        axes.text(time, strength + 0.06, f"{strength:.2f}", ha="center", fontsize=8.5)
    axes.set_ylim(0.0, 1.45)
    axes.set_yticks([0.0, 1.0], ["0", "1"])
    _name(axes, "accents")


def _draw_gestures(axes: Axes, lanes: Sequence[Sequence[GestureMark]], scale: float) -> None:
    """Draw the phases of gestures, with a diamond at each apex."""
    for row, lane in enumerate(lanes):
        for gesture in lane:
            phases = gesture.phases or (("stroke", gesture.start, gesture.end),)
            for name, start, end in phases:
                color = _PHASE_COLORS.get(name, _OTHER_PHASE)
                _box(axes, start, end, row + 0.5, 0.42, color)
            axes.plot([gesture.apex], [row + 0.71], "D", color=TEXT_COLOR, markersize=4.5, zorder=3)
            if (gesture.end - gesture.start) * scale >= LETTER_IN * len(gesture.name):
                middle = (gesture.start + gesture.end) / 2
                axes.text(middle, row + 0.26, gesture.name, ha="center", va="center", fontsize=8.5)
    used = {name for lane in lanes for gesture in lane for name, _, _ in gesture.phases}
    handles = [
        Rectangle((0, 0), 1, 1, facecolor=color, edgecolor=BORDER_COLOR, label=name)
        for name, color in _PHASE_COLORS.items()
        if name in used
    ]
    if handles:
        axes.legend(handles=handles, ncols=4, fontsize=8.5, frameon=False, loc="upper right",
                    bbox_to_anchor=(1.0, -0.35 / len(lanes)))  # fmt: skip
    axes.set_ylim(0.0, len(lanes))
    axes.set_yticks([])
    _name(axes, "gestures")


def _draw_boxes(
    axes: Axes, boxes: Iterable[tuple[float, float, str, str]], scale: float, size: float
) -> None:
    """Draw boxes with start, end, text and colour; the text where it fits."""
    for start, end, text, color in boxes:
        _box(axes, start, end, 0.5, 0.46, color)
        letters = sum(1 for letter in text if letter.isprintable())
        if (end - start) * scale >= LETTER_IN * size / 11.0 * letters:
            axes.text((start + end) / 2, 0.48, printable(text), ha="center", va="center",
                      fontsize=size, clip_on=True)  # fmt: skip
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])


def _box(axes: Axes, start: float, end: float, middle: float, half: float, color: str) -> None:
    box = Rectangle((start, middle - half), end - start, 2 * half, facecolor=color)
    box.set(edgecolor=BORDER_COLOR, linewidth=0.7)
    axes.add_patch(box)


def _name(axes: Axes, name: str) -> None:
    axes.set_ylabel(name, rotation=0, ha="right", va="center", color=SECONDARY_COLOR)
