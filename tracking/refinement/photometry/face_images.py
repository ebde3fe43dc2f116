"""The printed faces as textures, blurred as the camera blurs them."""

import cv2
import numpy as np

from cubeling.tracking.cube.marker import black_texels, marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Indices
from cubeling.tracking.refinement.photometry.texels import frequencies


class FaceTextures:
    """Textures of all faces of a cube, `side` texels wide, from black 0 to white 1."""

    def __init__(self, cube: CubeModel, side: int) -> None:
        self._texel = cube.edge / side
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
    white = 1 - black_texels(cube, cells, side * fine).astype(np.float32)
    return np.asarray(cv2.resize(white, (side, side), interpolation=cv2.INTER_AREA), np.float32)
