"""The commands of `cubeling speech`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.command_group import CommandGroup
from cubeling.app.commands.output import (
    PLOT_SUFFIXES,
    OverwriteOption,
    PlotOption,
    chosen_output,
    needs_matplotlib,
)
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.characters.speech import DEFAULT_PROFILE

if TYPE_CHECKING:
    from cubeling.characters.motion import PlannedGesture
    from cubeling.characters.speech import Accent, AccentSettings, Interval, Speech

MAX_PLOT_S = 120.0
"""Longest speech that is plotted [s]."""

COMPARED_THRESHOLDS = (0.2, 0.3, 0.4, 0.5, 0.6)
"""Thresholds at which accents are compared with labels, beside the chosen one."""

app = CommandGroup("Look at recorded speech: its pitch, accents, words and phones.")

FileArgument = Annotated[Path, typer.Argument(help="A recording: WAV, MP3, Ogg, a video, …")]
LanguageOption = Annotated[str, typer.Option("--language", help="Language of the text: en, ca, …")]


@app.command()
def show(
    file: FileArgument,
    text: Annotated[str | None, typer.Option(help="What is said, for words and phones.")] = None,
    language: LanguageOption = "en",
    textgrid: Annotated[
        Path | None, typer.Option(help="A TextGrid with words or phones, instead of --text.")
    ] = None,
    threshold: Annotated[
        float, typer.Option(min=0.0, max=1.0, help="Least strength of an accent.")
    ] = DEFAULT_PROFILE.accent_threshold,
    labels: Annotated[
        Path | None,
        typer.Option(
            help="Compare with accents that people heard: a .csv of times, or a TextGrid with a "
            "tier 'accents'."
        ),
    ] = None,
    character: Annotated[
        str, typer.Option(help="Whose gestures are plotted: bundled, or a .glb file.")
    ] = "human",
    output: PlotOption = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Show a recording: duration, speech rate, pitch and pitch accents.

    The plot also shows waveform, intensity and voicing, words and phones if the text is known, and
    the gestures with which a character would say it. With labels, it prints precision, recall
    and F1 of accents, and the correlation of accented words, for several thresholds.
    It needs matplotlib: pip install matplotlib

    Example: cubeling speech show talk.wav --text "Hello there" -o talk.png
    """
    if output is not None:
        chosen_output(output, "", "plot", PLOT_SUFFIXES, overwrite)
    if text is not None and textgrid is not None:
        raise AppError("give --text or --textgrid, not both")
    console = Console()
    from cubeling.characters.speech import (
        AccentSettings,
        read_accent_labels,
        read_speech,
        read_textgrid,
        with_textgrid,
    )

    labelled = None if labels is None else read_accent_labels(labels)
    speech = read_speech(file)
    if output is not None and speech.duration > MAX_PLOT_S:
        raise AppError(f"a plot shows up to {MAX_PLOT_S:g} s, and '{file}' is longer: cut it")
    if textgrid is not None:
        speech = _with_stress(with_textgrid(speech, read_textgrid(textgrid)), language)
    elif text is not None:
        speech = align_speech(speech, text, language, console)
    settings = AccentSettings(threshold)
    accents = describe(console, speech, settings)
    if labelled is not None:
        _print_agreement(console, speech, labelled, threshold)
    if output is None:
        return
    with needs_matplotlib():
        from cubeling.app.workshop.speech_plot import GestureMark, save_plot
    marks = [
        GestureMark(each.node.phrase.hand, each.start, each.apex, each.end, tuple(each.phases))
        for each in planned_gestures(character, accents, speech.duration)
    ]
    save_plot(output, speech, file.name, marks, settings)
    console.print(f"Plotted: [bold]{escape(str(output))}[/]", soft_wrap=True, highlight=False)


def _with_stress(speech: Speech, language: str) -> Speech:
    """Return a speech whose words are stressed as a voice stresses them, if there is a voice."""
    from cubeling.characters.speech import VoiceError, espeak, say, stressed_like

    try:
        with espeak() as voice:
            return stressed_like(speech, say(voice, speech.text, language))
    except VoiceError:
        return speech


def _print_agreement(
    console: Console, speech: Speech, labels: Sequence[Interval], threshold: float
) -> None:
    """Print how accents agree with those that people heard, at several thresholds."""
    from cubeling.characters.speech import (
        AccentSettings,
        LabelAgreement,
        accents_of,
        measure_prosody,
    )

    prosody = measure_prosody(speech.samples, speech.rate)
    title = f"beside {quantity(len(labels), 'label')} of people"
    rows = Table(box=SIMPLE_HEAD, title=title, title_justify="left")
    for heading in ("threshold", "accents", "precision", "recall", "F1", "words' MCC"):
        rows.add_column(heading, justify="right")
    for each in sorted({*COMPARED_THRESHOLDS, threshold}):
        accents = accents_of(prosody, speech.phones, AccentSettings(each))
        found = LabelAgreement.of(labels, accents, speech.words)
        words = "no words" if found.words is None else f"{found.words:.2f}"
        scores = [f"{score:.2f}" for score in (found.precision, found.recall, found.f1)]
        style = "bold" if each == threshold else ""
        rows.add_row(f"{each:g}", f"{len(accents)}", *scores, words, style=style)
    console.print(rows)


def planned_gestures(
    character: str, accents: Sequence[Accent], duration: float
) -> tuple[PlannedGesture, ...]:
    """Return the gestures with which a character would say it; () for one without gestures."""
    from cubeling.characters import Character

    gestures = Character.load(character).gestures
    if gestures is None:
        return ()
    return DEFAULT_PROFILE.planner(gestures).plan(accents, duration).gestures


@app.command()
def align(
    file: FileArgument,
    text: Annotated[str, typer.Option(help="What is said; @FILE reads it from a file.")],
    language: LanguageOption = "en",
    sphinx: Annotated[
        bool, typer.Option(help="Align by PocketSphinx, more exact; English only.")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The .TextGrid file; see Praat.")
    ] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Write when each word and phone of a recording is said, as a TextGrid.

    Example: cubeling speech align talk.wav --text "Bon dia" --language ca
    """
    target = chosen_output(output, f"{file.stem}.TextGrid", "TextGrid", (".textgrid",), overwrite)
    console = Console()
    said = said_text(text)
    from cubeling.characters.speech import read_speech, textgrid_of, write_textgrid

    speech = align_speech(read_speech(file), said, language, console, sphinx=sphinx)
    write_textgrid(target, textgrid_of(speech))
    console.print(
        f"[bold]{escape(str(target))}[/] is written: {quantity(len(speech.words), 'word')}, "
        f"{quantity(sum(bool(phone.symbol) for phone in speech.phones), 'phone')}",
        soft_wrap=True,
        highlight=False,
    )


def said_text(text: str) -> str:
    """Return a text, or what is in the file that it names after an @."""
    from cubeling.characters.speech import TEXT_FILE

    return TEXT_FILE.read_text(text[1:]) if text.startswith("@") else text


def align_speech(
    speech: Speech, text: str, language: str, console: Console, *, sphinx: bool = False
) -> Speech:
    """Return a recording with the times of its words and phones."""
    if sphinx and language.split("-")[0] != "en":
        raise AppError(f"PocketSphinx knows English only, not '{language}': leave out --sphinx")
    from cubeling.characters.speech import align as align_by_warping, align_with_sphinx, espeak

    with console.status("aligning"), espeak() as voice:
        if sphinx:
            return align_with_sphinx(speech, text, voice)
        return align_by_warping(speech, text, voice, language)


def describe(console: Console, speech: Speech, settings: AccentSettings) -> tuple[Accent, ...]:
    """Print what a recording is like, and its accents; return these."""
    import numpy as np

    from cubeling.characters.speech import accents_of, measure_prosody, syllable_nuclei

    prosody = measure_prosody(speech.samples, speech.rate, settings.prosody)
    accents = accents_of(prosody, speech.phones, settings)
    voiced = prosody.f0[prosody.f0 > 0]
    spoken = speech.duration - float((prosody.pauses[:, 1] - prosody.pauses[:, 0]).sum())
    facts = [f"{speech.duration:.2f} s, {speech.rate} Hz", f"{spoken:.2f} s without pauses"]
    syllables = len(syllable_nuclei(prosody, speech.phones).times)
    facts.append(f"{syllables / max(spoken, 1e-3):.1f} syllables a second")
    if len(voiced):
        low, middle, high = np.quantile(voiced, (0.05, 0.5, 0.95))
        facts.append(f"pitch {middle:.0f} Hz ({low:.0f} to {high:.0f})")
    else:
        facts.append("no voice is heard")
    console.print(", ".join(facts), highlight=False, soft_wrap=True)
    if not accents:
        console.print("no pitch accents")
        return accents
    table = Table(box=SIMPLE_HEAD, title="pitch accents", title_justify="left")
    for heading in ("time", "strength", "pitch") + (("word",) if speech.words else ()):
        table.add_column(heading, justify="left" if heading == "word" else "right")
    pitches = np.interp([a.time for a in accents], prosody.times, prosody.f0)
    for accent, pitch in zip(accents, pitches, strict=True):
        row = [f"{accent.time:.2f} s", f"{accent.strength:.2f}", f"{pitch:.0f} Hz"]
        table.add_row(*row, *([escape(_word_at(speech, accent))] if speech.words else []))
    console.print(table)
    return accents


def _word_at(speech: Speech, accent: Accent) -> str:
    """Return the word of an accent."""
    words = (word.text for word in speech.words if word.start <= accent.time <= word.end)
    return next(words, "")
