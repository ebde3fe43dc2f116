"""Photometric alignment of a cube that moved while the shutter was open.

The picture of a moving cube is the mean of its pictures along the way. The printed faces are known,
so that mean can be drawn for any pose and any way, and both are moved until it is what the camera
saw: Gauss-Newton on twelve numbers, where the cube was in mid-exposure and how it moved during it.
The idea is ESM-Blur's (Park, Lepetit and Woo, 2009), for a whole cube, fingers, and a camera
whose response is not known.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.faces import FacePlanes, face_frame
from tracking.cube.marker import marker_cells
from tracking.cube.model import CubeModel
from tracking.geometry import se3
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import MIN_DEPTH, Projection
from tracking.refinement.alignment import Alignment
from tracking.refinement.face_images import FaceTextures
from tracking.refinement.photometric_fit import PhotometricFit, PhotometricSamples, fit

Array = NDArray[np.float64]
Image = NDArray[np.float32]

TEXELS = 8
"""Texels of the drawing on each cell of a marker."""

COARSE, FINE = 12, 16
"""Samples on each side of a face in the two searches: fewer miss edges."""

LENS = 0.85
"""Blur of a lens in focus with its pixels [px], one standard deviation."""

RIM = 1.5
"""Samples nearer than so many blurs to the border of their face are left out: what lies beyond is
not known."""

BLOCKS = 5
"""Blocks of samples on each side of a face, which count as one measurement each."""

MOMENTS = (5, 15)
"""Moments of the way that the drawn mean is made of, at least and at most."""

STRIDE = 0.22
"""How far an edge may go from one moment to the next [cells]: less than it is blurred anyway."""

SOFT, SHARP = 0.5, 0.15
"""Blur of drawing and picture in the coarse search and in the fine one [cells]."""

STAGES = ((SOFT, COARSE, 4), (SHARP, FINE, 4))
"""Blur, samples and rounds of the coarse search and of the fine one."""

GRAZING = 0.12
"""Cosine of the viewing angle below which a face shows too little of its picture."""

SETTLED = np.repeat([1.5e-4, 1e-3], 3)
"""A step smaller than this is the last [m, rad]."""

FEWEST = 40
"""Fewer samples than this do not make a pose."""


class MotionBlurAligner:
    """Aligns one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._projection = projection
        self._cell = cube.marker_size / len(marker_cells(cube.dictionary, cube.faces[0].marker_id))
        self._half = cube.edge / 2
        self._frames = np.stack([face_frame(face) for face in cube.faces])
        side = round(cube.edge / self._cell * TEXELS)
        self._side = side
        self._drawing = FaceTextures(cube, side)
        self._grids = {count: _grid(count, cube.edge) for count in (COARSE, FINE)}

    def align(
        self, patch: Patch, start: Array, sweep: Array, prior: Array, coarse: bool = True
    ) -> Alignment | None:
        """Align from a pose that is right to about a cell in the picture.

        Parameters
        ----------
        patch
            The picture round the cube.
        start
            Pose of the cube in mid-exposure, (4, 4).
        sweep
            Shift-turn while the shutter was open, (6,), as it is expected.
        prior
            Standard deviations of that expectation, (6,).
        coarse
            Whether to search with both pictures much blurred first.

        Returns
        -------
        None where the cube is not in view.
        """
        pose, way = start, sweep
        last: tuple[_Scene, PhotometricFit, Array, Array] | None = None
        for blur, count, rounds in STAGES if coarse else STAGES[1:]:
            scene = self._scene(patch, pose, blur, count)
            if scene is None:
                return None
            for _ in range(rounds):
                mixture = self._mixture(scene, pose, way)
                if mixture is None:
                    return None
                step = mixture.step(sweep - way, prior)
                last = scene, mixture, way, step
                pose, way = se3.moved(pose, step[:6]), way + step[6:]
                if (np.abs(step[:6]) < SETTLED).all():
                    break
        return self._finished(pose, way, prior, *last) if last else None

    def _finished(
        self,
        pose: Array,
        way: Array,
        prior: Array,
        scene: "_Scene",
        mixture: PhotometricFit,
        before: Array,
        step: Array,
    ) -> Alignment:
        whole, *each = mixture.likeness.tolist()
        named = zip(scene.facing, each, strict=True)
        return Alignment(
            pose,
            way,
            mixture.covariance(prior),
            mixture.told(before, step, prior),
            whole,
            {self._faces.names[face]: share for face, share in named if not np.isnan(share)},
            mixture.scale / max(mixture.contrast, 1.0),
            *mixture.tones,
        )

    def _scene(self, patch: Patch, pose: Array, blur: float, count: int) -> "_Scene | None":
        """Choose the samples, read the picture there, and say how the faces slide under them."""
        facing = np.array(self._faces.facing(pose, GRAZING), np.intp)
        if not len(facing):
            return None
        frames = pose @ self._frames[facing]
        points = frames[:, :3] @ self._grids[count]
        if points[:, 2].min() < MIN_DEPTH:
            return None
        flat = points.transpose(0, 2, 1).reshape(-1, 3)
        pixels = self._projection.project(flat)
        sigma = blur * self._cell * float(self._projection.matrix[0, 0]) / pose[2, 3]
        smooth = sigma > LENS
        seen = patch.smoothed(sigma) if smooth else patch
        values = seen.at(pixels[:, None])[:, 0].astype(np.float64)
        soft = np.hypot(sigma if smooth else 0.0, LENS)
        layers, rim = self._drawing.blurred(facing, self._texels_to_pixels(frames), soft)
        rays = points / points[:, 2:]
        slides = self._slides(frames[:, :3, :2], points - pose[:3, 3, None], rays)
        inside = patch.room(pixels) > 1
        return _Scene(facing, rays, slides, values, inside, layers, RIM * rim, count)

    def _texels_to_pixels(self, frames: Array) -> Array:
        """How the picture of each face moves with its texels at its centre, (faces, 2, 2) [px]."""
        centres = frames[:, :3, 3]
        _, slopes = self._projection.project_with_jacobian(np.ascontiguousarray(centres))
        return np.asarray(slopes @ frames[:, :3, :2] * (2 * self._half / self._side), np.float64)

    def _mixture(self, scene: "_Scene", pose: Array, way: Array) -> PhotometricFit | None:
        """Draw the cube along its way, and fit the drawing's tones to the picture."""
        when = self._moments(way)
        poses = se3.along(pose, way, when)
        texture, inside = self._looked_up(scene, *self._on_faces(scene, poses))
        use = np.flatnonzero(inside & scene.inside)
        if len(use) < FEWEST:
            return None
        # The mean along the way, and weighted by the time; with them go their slopes.
        weights = np.stack([np.ones(len(when)), when]).astype(np.float32) / len(when)
        means = (weights @ texture.reshape(len(when), -1)).reshape(2, -1, 3)[:, use]
        slides = scene.slides[use]
        slopes = [
            mean[:, 1, None] * slides[:, 0] + mean[:, 2, None] * slides[:, 1] for mean in means
        ]
        number, place = np.divmod(use, scene.count**2)
        row, column = np.divmod(place, scene.count)
        block = (number * BLOCKS + row * BLOCKS // scene.count) * BLOCKS
        block += column * BLOCKS // scene.count
        drawn = means[0, :, 0].astype(np.float64)
        samples = PhotometricSamples(
            number, block, scene.values[use], drawn, np.concatenate(slopes, axis=1)
        )
        return fit(samples, len(scene.facing))

    def _moments(self, way: Array) -> Array:
        """Moments of the exposure, each in the middle of its share, −0.5…0.5."""
        far = float(np.linalg.norm(way[:3])) + self._half * float(np.linalg.norm(way[3:]))
        count = int(np.clip(np.ceil(far / (STRIDE * self._cell)), *MOMENTS))
        return (np.arange(count) + 0.5) / count - 0.5

    def _on_faces(self, scene: "_Scene", poses: Array) -> tuple[Array, Array]:
        """Where the samples' rays meet their faces, each (moments, faces, N) [m]."""
        planes = (poses[:, None] @ self._frames[scene.facing])[..., :3, [0, 1, 3]]
        met = np.linalg.inv(planes) @ scene.rays
        return met[:, :, 0] / met[:, :, 2], met[:, :, 1] / met[:, :, 2]

    def _looked_up(self, scene: "_Scene", u: Array, v: Array) -> tuple[Image, NDArray[np.bool_]]:
        """Read the drawing and its gradient; say which samples stay on their face all the way."""
        size, half = self._side, self._half
        inside = np.maximum(np.abs(u), np.abs(v)) < half - scene.rim[:, None]
        inside = inside.all(axis=0).ravel()
        scale = size / (2 * half)
        x = np.clip((u + half) * scale - 0.5, 0, size - 1).astype(np.float32)
        y = np.clip((v + half) * scale - 0.5, 0, size - 1).astype(np.float32)
        y += (np.arange(len(scene.facing), dtype=np.float32) * size)[:, None]
        count = len(u)
        read = cv2.remap(scene.layers, x.reshape(count, -1), y.reshape(count, -1), cv2.INTER_LINEAR)
        return np.asarray(read, np.float32), inside

    def _slides(self, axes: Array, arm: Array, rays: Array) -> Array:
        """How a face slides under each sample's ray with a shift-turn, (faces · N, 2, 6) [texels].

        A point X = (x Z, y Z, Z) of the face moves by Ẋ; what is under the ray afterwards lies at
        u̇ = −B⁻¹ ẋ on the face, with ẋ = (Ẋ − x Ż)/Z, and B how x moves with u.

        Parameters
        ----------
        axes
            Axes of the faces, (faces, 3, 2).
        arm
            From the cube's origin to the samples, (faces, 3, N) [m].
        rays
            The samples' rays, (faces, 3, N).
        """
        x, y = rays[:, 0], rays[:, 1]
        a, b = (axes[:, 0, n, None] - x * axes[:, 2, n, None] for n in (0, 1))
        c, d = (axes[:, 1, n, None] - y * axes[:, 2, n, None] for n in (0, 1))
        scale = -(self._side / (2 * self._half)) / (a * d - b * c)
        by_shift = np.stack(
            [d * scale, -b * scale, (b * y - d * x) * scale,
             -c * scale, a * scale, (c * x - a * y) * scale], axis=2
        ).reshape(-1, 2, 3)  # fmt: skip
        arms = arm.transpose(0, 2, 1).reshape(-1, 1, 3)
        return np.concatenate([by_shift, np.cross(arms, by_shift)], axis=2)


@dataclass(frozen=True)
class _Scene:
    """The samples of one picture."""

    facing: NDArray[np.intp]
    rays: Array
    slides: Array
    values: Array
    inside: NDArray[np.bool_]
    layers: Image
    rim: Array
    count: int


def _grid(count: int, edge: float) -> Array:
    """Lay points on a face in its own frame, as columns of (x, y, 0, 1), (4, count²)."""
    steps = ((np.arange(count) + 0.5) / count - 0.5) * edge
    x, y = np.meshgrid(steps, steps)
    return np.stack([x.ravel(), y.ravel(), np.zeros(count**2), np.ones(count**2)])
