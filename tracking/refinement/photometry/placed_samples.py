"""Samples on the markers in view, and how pose, lens and bent paper move what each shows."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.faces import FacePlanes, face_frame
from cubeling.tracking.cube.marker import cell_size
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Indices
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection, radial_bend
from cubeling.tracking.refinement.photometry.texels import (
    SampleGrid,
    bend_slides,
    texel_slides,
    texels_to_pixels,
)

MARGIN_CELLS, PAPER_SHARE = 1.0, 0.8
"""How far around a marker its paper is compared [cells], and at most which share of the paper."""

COARSE_SAMPLES, FINE_SAMPLES, BLOCKS_PER_SIDE = 24, 48, 6
"""Samples along each side of a marker with that paper, in a search and to measure, and blocks, each
one measurement."""

SMALL_SAMPLES = 18
"""Samples instead of `COARSE_SAMPLES` where a picture has about as many pixels there."""

MIN_SAMPLES = 60
"""Fewer samples in view than this do not determine a pose."""

CELL_ERROR_PX = 0.2
"""How far light, blur and the lens's errors move the cells of a small marker as a bend does, one
standard deviation. Measured on the boards of `make bench-photographs`."""

MIN_FACING_COSINE = 0.15
"""Cosine of the viewing angle below which a face shows too little of its marker."""


@dataclass(frozen=True)
class PlacedSamples:
    """Samples on the faces in view of one pose, and what the image shows there."""

    facing: Indices
    """Indices of the faces in view, (faces,)."""

    used: Indices | slice
    """Indices of the samples in the image, (N,), or a slice where all are."""

    values: Array
    """Light in the image, (N,)."""

    rays: Array
    """Rays of all samples at z = 1, (faces, 3, samples)."""

    by_k1: Array
    """How k1 moves these rays beside that of the cube's centre, (faces, 2, samples)."""

    slides: Array
    """How the texel under each ray moves by a pose delta, (2, 6, N) [texels]."""

    stretches: Array
    """How it moves by the radial distortion k1, (2, N) [texels]."""

    lifts: Array | None
    """How the texels of all samples move by the bends of their faces, (faces, 2, 3, samples); None
    where several flat ones are compared."""

    bend_errors: Array
    """How bent each face seems where its cells are moved by `CELL_ERROR_PX`, (faces,) [m]."""

    texels_to_pixels: Array
    """Jacobian of the image by the texels of each face, (faces, 2, 2)."""

    face: Indices
    """Index of the face of each sample among those in view, (N,)."""

    block: Indices
    """Index of the block of each sample, (N,)."""

    places: Array
    """Place of each sample on its face, −1…1, (N, 2)."""


class SamplePlacer:
    """Places samples on the markers of one cube seen by one camera, with texels of a size [m].

    In a search there are `samples` of them along each side of a marker with its paper.
    """

    def __init__(
        self, cube: CubeModel, projection: Projection, texel: float, samples: int = COARSE_SAMPLES
    ) -> None:
        self.faces = FacePlanes(cube)
        """The faces, whose indices are those of `PlacedSamples.facing`."""
        self.texel = texel
        """Size of a texel [m]."""
        paper = PAPER_SHARE * (cube.white - cube.marker_size) / 2
        self.reach = cube.marker_size / 2 + min(MARGIN_CELLS * cell_size(cube), paper)
        """How far from the middle of a face there are samples [m]."""
        self._projection = projection
        self._frames = np.stack([face_frame(face) for face in cube.faces])
        self._coarse, self._fine = (
            SampleGrid(count, self.reach, BLOCKS_PER_SIDE) for count in (samples, FINE_SAMPLES)
        )

    def place(
        self, patch: Patch, pose: Array, faces: Collection[str] | None, fine: bool, bent: bool
    ) -> PlacedSamples | None:
        """Place samples on `faces`, or on all, that look at the camera at a pose, (4, 4).

        None where too few of them are in the patch. `fine` takes more samples. `bent` is whether
        several faces are taken to be bent; a single one always may be.
        """
        grid = self._fine if fine else self._coarse
        names = self.faces.names
        facing = np.array(
            [
                number
                for number in self.faces.faces_towards(pose, MIN_FACING_COSINE)
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
        rays = points / points[:, 2:]
        slides = texel_slides(frames, points - pose[:3, 3, None], rays, self.texel)
        flat = rays[:, :2].transpose(0, 2, 1)
        by_k1 = radial_bend(flat) - radial_bend(pose[:2, 3] / pose[2, 3])
        by_k1 = by_k1.transpose(0, 2, 1)
        x, y = (points[:, 2] * by_k1.transpose(1, 0, 2)).reshape(2, -1)
        stretches = x * slides[:, 0] + y * slides[:, 1]
        lifts = None
        if bent or len(facing) == 1:
            lifts = bend_slides(frames, rays, grid.places) / self.texel
        to_pixels = texels_to_pixels(self._projection, frames, self.texel)
        ray = np.linalg.inv(frames)[:, :3, 3]
        moved = (to_pixels / self.texel @ (ray[:, :2] / ray[:, 2:])[..., None])[..., 0]
        bend_errors = CELL_ERROR_PX / np.maximum(np.linalg.norm(moved, axis=1), 1e-6)
        face, place, block = grid.locate(used)
        chosen = slice(None) if len(used) == len(pixels) else used
        return PlacedSamples(
            facing, chosen, values, rays, by_k1, slides[..., chosen], stretches[:, chosen], lifts,
            bend_errors, to_pixels, face, block, grid.places[place],
        )  # fmt: skip

    def texels(self, placed: PlacedSamples, pose: Array, k1: float, bends: Array) -> Array:
        """Texels under all samples at a pose, from the middle of each face, (faces, 2, samples).

        `k1` is the radial distortion beyond that of the intrinsics, `bends` those of all faces,
        (cube's faces, 3) [m].
        """
        planes = (pose @ self._frames[placed.facing])[:, :3, [0, 1, 3]]
        rays = placed.rays
        if k1:
            rays = np.concatenate([rays[:, :2] - k1 * placed.by_k1, rays[:, 2:]], axis=1)
        met = np.linalg.inv(planes) @ rays
        found = met[:, :2] / met[:, 2:] / self.texel
        if placed.lifts is not None and bends[placed.facing].any():
            found += np.einsum("fdks,fk->fds", placed.lifts, bends[placed.facing])
        return np.asarray(found, np.float64)
