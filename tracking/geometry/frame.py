"""The first value of the pipeline: one image from a camera."""

from dataclasses import dataclass

from cubeling.tracking.geometry.arrays import Image


@dataclass(frozen=True)
class Frame:
    """One camera image with its time."""

    image: Image
    """Pixels, (height, width, 3), BGR."""

    timestamp: float
    """Time of the exposure in seconds, on the source's own clock; never decreases."""

    index: int
    """Index of the frame in its source, from 0."""

    encoded: bytes | None = None
    """The bytes that `image` was decoded from, where the source gives them."""

    encoding: str = ""
    """Format of `encoded`: "jpeg", "h264" or ""."""
