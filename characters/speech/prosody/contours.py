"""The contours of a speech: pitch, intensity, voiced regions and pauses."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.frames import frame_blocks, runs
from cubeling.characters.speech.prosody.pitch import PitchSettings, track_pitch
from cubeling.characters.speech.speech import Samples

INTENSITY_WINDOW_S = 0.04
"""Length of the window of the intensity [s]: three periods of the lowest voice."""

QUIETEST_DB = -100.0
"""Intensity of digital silence [dB]."""

PAUSE_BELOW_DB = 25.0
"""A pause is so much quieter than the loud parts [dB], as in Praat's detector of silences."""


@dataclass(frozen=True)
class ProsodySettings:
    """How prosody is measured."""

    pitch: PitchSettings = field(default_factory=PitchSettings)
    """How pitch is tracked."""

    min_pause: float = 0.25
    """Shortest pause [s]."""

    min_voiced: float = 0.04
    """Shortest voiced region [s]."""


@dataclass(frozen=True, eq=False)
class Prosody:
    """How a speech sounds over time, at equally spaced times."""

    times: NDArray[np.float64]
    """Centres of the frames, (n,) [s]."""

    f0: NDArray[np.float64]
    """Fundamental frequency, (n,) [Hz]; 0 where the sound is not voiced."""

    intensity: NDArray[np.float64]
    """Mean power, (n,) [dB relative to a constant sample of 1]."""

    voiced: NDArray[np.float64]
    """Start and end of each voiced region, (k, 2) [s]."""

    pauses: NDArray[np.float64]
    """Start and end of each pause, (k, 2) [s]; silence at both ends of the speech among them."""

    duration: float
    """Length of the sound [s]."""

    @property
    def step(self) -> float:
        """Time from frame to frame [s]."""
        return float(self.times[1] - self.times[0]) if len(self.times) > 1 else self.duration


def measure_prosody(
    samples: Samples, rate: int, settings: ProsodySettings | None = None
) -> Prosody:
    """Return the prosody of a sound."""
    settings = settings or ProsodySettings()
    track = track_pitch(samples, rate, settings.pitch)
    intensity = _intensity(samples, rate, track.times)
    voiced, quiet = track.f0 > 0, _quiet(intensity)
    step, duration = settings.pitch.step, len(samples) / rate
    edges = np.append(track.times - step / 2, track.times[-1] + step / 2).clip(0.0, duration)
    return Prosody(
        track.times,
        track.f0,
        intensity,
        _regions(voiced, edges, settings.min_voiced),
        _regions(quiet & ~voiced, edges, settings.min_pause),
        duration,
    )


def _intensity(samples: Samples, rate: int, times: NDArray[np.float64]) -> NDArray[np.float64]:
    window = np.hanning(max(int(INTENSITY_WINDOW_S * rate), 1) + 2)[1:-1].astype(np.float32)
    window /= window.sum()
    power = np.zeros(len(times))
    for own, frames in frame_blocks(samples, rate, times, len(window)):
        power[own] = (frames * frames) @ window
    return np.asarray(10 * np.log10(np.maximum(power, 10 ** (QUIETEST_DB / 10))))


def _quiet(intensity: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return where a sound is quiet beside its loud parts; digital silence is so throughout."""
    loud = float(np.quantile(intensity, 0.95))
    return np.asarray(intensity < max(loud - PAUSE_BELOW_DB, QUIETEST_DB + PAUSE_BELOW_DB))


def _regions(
    mask: NDArray[np.bool_], edges: NDArray[np.float64], shortest: float
) -> NDArray[np.float64]:
    found = edges[runs(mask)].reshape(-1, 2)
    return np.asarray(found[found[:, 1] - found[:, 0] >= shortest - 1e-9])
