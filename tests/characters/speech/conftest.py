"""Sounds with known truth: buzzing syllables, and what eSpeak NG says."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pytest

from cubeling.characters.speech.speech import Samples
from cubeling.characters.speech.voices import Voice, espeak
from cubeling.characters.speech.voices.espeak import espeak_installed


@pytest.fixture(scope="session")
def spoken_voice() -> Iterator[Voice]:
    if not espeak_installed():
        pytest.skip("eSpeak NG is not installed")
    with espeak() as voice:
        yield voice


@pytest.fixture(scope="session")
def buzz() -> Callable[..., Samples]:
    """Make syllables of harmonics with Gaussian peaks of pitch and level."""

    def make(
        duration: float,
        peaks: Sequence[tuple[float, float, float]],
        pitch: float = 120.0,
        rate: int = 16_000,
    ) -> Samples:
        """Each peak has a time [s], a level [dB] and a pitch above the base [semitones]."""
        t = np.arange(round(duration * rate)) / rate
        semitones, amplitude = np.zeros(len(t)), np.zeros(len(t))
        for time, level, raised in peaks:
            semitones += raised * np.exp(-(((t - time) / 0.06) ** 2) / 2)
            peak = 10 ** (level / 20) * np.exp(-(((t - time) / 0.05) ** 2) / 2)
            amplitude = np.maximum(amplitude, peak)
        phase = 2 * np.pi * np.cumsum(pitch * 2 ** (semitones / 12)) / rate
        tone = sum(np.sin(k * phase) / k for k in range(1, 12))
        return (0.3 * tone * amplitude).astype(np.float32)

    return make
