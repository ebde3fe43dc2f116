"""Samples and texels on a cube's faces, and how these move in the image."""

import numpy as np

from cubeling.tracking.geometry.arrays import Array, Indices
from cubeling.tracking.geometry.projection import Projection


class SampleGrid:
    """Samples on a face, `count` along each side, as far as `reach` from its middle [m].

    `blocks` of them along each side are one measurement: their errors are not independent.
    """

    def __init__(self, count: int, reach: float, blocks: int) -> None:
        steps = ((np.arange(count) + 0.5) / count - 0.5) * 2
        x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
        self.places = np.stack([x, y], axis=1)
        """Place of each sample on its face, −1…1, (N, 2)."""
        self.points = np.stack([x * reach, y * reach, np.zeros(count**2), np.ones(count**2)])
        """The same as columns of (x, y, 0, 1) [m], (4, N)."""
        number = np.arange(count) * blocks // count
        self._block = (number[:, None] * blocks + number).ravel()
        self._blocks = blocks**2

    def locate(self, samples: Indices) -> tuple[Indices, Indices, Indices]:
        """Return the face, the sample on it, and the block of samples of several faces, (N,)."""
        face, place = np.divmod(samples, len(self._block))
        return face, place, face * self._blocks + self._block[place]


def frequencies(side: int) -> tuple[Array, Array, list[Array]]:
    """Frequencies of a texture's spectrum to the right and down, and its gradient's factors.

    `side` is the number of texels, and all are (side, side // 2 + 1) [rad/texel].
    """
    across, down = np.fft.rfftfreq(side), np.fft.fftfreq(side)
    x, y = (2 * np.pi * axis for axis in np.meshgrid(across, down))
    # The gradient has no Nyquist frequency: half a turn per texel has no sign.
    return x, y, [np.where(np.abs(axis) < 3.14, 1j * axis, 0) for axis in (x, y)]


def texels_to_pixels(projection: Projection, frames: Array, texel: float) -> Array:
    """Jacobian of the image of each face by its texels, at its centre, (faces, 2, 2) [px].

    `frames` are those of the faces in the camera's, (faces, 4, 4), and `texel` the size of one [m].
    """
    centres = np.ascontiguousarray(frames[:, :3, 3])
    by_point = projection.project_with_jacobian(centres)[1]
    return np.asarray(by_point @ frames[:, :3, :2] * texel, np.float64)


def texel_slides(frames: Array, arm: Array, rays: Array, texel: float) -> Array:
    """Jacobian of the texel under each ray by a pose delta, (2, 6, faces · N).

    A point X = (x Z, y Z, Z) of the face moves by Ẋ; the point under the ray then moves by
    u̇ = −B⁻¹ ẋ on the face, with ẋ = (Ẋ − x Ż)/Z and B the Jacobian of x by u. `frames` are those
    of the faces, (faces, 4, 4), `arm` leads from the cube's origin to the samples, as `rays`
    (faces, 3, N) [m], and `texel` is the size of one [m].
    """
    axes = frames[:, :3, :2]
    x, y = rays[:, 0], rays[:, 1]
    a, b = (axes[:, 0, n, None] - x * axes[:, 2, n, None] for n in (0, 1))
    c, d = (axes[:, 1, n, None] - y * axes[:, 2, n, None] for n in (0, 1))
    scale = -1 / texel / (a * d - b * c)
    a, b, c, d = (each * scale for each in (a, b, c, d))
    slides = np.empty((2, 6, *x.shape))
    slides[0, :3] = d, -b, b * y - d * x
    slides[1, :3] = -c, a, c * x - a * y
    for turned, (one, two) in enumerate(((1, 2), (2, 0), (0, 1)), start=3):
        slides[:, turned] = arm[:, one] * slides[:, two] - arm[:, two] * slides[:, one]
    return slides.reshape(2, 6, -1)


def bend_slides(frames: Array, rays: Array, places: Array) -> Array:
    """Jacobian of the point under each ray by the bends of its face, (faces, 2, 3, N).

    A face bends along its x axis, twists, and bends along its y axis, each by so much at the end of
    that axis, or at the corner [m]. `frames` are those of the faces, (faces, 4, 4), `rays` lead to
    the samples, (faces, 3, N), and `places` are those of the samples on a face, −1…1, (N, 2).
    """
    across, down = places.T
    # The mean stays in place: a bend is no shift.
    heights = np.stack([across**2 - 1 / 3, across * down, down**2 - 1 / 3])
    x, y, z = (frames[:, :3, :3].transpose(0, 2, 1) @ rays).transpose(1, 0, 2)
    return np.asarray(np.stack([x / z, y / z], axis=1)[:, :, None] * heights, np.float64)
