"""The printed faces as pictures, blurred as the camera blurs them."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.marker import marker_cells
from tracking.cube.model import CubeModel

Array = NDArray[np.float64]
Image = NDArray[np.float32]


class FaceTextures:
    """All faces of a cube, from black 0 to white 1.

    Parameters
    ----------
    cube
        The cube.
    side
        Texels along the edge of a face.
    """

    def __init__(self, cube: CubeModel, side: int) -> None:
        self._texel = cube.edge / side
        self._side = side
        pictures = np.stack([_drawn(cube, face, side) for face in range(len(cube.faces))])
        self._spectra = np.fft.rfft2(pictures).astype(np.complex64)
        across, down = np.fft.rfftfreq(side), np.fft.fftfreq(side)
        self._x, self._y = (2 * np.pi * axis for axis in np.meshgrid(across, down))
        # A slope has no highest frequency: half a turn per texel has no direction.
        right = np.where(np.abs(self._x) < 3.14, 1j * self._x, 0)
        below = np.where(np.abs(self._y) < 3.14, 1j * self._y, 0)
        self._slopes = np.stack([np.ones_like(right), right, below]).astype(np.complex64)

    def blurred(
        self, faces: NDArray[np.intp], texels_to_pixels: Array, sigma: float
    ) -> tuple[Image, Array]:
        """Blur faces by a Gaussian that is round in the camera's picture, not on the paper.

        A face that leans away is blurred more along its lean. The faces are white all round, so
        that the blur may run over one side and in on the other.

        Parameters
        ----------
        faces
            Their numbers, (faces,).
        texels_to_pixels
            How each is seen, (faces, 2, 2).
        sigma
            Standard deviation of the Gaussian [px].

        Returns
        -------
        The faces below each other, each texel with its slopes to the right and down, (faces · side,
        side, 3), and the widest standard deviation on each face, (faces,) [m].
        """
        spread = np.linalg.inv(texels_to_pixels)
        spread = sigma**2 * spread @ spread.transpose(0, 2, 1)
        xx, xy, yy = (spread[:, i, j, None, None] for i, j in ((0, 0), (0, 1), (1, 1)))
        power = xx * self._x**2 + 2 * xy * self._x * self._y + yy * self._y**2
        gauss = np.exp(-power / 2).astype(np.float32)
        spectra = (self._spectra[faces] * gauss)[:, None] * self._slopes
        pictures = np.fft.irfft2(spectra, s=(self._side, self._side))
        layers = pictures.transpose(0, 2, 3, 1).reshape(-1, self._side, 3)
        widest = np.sqrt(np.linalg.eigvalsh(spread)[:, -1]) * self._texel
        return np.ascontiguousarray(layers, np.float32), widest


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
