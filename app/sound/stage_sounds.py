"""The sounds of plays: those of files, and some that are synthesised, as `bank` does it."""

from collections.abc import Mapping

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.pipeline.table.stage_sounds import SoundClip, SoundSource
from cubeling.app.session.encoding import decode_sound, encode_sound
from cubeling.app.sound.bank import synthesise
from cubeling.app.sound.sounds import Sound
from cubeling.app.sound.synthesis import SAMPLE_RATE, Array, curve, noise, strike, times, wobble
from cubeling.characters import CharacterError
from cubeling.characters.speech import read_speech, resample

MAX_FILE_S = 600.0
"""Longest sound that a file of a play may hold [s]."""


def _wind(random: np.random.Generator) -> Array:
    """Blow for half a minute: gusts that are higher the stronger they are."""
    time = times(30.0)
    gust = np.clip(0.55 + 0.25 * wobble(random, len(time), 0.35), 0.1, 1.0)
    low, high = (noise(random, len(time), center, 0.6) for center in (260, 620))
    ends = curve([(0.0, 0), (2.0, 1), (26.0, 1), (29.9, 0)], time)
    return ends * gust * (low + (gust - 0.1) * high)


def _gong(random: np.random.Generator) -> Array:
    """Strike a big gong: partials that are no harmonics, of which the high ones swell late."""
    time = times(6.0)
    partials = [
        (82.0 * ratio * float(random.uniform(0.997, 1.003)), 2.6 / ratio**0.7, 1.0 / ratio)
        for ratio in (1.0, 1.52, 2.09, 2.71, 3.47, 4.16, 5.43, 6.79)
    ]
    late = np.minimum(time / 0.25, 1.0)
    felt = noise(random, len(time), 300, 0.7) * curve([(0.0, 0), (0.004, 1), (0.06, 0)], time)
    return strike(time, partials[:3]) + late * strike(time, partials[3:]) + 0.15 * felt


STAGE_SOUNDS: dict[str, Sound] = {
    "wind": Sound(_wind, -28.0, "wind over an open place, for half a minute"),
    "gong": Sound(_gong, -20.0, "a big gong"),
}
"""Sounds that plays may name instead of a file."""


def open_clips(sources: Mapping[str, SoundSource]) -> dict[str, SoundClip]:
    """Return the sounds of a scenario by their names.

    Raises
    ------
    AppError
        A file cannot be read, or is longer than `MAX_FILE_S`; the message names the place.
    """
    return {name: _open_clip(name, source) for name, source in sources.items()}


def _open_clip(name: str, source: SoundSource) -> SoundClip:
    if source.path is None:
        samples = synthesise(STAGE_SOUNDS[name], name, 1)[0].astype(np.float32)
    else:
        try:
            sound = read_speech(source.path, MAX_FILE_S)
        except CharacterError as error:
            raise AppError(f"{source.place}: {error}") from error
        samples = resample(sound.samples, sound.rate, SAMPLE_RATE)
    # With the samples that a recording keeps, so that a replay has the very same.
    return SoundClip(decode_sound(encode_sound(samples)), SAMPLE_RATE)
