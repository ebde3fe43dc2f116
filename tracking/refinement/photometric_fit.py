"""Least squares between the drawn mixture of black and white and what the camera saw."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.geometry.robust_statistics import quantile

Array = NDArray[np.float64]

SOFTNESS = 2.0
"""Residuals beyond so many standard deviations lose their weight: fingers, glare, shadows."""

TOLERANCE = 0.2
"""And residuals beyond this share of the contrast: an edge that is not yet in its place leaves as
much, and must not be taken for a finger."""


@dataclass(frozen=True)
class PhotometricSamples:
    """What the drawing and the picture say at the samples that are in view."""

    face: NDArray[np.intp]
    """Number of each sample's face, 0 for the first in view, (N,)."""

    block: NDArray[np.intp]
    """Number of its block: samples of one block err alike, (N,)."""

    seen: Array
    """Light that the camera saw, (N,)."""

    drawn: Array
    """Share of white in the drawn mixture, 0…1, (N,)."""

    slopes: Array
    """How that changes with a shift-turn of the pose, and of the sweep, (N, 12)."""


@dataclass(frozen=True)
class PhotometricFit:
    """The drawing's tones fitted to the picture, and the step towards a better drawing."""

    samples: PhotometricSamples
    """What was fitted."""

    rows: Array
    """Linear equations of the residual: pose, sweep, then the tones, (N, 12 + tones)."""

    normal: Array
    """Their normal matrix without priors."""

    pull: Array
    """Its right-hand side."""

    gain: Array
    """Tones: black of each face, white over black of each face, and the bend of mixtures."""

    residual: Array
    """What the tones leave, (N,)."""

    weights: Array
    """Robust weights over the variance, (N,)."""

    scale: float
    """Standard deviation of the residual."""

    def step(self, expected: Array, prior: Array) -> Array:
        """Solve for the step of pose and sweep, (12,), with a prior of the sweep.

        Parameters
        ----------
        expected
            Step of the sweep that the prior asks for, (6,).
        prior
            Its standard deviations, (6,).
        """
        normal, pull = self._with(prior), self.pull.copy()
        pull[6:12] += expected / prior**2
        return np.asarray(np.linalg.solve(normal, pull)[:12], np.float64)

    def covariance(self, prior: Array) -> Array:
        """Covariance of pose and sweep, (12, 12), each block of samples one measurement.

        The same as for edges (`refinement`): neighbours do not err independently.
        """
        inverse = np.linalg.inv(self._with(prior))
        starts, order = self._blocks()
        weighted = self.rows * (self.weights * self.residual)[:, None]
        pulls = np.add.reduceat(weighted[order], starts) @ inverse[:, :12]
        count, taken = len(starts), self.rows.shape[1] / 2
        spread = pulls.T @ pulls * (count / max(count - taken, 1.0))
        own = inverse[:12, 6:12] / prior
        # A handful of blocks cannot span all directions; no sample is that sure either.
        return np.asarray(spread + own @ own.T + 0.2 * inverse[:12, :12], np.float64)

    def told(self, way: Array, step: Array, prior: Array) -> tuple[Array, Array]:
        """Information times sweep, (6,), and information, (6, 6), from the picture alone.

        Parameters
        ----------
        way
            The sweep from which the step was made, (6,).
        step
            The step that `step` gave, (12,).
        prior
            The prior that it was given, which is not counted here, (6,).
        """
        inverse = np.linalg.inv(self._with(prior))
        marginal = np.linalg.inv(inverse[6:12, 6:12]) - np.diag(1 / prior**2)
        return marginal @ (way + step[6:12]), marginal

    @property
    def contrast(self) -> float:
        """White over black of the face where it is greatest."""
        return float(self.gain[self._faces : 2 * self._faces].max())

    @property
    def tones(self) -> tuple[float, float]:
        """Bend of mixtures, and black beside white, as `Response.learn` takes them."""
        best = int(np.argmax(self.gain[self._faces : 2 * self._faces]))
        black, height = float(self.gain[best]), max(self.contrast, 1e-3)
        return float(self.gain[-1]) / height, black / (black + height)

    @property
    def likeness(self) -> Array:
        """Correlation of fitted drawing and picture, over all and for each face; NaN if unseen."""
        fitted = self.samples.seen - self.residual
        whole = [_correlation(self.samples.seen, fitted)]
        for face in range(self._faces):
            of = self.samples.face == face
            enough = np.count_nonzero(of) > 30
            whole.append(_correlation(self.samples.seen[of], fitted[of]) if enough else np.nan)
        return np.array(whole)

    @property
    def _faces(self) -> int:
        return len(self.gain) // 2

    def _with(self, prior: Array) -> Array:
        normal = self.normal.copy()
        diagonal = np.full(len(normal), 1e-3)
        diagonal[6:12] = 1 / prior**2
        normal[np.diag_indices_from(normal)] += diagonal
        return normal

    def _blocks(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        order = np.argsort(self.samples.block, kind="stable")
        return np.flatnonzero(np.diff(self.samples.block[order], prepend=-1)), order


def fit(samples: PhotometricSamples, faces: int) -> PhotometricFit:
    """Fit the tones of all faces with robust weights.

    Parameters
    ----------
    samples
        What is drawn and seen.
    faces
        How many faces are in view: each has its own light.
    """
    face, drawn, seen = samples.face, samples.drawn, samples.seen
    light = (face[:, None] == np.arange(faces)).astype(np.float64)
    mixed = (drawn * (1 - drawn))[:, None]
    tone = np.concatenate([light, light * drawn[:, None], mixed], axis=1)
    robust, scale = np.ones(len(seen)), 1.0
    steady = np.eye(tone.shape[1]) * 1e-3
    for _ in range(2):
        weighted = tone * robust[:, None]
        gain = np.linalg.solve(weighted.T @ tone + steady, weighted.T @ seen)
        residual = seen - tone @ gain
        scale = 1.4826 * quantile(np.abs(residual), 0.5) + 0.3
        cut = max(SOFTNESS * scale, TOLERANCE * float(gain[faces : 2 * faces].max()))
        robust = 1 / np.square(1 + np.square(residual / cut))
    strength = gain[faces : 2 * faces][face] + gain[-1] * (1 - 2 * drawn)
    rows = np.concatenate([samples.slopes * strength[:, None], tone], axis=1)
    weights = robust / scale**2
    weighted = rows * weights[:, None]
    return PhotometricFit(
        samples, rows, weighted.T @ rows, weighted.T @ residual, gain, residual, weights, scale
    )


def _correlation(a: Array, b: Array) -> float:
    a, b = a - a.mean(), b - b.mean()
    return float(a @ b / np.sqrt(max(float((a @ a) * (b @ b)), 1e-12)))
