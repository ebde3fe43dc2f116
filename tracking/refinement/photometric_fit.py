"""Least squares between the rendered mixture of black and white and the image."""

from dataclasses import dataclass

import numpy as np

from tracking.geometry.arrays import Array, Indices
from tracking.geometry.robust_statistics import quantile

MAX_RESIDUAL_SIGMAS, MIN_CUT_SHARE = 2.0, 0.2
"""Residuals beyond this many standard deviations lose their weight (fingers, glare, shadows), but
not below this share of the contrast, which an edge leaves that is not yet in place."""

MIN_FACE_SAMPLES = 30
"""A face with fewer samples has no correlation of its own."""


@dataclass(frozen=True)
class PhotometricSamples:
    """Rendered and measured values of the samples in view."""

    face: Indices
    """Index of each sample's face, 0 for the first in view, (N,)."""

    block: Indices
    """Index of its block: the errors of one block are not independent, (N,)."""

    seen: Array
    """Light in the image, (N,)."""

    rendered: Array
    """Share of white in the rendered mixture, 0…1, (N,)."""

    jacobian: Array
    """Derivative of `rendered` by a pose delta and by the blur motion, (N, 12)."""


@dataclass(frozen=True)
class PhotometricFit:
    """The rendered tones fitted to the image, and the step to a better pose and motion."""

    samples: PhotometricSamples
    """The fitted samples."""

    rows: Array
    """Jacobian of the residual: pose, blur motion, then the tones, (N, 12 + tones)."""

    normal: Array
    """Their normal matrix without priors."""

    right_side: Array
    """The right-hand side of the normal equations."""

    tones: Array
    """Black of each face, white minus black of each face, and the bend of mixtures."""

    residual: Array
    """Residuals, (N,)."""

    weights: Array
    """Robust weights over the variance, (N,)."""

    scale: float
    """Standard deviation of the residual."""

    def step(self, expected: Array, prior: Array) -> Array:
        """Solve for the step of pose and blur motion, (12,).

        That of the motion is expected to be `expected` with standard deviations `prior`, (6,) each.
        """
        normal, right_side = self._with(prior), self.right_side.copy()
        right_side[6:12] += expected / prior**2
        return np.asarray(np.linalg.solve(normal, right_side)[:12], np.float64)

    def covariance(self, prior: Array) -> Array:
        """Covariance of pose and blur motion, (12, 12), with each block as one measurement."""
        inverse = np.linalg.inv(self._with(prior))
        order = np.argsort(self.samples.block, kind="stable")
        starts = np.flatnonzero(np.diff(self.samples.block[order], prepend=-1))
        weighted = self.rows * (self.weights * self.residual)[:, None]
        scores = np.add.reduceat(weighted[order], starts) @ inverse[:, :12]
        count, used = len(starts), self.rows.shape[1] / 2
        spread = scores.T @ scores * (count / max(count - used, 1.0))
        own = inverse[:12, 6:12] / prior
        # A few blocks cannot span all directions: add a share of the independent covariance.
        return np.asarray(spread + own @ own.T + 0.2 * inverse[:12, :12], np.float64)

    def motion_information(self, motion: Array, step: Array, prior: Array) -> tuple[Array, Array]:
        """Information times blur motion, (6,), and information, (6, 6), without the prior.

        `motion` is the blur motion before the step, (6,), and `step` the result of `step`.
        """
        inverse = np.linalg.inv(self._with(prior))
        marginal = np.linalg.inv(inverse[6:12, 6:12]) - np.diag(1 / prior**2)
        return marginal @ (motion + step[6:12]), marginal

    @property
    def contrast(self) -> float:
        """White minus black of the face where it is greatest."""
        return float(self.tones[self._faces : 2 * self._faces].max())

    @property
    def mixture_tones(self) -> tuple[float, float]:
        """Bend of mixtures, and black over white, as `ToneCurve.learn` takes them."""
        best = int(np.argmax(self.tones[self._faces : 2 * self._faces]))
        black, contrast = float(self.tones[best]), max(self.contrast, 1e-3)
        return float(self.tones[-1]) / contrast, black / (black + contrast)

    @property
    def correlations(self) -> Array:
        """Correlation of rendering and image, over all and for each face; NaN if not in view."""
        fitted = self.samples.seen - self.residual
        whole = [_correlation(self.samples.seen, fitted)]
        for face in range(self._faces):
            of = self.samples.face == face
            enough = np.count_nonzero(of) > MIN_FACE_SAMPLES
            whole.append(_correlation(self.samples.seen[of], fitted[of]) if enough else np.nan)
        return np.array(whole)

    @property
    def _faces(self) -> int:
        return len(self.tones) // 2

    def _with(self, prior: Array) -> Array:
        normal = self.normal.copy()
        diagonal = np.full(len(normal), 1e-3)
        diagonal[6:12] = 1 / prior**2
        normal[np.diag_indices_from(normal)] += diagonal
        return normal


@dataclass(frozen=True)
class Alignment:
    """A pose and a blur motion that explain a motion-blurred image."""

    camera_from_cube: Array
    """Pose of the cube in the middle of the exposure, (4, 4) [m]."""

    blur_motion: Array
    """Pose delta of the cube during the exposure, (6,)."""

    covariance: Array
    """Of a pose delta and then of the blur motion, (12, 12)."""

    motion_information: tuple[Array, Array]
    """What the image alone says of the blur motion: information times motion, (6,), and
    information, (6, 6)."""

    correlation: float
    """Correlation of the rendering and the image, −1…1, over all samples in view."""

    face_correlations: dict[str, float]
    """The same for each face in view."""

    residual: float
    """Standard deviation of the samples that fit, as a share of the contrast."""

    mixture_bend: float
    """By how much mixtures of black and white are brighter than they should be, see `ToneCurve`."""

    black_level: float
    """Black over white, in the face with the greatest contrast."""

    @property
    def min_correlation(self) -> float:
        """The smallest of all correlations."""
        return min(self.correlation, *self.face_correlations.values())


def fit_tones(samples: PhotometricSamples, faces: int) -> PhotometricFit:
    """Fit the tones of all faces in view with robust weights: each face has its own light."""
    face, rendered, seen = samples.face, samples.rendered, samples.seen
    light = (face[:, None] == np.arange(faces)).astype(np.float64)
    mixed = (rendered * (1 - rendered))[:, None]
    rows_of_tones = np.concatenate([light, light * rendered[:, None], mixed], axis=1)
    robust, scale = np.ones(len(seen)), 1.0
    regularization = np.eye(rows_of_tones.shape[1]) * 1e-3
    for _ in range(2):
        weighted = rows_of_tones * robust[:, None]
        normal = weighted.T @ rows_of_tones + regularization
        tones = np.linalg.solve(normal, weighted.T @ seen)
        residual = seen - rows_of_tones @ tones
        scale = 1.4826 * quantile(np.abs(residual), 0.5) + 0.3
        contrast = float(tones[faces : 2 * faces].max())
        cut = max(MAX_RESIDUAL_SIGMAS * scale, MIN_CUT_SHARE * contrast)
        robust = 1 / np.square(1 + np.square(residual / cut))
    strength = tones[faces : 2 * faces][face] + tones[-1] * (1 - 2 * rendered)
    rows = np.concatenate([samples.jacobian * strength[:, None], rows_of_tones], axis=1)
    weights = robust / scale**2
    weighted = rows * weights[:, None]
    return PhotometricFit(
        samples, rows, weighted.T @ rows, weighted.T @ residual, tones, residual, weights, scale
    )


def _correlation(a: Array, b: Array) -> float:
    a, b = a - a.mean(), b - b.mean()
    return float(a @ b / np.sqrt(max(float((a @ a) * (b @ b)), 1e-12)))
