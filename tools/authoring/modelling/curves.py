"""Looping animation curves: key poses, and springs that follow them.

All curves are sampled at ``frames`` even steps of a phase in 0…1.
"""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters import smoothing

Array = NDArray[np.float64]


def smoothstep(u: Array | float) -> Array:
    """Return the smooth step from 0 to 1 of u, which is limited to that."""
    limited: Array = np.clip(np.asarray(u, float), 0.0, 1.0)
    return smoothing.smoothstep(limited)


def soft_limited(values: Array, limit: float) -> Array:
    """Return values that approach ±limit instead of exceeding it."""
    return np.asarray(limit * np.tanh(values / limit))


def loop_phases(frames: int) -> Array:
    """Return the phase of each frame, (frames,), 0 ≤ phase < 1."""
    return np.arange(frames) / frames


def keys(frames: int, *poses: tuple[float, float]) -> Array:
    """Return a smooth periodic curve through keys (phase, value), (frames,).

    It is monotone between keys and flat at every extremum: slow in, slow out, and no overshoot
    without a key (Fritsch and Carlson 1980, harmonic slopes).

    >>> keys(4, (0.0, 0.0), (0.5, 1.0)).round(3).tolist()
    [0.0, 0.5, 1.0, 0.5]
    """
    times, values = np.array(poses, float).T
    if len(times) == 1:
        return np.full(frames, values[0])
    times = np.concatenate([times[-2:] - 1, times, times[:2] + 1])
    values = np.concatenate([values[-2:], values, values[:2]])
    gap, rise = np.diff(times), np.diff(values) / np.diff(times)
    before, after = 2 * gap[1:] + gap[:-1], gap[1:] + 2 * gap[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        harmonic = (before + after) / (before / rise[:-1] + after / rise[1:])
    slope = np.concatenate([[0.0], np.where(rise[:-1] * rise[1:] > 0, harmonic, 0.0), [0.0]])
    phase = loop_phases(frames)
    i = np.searchsorted(times, phase, side="right") - 1
    h = gap[i]
    u = (phase - times[i]) / h
    ease = smoothing.smoothstep(u)
    curve: Array = (
        values[i] * (1 - ease)
        + values[i + 1] * ease
        + h * slope[i] * u * (1 - u) ** 2
        - h * slope[i + 1] * u * u * (1 - u)
    )
    return curve


def wave(frames: int, cycles: int, at: float = 0.0) -> Array:
    """Return a sine of `cycles` per loop that crosses zero upward at phase `at`, (frames,)."""
    return np.asarray(np.sin(2 * np.pi * cycles * (loop_phases(frames) - at)))


def spring_follow(curve: Array, seconds: float, hertz: float, damping: float = 0.5) -> Array:
    """Return how a damped spring follows a curve: delayed and with overshoot.

    It is the steady response to the repeating curve, in closed form over its Fourier series, so
    the result loops exactly.

    Parameters
    ----------
    curve : (frames, …)
    seconds : duration of the loop
    hertz : natural frequency of the spring [Hz]; lower means more delay
    damping : 1 for no overshoot
    """
    spectrum = np.fft.rfft(curve, axis=0)
    ratio = np.fft.rfftfreq(len(curve), seconds / len(curve)) / hertz
    response = 1 / (1 - ratio**2 + 2j * damping * ratio)
    shape = (-1,) + (1,) * (curve.ndim - 1)
    return np.asarray(np.fft.irfft(spectrum * response.reshape(shape), len(curve), axis=0))


def delayed(curve: Array, phase: float) -> Array:
    """Return the curve delayed by a phase, (frames, …)."""
    frames = len(curve)
    at = loop_phases(frames) - phase
    low = np.floor(at * frames).astype(int)
    u = (at * frames - low).reshape((-1,) + (1,) * (curve.ndim - 1))
    return np.asarray(curve[low % frames] * (1 - u) + curve[(low + 1) % frames] * u)
