"""Least squares between the rendered mixture of black and white and the image."""

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np

from cubeling.tracking.geometry.arrays import Array, Flags, Indices, run_starts
from cubeling.tracking.geometry.robust_statistics import quantile

MAX_RESIDUAL_SIGMAS, MIN_CUT_SHARE = 2.0, 0.25
"""Residuals beyond this many standard deviations lose their weight (fingers, glare, shadows), but
not below this share of the contrast, which an edge leaves that is not yet in place."""

WRONG_SHARE = 0.5
"""A cell that is brighter or darker than rendered by this share of the contrast is wrong."""

TYPICAL_ERROR, LEAST_CONTRAST, LEAST_ERROR = 0.08, 0.3, 1.0
"""Typical error of a sample as a share of its face's contrast, which is taken to be at least this
share of the greatest one, and in grey levels at least."""

EVEN_ERROR = 0.5
"""Error of an even surface as a share of the contrast: it is half as bright as white paper."""

MIN_FACE_SAMPLES = 30
"""A face with fewer samples has no correlation of its own."""


@dataclass(frozen=True)
class PhotometricSamples:
    """Rendered and measured values of the samples in view."""

    face: Indices
    """Index of each sample's face, 0 for the first in view, ascending, (N,)."""

    block: Indices
    """Index of its block: the errors of one block are not independent, (N,)."""

    seen: Array
    """Light in the image, (N,)."""

    rendered: Array
    """Share of white in the rendered mixture, 0…1, (N,)."""

    jacobian: Array
    """Derivative of `rendered` by a pose delta and by K properties of the image: blur motion, or
    blur and bloom, (N, 6 + K)."""


@dataclass(frozen=True)
class PhotometricFit:
    """The rendered tones fitted to the image, and the step to a better pose and motion."""

    samples: PhotometricSamples
    """Points of the cube whose brightness was compared."""

    own_rows: Array
    """Jacobian of the residual: pose, the K others, then the tones of the sample's own face and the
    bend of mixtures, (6 + K + 3 or 5, N)."""

    columns: Indices
    """Which unknowns these are of, for each face, (faces, 6 + K + 3 or 5)."""

    bounds: Indices
    """Where the samples of each face begin, and where the last end, (faces + 1,)."""

    normal: Array
    """Their normal matrix without priors."""

    right_side: Array
    """The right-hand side of the normal equations."""

    faces: int
    """Number of faces in view."""

    tones: Array
    """Black of each face, white minus black of each face, the bend of mixtures, and the slopes of
    the light across each face, if they were fitted."""

    even: Array
    """Light in the image without those slopes, (N,)."""

    residual: Array
    """Residuals, (N,)."""

    weights: Array
    """Robust weights over the variance, (N,)."""

    scale: float
    """Standard deviation of the residual."""

    def step(self, expected: Array, prior: Array) -> Array:
        """Solve for the step of the pose and of the K others, (6 + K,).

        That of the others is expected to be `expected` with standard deviations `prior`, (K,) each.
        """
        normal, right_side = self._with(prior), self.right_side.copy()
        count = 6 + len(prior)
        right_side[6:count] += expected / prior**2
        return np.asarray(np.linalg.solve(normal, right_side)[:count], np.float64)

    def covariance(self, prior: Array) -> Array:
        """Covariance of pose and others, (6 + K, 6 + K), with each block as one measurement."""
        inverse, end = np.linalg.inv(self._with(prior)), 6 + len(prior)
        # numpy sorts integers of 16 bits by their digits, in a tenth of the time.
        order = np.argsort(self.samples.block.astype(np.uint16), kind="stable")
        starts = run_starts(self.samples.block[order])
        weighted = self.own_rows * (self.weights * self.residual)
        by_block = np.add.reduceat(weighted[:, order], starts, axis=1).T
        # All samples of a block lie on one face.
        columns = self.columns[self.samples.face[order[starts]]]
        scores = np.einsum("br,brk->bk", by_block, inverse[columns, :end])
        count, used = len(starts), len(self.normal) / 2
        spread = scores.T @ scores * (count / max(count - used, 1.0))
        own = inverse[:end, 6:end] / prior
        # A few blocks cannot span all directions: add a share of the independent covariance.
        return np.asarray(spread + own @ own.T + 0.2 * inverse[:end, :end], np.float64)

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
        return float(self.tones[self.faces : 2 * self.faces].max())

    @property
    def mixture_tones(self) -> tuple[float, float]:
        """Bend of mixtures, and black over white, as `ToneCurve.learn` takes them."""
        best = int(np.argmax(self.tones[self.faces : 2 * self.faces]))
        black, contrast = float(self.tones[best]), max(self.contrast, 1e-3)
        return float(self.tones[2 * self.faces]) / contrast, black / (black + contrast)

    @property
    def visible_correlations(self) -> Array:
        """Correlation over the samples that fit, and their share, for each face, (faces, 2).

        A finger covers the others.
        """
        weight = self._light * (self.weights * self.scale**2)
        count = self._light.sum(axis=1)
        return np.stack([self._alike(weight), weight.sum(axis=1) / np.maximum(count, 1)], axis=1)

    def correlations_within(self, chosen: Flags) -> Array:
        """Correlation of rendering and image over some samples, (N,), for each face, (faces,)."""
        return self._alike(self._light * chosen)

    def block_evidence(self, blocks: int) -> Array:
        """How well the rendering explains each block of each face, (faces, blocks).

        Twice the logarithm of the likelihood ratio to an even surface, mean of the samples, with
        Cauchy's distribution, as fingers and dirt are no errors of light; 0 where they cover it.
        """
        face = self.samples.face
        contrast = self.tones[self.faces : 2 * self.faces]
        contrast = np.maximum(contrast, max(LEAST_CONTRAST * self.contrast, LEAST_ERROR))
        error = np.hypot(TYPICAL_ERROR, LEAST_ERROR / contrast)[face] ** 2
        gain = 2 * np.log((error + EVEN_ERROR**2) / (error + (self.residual / contrast[face]) ** 2))
        samples = np.bincount(self.samples.block, minlength=self.faces * blocks)
        means = np.bincount(self.samples.block, gain, len(samples)) / np.maximum(samples, 1)
        return np.maximum(means.reshape(self.faces, blocks), 0)

    def wrong_cells(self, cells: Indices, count: int) -> Array:
        """Count the cells of each face, (faces,), that are not as bright as they are rendered.

        `cells` is the cell of each sample on its face, 0 to `count` − 1, or −1 for none, (N,).
        """
        found = np.zeros(self.faces)
        contrasts = self.tones[self.faces : 2 * self.faces]
        for face, (begin, end) in enumerate(pairwise(self.bounds.tolist())):
            of = begin + np.flatnonzero(cells[begin:end] >= 0)
            samples = np.bincount(cells[of], minlength=count)
            off = np.bincount(cells[of], self.residual[of], count) / np.maximum(samples, 1)
            found[face] = np.count_nonzero(np.abs(off) > WRONG_SHARE * abs(contrasts[face]))
        return found

    @property
    def correlations(self) -> Array:
        """Correlation of rendering and image, over all and for each face; NaN if not in view."""
        overall = _correlations(self.even, self.even - self.residual, np.ones((1, len(self.even))))
        each = self._alike(self._light)
        each[self._light.sum(axis=1) <= MIN_FACE_SAMPLES] = np.nan
        return np.concatenate([overall, each])

    def _alike(self, weights: Array) -> Array:
        """Correlation with weights, (faces, N), for each face: negative where black is brighter."""
        found = _correlations(self.even, self.even - self.residual, weights)
        found[self.tones[self.faces : 2 * self.faces] < 0] *= -1
        found[np.count_nonzero(weights, axis=1) <= MIN_FACE_SAMPLES] = 0.0
        return found

    @cached_property
    def _light(self) -> Array:
        """Which samples lie on each face: 1 or 0, (faces, N)."""
        light = np.zeros((self.faces, len(self.residual)))
        for face, (begin, end) in enumerate(pairwise(self.bounds.tolist())):
            light[face, begin:end] = 1.0
        return light

    def _with(self, prior: Array) -> Array:
        normal = self.normal.copy()
        diagonal = np.full(len(normal), 1e-3)
        diagonal[6 : 6 + len(prior)] = 1 / prior**2
        normal.flat[:: len(normal) + 1] += diagonal
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


def fit_tones(
    samples: PhotometricSamples, faces: int, places: Array | None = None
) -> PhotometricFit:
    """Fit the tones of all faces in view with robust weights: each face has its own light.

    `places` are those of the samples on their faces, −1…1, (N, 2), if the light of a face may
    have a slope.
    """
    rendered, seen, tilted = samples.rendered, samples.seen, places is not None
    bounds = np.searchsorted(samples.face, np.arange(faces + 1))
    count, sizes = samples.jacobian.shape[1], np.diff(bounds)
    # The unknowns of one face's samples; one property of all samples after the other is faster
    # than one sample after the other.
    rows = np.empty((count + (5 if tilted else 3), len(seen)))
    all_columns = _columns(faces, count, tilted)
    columns = all_columns[:, count:] - count
    of_tones = rows[count:]
    of_tones[0], of_tones[1] = 1.0, rendered
    np.multiply(rendered, 1 - rendered, out=of_tones[2])
    used, weighted, scale = 3, of_tones[:3], 1.0
    for last in (False, True):
        of = columns[:, :used]
        normal, right_side = _summed(weighted, of_tones[:used], seen, of, bounds)
        normal.flat[:: len(normal) + 1] += 1e-3
        tones = np.asarray(np.linalg.solve(normal, right_side), np.float64)
        residual = seen - _mixed(tones[of], of_tones[:used], bounds)
        scale = 1.4826 * quantile(np.abs(residual), 0.5) + 0.3
        contrast = float(tones[faces : 2 * faces].max())
        cut = max(MAX_RESIDUAL_SIGMAS * scale, MIN_CUT_SHARE * contrast)
        robust = 1 / np.square(1 + np.square(residual / cut))
        if last:
            break
        if places is not None:
            # A slope of the light changes black and white by the same share.
            np.multiply(seen - residual, places.T, out=of_tones[3:])
            used = 5
        weighted = of_tones[:used] * robust
    even = seen - _mixed(tones[columns[:, 3:]], of_tones[3:], bounds)
    strength = np.repeat(tones[faces : 2 * faces], sizes) + tones[2 * faces] * (1 - 2 * rendered)
    np.multiply(samples.jacobian.T, strength, out=rows[:count])
    weights = robust / scale**2
    normal, right_side = _summed(rows * weights, rows, residual, all_columns, bounds)
    return PhotometricFit(
        samples, rows, all_columns, bounds, normal, right_side, faces, tones, even, residual,
        weights, scale,
    )  # fmt: skip


@cache
def _columns(faces: int, count: int, tilted: bool) -> Indices:
    """Return `PhotometricFit.columns` for samples with `count` unknowns beside the tones.

    The tones are black, white minus black, the bend of mixtures, which all faces share, and, if the
    light is `tilted`, its two slopes.
    """
    face = count + np.arange(faces)[:, None]
    pose = np.tile(np.arange(count), (faces, 1))
    bend = np.full((faces, 1), count + 2 * faces)
    slopes = [2 * faces + 1 + face, 3 * faces + 1 + face] if tilted else []
    return np.hstack([pose, face, faces + face, bend, *slopes])


def _mixed(tones: Array, rows: Array, bounds: Indices) -> Array:
    """Return the sum of rows, (R, N), each times the tones of the sample's face, (faces, R)."""
    mixed = np.empty(rows.shape[1])
    for own, (begin, end) in zip(tones, pairwise(bounds.tolist()), strict=True):
        np.matmul(own, rows[:, begin:end], out=mixed[begin:end])
    return mixed


def _summed(
    weighted: Array, rows: Array, values: Array, columns: Indices, bounds: Indices
) -> tuple[Array, Array]:
    """Return normal matrix and right-hand side over the samples of all faces.

    `rows` and `weighted`, (R, N), are those of each sample's own unknowns, whose numbers are
    `columns`, (faces, R).
    """
    if len(columns) == 1:
        return weighted @ rows.T, weighted @ values
    size = int(columns.max()) + 1
    normal, right_side = np.zeros((size, size)), np.zeros(size)
    for of, (begin, end) in zip(columns, pairwise(bounds.tolist()), strict=True):
        own = weighted[:, begin:end]
        normal[of[:, None], of] += own @ rows[:, begin:end].T
        right_side[of] += own @ values[begin:end]
    return normal, right_side


def _correlations(a: Array, b: Array, weights: Array) -> Array:
    """Correlation of a and b, (N,) each, with each row of weights, (M, N), (M,)."""
    share = weights / np.maximum(weights.sum(axis=1), 1e-9)[:, None]
    a, b = a - (share @ a)[:, None], b - (share @ b)[:, None]
    across, one, two = ((share * x * y).sum(axis=1) for x, y in ((a, b), (a, a), (b, b)))
    return np.asarray(across / np.sqrt(np.maximum(one * two, 1e-12)), np.float64)
