"""Photometric alignment of a cube at rest: all cells of its markers are compared with the image.

The markers are rendered as a lens of unknown focus sees them, with white that grows over black by
an unknown width, on paper that is bent where a single face is compared. Gauss-Newton adjusts the
pose, these, and the light of each face until the rendering matches the image. Unlike single edges
it needs no cell wider than the blur.
"""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from cubeling.tracking.cube.marker import cell_size
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Indices
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.evidence import Evidence
from cubeling.tracking.refinement.photometry.marker_images import (
    SMALL_TEXELS_PER_CELL,
    TEXELS_PER_CELL,
    DrawnMarkers,
    MarkerTextures,
)
from cubeling.tracking.refinement.photometry.photometric_fit import (
    PhotometricFit,
    PhotometricSamples,
    fit_tones,
)
from cubeling.tracking.refinement.photometry.placed_samples import (
    BLOCKS_PER_SIDE,
    COARSE_SAMPLES,
    MIN_FACING_COSINE,
    SMALL_SAMPLES,
    PlacedSamples,
    SamplePlacer,
)
from cubeling.tracking.refinement.systematic_error import CLAIMED_K1

EXPECTED_BLUR_PX = 0.7
"""Blur of a focused lens, one standard deviation."""

BLUR_SPREAD_PX2, MIN_BLUR_PX2 = 1.5, 0.15
"""Standard deviation of the variance of a lens's blur, and the least variance."""

BEND_BLOCKS = 4
"""What bends say of a pose counts as so many blocks: more would take it for surer than it is."""

MEASURED_STIFFNESS = 16.0
"""Paper is this much flatter where a pose is measured, not searched: what neighbouring samples
share of their errors looks like a bend, too."""

BLOOM_SPREAD_PX = 0.3
"""How far white grows over black, one standard deviation."""

BEND_SHARES = np.array([0.015, 0.0075, 0.015])
"""How far the paper of a face is from flat, as `bend_slides` takes it: one standard deviation, as a
share of the marker's side. Perspective, by which a lone face shows its lean, moves its cells in the
same way. Measured on the dodecahedron of `make bench-photographs`: each of its markers has a bend
of its own in all pictures, of up to 0.023."""

NO_ERROR = 1e-6
"""Standard deviation of what is known."""

MAX_STEPS, CONVERGED_PX, MAX_SLIDE_PX = 12, 0.03, 1.5
"""Steps at most, the length of the last, and from which length on the samples are placed again."""

MAX_SMALL_CELL_PX, MIN_SMALL_FACES = 3.0, 3
"""Cells smaller than this are rendered with fewer texels, and compared in fewer samples, where so
many faces are compared: their pose is not measured with more samples afterwards."""

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

    blur: float
    """Blur of the lens, one standard deviation [px]."""

    bloom: float
    """How far white has grown over black [px]."""

    k1: float
    """Radial distortion beyond that of the intrinsics, as far as this image tells it."""

    bends: Array
    """How each face of the cube is bent, as in `bend_slides`, (faces, 3) [m]."""

    correlations: dict[str, float]
    """Correlation of rendering and image on each face in view, −1…1."""

    cells: Indices
    """The cell inside the border of each sample, −1 for none, (N,)."""

    cell_count: int
    """How many such cells a face has."""

    evidence: Evidence
    """How much the image speaks for the pose."""

    residual: float
    """Standard deviation of the samples that fit, as a share of the contrast."""

    markers: DrawnMarkers
    """What was rendered, so that the next alignment need not render it again."""

    fit: PhotometricFit
    """The last step of the alignment."""

    prior: Array
    """Standard deviations of its unknowns beside the pose, (K,)."""

    @cached_property
    def inner(self) -> dict[str, float]:
        """As `correlations`, over the cells inside the border alone, which tell markers apart."""
        alike = self.fit.correlations_within(self.cells >= 0)
        return dict(zip(self.correlations, alike.tolist(), strict=True))

    @cached_property
    def wrong(self) -> dict[str, int]:
        """How many of these cells of each face are not as bright as they should be."""
        counts = self.fit.wrong_cells(self.cells, self.cell_count)
        return dict(zip(self.correlations, map(int, counts), strict=True))

    @cached_property
    def visible(self) -> dict[str, tuple[float, float]]:
        """Correlation over the samples that fit, and their share, of each face."""
        alike = self.fit.visible_correlations.tolist()
        return dict(zip(self.correlations, map(tuple, alike), strict=True))

    @cached_property
    def covariance(self) -> Array:
        """Of a pose delta, (6, 6), by the residuals."""
        return self.fit.covariance(self.prior)[:6, :6]


class StillAligner:
    """Aligns one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        sizes = (TEXELS_PER_CELL, COARSE_SAMPLES), (SMALL_TEXELS_PER_CELL, SMALL_SAMPLES)
        every = ((MarkerTextures(cube, texels), samples) for texels, samples in sizes)
        self._large, self._small = (
            (textures, SamplePlacer(cube, projection, textures.texel, samples))
            for textures, samples in every
        )
        self._placer = self._large[1]
        self._focal = float(projection.matrix[0, 0])
        self._k1_error = CLAIMED_K1 if projection.claims_no_distortion else NO_ERROR
        self._bend_errors = BEND_SHARES * cube.marker_size
        # The cells inside the border, as a share of the reach.
        self._cell = cell = cell_size(cube)
        self._inner = (cube.marker_size / 2 - cell) / self._placer.reach
        self._cells = round(cube.marker_size / cell) ** 2

    def align(
        self,
        patch: Patch,
        start: Array,
        faces: Collection[str] | None = None,
        blur: float = EXPECTED_BLUR_PX,
        steps: int = MAX_STEPS,
        markers: DrawnMarkers | None = None,
    ) -> StillAlignment | None:
        """Align from a pose, (4, 4), that is right to about half a cell; None if not in view.

        `faces` are those that are compared with the image, None for all that face the camera,
        `blur` the expected blur of the patch, one standard deviation [px], and `markers` what was
        rendered near this pose before.
        """
        flat = np.zeros((len(self._placer.faces.names), 3))
        begin = blur, 0.0, flat, markers
        return self._align(patch, start, faces, begin, steps, False, 1.0)

    def realign(
        self,
        patch: Patch,
        last: StillAlignment,
        faces: Collection[str] | None,
        steps: int = MAX_STEPS,
        fine: bool = False,
        stiffness: float = 1.0,
    ) -> StillAlignment | None:
        """Align from where another alignment ended; `fine` takes more samples: slower, better.

        Several faces tell their lean together, and are taken to be flat; with None for `faces`,
        they stay as bent as they were. Paper bends `stiffness` times less than `BEND_SHARES` say.
        """
        bends = last.bends * (faces is None or len(faces) == 1)
        begin = last.blur, last.k1, bends, last.markers
        return self._align(patch, last.camera_from_cube, faces, begin, steps, fine, stiffness)

    def _align(
        self,
        patch: Patch,
        start: Array,
        faces: Collection[str] | None,
        begin: tuple[float, float, Array, DrawnMarkers | None],
        steps: int,
        fine: bool,
        stiffness: float,
    ) -> StillAlignment | None:
        """Align from a pose with a blur, a k1, bends, and markers that were drawn before."""
        blur, k1, bends, markers = begin
        textures, placer = self._small if self._is_small(start, faces) else self._large
        expected, optics = np.array([blur**2, 0.0, 0.0]), np.array([blur**2, 0.0, k1])
        optics_errors = BLUR_SPREAD_PX2 + blur**2 / 4, BLOOM_SPREAD_PX, self._k1_error
        prior = np.array([*optics_errors, *self._bend_errors / stiffness])
        pose, moved, drawn = start, np.inf, blur**2
        if markers and 1 / REDRAW_RATIO < drawn / markers.variance < REDRAW_RATIO:
            drawn = markers.variance
        placed: PlacedSamples | None = None
        for _ in range(steps):
            if placed is None or moved > MAX_SLIDE_PX:
                placed = placer.place(patch, pose, faces, fine, bent=bool(bends.any()))
                if placed is None:
                    return None
            if not 1 / REDRAW_RATIO < optics[0] / drawn < REDRAW_RATIO:
                drawn = float(optics[0])
            markers = textures.draw(placed.facing, placed.texels_to_pixels, drawn, markers)
            texels = placer.texels(placed, pose, optics[2], bends)
            fit = _fit(placed, markers, texels, optics - (drawn, 0.0, 0.0))
            # The bend of a single face is estimated, too.
            lone = placed.facing[: len(placed.facing) == 1]
            off = np.concatenate([expected - optics, -bends[lone].ravel()])
            step = fit.step(off, prior[: len(off)])
            pose, moved = se3.apply_delta(pose, step[:6]), self._slide_px(pose, step)
            optics = optics + step[6:9]
            bends = bends.copy()
            bends[lone] += step[9:].reshape(-1, 3)
            optics[0] = np.clip(optics[0], max(MIN_BLUR_PX2, drawn / 2), 3 * drawn)
            if moved < CONVERGED_PX:
                break
        if placed is None or markers is None:
            return None
        return self._summary(pose, optics, bends, placed, fit, prior, markers, textures.texel)

    def _is_small(self, pose: Array, faces: Collection[str] | None) -> bool:
        """Whether fewer texels do: for many small faces, which determine their pose together."""
        if self._cell * self._focal > MAX_SMALL_CELL_PX * pose[2, 3]:
            return False
        facing = self._placer.faces.faces_towards(pose, MIN_FACING_COSINE)
        names = self._placer.faces.names
        return sum(faces is None or names[each] in faces for each in facing) >= MIN_SMALL_FACES

    def _slide_px(self, pose: Array, step: Array) -> float:
        """How far a step moves the image of a face at most [px]."""
        shift, turn = np.linalg.norm(step[:6].reshape(2, 3), axis=1)
        return float(shift + self._placer.reach * turn) * self._focal / float(pose[2, 3])

    def _summary(
        self,
        pose: Array,
        optics: Array,
        bends: Array,
        placed: PlacedSamples,
        fit: PhotometricFit,
        prior: Array,
        markers: DrawnMarkers,
        texel: float,
    ) -> StillAlignment:
        names = [self._placer.faces.names[number] for number in placed.facing]
        alike = np.nan_to_num(fit.correlations[1:])
        area = (
            np.abs(np.linalg.det(placed.texels_to_pixels)) * (2 * self._placer.reach / texel) ** 2
        )
        count = np.minimum(self._cells / CELLS_PER_MEASUREMENT, area / PIXELS_PER_MEASUREMENT)
        blocks = BLOCKS_PER_SIDE**2
        evidence = np.zeros((len(bends), blocks + BEND_BLOCKS))
        evidence[placed.facing, :blocks] = fit.block_evidence(blocks) * count[:, None] / blocks
        bent, seen = np.square(bends[placed.facing]), np.square(placed.bend_errors)[:, None]
        cost = (bent / (self._bend_errors**2 + seen)).sum(axis=1)
        evidence[placed.facing, blocks:] = -cost[:, None] / BEND_BLOCKS
        return StillAlignment(
            pose,
            float(np.sqrt(optics[0])),
            float(optics[1]),
            float(optics[2]),
            bends,
            dict(zip(names, alike.tolist(), strict=True)),
            *self._inner_cells(placed),
            Evidence(evidence, float((bent / self._bend_errors**2).sum())),
            fit.scale / max(fit.contrast, 1.0),
            markers,
            fit,
            prior[: fit.samples.jacobian.shape[1] - 6],
        )

    def _inner_cells(self, placed: PlacedSamples) -> tuple[Indices, int]:
        """Return the cell inside the border of each sample, −1 for none, and how many there are."""
        side = round(np.sqrt(self._cells)) - 2
        column, row = np.floor((placed.places.T / self._inner + 1) / 2 * side).astype(np.intp)
        inside = (np.minimum(column, row) >= 0) & (np.maximum(column, row) < side)
        return np.where(inside, row * side + column, -1), side**2


def _fit(
    placed: PlacedSamples, markers: DrawnMarkers, texels: Array, optics: Array
) -> PhotometricFit:
    """Render the markers with small changes of blur and bloom, and fit the light.

    `texels` are those under all samples, as `SamplePlacer.texels` returns them.
    """
    side = markers.layers.shape[-1]
    places = np.clip(texels + (side - 1) / 2, 0, side - 1)
    places[:, 1] += (np.arange(len(placed.facing)) * side)[:, None]
    x, y = places.astype(np.float32).transpose(1, 0, 2)
    texel, right, down, by_blur, by_bloom = (
        cv2.remap(each, x, y, cv2.INTER_LINEAR).ravel()[placed.used]
        for each in markers.layers.reshape(5, -1, side)
    )
    lone = len(placed.facing) == 1
    jacobian = np.empty((9 + 3 * lone, len(texel)))
    np.multiply(placed.slides[0], right, out=jacobian[:6])
    jacobian[:6] += placed.slides[1] * down
    by_k1 = placed.stretches[0] * right + placed.stretches[1] * down
    jacobian[6:9] = by_blur, by_bloom, by_k1
    if lone:
        assert placed.lifts is not None
        by_right, by_down = placed.lifts[0][..., placed.used]
        jacobian[9:] = by_right * right + by_down * down
    rendered = texel + optics[:2] @ jacobian[6:8]
    samples = PhotometricSamples(placed.face, placed.block, placed.values, rendered, jacobian.T)
    return fit_tones(samples, len(placed.facing), placed.places)
