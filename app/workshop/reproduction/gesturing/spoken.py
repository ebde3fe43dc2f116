"""Speech and gestures that the tables of chapter 4 are made from, in the conditions of its test."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path
from typing import Literal

import numpy as np

from cubeling.app.errors import AppError
from cubeling.characters.motion import GestureLibrary, GestureSettings
from cubeling.characters.speech import (
    Accent,
    Speech,
    Utterance,
    phones_from_sound,
    read_speech,
    utterance_of,
)

LIBRARY = "human.gestures"
"""The bundled library of the human, whose phrases our own generator made."""

PRINTED_SETTINGS = GestureSettings(
    model="thesis", anticipations=1, accent_floor=0.0, longest_hold_s=0.0
)
"""How gestures are chosen, to the letter of section 4.4.4, but by our search (erratum 9)."""

Condition = Literal["intensity", "time", "random"]
"""What chosen gestures follow: strength and time of the accents, time only, or neither."""

LEAST_GAP_S = 0.3
"""Least time between two accents that are put at random [s]."""


def bundled_library() -> GestureLibrary:
    """Return the bundled gestures of the human."""
    with as_file(files("cubeling.characters") / "assets" / LIBRARY) as path:
        return GestureLibrary.load(path)


def recordings(folder: Path) -> list[Path]:
    """Return the sound files of a folder and those below it, in order; raises AppError if none."""
    found = sorted(folder.rglob("*.wav"))
    if not found:
        raise AppError(f"there is no .wav file in '{folder}'")
    return found


def speeches(folder: Path) -> Iterator[tuple[str, Speech, Utterance]]:
    """Yield name, sound and utterance of each recording of a folder."""
    for path in recordings(folder):
        sound = read_speech(path)
        speech = replace(sound, phones=phones_from_sound(sound.samples, sound.rate))
        yield path.stem, speech, utterance_of(speech)


def accents_for(
    condition: Condition, accents: Sequence[Accent], duration: float, rng: np.random.Generator
) -> list[Accent]:
    """Return what the gestures of a condition follow (section 4.4.5).

    In "time" the strengths are drawn at random from those of the speech, so that the restrictions
    are equal; in "random" the times are as well.
    """
    if condition == "intensity" or not accents:
        return list(accents)
    strengths = rng.choice([each.strength for each in accents], len(accents)).tolist()
    times = [each.time for each in accents]
    if condition == "random":
        # Sorted free room, with the least gap before each: uniform, and never too close.
        room = max(duration - LEAST_GAP_S * len(accents), 0.0)
        times = (
            np.sort(rng.uniform(0.0, room, len(accents))) + LEAST_GAP_S * np.arange(len(accents))
        ).tolist()
    return [Accent(*each) for each in zip(times, strengths, strict=True)]
