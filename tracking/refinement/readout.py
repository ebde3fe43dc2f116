"""How long a rolling shutter takes from the first row of an image to the last, measured in play.

Each row is exposed a little later than the one above it, so a cube that moves looks slanted or
stretched. A pose explains part of that; what is left in the residuals of the edges tells the time,
given how fast the cube moves (Ait-Aider, Andreff, Lavest and Martinet, 2006, solve for both).
"""

from collections import deque

import numpy as np

from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.robust_statistics import median, median_with_error
from cubeling.tracking.refinement.edges.edge_fit import FittedEdges
from cubeling.tracking.refinement.edges.profiles import row_shares

MAX_READOUT_S, MIN_READOUT_S = 0.05, 0.004
"""The longest of a webcam, and the shortest that matters [s]."""

MAX_SAMPLE_DEVIATION_S, MAX_SAMPLES = 0.006, 60
"""A frame that tells the time less well than this does not count [s], and so many that do are kept.
"""

MIN_SAMPLES_EACH_WAY, MIN_DEVIATIONS = 5, 5.0
"""Frames in which the cube moves one way and the other way, as what is folded askew seems to take
time in one and to save it in the other; and how many standard deviations a time is above none."""


class ReadoutEstimator:
    """Estimates that time for one camera; it is 0 until it is known."""

    def __init__(self) -> None:
        self._samples: deque[tuple[float, bool]] = deque(maxlen=MAX_SAMPLES)
        self.seconds = 0.0
        """Time from the first row to the last [s]."""

    def learn(self, edges: FittedEdges, velocity: Array, height: int) -> None:
        """Learn from the edges of a trusted pose of a cube with a velocity, (6,).

        `height` is that of the image [px].
        """
        fit, profiles = edges.fit, edges.profiles
        used = fit.strong
        # How far each edge is moved by a second of readout.
        late = row_shares(profiles.pixels[used, 1], height)
        column = late * (profiles.slopes[used] @ velocity)
        weighted = fit.rows * fit.weights[:, None]
        explained = np.linalg.solve(fit.normal, weighted.T @ column)
        alone = column - fit.rows @ explained
        information = float(fit.weights @ alone**2)
        # Residuals scatter more than the noise of the pixels does.
        freedom = max(float(fit.robust.sum()) - len(explained), 1.0)
        chi = max(float(fit.weights @ fit.residual**2) / freedom, 1.0)
        if information / chi < 1 / MAX_SAMPLE_DEVIATION_S**2:
            return
        already = late * (profiles.slopes[used] @ profiles.readout_motion)
        found = float((fit.weights * alone) @ (fit.residual + already)) / information
        self._samples.append((found, bool(velocity[np.abs(velocity[:3]).argmax()] > 0)))
        self._update()

    def _update(self) -> None:
        """Take the median where both ways of moving agree on it."""
        found = np.array([each for each, _ in self._samples])
        forward = np.array([way for _, way in self._samples])
        ways = (found[forward], found[~forward])
        if min(map(len, ways)) < MIN_SAMPLES_EACH_WAY:
            return
        middle, error = median_with_error(found)
        agree = all(abs(median(way) - middle) < middle / 3 for way in ways)
        if agree and middle > max(MIN_READOUT_S, MIN_DEVIATIONS * error):
            self.seconds = min(middle, MAX_READOUT_S)
