"""Overlapping frames of a sound, in blocks, so that an hour of it needs little memory."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.speech import Samples

BLOCK_FRAMES = 512
"""Frames of a block."""


def frame_times(count: int, rate: int, step: float) -> NDArray[np.float64]:
    """Return the centres of frames [s] that lie `step` apart and as far from both ends.

    >>> frame_times(1000, 1000, 0.4).round(2).tolist()
    [0.1, 0.5, 0.9]
    """
    duration = count / rate
    intervals = int(duration / step + 1e-9)
    return np.asarray((duration - intervals * step) / 2 + step * np.arange(intervals + 1))


def frame_blocks(
    samples: Samples, rate: int, times: NDArray[np.float64], length: int
) -> Iterator[tuple[slice, NDArray[np.float32]]]:
    """Yield which of the times, and the frames (m, length) around them; zeros beyond the ends."""
    starts = np.floor(times * rate - 0.5).astype(int) - length // 2 + 1
    for first in range(0, len(starts), BLOCK_FRAMES):
        own = starts[first : first + BLOCK_FRAMES]
        begin, end = int(own[0]), int(own[-1]) + length
        part = samples[max(begin, 0) : max(min(end, len(samples)), 0)]
        part = np.pad(part, (max(-begin, 0), max(end - begin - max(-begin, 0) - len(part), 0)))
        yield (
            slice(first, first + len(own)),
            np.asarray(part[(own - begin)[:, None] + np.arange(length)], np.float32),
        )


def runs(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the first index, and the index after the last one, of each run of True, (n, 2).

    >>> runs(np.array([True, False, True, True])).tolist()
    [[0, 1], [2, 4]]
    """
    changes = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return np.asarray(changes.reshape(-1, 2), np.int64)
