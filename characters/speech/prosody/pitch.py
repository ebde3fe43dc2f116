"""The pitch of a voice: autocorrelation with a path search.

P. Boersma (1993), "Accurate short-term analysis of the fundamental frequency and the
harmonics-to-noise ratio of a sampled sound", IFA Proceedings 17, 97-110. The path costs are those
of its section 4; the silence threshold is that of Praat's manual.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.frames import frame_blocks, frame_times
from cubeling.characters.speech.speech import Samples

MAX_CANDIDATES = 15
"""Candidates of a frame, "unvoiced" among them."""

WINDOW_PERIODS = 3.0
"""Length of a frame in periods of the lowest pitch (Boersma 1993, section 3.1)."""

MIN_LAG_RATE = 48_000
"""The autocorrelation is interpolated to at least this rate [Hz]; its peaks are sharp."""

PATH_BLOCK = 4096
"""Frames whose transition costs are computed together."""


@dataclass(frozen=True)
class PitchSettings:
    """How pitch is tracked; the defaults are Praat's, with a ceiling of 500 Hz."""

    floor: float = 75.0
    """Lowest pitch [Hz]."""

    ceiling: float = 500.0
    """Highest pitch [Hz]."""

    step: float = 0.01
    """Time from frame to frame [s]."""

    silence_threshold: float = 0.03
    """Frames with less of the sound's peak tend to be unvoiced."""

    voicing_threshold: float = 0.45
    """Frames whose normalised autocorrelation stays below are unvoiced."""

    octave_cost: float = 0.01
    """How much higher candidates are preferred, per octave."""

    octave_jump_cost: float = 0.35
    """Cost of a change of pitch, per octave and 10 ms."""

    voicing_cost: float = 0.14
    """Cost of a change between voiced and unvoiced."""


@dataclass(frozen=True, eq=False)
class PitchTrack:
    """The pitch of a sound over time."""

    times: NDArray[np.float64]
    """Centres of the frames, (n,) [s]."""

    f0: NDArray[np.float64]
    """Fundamental frequency, (n,) [Hz]; 0 where the sound is not voiced."""

    strength: NDArray[np.float64]
    """Normalised autocorrelation at the period, (n,), 0…1; 0 where the sound is not voiced."""


def track_pitch(samples: Samples, rate: int, settings: PitchSettings | None = None) -> PitchTrack:
    """Return the pitch of a sound at any sample rate of at least twice the ceiling."""
    settings = settings or PitchSettings()
    times = frame_times(len(samples), rate, settings.step)
    f0 = np.zeros((len(times), MAX_CANDIDATES))
    strength = np.zeros_like(f0)
    analysis = _Autocorrelation(rate, settings)
    mean = float(samples.mean(dtype=np.float64)) if len(samples) else 0.0
    peak = max(float(samples.max()) - mean, mean - float(samples.min())) if len(samples) else 0.0
    for own, frames in frame_blocks(samples, rate, times, analysis.length):
        f0[own], strength[own] = analysis.candidates(frames, peak)
    chosen = _best_path(f0, strength, settings)[:, None]
    f0 = np.take_along_axis(f0, chosen, 1)[:, 0]
    strength = np.take_along_axis(strength, chosen, 1)[:, 0]
    return PitchTrack(times, f0, np.where(f0 > 0, np.clip(strength, 0.0, 1.0), 0.0))


class _Autocorrelation:
    """Finds the pitch candidates of frames at one sample rate."""

    def __init__(self, rate: int, settings: PitchSettings) -> None:
        self._settings = settings
        half = int(WINDOW_PERIODS / settings.floor * rate) // 2 - 1
        self.length = 2 * half
        self._period = int(rate / settings.floor)
        self._fft = 1 << int(np.ceil(np.log2(1.5 * self.length)))
        self._finer = 1 << max(0, int(np.ceil(np.log2(MIN_LAG_RATE / rate))))
        self._lag_rate = rate * self._finer
        position = np.arange(1, self.length + 1) / (self.length + 1)
        self._window = (0.5 - 0.5 * np.cos(2 * np.pi * position)).astype(np.float32)
        self._lags = (int(self.length / WINDOW_PERIODS) + 2) * self._finer
        self._of_window = self._correlate(self._window[None])[0]

    def candidates(
        self, frames: NDArray[np.float32], peak: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return pitches [Hz] and strengths, (n, MAX_CANDIDATES); the first is "unvoiced"."""
        settings, half = self._settings, self.length // 2
        middle = slice(max(half - self._period, 0), half + self._period)
        frames = (frames - frames[:, middle].mean(1, keepdims=True)) * self._window
        f0 = np.zeros((len(frames), MAX_CANDIDATES))
        strength = np.full_like(f0, -np.inf)
        middle = slice(half - self._period // 2 - 1, half + self._period // 2 + 1)
        loudness = np.abs(frames[:, middle]).max(1) / max(peak, 1e-9)
        quiet = loudness * (1 + settings.voicing_threshold) / settings.silence_threshold
        strength[:, 0] = settings.voicing_threshold + np.maximum(0.0, 2.0 - quiet)
        row, pitch, height = self._peaks(self._correlate(frames) / self._of_window)
        score = height - settings.octave_cost * np.log2(settings.floor / pitch)
        order = np.lexsort((-score, row))
        row, pitch, height = row[order], pitch[order], height[order]
        rank = 1 + np.arange(len(row)) - np.searchsorted(row, row)
        kept = rank < MAX_CANDIDATES
        f0[row[kept], rank[kept]] = pitch[kept]
        strength[row[kept], rank[kept]] = height[kept]
        return f0, strength

    def _correlate(self, frames: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the normalised autocorrelation at lags of 1 ÷ `_lag_rate`."""
        spectrum = np.fft.rfft(frames, self._fft)
        power = spectrum.real**2 + spectrum.imag**2
        correlation = np.fft.irfft(power, self._fft * self._finer)[:, : self._lags]
        return np.asarray(correlation / np.maximum(correlation[:, :1], 1e-12), np.float32)

    def _peaks(
        self, correlation: NDArray[np.float32]
    ) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
        """Return the frame, the pitch [Hz] and the height of each peak, by parabolas."""
        shortest = max(2, int(self._lag_rate / self._settings.ceiling))
        before, at, after = (
            correlation[:, shortest + shift : self._lags - 1 + shift] for shift in (-1, 0, 1)
        )
        least = 0.5 * self._settings.voicing_threshold
        row, column = np.nonzero((at > least) & (at > before) & (at >= after))
        left, top, right = (side[row, column].astype(float) for side in (before, at, after))
        slope, bend = (right - left) / 2, 2 * top - left - right
        pitch = self._lag_rate / (shortest + column + slope / bend)
        height = top + slope**2 / (2 * bend)
        return row, pitch, np.where(height > 1, 1 / height, height)


def _best_path(
    f0: NDArray[np.float64], strength: NDArray[np.float64], settings: PitchSettings
) -> NDArray[np.intp]:
    """Return the candidate of each frame on the best path (Viterbi; Boersma 1993, section 4)."""
    voiced = (f0 > 0) & (f0 <= settings.ceiling)
    octaves = np.log2(np.where(voiced, f0, 1.0))
    own = strength - np.where(
        voiced, settings.octave_cost * (np.log2(settings.ceiling) - octaves), 0.0
    )
    per_step = 0.01 / settings.step
    back = np.zeros(f0.shape, np.int8)
    total = own[0]
    for first in range(1, len(own), PATH_BLOCK):
        block = slice(first, first + PATH_BLOCK)
        earlier = slice(first - 1, min(first + PATH_BLOCK, len(own)) - 1)
        jump = np.abs(octaves[block, :, None] - octaves[earlier, None, :])
        was, becomes = voiced[earlier, None, :], voiced[block, :, None]
        cost = np.where(was & becomes, settings.octave_jump_cost * jump, 0.0)
        cost = per_step * (cost + settings.voicing_cost * (was != becomes))
        for index, step_cost in enumerate(cost, first):
            ways = total - step_cost
            best = ways.argmax(1)
            back[index] = best
            total = own[index] + ways[_ROWS, best]
    path = np.zeros(len(own), np.intp)
    path[-1] = total.argmax()
    for index in range(len(own) - 1, 0, -1):
        path[index - 1] = back[index, path[index]]
    return path


_ROWS = np.arange(MAX_CANDIDATES)
