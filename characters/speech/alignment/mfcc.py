"""Mel-frequency cepstra: the shape of the spectrum, without the voice's pitch.

S. Davis and P. Mermelstein (1980), "Comparison of parametric representations for monosyllabic word
recognition in continuously spoken sentences", IEEE Transactions on Acoustics, Speech, and Signal
Processing 28(4), 357-366.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.audio import resample
from cubeling.characters.speech.frames import frame_blocks
from cubeling.characters.speech.speech import Samples

RATE = 16_000
"""Sample rate of the analysis [Hz]."""

HOP_S = 0.005
"""Time from frame to frame [s]; frame n is centred at (n + ½)·`HOP_S`."""

WINDOW_S = 0.02
"""Length of a frame [s]."""

FFT = 512
"""Length of the Fourier transform."""

BANDS, LOWEST_HZ, HIGHEST_HZ = 26, 80.0, 7600.0
"""Number of bands, and what they cover [Hz]."""

COEFFICIENTS = 13
"""Cepstral coefficients, the mean level among them."""

DELTA_FRAMES = 3
"""Frames before and after over which the slope is measured."""

NOISE = 1e-4
"""Standard deviation of noise that is added, so that digital silence is like any silence."""


@dataclass(frozen=True, eq=False)
class Cepstra:
    """The spectrum of a sound over time."""

    features: NDArray[np.float32]
    """Cepstral coefficients and their slopes, (n, 26), each with mean 0 and deviation 1 in what is
    loud."""

    level: NDArray[np.float64]
    """Mean level of the bands, (n,) [dB]; hisses count as much as vowels."""


def cepstra(samples: Samples, rate: int) -> Cepstra:
    """Return the spectrum of a sound every `HOP_S`."""
    bands = _log_bands(resample(samples, rate, RATE))
    level = bands.mean(1) * 10 / np.log(10)
    loud = level > np.quantile(level, 0.95) - 20.0
    order = np.arange(COEFFICIENTS)
    cosines = np.cos(np.pi / BANDS * (np.arange(BANDS)[:, None] + 0.5) * order)
    values = bands @ cosines
    values = _normalise(values, loud)
    return Cepstra(np.hstack([values, _normalise(_slope(values), loud)]).astype(np.float32), level)


def mel_filters(rate: int = RATE, length: int = FFT) -> NDArray[np.float32]:
    """Return the weights of the frequencies of a spectrum in each band, (bands, length ÷ 2 + 1)."""
    low, high = 2595 * np.log10(1 + np.array([LOWEST_HZ, HIGHEST_HZ]) / 700)
    corners = 700 * (10 ** (np.linspace(low, high, BANDS + 2) / 2595) - 1)
    start, middle, end = (corners[n : n + BANDS, None] for n in range(3))
    frequency = np.arange(length // 2 + 1) * rate / length
    rising, falling = (frequency - start) / (middle - start), (end - frequency) / (end - middle)
    return np.minimum(rising, falling).clip(0.0).astype(np.float32)


def _log_bands(samples: Samples) -> NDArray[np.float64]:
    """Return the logarithm of the energy in each band, (n, BANDS)."""
    scale = 0.1 / max(float(np.sqrt(np.mean(samples * samples))), 1e-9) if len(samples) else 1.0
    noise = np.random.default_rng(0).normal(0.0, NOISE, len(samples)).astype(np.float32)
    sound = samples * np.float32(scale) + noise
    sound[1:] -= np.float32(0.95) * sound[:-1]
    times = np.arange(HOP_S / 2, len(samples) / RATE, HOP_S)
    window = np.hanning(round(WINDOW_S * RATE)).astype(np.float32)
    filters = mel_filters()
    energy = np.zeros((len(times), BANDS), np.float32)
    for own, frames in frame_blocks(sound, RATE, times, len(window)):
        spectrum = np.fft.rfft(frames * window, FFT)
        energy[own] = (spectrum.real**2 + spectrum.imag**2) @ filters.T
    return np.log(energy.astype(float) + 1e-6)


def _slope(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slope of the regression line over `DELTA_FRAMES` on both sides."""
    n = DELTA_FRAMES
    padded = np.pad(values, ((n, n), (0, 0)), "edge")
    shifts = np.arange(-n, n + 1)
    moved = [k * padded[n + k : n + k + len(values)] for k in shifts.tolist()]
    return np.asarray(np.sum(moved, 0) / (shifts**2).sum())


def _normalise(values: NDArray[np.float64], loud: NDArray[np.bool_]) -> NDArray[np.float64]:
    spoken = values[loud] if loud.any() else values
    return np.asarray((values - spoken.mean(0)) / (spoken.std(0) + 1e-3))
