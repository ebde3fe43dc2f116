"""How a camera's grey values grow with the light, learnt from how the cube blurs."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

USUAL = 2.2
"""Exponent of nearly every camera: light is the grey value to this power (sRGB)."""

LEAST, MOST = 1.0, 2.6
"""Exponents that are believed."""

KEPT = 9
"""The median of so many measurements counts."""

STEP = 0.15
"""The exponent is changed only by more than this: a new table means other poses by hundredths of a
millimetre."""


class Response:
    """The tone curve of one camera, as a power of the grey value.

    Blur mixes light, not grey values: half black and half white is not the grey in their middle.
    Where that is not undone, every blurred edge seems to lie too far in the black.
    """

    def __init__(self) -> None:
        self.exponent = USUAL
        """Light is the grey value to this power."""
        self.table = _table(USUAL)
        """Light for each grey value, 0…255, (256,)."""
        self._measured: deque[float] = deque(maxlen=KEPT)

    @property
    def known(self) -> bool:
        """Whether it was measured often enough."""
        return len(self._measured) == KEPT

    def learn(self, bend: float, black: float) -> None:
        """Take in by how much the middle between black and white is too bright for a mixture.

        Parameters
        ----------
        bend
            c of light = a + b·m + c·m(1 − m), with m the share of white in a mixture, over b.
        black
            a/(a + b): what black is beside white.
        """
        self._measured.append(np.clip(_exponent(self.exponent, bend, black), LEAST, MOST).item())
        exponent = float(np.median(self._measured))
        if self.known and abs(exponent - self.exponent) > STEP:
            self.exponent = exponent
            self.table = _table(exponent)


def _table(exponent: float) -> Floats:
    return np.asarray(255 * (np.arange(256) / 255) ** exponent, np.float32)


def _exponent(used: float, bend: float, black: float) -> float:
    """Exponent that makes a mixture of half black and half white the middle of the two.

    With the exponent used, the middle reads at h = (1 + black)/2 + bend (1 − black)/4 of white. The
    grey values of black, middle and white are their `used`-th roots; the exponent sought makes
    2 middle^e = black^e + 1.
    """
    black = min(max(black, 1e-3), 0.9)
    middle = (1 + black) / 2 + bend * (1 - black) / 4
    dark, grey = black ** (1 / used), min(max(middle, 1e-3), 0.999) ** (1 / used)
    tried = np.linspace(0.6, 3.2, 105)
    return float(tried[np.argmin(np.abs(2 * grey**tried - dark**tried - 1))])
