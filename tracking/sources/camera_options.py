"""What can be asked of a camera: `0?exposure=8&focus=30&lock=0&buffers=2`."""

from dataclasses import dataclass
from typing import Self
from urllib.parse import parse_qsl

from tracking.errors import TrackingError

BUFFERS = 2
"""One to fill while the other is read. With a single one many drivers find nowhere to put the next
picture and give every other one only (nokhwa#128, horus#60), and as the capture thread always
reads, a second one adds no delay."""

LIMITS = {"exposure": (0.1, 1000.0), "focus": (0.0, 10000.0), "buffers": (1.0, 10.0)}
"""The least and the most of each."""


@dataclass(frozen=True)
class CameraOptions:
    """How a camera is set up."""

    lock: bool = True
    """Whether exposure and focus are held once they have settled."""

    exposure: float | None = None
    """How long the shutter is open [ms]: short against blur, long in the dark; None: as the
    camera's automatic has settled."""

    focus: float | None = None
    """In the driver's unit, often 0 (far) to 255 (near); None: as the automatic has settled."""

    buffers: int = BUFFERS
    """How many pictures the driver may hold."""

    @classmethod
    def parse(cls, uri: str) -> tuple[str, Self]:
        """Split "DEVICE?key=value" into the device and the options.

        >>> CameraOptions.parse("/dev/video2?exposure=8&lock=0")
        ('/dev/video2', CameraOptions(lock=False, exposure=8.0, focus=None, buffers=2))

        Raises
        ------
        TrackingError
            An option is unknown, or its value is none that it can have.
        """
        device, _, query = uri.partition("?")
        found: dict[str, float] = {}
        for key, text in parse_qsl(query, keep_blank_values=True):
            found[key] = _number(device, key, text)
        return device, cls(
            lock=bool(found.get("lock", 1.0)),
            exposure=found.get("exposure"),
            focus=found.get("focus"),
            buffers=int(found.get("buffers", BUFFERS)),
        )


def _number(device: str, key: str, text: str) -> float:
    if key == "lock":
        if text not in ("0", "1"):
            raise TrackingError(f"camera:{device}: lock={text} is neither 0 nor 1")
        return float(text)
    if key not in LIMITS:
        known = ", ".join(("lock", *LIMITS))
        raise TrackingError(f"camera:{device} has no option '{key}': it has {known}")
    low, high = LIMITS[key]
    try:
        value = float(text)
    except ValueError as error:
        raise TrackingError(f"camera:{device}: {key}={text} is no number") from error
    if not low <= value <= high:
        raise TrackingError(
            f"camera:{device}: {key} must be from {low:g} to {high:g}, not {value:g}"
        )
    return value
