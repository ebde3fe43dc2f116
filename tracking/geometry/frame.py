"""The first arrow of the line: one picture from a camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Frame:
    """One camera picture with its time."""

    image: NDArray[np.uint8]
    """Pixels, (height, width, 3), BGR."""

    timestamp: float
    """Moment of exposure in seconds, on the source's own clock; never decreases."""

    index: int
    """Number of the frame in its source, from 0."""

    encoded: bytes | None = None
    """The very bytes that `image` was decoded from, where the source gives them."""

    encoding: str = ""
    """Format of `encoded`: "jpeg", "h264" or ""."""
