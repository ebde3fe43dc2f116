"""How a live source fares: whether its device is there, and how late its pictures are."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

SourceState: TypeAlias = Literal["running", "lost", "frozen", "recovering", "closed"]
"""Running; gone or silent; the same picture again and again; open again, but no picture yet."""


@dataclass(frozen=True)
class Setting:
    """Something that a device was asked for, and what became of it."""

    name: str
    """ "exposure", "focus", "buffers"."""

    honoured: bool
    """Whether the device does it, by what it says when asked again."""

    told: str
    """In words: "locked at 15.6 ms", "the camera has no such setting"."""


@dataclass(frozen=True)
class Health:
    """A live source as it is at one moment."""

    name: str
    """How messages call the source: "camera 0"."""

    state: SourceState
    """What it does."""

    since: float
    """On the source's clock [s]: since when it runs; while it does not, when the last new picture
    came."""

    problem: str = ""
    """Why it does not run, one line; "" where it does."""

    frames: int = 0
    """Frames that were handed out."""

    dropped: int = 0
    """Pictures that came and gave way to newer ones before anybody asked for them."""

    gaps: int = 0
    """How often it was lost or frozen."""

    rate: float = 0.0
    """Pictures a second, of the last ones that came; 0 where too few came to tell."""

    latency: float = 0.0
    """From the picture's timestamp to its being handed out, median of the last ones [s]."""

    depth: float = 0.0
    """How many pictures waited in the driver's queue, mean of the last ones."""

    deepest: int = 0
    """The most that ever waited there."""

    stamped_by: Literal["driver", "arrival"] = "arrival"
    """Whose time the last picture bears: the driver's, or that of its arrival, later by what the
    camera and the cable take."""

    settings: tuple[Setting, ...] = ()
    """What the device was asked for."""

    still: bool = False
    """Whether its trouble is, or before it was opened again was, a picture that stood still."""

    @property
    def running(self) -> bool:
        """Whether new pictures come."""
        return self.state == "running"
