"""What sounds are made of: curves over time, voices, struck bodies and noise.

All sounds are arrays of float64 samples, (n,), at `SAMPLE_RATE`. Voices are a source and a filter
(Fant, *Acoustic Theory of Speech Production*, 1960): the harmonics of a pitch, weighted by the
resonances of a mouth. Struck bodies are sums of decaying sines (modal synthesis).
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion import smoothstep

SAMPLE_RATE = 48_000
"""Samples a second [Hz], of all sounds and of the output."""

Array = NDArray[np.float64]

Curve = Sequence[tuple[float, float]]
"""Breakpoints (time [s], value) in order; before the first and after the last it is constant."""

Formant = tuple[Curve, float, float]
"""A resonance of the mouth: frequency [Hz] over time, half its bandwidth [Hz], and amplitude."""

MAX_HARMONIC_HZ = 8_000.0
"""Harmonics above this are left out: a mouth lets little of them through."""

LOUDNESS_WINDOW_S = 0.05
"""The loudness of a sound is the RMS of its loudest part of this length."""

MAX_AMPLITUDE = 0.9
"""No sample of a sound is greater."""


def times(duration: float) -> Array:
    """Return the times of the samples of a duration [s]."""
    return np.arange(round(duration * SAMPLE_RATE)) / SAMPLE_RATE


def curve(points: Curve, time: Array) -> Array:
    """Return a smooth curve through breakpoints, without overshoot.

    >>> curve([(0.0, 1.0), (1.0, 3.0)], np.array([-1.0, 0.0, 0.5, 1.0])).tolist()
    [1.0, 1.0, 2.0, 3.0]
    """
    at, values = (np.array(column, float) for column in zip(*points, strict=True))
    place = np.interp(time, at, np.arange(len(at)))
    first = np.minimum(place.astype(int), max(len(at) - 2, 0))
    part = place - first
    after = np.minimum(first + 1, len(at) - 1)
    return np.asarray(values[first] + (values[after] - values[first]) * smoothstep(part))


def glide(points: Curve, time: Array) -> Array:
    """Return a pitch [Hz] that glides through breakpoints (time [s], Hz), evenly in octaves."""
    return np.exp2(curve([(at, math.log2(pitch)) for at, pitch in points], time))


def phase(pitch: Array) -> Array:
    """Return the phase of a pitch [Hz] over time [rad]."""
    cycles: Array = np.cumsum(pitch) / SAMPLE_RATE
    return 2.0 * np.pi * cycles


def voice(pitch: Array, formants: Sequence[Formant], brightness: float = 1.2) -> Array:
    """Return a voice: the harmonics of a pitch [Hz] over time, through a mouth.

    Harmonic k has the amplitude k to the power of −`brightness`, and that of the mouth at its
    frequency: a sum of resonances.
    """
    time, angle = np.arange(len(pitch)) / SAMPLE_RATE, phase(pitch)
    mouth = [(curve(points, time), width, gain) for points, width, gain in formants]
    sound, twice_cosine = np.zeros(len(pitch)), 2.0 * np.cos(angle)
    sine_before, sine = np.zeros(len(pitch)), np.sin(angle)
    for k in range(1, int(MAX_HARMONIC_HZ / float(pitch.max())) + 1):
        gain = sum(amount / (1.0 + ((k * pitch - at) / width) ** 2) for at, width, amount in mouth)
        sound += k**-brightness * gain * sine
        sine_before, sine = sine, twice_cosine * sine - sine_before  # of the next harmonic
    return sound


def hit(time: Array, decay: float, start: float = 0.0) -> Array:
    """Return the envelope of something that is hit at `start`: onset in 3 ms, then a decay [s]."""
    since = np.maximum(time - start, 0.0)
    return np.asarray((1.0 - np.exp(-since / 0.001)) * np.exp(-since / decay))


def strike(time: Array, modes: Sequence[tuple[float, float, float]], start: float = 0.0) -> Array:
    """Return a struck body: modes of a frequency [Hz], a decay time constant [s], an amplitude."""
    since = np.maximum(time - start, 0.0)
    return np.asarray(
        sum(
            amount * np.sin(2.0 * np.pi * frequency * since) * hit(time, decay, start)
            for frequency, decay, amount in modes
        )
    )


def noise(random: np.random.Generator, count: int, center: float, octaves: float) -> Array:
    """Return noise around a frequency [Hz], with the RMS 1.

    The spectrum falls off like a bell over `octaves` to both sides.
    """
    frequencies = np.fft.rfftfreq(count, 1.0 / SAMPLE_RATE)
    distance = np.log2(np.maximum(frequencies, 1.0) / center) / octaves
    spectrum = np.fft.rfft(random.standard_normal(count)) * np.exp(-0.5 * distance**2)
    sound = np.fft.irfft(spectrum, count)
    return np.asarray(sound / max(float(np.sqrt(np.mean(sound**2))), 1e-12))


def wobble(random: np.random.Generator, count: int, rate: float) -> Array:
    """Return a random curve of the RMS 1 that changes about `rate` times a second."""
    knots = random.standard_normal(max(2, math.ceil(count / SAMPLE_RATE * rate) + 2))
    at = np.arange(len(knots)) / rate
    smooth = curve(
        list(zip(at.tolist(), knots.tolist(), strict=True)), np.arange(count) / SAMPLE_RATE
    )
    return np.asarray(smooth / max(float(np.sqrt(np.mean(smooth**2))), 1e-12))


def loudness(sound: Array) -> float:
    """Return the RMS of the loudest part of a sound [dB of full scale].

    >>> round(loudness(np.sin(2 * np.pi * 1000 * times(1.0))), 1)
    -3.0
    """
    window = round(LOUDNESS_WINDOW_S * SAMPLE_RATE)
    energy = np.concatenate([[0.0], np.cumsum(sound**2)])
    count = min(window, len(sound))
    loudest = float((energy[count:] - energy[:-count]).max()) / window
    return 10.0 * math.log10(max(loudest, 1e-12))


def with_level(sound: Array, level: float) -> Array:
    """Return a sound of a loudness [dB of full scale], without offset, and with soft ends."""
    sound = sound - sound.mean()
    ends = np.minimum(np.arange(len(sound)), np.arange(len(sound))[::-1])
    sound = sound * np.minimum(ends / (0.002 * SAMPLE_RATE), 1.0)
    sound = sound * 10.0 ** ((level - loudness(sound)) / 20.0)
    return sound * min(1.0, MAX_AMPLITUDE / max(float(np.abs(sound).max()), 1e-12))
