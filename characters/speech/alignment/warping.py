"""Dynamic time warping of one sequence of features onto another.

H. Sakoe and S. Chiba (1978), "Dynamic programming algorithm optimization for spoken word
recognition", IEEE Transactions on Acoustics, Speech, and Signal Processing 26(1), 43-49; for long
sequences within a band around the path of a coarse one, as in S. Salvador and P. Chan (2007),
"FastDTW", Intelligent Data Analysis 11(5), 561-580.
"""

import numpy as np
from numpy.typing import NDArray

STEP_COST = 0.2
"""Cost of standing still in the template, or of skipping one row of it, in deviations."""

MAX_CELLS = 40_000_000
"""Largest product of two lengths that are warped as a whole; it takes so many bytes."""

COARSE_ROWS = 16
"""Rows that are averaged for the coarse path."""

BAND = 400
"""Half of the width of the band around the coarse path, in rows: 2 s."""


def warp(features: NDArray[np.float32], template: NDArray[np.float32]) -> NDArray[np.intp]:
    """Return for each row of the features the row of the template that suits it, never falling.

    From row to row the template advances by 0, 1 or 2 rows. Both are (n, d), and of similar length.
    """
    if len(features) * len(template) <= MAX_CELLS:
        return _path(features, template, np.zeros(len(features), int), len(template))
    coarse = warp(_average(features), _average(template))
    centre = COARSE_ROWS * np.interp(
        np.arange(len(features)), COARSE_ROWS * (np.arange(len(coarse)) + 0.5), coarse + 0.5
    )
    width = min(2 * BAND, len(template))
    lows = np.clip(centre.astype(int) - width // 2, 0, len(template) - width)
    lows[0], lows[-1] = 0, len(template) - width
    return _path(features, template, np.maximum.accumulate(lows), width)


def _average(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    count = -(-len(rows) // COARSE_ROWS)
    padded = np.pad(rows, ((0, count * COARSE_ROWS - len(rows)), (0, 0)), "edge")
    return np.asarray(padded.reshape(count, COARSE_ROWS, -1).mean(1), np.float32)


def _path(
    features: NDArray[np.float32], template: NDArray[np.float32], lows: NDArray[np.int_], width: int
) -> NDArray[np.intp]:
    """Return the cheapest path; row n may meet the `width` rows of the template from lows[n] on."""
    squares = (template * template).sum(1)
    dimensions = features.shape[1]
    back = np.zeros((len(features), width), np.int8)
    total = np.full(width + 2, np.inf, np.float32)  # two impossible cells before the first
    ways = np.empty((3, width), np.float32)
    for index, row in enumerate(features):
        low = int(lows[index])
        own = slice(low, low + width)
        square = squares[own] - 2 * (template[own] @ row) + row @ row
        cost = np.sqrt(np.maximum(square, 0.0) / dimensions)
        if index == 0:
            total[2 : 2 + min(2, width)] = cost[:2]
            continue
        shifted = _shift(total, low - int(lows[index - 1]))
        ways[0] = shifted[2:] + STEP_COST
        ways[1] = shifted[1:-1]
        ways[2] = shifted[:-2] + STEP_COST
        best = ways.argmin(0)
        back[index] = best
        total[2:] = ways[best, np.arange(width)] + cost
        total[:2] = np.inf
    return _trace(back, lows, total[2:])


def _shift(total: NDArray[np.float32], by: int) -> NDArray[np.float32]:
    """Return costs by the rows of a band that lies so much further on."""
    if by == 0:
        return total
    moved = np.full_like(total, np.inf)
    kept = max(len(total) - by, 0)
    moved[:kept] = total[len(total) - kept :]
    return moved


def _trace(
    back: NDArray[np.int8], lows: NDArray[np.int_], total: NDArray[np.float32]
) -> NDArray[np.intp]:
    """Return the path that ends in the last row, or the nearest one that can be reached."""
    reached = np.flatnonzero(np.isfinite(total))
    at = int(lows[-1]) + int(reached[-1] if len(reached) else len(total) - 1)
    path = np.zeros(len(back), np.intp)
    for index in range(len(back) - 1, -1, -1):
        path[index] = at
        at -= int(back[index, min(max(at - int(lows[index]), 0), back.shape[1] - 1)])
    return path
