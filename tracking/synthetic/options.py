"""What can be asked of the synthetic camera: `NAME?key=value&key=value`."""

from dataclasses import dataclass, fields, replace
from typing import Self
from urllib.parse import parse_qsl

from tracking.errors import TrackingError


@dataclass(frozen=True)
class Options:
    """How the camera sees and how the script goes."""

    seed: int = 1
    """Of all that is drawn at random."""

    frames: int = 0
    """How many frames; 0 for the script's own length."""

    rate: float = 30.0
    """Frames a second."""

    width: int = 1280
    """Of the picture [px]."""

    height: int = 720
    """Of the picture [px]."""

    blur: float = 0.008
    """How long the shutter is open [s]."""

    noise: float = 1.5
    """Standard deviation of the sensor's noise at middle grey [grey levels]."""

    defocus: float = 0.6
    """Standard deviation of the lens blur [px]."""

    distortion: float = 1.0
    """Strength of the lens distortion: 0 none, 1 that of a webcam."""

    clutter: bool = True
    """Whether things lie on the desk."""

    hand: bool = True
    """Whether the hand that moves the cube is seen."""

    shadow: bool = True
    """Whether cube and hand throw shadows, and somebody's shadow moves over the desk."""

    speed: float = 0.5
    """Greatest speed of the script "sweep" [m/s]."""

    fold: float = 0.0
    """How badly the cube is folded: each face is off by up to so many millimetres along each axis,
    and turned by as many degrees about each."""

    @classmethod
    def parse(cls, uri: str) -> tuple[str, Self]:
        """Split "NAME?key=value" into the name and the options.

        Raises
        ------
        TrackingError
            An option is unknown, or its value is none that it can have.
        """
        name, _, query = uri.partition("?")
        kinds = {field.name: field.type for field in fields(cls)}
        changes: dict[str, object] = {}
        for key, text in parse_qsl(query, keep_blank_values=True):
            if key == "size":
                changes.update(_size(name, text))
                continue
            if key not in kinds:
                known = ", ".join(("size", *kinds))
                raise TrackingError(f"synthetic:{name} has no option '{key}': it has {known}")
            try:
                changes[key] = _value(kinds[key], text)
            except ValueError as error:
                raise TrackingError(
                    f"synthetic:{name}: {key}={text} is not a {kinds[key]}"
                ) from error
        options = replace(cls(), **changes)  # type: ignore[arg-type]  # kinds were held to
        options._check(name)
        return name, options

    def _check(self, name: str) -> None:
        for key, low, high in (
            ("rate", 1.0, 240.0),
            ("width", 64, 4096),
            ("height", 64, 4096),
            ("blur", 0.0, 0.1),
            ("noise", 0.0, 50.0),
            ("defocus", 0.0, 10.0),
            ("distortion", -2.0, 2.0),
            ("speed", 0.01, 3.0),
            ("fold", 0.0, 3.0),
            ("frames", 0, 1_000_000),
        ):
            value = getattr(self, key)
            if not low <= value <= high:
                raise TrackingError(
                    f"synthetic:{name}: {key} must be from {low:g} to {high:g}, not {value:g}"
                )


def _size(name: str, text: str) -> dict[str, int]:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise TrackingError(f"synthetic:{name}: size={text} is no size; write size=640x360")
    return {"width": int(width), "height": int(height)}


def _value(kind: object, text: str) -> object:
    if kind is bool:
        if text not in ("0", "1"):
            raise ValueError(text)
        return text == "1"
    return int(text) if kind is int else float(text)
