"""Markers whose cells are smeared by motion or defocus, told by their likeness to such patterns."""

from functools import cache
from itertools import product

import cv2
import numpy as np

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.quads import Quads, sample_grey
from cubeling.tracking.geometry.arrays import Array, Flags, Floats, Image, Indices

SMEARS_CELLS, DIRECTIONS = (1.0, 1.75, 2.5), 8
"""Lengths of the blur that are compared beside none, and directions, evenly spread over half a
turn."""

SAMPLES_PER_CELL, TEXELS_PER_SAMPLE = 2, 4
"""Samples along a cell of a quad, and texels along a sample when the patterns are smeared."""

PAPER_CELLS = 0.5
"""How far around a marker its white paper is compared."""

MIN_CORRELATION, MIN_LEAD = 0.8, 0.06
"""Correlation of a quad with its most similar pattern, and its lead over the next marker."""

MIN_INNER_CORRELATION = 0.7
"""Correlation of the cells inside the border, which tell markers apart: of 34 markers in blurred
photographs and drawings the least is 0.74, of 8 that are other things five are below 0.7."""

MIN_VISIBLE_SHARE = 0.6
"""Share of a quad's outline that must be seen."""


class SmearedPatterns:
    """The patterns of all markers of one cube, smeared in every direction.

    What they find is a proposal for the alignment of the blurred image, which proves or refuses it.
    """

    def __init__(self, cube: CubeModel) -> None:
        ids = tuple(face.marker_id for face in cube.faces)
        cells = len(marker_cells(cube.dictionary, ids[0]))
        span = cells + 2 * PAPER_CELLS
        count = round(span * SAMPLES_PER_CELL)
        steps = ((np.arange(count) + 0.5) / count * span - PAPER_CELLS) / cells
        x, y = np.meshgrid(steps, steps)
        self._places = np.stack([x.ravel(), y.ravel()], axis=1)
        self._inner = (np.abs(self._places - 0.5) < 0.5 - 1 / cells).all(axis=1)
        self._drawn_from = cube.dictionary, ids, count

    def match(self, soft: Image, quads: Quads) -> tuple[Indices, Array]:
        """Find the marker that each quad of an image, (H, W), is most like.

        Return 4 × index of its face + rotation, or −1, and the correlation, (N,) each.
        """
        values = _normalize(sample_grey(soft, quads.map(self._places)))
        patterns = _smeared_patterns(*self._drawn_from)
        by_smear = np.tensordot(values, patterns, axes=([1], [2]))
        alike = by_smear.max(axis=2)
        order = np.argsort(alike, axis=1, kind="stable")
        best, next_best = np.take_along_axis(alike, order[:, :-3:-1], axis=1).T
        good = (best > MIN_CORRELATION) & (best - next_best > MIN_LEAD)
        good &= quads.visible > MIN_VISIBLE_SHARE
        for each in np.flatnonzero(good).tolist():
            smeared = patterns[order[each, -1], by_smear[each, order[each, -1]].argmax()]
            inner = _normalize(np.stack([values[each, self._inner], smeared[self._inner]]))
            good[each] = inner[0] @ inner[1] > MIN_INNER_CORRELATION
        return np.where(good, order[:, -1], -1), np.asarray(best, np.float64)


@cache
def _smeared_patterns(dictionary: str, marker_ids: tuple[int, ...], count: int) -> Floats:
    """Return every marker in four rotations with every blur, (markers · 4, smears, count²).

    They are drawn when a quad is first compared with them, and all trackers of a cube share them.
    """
    cells = [marker_cells(dictionary, number) for number in marker_ids]
    smeared = [_smear(each, count) for each in cells]
    turned = [_turn(each, turn, count) for each in smeared for turn in range(4)]
    patterns = _normalize(np.stack(turned))
    patterns.flags.writeable = False
    return patterns


def _smear(black: Flags, count: int) -> Floats:
    """Draw a marker with every blur, (smears, count²)."""
    ones = np.ones((SAMPLES_PER_CELL,) * 2, np.float32)
    fine = np.asarray(np.kron((~black).astype(np.float32), ones), np.float32)
    margin = round((count - len(fine)) / 2)
    white = np.asarray(np.pad(fine, margin, constant_values=1.0), np.float32)
    angles, cell = np.arange(DIRECTIONS) * np.pi / DIRECTIONS, SAMPLES_PER_CELL * TEXELS_PER_SAMPLE
    blurs = ((0.0, 0.0), *product(SMEARS_CELLS, angles))
    kernels = [_sampled_kernel(length * cell, angle) for length, angle in blurs]
    border = cv2.BORDER_REPLICATE
    drawn = [cv2.filter2D(white, cv2.CV_32F, each, borderType=border).ravel() for each in kernels]
    return np.asarray(drawn, np.float32)


def _turn(smeared: Floats, turn: int, count: int) -> Floats:
    """Turn a marker with every blur by quarters: a quarter turn also turns the blurs."""
    pictures = np.rot90(smeared.reshape(-1, count, count), turn, axes=(1, 2))
    if turn % 2:
        by_length = pictures[1:].reshape(len(SMEARS_CELLS), DIRECTIONS, count, count)
        crosswise = np.roll(by_length, DIRECTIONS // 2, axis=1).reshape(-1, count, count)
        pictures = np.concatenate([pictures[:1], crosswise])
    return np.asarray(pictures.reshape(len(pictures), -1), np.float32)


@cache
def _sampled_kernel(length: float, angle: float) -> Floats:
    """Return the same blur from sample to sample, which shows squares of even texels exactly.

    A sample is the mean of its texels: each texel of the kernel takes as much of a neighbour as
    its square covers, moved by that texel.
    """
    texels = _kernel(length, angle)
    reach = len(texels) // 2
    samples = -(-reach // TEXELS_PER_SAMPLE) + 1
    moved = np.arange(-reach, reach + 1)[:, None]
    apart = np.arange(-samples, samples + 1) * TEXELS_PER_SAMPLE - moved
    covered = np.maximum(1 - np.abs(apart) / TEXELS_PER_SAMPLE, 0.0)
    return np.asarray(covered.T @ texels @ covered, np.float32)


@cache
def _kernel(length: float, angle: float) -> Floats:
    """Smear by a line of a length and direction [texels, rad], softened as the detector's image."""
    reach = int(length / 2) + 3
    kernel = np.zeros((2 * reach + 1, 2 * reach + 1), np.float32)
    along = length * np.array([np.cos(angle), np.sin(angle)])
    steps = np.linspace(-0.5, 0.5, 4 * reach)[:, None] * along
    x, y = np.rint(reach + steps).astype(np.intp).T
    np.add.at(kernel, (y, x), 1)
    soft = np.asarray(cv2.GaussianBlur(kernel, (0, 0), TEXELS_PER_SAMPLE / 2), np.float32)
    return np.asarray(soft / soft.sum(), np.float32)


def _normalize(values: Array) -> Floats:
    """Shift and scale each row to mean 0 and length 1, (…, N)."""
    centred = values - values.mean(axis=-1, keepdims=True)
    length = np.sqrt((centred * centred).sum(axis=-1, keepdims=True))
    return np.asarray(centred / np.maximum(length, 1e-6), np.float32)
