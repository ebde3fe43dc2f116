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

from tracking import se3
from tracking.cube import CubeModel
from tracking.faces import Faces, face_frame
from tracking.marker import marker_cells
from tracking.patch import Patch
from tracking.robust import quantile
from tracking.projection import NEAREST, Projection

Array = NDArray[np.float64]
Image = NDArray[np.float32]

TEXELS = 8
"""Texels of the drawing on each cell of a marker."""

GRID = 16
"""Samples on each side of a face."""

MOMENTS = 7
"""Moments of the way that the drawn mean is made of."""

SOFT, SHARP = 0.55, 0.12
"""Blur of drawing and picture in the coarse search and in the fine one [cells]."""

WHEN = np.linspace(-0.5, 0.5, MOMENTS)
"""The moments, as shares of the exposure."""

MEANS = np.stack([np.ones(MOMENTS), WHEN]).astype(np.float32) / MOMENTS
"""Weights of the moments in the mean, and in the mean weighted by time."""

GRAZING = 0.25
"""Cosine of the viewing angle below which a face shows too little of its picture."""

SETTLED = (5e-5, 5e-4)
"""A step smaller than this is the last [m, rad]."""

FEWEST = 120
"""Fewer samples than this do not make a pose."""


@dataclass(frozen=True)
class Alignment:
    """A pose and a motion that explain a blurred picture."""

    camera_from_cube: Array
    """Pose of the cube in mid-exposure, (4, 4) [m]."""

    sweep: Array
    """Shift-turn of the cube while the shutter was open, (6,)."""

    covariance: Array
    """Of a shift-turn of the pose and then of the sweep, (12, 12)."""

    likeness: float
    """Correlation of the drawn and the seen picture, −1…1, over all samples that were in view."""

    residual: float
    """Root mean square difference of the samples that fit, as a share of the contrast."""

    support: float
    """Share of the samples in view that fit."""

    shares: dict[str, float]
    """Correlation for each face in view."""


class SweptAligner:
    """Aligns one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = Faces(cube)
        self._projection = projection
        self._cell = cube.marker_size / len(marker_cells(cube.dictionary, cube.faces[0].marker_id))
        self._half = cube.edge / 2
        self._frames = np.stack([face_frame(face) for face in cube.faces])
        side = round(cube.edge / self._cell * TEXELS)
        self._side = side
        drawing = [_drawn(cube, number, side) for number in range(len(cube.faces))]
        self._layers = {blur: _layers(drawing, blur * TEXELS) for blur in (SOFT, SHARP)}
        steps = ((np.arange(GRID) + 0.5) / GRID - 0.5) * cube.edge
        grid = np.stack(np.meshgrid(steps, steps), axis=2).reshape(-1, 2)
        flat = np.concatenate([grid, np.zeros((len(grid), 1)), np.ones((len(grid), 1))], 1)
        self._grid = np.ascontiguousarray(flat.T)

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
        pose, way, result = start, sweep, None
        for blur, rounds in ((SOFT, 4), (SHARP, 4)) if coarse else ((SHARP, 3),):
            scene = self._scene(patch, pose, blur)
            if scene is None:
                return None
            for _ in range(rounds):
                result = self._step(scene, pose, way, sweep, prior)
                if result is None:
                    return None
                moved = se3.motion(pose, result.camera_from_cube)
                pose, way = result.camera_from_cube, result.sweep
                if np.abs(moved[:3]).max() < SETTLED[0] and np.abs(moved[3:]).max() < SETTLED[1]:
                    break
        return result

    def _scene(self, patch: Patch, pose: Array, blur: float) -> "_Scene | None":
        """Choose the samples, read the picture there, and say how the faces slide under them."""
        facing = np.array(self._faces.facing(pose, GRAZING), np.intp)
        if not len(facing):
            return None
        frames = pose @ self._frames[facing]
        points = frames[:, :3] @ self._grid
        if points[:, 2].min() < NEAREST:
            return None
        flat = points.transpose(0, 2, 1).reshape(-1, 3)
        pixels = self._projection.pixels(flat)
        sigma = blur * self._cell * float(self._projection.matrix[0, 0]) / pose[2, 3]
        seen = patch.smoothed(sigma) if sigma > 0.8 else patch
        values = seen.at(pixels[:, None])[:, 0].astype(np.float64)
        rays = points / points[:, 2:]
        slides = self._slides(frames[:, :3, :2], points - pose[:3, 3, None], rays)
        inside = patch.room(pixels) > 1
        return _Scene(facing, rays, slides, values, inside, self._layers[blur])

    def _step(
        self, scene: "_Scene", pose: Array, way: Array, expected: Array, prior: Array
    ) -> Alignment | None:
        poses = np.stack([se3.moved(pose, moment * way) for moment in WHEN])
        texture, inside = self._looked_up(scene, *self._on_faces(scene, poses))
        use = np.flatnonzero(inside & scene.inside)
        if len(use) < FEWEST:
            return None
        # The mean along the way; its slopes, plain and weighted by the time.
        means = (MEANS @ texture.reshape(len(WHEN), -1)).reshape(2, -1, 3)[:, use]
        slides = scene.slides[use]
        still, moving = (
            mean[:, 1, None] * slides[:, 0] + mean[:, 2, None] * slides[:, 1] for mean in means
        )
        number = use // self._grid.shape[1]
        return self._solved(
            scene,
            number,
            scene.values[use],
            means[0, :, 0],
            still,
            moving,
            pose,
            way,
            expected,
            prior,
        )

    def _on_faces(self, scene: "_Scene", poses: Array) -> tuple[Array, Array]:
        """Where the samples' rays meet their faces, each (moments, faces, N) [m]."""
        planes = (poses[:, None] @ self._frames[scene.facing])[..., :3, [0, 1, 3]]
        met = np.linalg.inv(planes) @ scene.rays
        return met[:, :, 0] / met[:, :, 2], met[:, :, 1] / met[:, :, 2]

    def _looked_up(self, scene: "_Scene", u: Array, v: Array) -> tuple[Image, NDArray[np.bool_]]:
        """Read the drawing and its gradient; say which samples stay on their face all the way."""
        size, half = self._side, self._half
        inside = (np.maximum(np.abs(u), np.abs(v)) < half).all(axis=0).ravel()
        scale = size / (2 * half)
        places = np.empty((*u.shape, 2), np.float32)
        places[..., 0] = np.clip((u + half) * scale - 0.5, 0, size - 1)
        places[..., 1] = np.clip((v + half) * scale - 0.5, 0, size - 1)
        places[..., 1] += (scene.facing * size)[:, None]
        flat = places.reshape(len(u), -1, 2)
        return np.asarray(cv2.remap(scene.layers, flat, None, cv2.INTER_LINEAR), np.float32), inside

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

    def _solved(
        self,
        scene: "_Scene",
        number: NDArray[np.intp],
        seen: Array,
        drawn: Array,
        still: Array,
        moving: Array,
        pose: Array,
        way: Array,
        expected: Array,
        prior: Array,
    ) -> Alignment | None:
        faces = len(scene.facing)
        light = (number[:, None] == np.arange(faces)).astype(np.float64)
        tone = np.concatenate([light, light * drawn[:, None], (drawn * (1 - drawn))[:, None]], 1)
        weights, robust = np.ones(len(seen)), np.ones(len(seen))
        gain = np.linalg.lstsq(tone, seen, rcond=None)[0]
        for _ in range(3):
            weighted = tone * robust[:, None]
            gain = np.linalg.solve(
                weighted.T @ tone + np.eye(tone.shape[1]) * 1e-3, weighted.T @ seen
            )
            residual = seen - tone @ gain
            scale = 1.4826 * float(quantile(np.abs(residual), 0.5)) + 0.5
            robust = 1 / (1 + (residual / (2.0 * scale)) ** 2) ** 2
        strength = (gain[faces : 2 * faces][number] + gain[-1] * (1 - 2 * drawn))[:, None]
        rows = np.concatenate([still * strength, moving * strength, tone], axis=1)
        weighted = rows * (robust / scale**2)[:, None]
        normal = weighted.T @ rows
        normal[:6, :6] += np.eye(6) * 1e-6
        normal[6:12, 6:12] += np.diag(1 / prior**2)
        normal[12:, 12:] += np.eye(tone.shape[1]) * 1e-3 / scale**2
        right = weighted.T @ residual
        right[6:12] += (expected - way) / prior**2
        step = np.linalg.solve(normal, right)
        covariance = np.linalg.inv(normal)[:12, :12]
        contrast = float(np.median(gain[faces : 2 * faces]))
        shares = {}
        for face in range(faces):
            of = number == face
            if np.count_nonzero(of) > 30:
                shares[self._faces.names[scene.facing[face]]] = _correlation(
                    seen[of], (tone @ gain)[of]
                )
        return Alignment(
            se3.moved(pose, step[:6]),
            way + step[6:12],
            covariance,
            _correlation(seen, tone @ gain),
            scale / max(abs(contrast), 1.0),
            float(np.mean(np.abs(residual) < 3 * scale)),
            shares,
        )


@dataclass(frozen=True)
class _Scene:
    """The samples of one picture."""

    facing: NDArray[np.intp]
    rays: Array
    slides: Array
    values: Array
    inside: NDArray[np.bool_]
    layers: Image


def _drawn(cube: CubeModel, face: int, side: int) -> Image:
    """Draw a face, 1 white and 0 black, (side, side)."""
    fine = 4
    cells = marker_cells(cube.dictionary, cube.faces[face].marker_id)
    texel = (np.arange(side * fine) + 0.5) / (side * fine) * cube.edge - cube.edge / 2
    place = (texel + cube.marker_size / 2) / cube.marker_size * len(cells)
    inside = (place >= 0) & (place < len(cells))
    index = np.clip(place.astype(int), 0, len(cells) - 1)
    black = cells[index][:, index] & inside[:, None] & inside
    picture = 1 - black.astype(np.float32)
    return np.asarray(cv2.resize(picture, (side, side), interpolation=cv2.INTER_AREA), np.float32)


def _layers(drawing: list[Image], sigma: float) -> Image:
    """Blur the faces, and stack each with its slopes to the right and down, (faces · side, side, 3)."""
    border = cv2.BORDER_REPLICATE
    soft = [cv2.GaussianBlur(face, (0, 0), sigma, borderType=border) for face in drawing]
    layers = []
    for face in soft:
        down, right = np.gradient(face)
        layers.append(np.stack([face, right, down], axis=2))
    return np.ascontiguousarray(np.concatenate(layers), np.float32)


def _correlation(a: Array, b: Array) -> float:
    a, b = a - a.mean(), b - b.mean()
    return float(a @ b / np.sqrt(max(float((a @ a) * (b @ b)), 1e-12)))
