"""Options behind the "?" of a source's URI, parsed into a dataclass."""

from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self
from urllib.parse import parse_qsl

from cubeling.tracking.errors import TrackingError


@dataclass(frozen=True)
class UriOptions:
    """Base of the options of one kind of source; a field's name is the option's key."""

    LIMITS: ClassVar[dict[str, tuple[float, float]]] = {}
    """Smallest and largest allowed value of each numeric option."""

    PAIRS: ClassVar[dict[str, tuple[str, str]]] = {}
    """Keys that set two options at once, as in "size=640x360"."""

    @classmethod
    def parse(cls, uri: str) -> tuple[str, Self]:
        """Split "SCHEME:NAME?key=value&key=value" into the name and the options.

        Raises
        ------
        TrackingError
            An option is unknown, or its value is not allowed.
        """
        source, _, query = uri.partition("?")
        kinds = {field.name: field.type for field in fields(cls)}
        values: dict[str, Any] = {}
        for key, text in parse_qsl(query, keep_blank_values=True):
            if key in cls.PAIRS:
                parts = text.split("x")
                if len(parts) != 2 or not all(part.isdecimal() for part in parts):
                    raise TrackingError(f"{source}: {key}={text} must be written as {key}=640x360")
                pairs = list(zip(cls.PAIRS[key], parts, strict=True))
            else:
                pairs = [(key, text)]
            for name, value in pairs:
                if name not in kinds:
                    known = ", ".join((*cls.PAIRS, *kinds))
                    raise TrackingError(f"{source} has no option '{name}': it has {known}")
                values[name] = _value(f"{source}: {name}", kinds[name], value)
                low, high = cls.LIMITS.get(name, (-float("inf"), float("inf")))
                if not low <= values[name] <= high:
                    raise TrackingError(
                        f"{source}: {name} must be from {low:g} to {high:g}, not {values[name]:g}"
                    )
        return source.partition(":")[2], cls(**values)


def _value(option: str, kind: object, text: str) -> float:
    if kind is bool:
        if text not in ("0", "1"):
            raise TrackingError(f"{option}={text} is neither 0 nor 1")
        return text == "1"
    try:
        return int(text) if kind is int else float(text)
    except ValueError as error:
        number = "a whole number" if kind is int else "a number"
        raise TrackingError(f"{option}={text} is not {number}") from error
