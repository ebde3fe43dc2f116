"""How the room is lit, judged from the camera's own picture."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TO_LIGHT = np.array([-0.42, 1.0, 0.34]) / np.linalg.norm([-0.42, 1.0, 0.34])
"""Direction to the key light in the table frame: from above, the left, and the camera's side,
as most desks are lit; the shadow then falls to the right and away, where it is seen."""

LUMA = np.array([0.2126, 0.7152, 0.0722])
"""Shares of red, green and blue in luminance (Rec. 709)."""

DECODED = np.where(
    np.arange(256) <= 10, np.arange(256) / 3294.6, ((np.arange(256) / 255 + 0.055) / 1.055) ** 2.4
)
"""Linear light of each 8-bit sRGB value (IEC 61966-2-1)."""


@dataclass(frozen=True)
class Light:
    """The light that falls on a character; linear RGB, 1 makes a white surface just white."""

    key: Array
    """From `TO_LIGHT`, (3,)."""

    sky: Array
    """From all of the upper hemisphere, (3,)."""

    ground: Array
    """Thrown back by the table, (3,)."""

    @property
    def white(self) -> Array:
        """What a white sheet on the table returns, (3,)."""
        return np.asarray(self.key * TO_LIGHT[1] + self.sky)


class LightEstimate:
    """Follows exposure and colour of the light from picture to picture.

    A real cube of white paper in the picture is the best light meter. Without one, the illuminant
    is the Minkowski mean of the picture, between grey world and brightest patch (Finlayson and
    Trezzi, "Shades of gray and colour constancy", 2004, with p = 6), drawn towards what a camera's
    automatic exposure makes of white. It depends on the pictures given, in their order, only.
    """

    MINKOWSKI = 6.0
    BRIGHTEST = 0.6
    """Albedo of the things that dominate the Minkowski mean: light things, seldom white ones."""

    USUAL = 0.85
    """Linear value to which automatic exposure tends to bring white."""

    PAPER = 0.82
    """Albedo of printing paper."""

    TRUST = 0.45
    """Share of a colour cast that is ascribed to the light and not to the things."""

    STEP = 0.08
    """Share of the way to a new estimate that is gone each picture: half of it after eight."""

    LIMITS = (0.25, 1.1)
    """Of the light's strength: a character is never lost in the dark, nor burnt out."""

    def __init__(self) -> None:
        self._white: Array | None = None
        self._ground: Array | None = None

    def update(self, picture: NDArray[np.uint8], paper: Array | None = None) -> Light:
        """Take one picture into account and return the light.

        Parameters
        ----------
        picture
            (height, width, 3) BGR.
        paper
            Linear RGB of white paper in it, (3,), where some was recognised.
        """
        step = max(1, picture.shape[1] // 64)
        linear = DECODED[picture[step // 2 :: step, step // 2 :: step, ::-1].reshape(-1, 3)]
        white = self._guess(linear) if paper is None else _toned(paper / self.PAPER, 0.8)
        white = np.maximum(white, 1e-3)
        white = white * np.clip(white @ LUMA, *self.LIMITS) / (white @ LUMA)
        ground = np.maximum(linear.mean(axis=0), 0.25 * self.LIMITS[0])
        if self._white is None or self._ground is None:
            self._white, self._ground = white, ground
        self._white = self._white + self.STEP * (white - self._white)
        self._ground = self._ground + self.STEP * (ground - self._ground)
        return Light(key=0.72 * self._white, sky=0.36 * self._white, ground=0.6 * self._ground)

    def _guess(self, linear: Array) -> Array:
        """Return what a white sheet would show, judged from all of the picture."""
        bright = (linear**self.MINKOWSKI).mean(axis=0) ** (1 / self.MINKOWSKI) / self.BRIGHTEST
        level = float(bright @ LUMA)
        return _toned(bright, self.TRUST) * float(np.sqrt(self.USUAL / max(level, 1e-6)))


def _toned(color: Array, share: float) -> Array:
    """Return a colour with some share of its cast, as bright as before."""
    return np.asarray(share * color + (1.0 - share) * (color @ LUMA))
