"""What the mouth does, guessed from the sound alone: for a live voice, or a speech without text.

Vowels differ by the energy around their first two formants (G. Peterson and H. Barney 1952,
"Control methods used in a study of the vowels", Journal of the Acoustical Society of America 24):
an open vowel has much from 550 to 1100 Hz, a spread one next to nothing there and much above
1700 Hz, a rounded one little above 1100 Hz. Hisses have most of theirs above 4 kHz. Stops and
nasals are 12 dB quieter than vowels.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.frames import frame_blocks
from cubeling.characters.speech.phones import fill_pauses
from cubeling.characters.speech.speech import SILENCE, Phone, Samples

STEP_S, WINDOW_S = 0.01, 0.03
"""Time from frame to frame, and length of a frame [s]."""

RISE_S, FALL_S = 0.015, 0.04
"""How fast weights rise and fall [s]."""

BANDS_HZ = (100.0, 550.0, 1100.0, 1700.0, 3200.0)
"""Borders of four bands [Hz]."""

HISS_HZ = 4000.0
"""Lowest frequency of the band of hisses [Hz]; for a telephone, six tenths of its band."""

QUIETEST_DB = -50.0
"""Nothing quieter is a voice [dB relative to a constant sample of 1]."""

FORGOTTEN_DB_S = 2.0
"""How fast the loudest level is forgotten [dB/s], so that a softer speaker opens her mouth, too."""

PHONES = ("a", "i", "u", "s", "m")
"""What `phones_from_sound` calls the shapes: open, spread, rounded, hiss, closed."""

MIN_PHONE_S = 0.04
"""Shortest phone of `phones_from_sound` [s]."""


@dataclass(frozen=True)
class MouthWeights:
    """The shape of the mouth at a moment; each 0…1, together at most 1. The rest is closed."""

    open: float
    """Open, as in "father", 0…1."""

    spread: float
    """Spread, as in "see", 0…1."""

    rounded: float
    """Rounded, as in "too", 0…1."""

    hiss: float
    """Teeth together, as in "hiss", 0…1."""


class MouthTracker:
    """Follows the mouth of a live voice, about 30 ms behind the sound.

    Parameters
    ----------
    rate
        Sample rate of the blocks [Hz].
    """

    def __init__(self, rate: int) -> None:
        self._analysis = _MouthAnalysis(rate)
        self._step = round(STEP_S * rate)
        self._waiting = np.zeros(self._analysis.length, np.float32)
        self._weights = np.zeros(4)

    def update(self, block: Samples) -> MouthWeights:
        """Take the next samples, any number of them, and return the shape of the mouth."""
        sound = np.concatenate([self._waiting, np.nan_to_num(block).astype(np.float32)])
        count = (len(sound) - self._analysis.length) // self._step
        if count > 0:
            starts = self._step * np.arange(1, count + 1)
            frames = sound[starts[:, None] + np.arange(self._analysis.length)]
            for target in self._analysis.shapes(frames)[0]:
                self._weights = _ease(self._weights, target)
            sound = sound[self._step * count :]
        self._waiting = sound
        return MouthWeights(*(self._weights / max(1.0, self._weights.sum())).tolist())


def phones_from_sound(samples: Samples, rate: int) -> tuple[Phone, ...]:
    """Return phones that move the mouth as the sound does: `PHONES` and pauses.

    They are no transcription: vowels have the nearest of three shapes, most consonants are "m".
    """
    analysis = _MouthAnalysis(rate)
    times = np.arange(STEP_S / 2, len(samples) / rate, STEP_S)
    shapes = np.full(len(times), len(PHONES))
    for own, frames in frame_blocks(samples, rate, times, analysis.length):
        weights, silent = analysis.shapes(frames)
        closed = 1.0 - weights.sum(1, keepdims=True)
        nearest = np.hstack([weights, closed]).argmax(1)
        shapes[own] = np.where(silent, len(PHONES), nearest)
    return fill_pauses(list(_phones(shapes)), len(samples) / rate)


class _MouthAnalysis:
    """Guesses the shape of the mouth from frames, one after the other."""

    def __init__(self, rate: int) -> None:
        self.length = round(WINDOW_S * rate)
        self._window = np.hanning(self.length + 2)[1:-1].astype(np.float32)
        self._scale = 2.0 / float((self._window**2).sum()) / self.length
        frequency = np.fft.rfftfreq(self.length, 1 / rate)
        hiss = min(HISS_HZ, 0.3 * rate)
        edges = [*itertools.pairwise(BANDS_HZ), (hiss, min(7800.0, rate / 2))]
        self._bands = [(frequency >= low) & (frequency < high) for low, high in edges]
        self._loudest = QUIETEST_DB + 25.0

    def shapes(self, frames: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return open, spread, rounded and hiss of each frame, (n, 4), and which are silent."""
        spectrum = np.fft.rfft(frames * self._window)
        power = (spectrum.real**2 + spectrum.imag**2) * self._scale
        energy = np.stack([power[:, band].sum(1) for band in self._bands], 1)
        energy_db = 10 * np.log10(energy.T + 1e-10)
        low, middle, _, high, hiss = energy_db
        level = 10 * np.log10(energy.sum(1) + 1e-10)
        loudest = self._loudest_so_far(level)
        silent = level < np.maximum(loudest - 30.0, QUIETEST_DB)
        voiced = _between(level - loudest, -18.0, -8.0)
        voiced[silent] = 0.0
        hissing = _between(hiss - energy_db[:4].max(0), -4.0, 4.0)
        hissing *= _between(level - loudest, -34.0, -26.0)
        spread = _between(high - middle, -5.0, 3.0)
        wide = _between(middle - low + (high - low) / 2, -22.0, -12.0)
        vowel = voiced * (1.0 - hissing)
        opened = vowel * (1.0 - spread)
        shapes = (opened * wide, vowel * spread, opened * (1.0 - wide), hissing)
        return np.stack(shapes, 1), silent

    def _loudest_so_far(self, level: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the loudest level so far, slowly forgotten."""
        fading = FORGOTTEN_DB_S * STEP_S * np.arange(1, len(level) + 1)
        peaks = np.maximum.accumulate(np.maximum(level + fading, self._loudest))
        loudest = np.maximum(peaks - fading, QUIETEST_DB + 25.0)
        self._loudest = float(loudest[-1]) if len(loudest) else self._loudest
        return np.asarray(loudest)


def _between(values: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    return np.asarray(((values - low) / (high - low)).clip(0.0, 1.0))


def _ease(weights: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return weights one frame later."""
    duration = np.where(target > weights, RISE_S, FALL_S)
    return np.asarray(weights + (target - weights) * (1.0 - np.exp(-STEP_S / duration)))


def _phones(shapes: NDArray[np.int_]) -> Iterator[Phone]:
    """Yield the phones of a shape for each frame; a short one goes on with the one before."""
    steady = shapes.copy()
    shortest = round(MIN_PHONE_S / STEP_S)
    for start, end in _equal_runs(shapes):
        if end - start < shortest and start > 0:
            steady[start:end] = steady[start - 1]
    for start, end in _equal_runs(steady):
        symbol = (*PHONES, SILENCE)[int(steady[start])]
        yield Phone(symbol, start * STEP_S, end * STEP_S)


def _equal_runs(values: NDArray[np.int_]) -> Iterator[tuple[int, int]]:
    """Yield where runs of one value begin and end."""
    cuts = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values)]
    yield from ((a, b) for a, b in itertools.pairwise(cuts) if b > a)
