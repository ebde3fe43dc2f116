"""How the texels of a cube's faces move in the image, and under its pixels."""

import numpy as np

from tracking.geometry.arrays import Array
from tracking.geometry.projection import Projection


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
