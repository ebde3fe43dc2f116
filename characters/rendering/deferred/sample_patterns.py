"""Patterns in which sampling changes from pixel to pixel of a tile (Huang 2013, ch. 3.4)."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array

PATTERN_SEED = 3
"""Of the patterns with random numbers: the same picture each time."""


def radical_inverse(count: int, base: int) -> Array:
    """Return the radical inverses of 0…count − 1 (Halton 1964), (count,).

    Examples
    --------
    >>> radical_inverse(4, 2).tolist()
    [0.0, 0.5, 0.25, 0.75]
    """
    index, value, digit = np.arange(count), np.zeros(count), 1.0 / base
    while index.any():
        value += digit * (index % base)
        index //= base
        digit /= base
    return value


def _random(count: int) -> Array:
    return np.random.default_rng(PATTERN_SEED).random((count, 2))


def _regular(count: int) -> Array:
    return np.stack([(np.arange(count) + 0.5) / count, np.full(count, 0.5)], axis=1)


def _jitter(count: int) -> Array:
    shifts = _random(count)
    shifts[:, 0] = (np.arange(count) + shifts[:, 0]) / count
    return shifts


def _halton(count: int) -> Array:
    return np.stack([radical_inverse(count, 2), radical_inverse(count, 3)], axis=1)


def _hammersley(count: int) -> Array:
    return np.stack([radical_inverse(count, 2), (np.arange(count) + 0.5) / count], axis=1)


PATTERNS: dict[str, Callable[[int], Array]] = {
    "random": _random,
    "regular": _regular,
    "jittered": _jitter,
    "halton": _halton,
    "hammersley": _hammersley,
}
"""By name: count → (count, 2), 0…1: how far the lines turn on their way to the next line, and how
far the samples shift on their way to the next sample.

A turn by 1 brings two orthogonal lines onto each other again. With angles over the full circle, as
the thesis has them, the 16 pixels of a 4×4 tile would have only four different pairs of lines."""


def sample_pattern(name: str, side: int) -> NDArray[np.float32]:
    """Return a pattern of `PATTERNS` for a square tile, (side, side, 2)."""
    return PATTERNS[name](side * side).reshape(side, side, 2).astype(np.float32)
