"""The markers as textures, as a lens out of focus and a bright sensor show them."""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Indices
from cubeling.tracking.refinement.photometry.texels import frequencies

TEXELS_PER_CELL, SMALL_TEXELS_PER_CELL = 8, 4
"""Texels along a cell, and along one that is so small in the image that a lens blurs it anyway."""

PAPER_CELLS = 2
"""Cells of white paper around a marker, which let the blur wrap around."""


MAX_SLANT_CHANGE = 0.03
"""A face is drawn again where the picture of its texels has changed by more than this share."""


@dataclass(frozen=True, eq=False)
class DrawnMarkers:
    """Markers as a blurred picture shows them, with how they change."""

    faces: Indices
    """Indices of their faces, (faces,)."""

    variance: float
    """Variance of the blur [px²]."""

    texels_to_pixels: Array
    """Jacobian of the image by the texels of each face, (faces, 2, 2), when it was drawn."""

    layers: Floats
    """The markers, and their derivatives to the right, down, by the variance, and by the bloom,
    which is how far white has grown over black in the image [px], (5, faces, side, side)."""


class MarkerTextures:
    """Textures of the markers of all faces, from black 0 to white 1, and how they change."""

    def __init__(self, cube: CubeModel, texels_per_cell: int) -> None:
        cells = [marker_cells(cube.dictionary, face.marker_id) for face in cube.faces]
        white = np.pad(~np.stack(cells), ((0, 0), *[(PAPER_CELLS, PAPER_CELLS)] * 2),
                       constant_values=True)  # fmt: skip
        ones = np.ones((1, texels_per_cell, texels_per_cell), np.float32)
        textures = np.kron(white.astype(np.float32), ones)
        self.side = textures.shape[1]
        """Texels along each side of a texture."""
        self.texel = cube.marker_size / len(cells[0]) / texels_per_cell
        """Size of a texel [m]."""
        self._spectra = _spectrum(textures)
        # By how much the texture brightens where every border moves by a texel into the black.
        self._borders = [
            _spectrum(np.abs(np.roll(textures, 1, axis) - np.roll(textures, -1, axis)) / 2)
            for axis in (2, 1)
        ]
        x, y, slopes = frequencies(self.side)
        self._powers = np.stack([x * x, 2 * x * y, y * y]).astype(np.float32)
        self._slopes = [each.astype(np.complex64) for each in slopes]

    def draw(
        self, faces: Indices, texels_to_pixels: Array, variance: float, last: DrawnMarkers | None
    ) -> DrawnMarkers:
        """Draw the markers of faces, blurred by a Gaussian that is round in the camera's image.

        `texels_to_pixels` and `variance` are as in `DrawnMarkers`. Markers of `last` are taken from
        there where they have the same blur and nearly the same slant.
        """
        known = [] if last is None else _known(last, faces, texels_to_pixels, variance, self.side)
        if last is not None and known == list(range(len(last.faces))):
            return last
        layers = np.empty((5, len(faces), self.side, self.side), np.float32)
        drawn_for = texels_to_pixels.copy()
        missing = [place for place in range(len(faces)) if not known or known[place] < 0]
        if missing:
            layers[:, missing] = self._blur(faces[missing], texels_to_pixels[missing], variance)
        for place, old in enumerate(known):
            if last is not None and old >= 0:
                layers[:, place], drawn_for[place] = last.layers[:, old], last.texels_to_pixels[old]
        return DrawnMarkers(faces, variance, drawn_for, layers)

    def _blur(self, faces: Indices, texels_to_pixels: Array, variance: float) -> Floats:
        """Draw the layers of `DrawnMarkers`."""
        spread = np.linalg.inv(texels_to_pixels)
        spread = (spread @ spread.transpose(0, 2, 1)).astype(np.float32)
        parts = spread[:, [0, 0, 1], [0, 1, 1]]
        power = np.tensordot(parts, self._powers, 1) / 2
        gauss = np.exp(-variance * power)
        # One pixel across a border is this many texels.
        area = np.abs(np.linalg.det(texels_to_pixels))
        columns = np.linalg.norm(texels_to_pixels, axis=1) / area[:, None]
        columns = columns.astype(np.float32)[:, :, None, None]
        spectra = np.empty((5, len(faces), *gauss.shape[1:]), np.complex64)
        soft = np.multiply(self._spectra[faces], gauss, out=spectra[0])
        np.multiply(soft, self._slopes[0], out=spectra[1])
        np.multiply(soft, self._slopes[1], out=spectra[2])
        np.multiply(soft, -power, out=spectra[3])
        borders = self._borders[0][faces] * columns[:, 1] + self._borders[1][faces] * columns[:, 0]
        np.multiply(borders, gauss, out=spectra[4])
        textures = np.fft.irfft2(spectra, s=(self.side, self.side))
        return np.asarray(textures, np.float32)


def _known(
    last: DrawnMarkers, faces: Indices, texels_to_pixels: Array, variance: float, side: int
) -> list[int]:
    """Find each face among those that were drawn alike; −1 where it was not."""
    if last.variance != variance or last.layers.shape[-1] != side:
        return [-1] * len(faces)
    same = last.faces == faces[:, None]
    change = np.abs(last.texels_to_pixels - texels_to_pixels[:, None]).max(axis=(2, 3))
    same &= change < MAX_SLANT_CHANGE * np.abs(texels_to_pixels).max(axis=(1, 2))[:, None]
    places = np.where(same.any(axis=1), same.argmax(axis=1), -1)
    return [int(place) for place in places]


def _spectrum(textures: Floats) -> Array:
    return np.fft.rfft2(textures).astype(np.complex64)
