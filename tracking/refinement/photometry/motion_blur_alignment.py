"""Photometric alignment of a cube that moved while the shutter was open.

The image of a moving cube is the mean of its images along the motion, rendered here from the known
faces. Gauss-Newton adjusts the pose in the middle of the exposure and the motion during it until
the rendering matches the image. The idea is ESM-Blur's (Park, Lepetit and Woo, 2009), extended to a
whole cube, to fingers, and to a camera whose tone curve is not known.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.cube.faces import FacePlanes, face_frame
from cubeling.tracking.cube.marker import black_texels, cell_size, marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Flags, Floats, Indices
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection
from cubeling.tracking.refinement.photometry.photometric_fit import (
    Alignment,
    PhotometricFit,
    PhotometricSamples,
    fit_tones,
)
from cubeling.tracking.refinement.photometry.texels import (
    SampleGrid,
    frequencies,
    texel_slides,
    texels_to_pixels,
)

TEXELS_PER_CELL = 8
"""Texels of a face texture along a cell of its marker."""

COARSE_SAMPLES, FINE_SAMPLES = 12, 16
"""Samples along each side of a face in the two searches: fewer miss edges."""

LENS_BLUR_PX = 0.85
"""Blur of a focused lens and of the pixels themselves, one standard deviation."""

MIN_BORDER_BLURS = 1.5
"""Samples lie at least this many standard deviations of the blur inside their face."""

BLOCKS_PER_SIDE = 5
"""Blocks of samples along each side of a face. Each block counts as one measurement."""

MIN_MOMENTS, MAX_MOMENTS, MOMENT_STEP_CELLS = 5, 15, 0.22
"""Number of moments of the exposure whose mean is rendered, and how far an edge may move from one
to the next: less than it is blurred anyway."""

SEARCH_STAGES = ((0.5, COARSE_SAMPLES, 4), (0.15, FINE_SAMPLES, 4))
"""Of the coarse search and of the fine one: blur of rendering and image [cells], samples, steps."""

MIN_FACING_COSINE = 0.12
"""Cosine of the viewing angle below which a face shows too little of its texture."""

CONVERGED_STEP = np.repeat([1.5e-4, 1e-3], 3)
"""A step smaller than this is the last one [m, rad]."""

MIN_SAMPLES = 40
"""Fewer samples than this do not determine a pose."""


class MotionBlurAligner:
    """Aligns one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._projection = projection
        self._cell = cell_size(cube)
        self._half = cube.white / 2
        self._frames = np.stack([face_frame(face) for face in cube.faces])
        side = round(cube.white / self._cell * TEXELS_PER_CELL)
        self._side = side
        self._textures = FaceTextures(cube, side)
        self._grids = {
            count: SampleGrid(count, self._half, BLOCKS_PER_SIDE) for _, count, _ in SEARCH_STAGES
        }

    def align(
        self, patch: Patch, start: Array, blur_motion: Array, prior: Array, coarse: bool = True
    ) -> Alignment | None:
        """Align from a pose, (4, 4), that is right to about a cell; None if it is not in view.

        `blur_motion` is the expected pose delta during the exposure, (6,), with the standard
        deviations `prior`, (6,). `coarse` searches with image and rendering much blurred first.
        """
        pose, motion = start, blur_motion
        last: tuple[_Samples, PhotometricFit, Array, Array] | None = None
        for blur, count, steps in SEARCH_STAGES if coarse else SEARCH_STAGES[1:]:
            samples = self._sample(patch, pose, blur, count)
            if samples is None:
                return None
            for _ in range(steps):
                fit = self._fit(samples, pose, motion)
                if fit is None:
                    return None
                step = fit.step(blur_motion - motion, prior)
                last = samples, fit, motion, step
                pose, motion = se3.apply_delta(pose, step[:6]), motion + step[6:]
                if (np.abs(step[:6]) < CONVERGED_STEP).all():
                    break
        return self._alignment(pose, motion, prior, *last) if last else None

    def _alignment(
        self,
        pose: Array,
        motion: Array,
        prior: Array,
        samples: "_Samples",
        fit: PhotometricFit,
        before: Array,
        step: Array,
    ) -> Alignment | None:
        """Return what was found; None if no face is in view with enough of its samples."""
        overall, *each = fit.correlations.tolist()
        seen = [pair for pair in zip(samples.facing, each, strict=True) if not np.isnan(pair[1])]
        if not seen:
            return None
        return Alignment(
            pose,
            motion,
            fit.covariance(prior),
            fit.motion_information(before, step, prior),
            overall,
            {self._faces.names[face]: value for face, value in seen},
            fit.scale / max(fit.contrast, 1.0),
            *fit.mixture_tones,
        )

    def _sample(self, patch: Patch, pose: Array, blur: float, count: int) -> "_Samples | None":
        """Place the samples, read the image there, and differentiate their places on the faces."""
        facing = np.array(self._faces.faces_towards(pose, MIN_FACING_COSINE), np.intp)
        if not len(facing):
            return None
        frames = pose @ self._frames[facing]
        points = frames[:, :3] @ self._grids[count].points
        if points[:, 2].min() < MIN_DEPTH:
            return None
        flat = points.transpose(0, 2, 1).reshape(-1, 3)
        pixels = self._projection.project(flat)
        sigma = blur * self._cell * float(self._projection.matrix[0, 0]) / pose[2, 3]
        smooth = sigma > LENS_BLUR_PX
        seen = patch.smooth(sigma) if smooth else patch
        values = seen.sample(pixels[:, None])[:, 0].astype(np.float64)
        blurred = np.hypot(sigma if smooth else 0.0, LENS_BLUR_PX)
        texel = 2 * self._half / self._side
        to_pixels = texels_to_pixels(self._projection, frames, texel)
        layers, widest = self._textures.blur(facing, to_pixels, blurred)
        rays = points / points[:, 2:]
        slides = texel_slides(frames, points - pose[:3, 3, None], rays, texel)
        inside = patch.border_distance(pixels) > 1
        border = MIN_BORDER_BLURS * widest
        return _Samples(facing, rays, slides, values, inside, layers, border, count)

    def _fit(self, samples: "_Samples", pose: Array, motion: Array) -> PhotometricFit | None:
        """Render the cube along its motion, and fit the tones of the rendering to the image."""
        when = self._moments(motion)
        poses = se3.along(pose, motion, when)
        texture, inside = self._look_up(samples, *self._on_faces(samples, poses))
        use = np.flatnonzero(inside & samples.inside)
        if len(use) < MIN_SAMPLES:
            return None
        # The mean over time, and the mean weighted by time, each with its derivatives.
        weights = np.stack([np.ones(len(when)), when]).astype(np.float32) / len(when)
        means = (weights @ texture.reshape(len(when), -1)).reshape(2, -1, 3)[:, use]
        right, down = samples.slides[..., use]
        jacobian = [mean[:, 1] * right + mean[:, 2] * down for mean in means]
        face, _, block = self._grids[samples.count].locate(use)
        rendered = means[0, :, 0].astype(np.float64)
        values, by_motion = samples.values[use], np.concatenate(jacobian).T
        mixture = PhotometricSamples(face, block, values, rendered, by_motion)
        return fit_tones(mixture, len(samples.facing))

    def _moments(self, motion: Array) -> Array:
        """Moments of the exposure, each in the middle of its share, −0.5…0.5."""
        far = float(np.linalg.norm(motion[:3])) + self._half * float(np.linalg.norm(motion[3:]))
        steps = np.ceil(far / (MOMENT_STEP_CELLS * self._cell))
        count = int(np.clip(steps, MIN_MOMENTS, MAX_MOMENTS))
        return (np.arange(count) + 0.5) / count - 0.5

    def _on_faces(self, samples: "_Samples", poses: Array) -> tuple[Array, Array]:
        """Return where the samples' rays meet their faces, each (moments, faces, N) [m]."""
        planes = (poses[:, None] @ self._frames[samples.facing])[..., :3, [0, 1, 3]]
        met = np.linalg.inv(planes) @ samples.rays
        return met[:, :, 0] / met[:, :, 2], met[:, :, 1] / met[:, :, 2]

    def _look_up(self, samples: "_Samples", u: Array, v: Array) -> tuple[Floats, Flags]:
        """Read the textures with their gradients; tell which samples always stay on their face."""
        size, half = self._side, self._half
        inside = np.maximum(np.abs(u), np.abs(v)) < half - samples.border[:, None]
        inside = inside.all(axis=0).ravel()
        scale = size / (2 * half)
        x = np.clip((u + half) * scale - 0.5, 0, size - 1).astype(np.float32)
        y = np.clip((v + half) * scale - 0.5, 0, size - 1).astype(np.float32)
        y += (np.arange(len(samples.facing), dtype=np.float32) * size)[:, None]
        x, y = x.reshape(len(u), -1), y.reshape(len(u), -1)
        read = cv2.remap(samples.layers, x, y, cv2.INTER_LINEAR)
        return np.asarray(read, np.float32), inside


@dataclass(frozen=True)
class _Samples:
    """Where an image is compared with its rendering."""

    facing: Indices
    """Indices of the faces in view, (faces,)."""

    rays: Array
    """Rays of the samples at z = 1, (faces, 3, N)."""

    slides: Array
    """As `texel_slides` returns them, (2, 6, faces · N)."""

    values: Array
    """Light of the image, (faces · N,)."""

    inside: Flags
    """Whether each sample is inside the image, (faces · N,)."""

    layers: Floats
    """Blurred textures of the faces with their derivatives, (faces · side, side, 3)."""

    border: Array
    """Width of the border of each face that is left out, (faces,) [m]."""

    count: int
    """Samples along each side of a face."""


class FaceTextures:
    """Textures of all faces of a cube, `side` texels wide, from black 0 to white 1."""

    def __init__(self, cube: CubeModel, side: int) -> None:
        self._texel = cube.white / side
        self._side = side
        textures = np.stack([_texture(cube, face, side) for face in range(len(cube.faces))])
        self._spectra = np.fft.rfft2(textures).astype(np.complex64)
        self._x, self._y, slopes = frequencies(side)
        self._derivatives = np.stack([np.ones_like(slopes[0]), *slopes]).astype(np.complex64)

    def blur(self, faces: Indices, texels_to_pixels: Array, sigma: float) -> tuple[Floats, Array]:
        """Blur faces by a Gaussian that is round in the camera's image, not on the paper.

        `texels_to_pixels` is the Jacobian of the image by the texels of each face, (faces, 2, 2),
        and `sigma` the standard deviation [px]. Their white borders let the blur wrap around.

        Return the faces below each other, each texel with its derivatives to the right and down,
        (faces · side, side, 3), and the largest standard deviation on each face, (faces,) [m].
        """
        spread = np.linalg.inv(texels_to_pixels)
        spread = sigma**2 * spread @ spread.transpose(0, 2, 1)
        xx, xy, yy = (spread[:, i, j, None, None] for i, j in ((0, 0), (0, 1), (1, 1)))
        power = xx * self._x**2 + 2 * xy * self._x * self._y + yy * self._y**2
        gauss = np.exp(-power / 2).astype(np.float32)
        spectra = (self._spectra[faces] * gauss)[:, None] * self._derivatives
        textures = np.fft.irfft2(spectra, s=(self._side, self._side))
        layers = textures.transpose(0, 2, 3, 1).reshape(-1, self._side, 3)
        widest = np.sqrt(np.linalg.eigvalsh(spread)[:, -1]) * self._texel
        return np.ascontiguousarray(layers, np.float32), widest


def _texture(cube: CubeModel, face: int, side: int) -> Floats:
    """Draw a face, 1 white and 0 black, (side, side)."""
    fine = 4
    cells = marker_cells(cube.dictionary, cube.faces[face].marker_id)
    white = 1 - black_texels(cube, cells, side * fine, cube.white).astype(np.float32)
    return np.asarray(cv2.resize(white, (side, side), interpolation=cv2.INTER_AREA), np.float32)
