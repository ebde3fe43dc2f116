"""Where two clips are most alike: local minima of their distance matrix."""

from dataclasses import dataclass
from itertools import combinations_with_replacement, pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.distances.distance import Block, FrameDistance, tiles
from cubeling.characters.synthesis.library import Frames, MotionLibrary


@dataclass(frozen=True)
class Candidates:
    """Pairs of frames that look alike; with each pair, the pair turned round."""

    rows: Frames
    """The one frame, (n,)."""

    columns: Frames
    """Frames at which the transitions arrive, (n,)."""

    distances: Array
    """Distance of the two frames of each, (n,)."""

    barred: Array
    """Distances of pairs that would be minima but have different labels, ascending."""

    def __len__(self) -> int:
        return len(self.rows)

    def where(self, keep: NDArray[np.bool_]) -> "Candidates":
        """Return the pairs for which `keep` (n,) is true."""
        return Candidates(self.rows[keep], self.columns[keep], self.distances[keep], self.barred)

    def below(self, threshold: float) -> "Candidates":
        """Return the pairs nearer than a threshold: T(a, b) of eq. 2.3."""
        return self.where(self.distances < threshold)

    def count_barred_below(self, threshold: float) -> int:
        """Return how many pairs nearer than a threshold have different labels."""
        return int(np.searchsorted(self.barred, threshold))


def find_candidates(
    distance: FrameDistance,
    library: MotionLibrary,
    threshold: float,
    labels: NDArray[np.int8] | None = None,
) -> Candidates:
    """Return the local minima below a threshold, over 8 neighbours within a pair of clips.

    Eq. 2.3 and erratum 2: maxima of similarity are minima of the distance. Only frames of one
    label (frames,) are compared: where the best look-alike has another label, the best of the own
    label counts. The minima do not depend on the threshold, so those of a high one serve every
    lower one. A clip is compared with itself too.
    """
    if labels is None:
        labels = np.zeros(len(library), np.int8)
    kept, barred = [], []
    for clip, other in combinations_with_replacement(_clips(library), 2):
        for rows, columns in tiles(clip, other):
            if columns[-1] > rows[0]:  # a clip with itself gives each pair twice
                block = _with_border(distance, library, rows, columns)
                alike = _bordered_labels(library, labels, rows, columns)
                free = _minima(block, threshold)
                block[~alike] = np.inf
                kept.append(_frames(_minima(block, threshold), rows, columns))
                barred.append(_frames(free & ~alike[1:-1, 1:-1], rows, columns))
    rows, columns = np.concatenate(kept, axis=1)
    distances = distance.pairs(rows, columns)  # the same both ways
    both = Candidates(
        np.concatenate([rows, columns]),
        np.concatenate([columns, rows]),
        np.concatenate([distances, distances]),
        np.sort(np.repeat(distance.pairs(*np.concatenate(barred, axis=1)), 2)),
    )
    return both.below(threshold)


def _clips(library: MotionLibrary) -> list[Frames]:
    """Return the frames of each clip."""
    return [np.arange(a, b) for a, b in pairwise(library.starts)]


def _wider(library: MotionLibrary, frames: Frames) -> Frames:
    """Return consecutive frames and their neighbours; −1 beyond the end of a clip."""
    before, after = library.predecessors[frames[0]], library.successors[frames[-1]]
    return np.concatenate([[before], frames, [after]])


def _with_border(
    distance: FrameDistance, library: MotionLibrary, rows: Frames, columns: Frames
) -> Block:
    """Return the distances of frames and their neighbours; beyond a clip nothing is near."""
    wide_rows, wide_columns = _wider(library, rows), _wider(library, columns)
    block = distance.block(wide_rows, wide_columns)
    block[wide_rows < 0] = np.inf
    block[:, wide_columns < 0] = np.inf
    return block


def _bordered_labels(
    library: MotionLibrary, labels: NDArray[np.int8], rows: Frames, columns: Frames
) -> NDArray[np.bool_]:
    """Return which frames and their neighbours have one label."""
    equal: NDArray[np.bool_] = (
        labels[_wider(library, rows)][:, None] == labels[_wider(library, columns)]
    )
    return equal


def _minima(block: Block, threshold: float) -> NDArray[np.bool_]:
    """Return which inner values of a block are local minima below a threshold."""
    height, width = block.shape[0] - 2, block.shape[1] - 2
    inner = block[1:-1, 1:-1]
    minimum = inner < threshold
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            near = block[1 + down : height + 1 + down, 1 + right : width + 1 + right]
            if (down, right) < (0, 0):
                minimum &= inner < near  # of equal neighbours, the last is the minimum
            elif (down, right) > (0, 0):
                minimum &= inner <= near
    return minimum


def _frames(chosen: NDArray[np.bool_], rows: Frames, columns: Frames) -> Frames:
    """Return the frames of the chosen pairs, (2, n): each pair once, none with itself."""
    at_row, at_column = np.nonzero(chosen)
    pairs = np.stack([rows[at_row], columns[at_column]])
    return pairs[:, pairs[0] < pairs[1]]
