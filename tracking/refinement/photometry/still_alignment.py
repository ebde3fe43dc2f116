"""Photometric alignment of a cube at rest: all cells of its markers are compared with the image.

The markers are rendered as a lens of unknown focus sees them, with white that grows over black by
an unknown width. Gauss-Newton adjusts the pose, these two, and the light of each face until the
rendering matches the image. Unlike single edges it needs no cell wider than the blur.
"""

from collections.abc import Collection
from dataclasses import dataclass

import cv2
import numpy as np

from tracking.cube.faces import FacePlanes, face_frame
from tracking.cube.model import CubeModel
from tracking.geometry import se3
from tracking.geometry.arrays import Array, Floats, Indices
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import MIN_DEPTH, Projection, radial_bend
from tracking.refinement.evidence import Evidence
from tracking.refinement.photometry.marker_images import TEXELS_PER_CELL, MarkerTextures
from tracking.refinement.photometry.photometric_fit import (
    PhotometricFit,
    PhotometricSamples,
    fit_tones,
)
from tracking.refinement.photometry.texels import SampleGrid, texel_slides, texels_to_pixels
from tracking.refinement.systematic_error import CLAIMED_K1

MARGIN_CELLS, PAPER_SHARE = 1.0, 0.8
"""How far around a marker its paper is compared [cells], and at most which share of the paper."""

COARSE_SAMPLES, FINE_SAMPLES, BLOCKS_PER_SIDE = 24, 48, 6
"""Samples along each side of a marker with that paper, in a search and to measure, and blocks, each
one measurement."""

MIN_SAMPLES = 60
"""Fewer samples in view than this do not determine a pose."""

MIN_FACING_COSINE = 0.15
"""Cosine of the viewing angle below which a face shows too little of its marker."""

EXPECTED_BLUR_PX = 0.7
"""Blur of a focused lens, one standard deviation."""

BLUR_SPREAD_PX2, MIN_BLUR_PX2 = 1.5, 0.15
"""Standard deviation of the variance of a lens's blur, and the least variance."""

BLOOM_SPREAD_PX = 0.3
"""How far white grows over black, one standard deviation."""

NO_ERROR = 1e-6
"""Standard deviation of what is known."""

MAX_STEPS, CONVERGED_PX, MAX_SLIDE_PX = 12, 0.01, 1.5
"""Steps at most, the length of the last, and from which length on the samples are placed again."""

REDRAW_RATIO = 1.6
"""The markers are drawn again, with the blur found so far, where its variance has changed by more
than this factor."""

PIXELS_PER_MEASUREMENT, CELLS_PER_MEASUREMENT = 20.0, 2.0
"""How many pixels and how many cells make one independent measurement, whichever are fewer."""


@dataclass(frozen=True)
class StillAlignment:
    """A pose at which the rendered markers match the image."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a pose delta, (6, 6), by the residuals."""

    blur: float
    """Blur of the lens, one standard deviation [px]."""

    bloom: float
    """How far white has grown over black [px]."""

    k1: float
    """Radial distortion beyond that of the intrinsics, as far as this image tells it."""

    correlations: dict[str, float]
    """Correlation of rendering and image on each face in view, −1…1."""

    inner: dict[str, float]
    """The same over the cells inside the border alone, which tell markers apart."""

    wrong: dict[str, int]
    """How many of these cells are not as bright as they should be."""

    visible: dict[str, tuple[float, float]]
    """Correlation over the samples that fit, and their share."""

    evidence: Evidence
    """How much the image speaks for the pose."""

    residual: float
    """Standard deviation of the samples that fit, as a share of the contrast."""


@dataclass(frozen=True)
class _Placed:
    """Samples on the faces in view of one pose, and what the image shows there."""

    facing: Indices
    """Indices of the faces in view, (faces,)."""

    used: Indices | slice
    """Indices of the samples in the image, (N,), or a slice where all are."""

    values: Array
    """Light in the image, (N,)."""

    rays: Array
    """Rays of all samples at z = 1, (faces, 3, samples)."""

    bent: Array
    """How k1 moves these rays beside that of the cube's centre, (faces, 2, samples)."""

    slides: Array
    """How the texel under each ray moves by a pose delta, (2, 6, N) [texels]."""

    bends: Array
    """How it moves by the radial distortion k1, (2, N) [texels]."""

    texels_to_pixels: Array
    """Jacobian of the image by the texels of each face, (faces, 2, 2)."""

    face: Indices
    """Index of the face of each sample among those in view, (N,)."""

    block: Indices
    """Index of the block of each sample, (N,)."""

    places: Array
    """Place of each sample on its face, −1…1, (N, 2)."""


class StillAligner:
    """Aligns one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._projection = projection
        self._k1_error = CLAIMED_K1 if projection.claims_no_distortion else NO_ERROR
        self._frames = np.stack([face_frame(face) for face in cube.faces])
        self._textures = MarkerTextures(cube)
        cell = self._textures.texel * TEXELS_PER_CELL
        paper = PAPER_SHARE * (cube.edge - cube.marker_size) / 2
        self._reach = cube.marker_size / 2 + min(MARGIN_CELLS * cell, paper)
        # The cells inside the border, as a share of the reach.
        self._inner = (cube.marker_size / 2 - cell) / self._reach
        self._cells = round(cube.marker_size / cell) ** 2
        self._coarse, self._fine = (
            SampleGrid(count, self._reach, BLOCKS_PER_SIDE)
            for count in (COARSE_SAMPLES, FINE_SAMPLES)
        )
        middle = (self._textures.side - 1) / 2
        self._texels_of_places = np.array([[1, 0, middle], [0, 1, middle], [0, 0, 1]])
        self._texels_of_places[:2, :2] /= self._textures.texel

    def align(
        self,
        patch: Patch,
        start: Array,
        faces: Collection[str] | None = None,
        blur: float = EXPECTED_BLUR_PX,
        steps: int = MAX_STEPS,
        fine: bool = False,
        k1: float = 0.0,
    ) -> StillAlignment | None:
        """Align from a pose, (4, 4), that is right to about half a cell; None if not in view.

        `faces` are those that are compared with the image, None for all that face the camera,
        `blur` the expected blur of the patch, one standard deviation [px], and `k1` where its
        search starts. `fine` takes more samples: slower, and more precise.
        """
        grid = self._fine if fine else self._coarse
        expected, optics = np.array([blur**2, 0.0, 0.0]), np.array([blur**2, 0.0, k1])
        prior = np.array([BLUR_SPREAD_PX2 + blur**2 / 4, BLOOM_SPREAD_PX, self._k1_error])
        drawn, pose, moved = np.inf, start, np.inf
        placed: _Placed | None = None
        layers: Floats | None = None
        for _ in range(steps):
            if placed is None or moved > MAX_SLIDE_PX:
                placed = self._place(patch, pose, faces, grid)
                if placed is None:
                    return None
            if layers is None or not 1 / REDRAW_RATIO < optics[0] / drawn < REDRAW_RATIO:
                drawn = float(optics[0])
                layers = self._textures.seen(placed.facing, placed.texels_to_pixels, drawn)
            fit = self._fit(placed, layers, pose, optics - (drawn, 0.0, 0.0))
            step = fit.step(expected - optics, prior)
            pose, moved = se3.moved(pose, step[:6]), self._slide_px(pose, step)
            optics = optics + step[6:]
            optics[0] = np.clip(optics[0], max(MIN_BLUR_PX2, drawn / 2), 3 * drawn)
            if moved < CONVERGED_PX:
                break
        return self._summary(pose, optics, placed, fit, prior) if placed else None

    def _slide_px(self, pose: Array, step: Array) -> float:
        """How far a step moves the image of a face at most [px]."""
        far = float(np.linalg.norm(step[:3])) + self._reach * float(np.linalg.norm(step[3:6]))
        return far * float(self._projection.matrix[0, 0] / pose[2, 3])

    def _place(
        self, patch: Patch, pose: Array, faces: Collection[str] | None, grid: SampleGrid
    ) -> _Placed | None:
        names = self._faces.names
        facing = np.array(
            [
                number
                for number in self._faces.facing(pose, MIN_FACING_COSINE)
                if faces is None or names[number] in faces
            ],
            np.intp,
        )
        frames = pose @ self._frames[facing]
        points = frames[:, :3] @ grid.points
        if not len(facing) or points[:, 2].min() < MIN_DEPTH:
            return None
        pixels = self._projection.project(points.transpose(0, 2, 1).reshape(-1, 3))
        used = np.flatnonzero(patch.border_distance(pixels) > 1)
        if len(used) < MIN_SAMPLES:
            return None
        values = patch.sample(pixels[used, None])[:, 0].astype(np.float64)
        rays, texel = points / points[:, 2:], self._textures.texel
        slides = texel_slides(frames, points - pose[:3, 3, None], rays, texel)
        flat = rays[:, :2].transpose(0, 2, 1)
        bent = radial_bend(flat) - radial_bend(pose[:2, 3] / pose[2, 3])
        bent = bent.transpose(0, 2, 1)
        x, y = (points[:, 2] * bent.transpose(1, 0, 2)).reshape(2, -1)
        bends = x * slides[:, 0] + y * slides[:, 1]
        to_pixels = texels_to_pixels(self._projection, frames, texel)
        face, place, block = grid.divided(used)
        chosen = slice(None) if len(used) == len(pixels) else used
        return _Placed(
            facing, chosen, values, rays, bent, slides[..., chosen], bends[:, chosen], to_pixels,
            face, block, grid.places[place],
        )  # fmt: skip

    def _fit(self, placed: _Placed, layers: Floats, pose: Array, optics: Array) -> PhotometricFit:
        """Render the markers at a pose, with small changes of blur and bloom, and fit the light."""
        planes = (pose @ self._frames[placed.facing])[:, :3, [0, 1, 3]]
        side, rays = self._textures.side, placed.rays
        if optics[2]:
            rays = np.concatenate([rays[:, :2] - optics[2] * placed.bent, rays[:, 2:]], axis=1)
        met = self._texels_of_places @ np.linalg.inv(planes) @ rays
        places = np.clip(met[:, :2] / met[:, 2:], 0, side - 1)
        places[:, 1] += (np.arange(len(placed.facing)) * side)[:, None]
        x, y = places.astype(np.float32).transpose(1, 0, 2)
        texel, right, down, by_blur, by_bloom = (
            cv2.remap(each, x, y, cv2.INTER_LINEAR).ravel()[placed.used] for each in layers
        )
        jacobian = np.empty((9, len(texel)))
        np.multiply(placed.slides[0], right, out=jacobian[:6])
        jacobian[:6] += placed.slides[1] * down
        jacobian[6:] = by_blur, by_bloom, placed.bends[0] * right + placed.bends[1] * down
        rendered = texel + optics[:2] @ jacobian[6:8]
        samples = PhotometricSamples(placed.face, placed.block, placed.values, rendered, jacobian.T)
        return fit_tones(samples, len(placed.facing), placed.places)

    def _summary(
        self, pose: Array, optics: Array, placed: _Placed, fit: PhotometricFit, prior: Array
    ) -> StillAlignment:
        names = [self._faces.names[number] for number in placed.facing]
        alike = np.nan_to_num(fit.correlations[1:])
        cells, inner = self._inner_cells(placed)
        side = 2 * self._reach / self._textures.texel
        area = np.abs(np.linalg.det(placed.texels_to_pixels)) * side**2
        count = np.minimum(self._cells / CELLS_PER_MEASUREMENT, area / PIXELS_PER_MEASUREMENT)
        evidence = np.zeros((len(self._frames), BLOCKS_PER_SIDE**2))
        evidence[placed.facing] = fit.explained(evidence.shape[1]) * count[:, None]
        evidence /= evidence.shape[1]
        return StillAlignment(
            pose,
            fit.covariance(prior)[:6, :6],
            float(np.sqrt(optics[0])),
            float(optics[1]),
            float(optics[2]),
            dict(zip(names, alike.tolist(), strict=True)),
            dict(zip(names, fit.correlations_within(cells >= 0).tolist(), strict=True)),
            dict(zip(names, map(int, fit.wrong_cells(cells, inner)), strict=True)),
            dict(zip(names, map(tuple, fit.visible_correlations.tolist()), strict=True)),
            Evidence(evidence),
            fit.scale / max(fit.contrast, 1.0),
        )

    def _inner_cells(self, placed: _Placed) -> tuple[Indices, int]:
        """Return the cell inside the border of each sample, −1 for none, and how many there are."""
        side = round(np.sqrt(self._cells)) - 2
        column, row = np.floor((placed.places.T / self._inner + 1) / 2 * side).astype(np.intp)
        inside = (np.minimum(column, row) >= 0) & (np.maximum(column, row) < side)
        return np.where(inside, row * side + column, -1), side**2
