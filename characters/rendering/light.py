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
        return self.key * TO_LIGHT[1] + self.sky


class LightEstimate:
    """Follows exposure and colour of the light from picture to picture.

    The illuminant is the Minkowski mean of the picture, between grey world and brightest patch
    (Finlayson and Trezzi, "Shades of gray and colour constancy", 2004, with p = 6), drawn halfway to grey
    since a wooden table is not the light of a sunset. It depends on the pictures given, in their order, only.
    """

    MINKOWSKI = 6.0
    BRIGHTEST = 0.8
    """Albedo of the things that dominate the Minkowski mean: paper, not snow."""

    TRUST = 0.5
    """Share of the colour cast that is ascribed to the light and not to the things."""

    STEP = 0.08
    """Share of the way to a new estimate that is gone each picture: half of it after eight."""

    LIMITS = (0.22, 1.05)
    """Of the light's strength: a character is never lost in the dark, nor burnt out."""

    def __init__(self) -> None:
        self._white: Array | None = None
        self._ground: Array | None = None

    def update(self, picture: NDArray[np.uint8]) -> Light:
        """Take one picture, (height, width, 3) BGR, into account and return the light."""
        step = max(1, picture.shape[1] // 96)
        linear = DECODED[picture[step // 2 :: step, step // 2 :: step, ::-1].reshape(-1, 3)]
        mean = linear.mean(axis=0)
        bright = (linear**self.MINKOWSKI).mean(axis=0) ** (1 / self.MINKOWSKI) / self.BRIGHTEST
        level = float(bright @ LUMA)
        tint = bright / level if level > 1e-6 else np.ones(3)
        white = np.clip(level, *self.LIMITS) * (1.0 + self.TRUST * (tint - 1.0))
        ground = np.maximum(mean, 0.25 * self.LIMITS[0])
        if self._white is None or self._ground is None:
            self._white, self._ground = white, ground
        self._white = self._white + self.STEP * (white - self._white)
        self._ground = self._ground + self.STEP * (ground - self._ground)
        return Light(key=0.78 * self._white, sky=0.34 * self._white, ground=0.55 * self._ground)
