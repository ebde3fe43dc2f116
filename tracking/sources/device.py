"""What a capture thread reads from."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from tracking.sources.health import Setting
from tracking.sources.pictures import Picture

Clock: TypeAlias = Callable[[], float]


class Device(Protocol):
    """What pictures come from. Only the capture thread uses it, but for `interrupt`."""

    rate: float
    """Nominal rate [frames/s]."""

    @property
    def settings(self) -> tuple[Setting, ...]:
        """What it was asked for, and what became of it."""
        ...

    @property
    def exposed(self) -> float | None:
        """When the last picture was taken, as the driver says [s]; None where it says nothing."""
        ...

    def read(self) -> Picture | bytes | None:
        """Wait for the next picture: pixels or a JPEG; None where there was none.

        Raises
        ------
        TrackingError
            There will be no more.
        """
        ...

    def interrupt(self) -> None:
        """Make a waiting `read` return soon, if that can be done. Called from another thread."""
        ...

    def close(self) -> None:
        """Let go of the device."""
        ...


@dataclass(frozen=True)
class Shot:
    """A picture as it came."""

    picture: Picture | bytes
    """Pixels, or a JPEG."""

    taken: float
    """When it was taken, as well as that is known [s]."""
