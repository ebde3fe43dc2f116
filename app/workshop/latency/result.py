"""What was measured: figures, what to do about them, and how they are printed."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from cubeling.app.ui.display import is_software_renderer
from cubeling.app.ui.literal_text import literal_text
from cubeling.app.workshop.latency.flips import picture_age
from cubeling.app.workshop.latency.program import ProgramTimes
from cubeling.app.workshop.latency.session import LatencySession
from cubeling.tracking import Health

SLOW_AGE_S = 0.12
"""A picture that is older than this on arrival is later than most webcams' on a good screen [s]."""

SLOW_INTERVAL_S = 0.045
"""A camera that is slower than this is short of light [s]."""

SLOW_PROGRAM_S = 0.05
"""A program that takes longer than this for a picture is slow [s]."""


@dataclass(frozen=True)
class Spread:
    """The distribution of a time [s]."""

    median: float
    """Half of the samples are below it."""

    low: float
    """5 % of the samples are below it."""

    high: float
    """95 % of the samples are below it."""

    @classmethod
    def of(cls, samples: Sequence[float] | NDArray[np.float64]) -> Self:
        """Return the distribution of samples."""
        low, median, high = np.percentile(samples, (5, 50, 95)).tolist()
        return cls(median, low, high)

    def text(self) -> str:
        """Return it in milliseconds.

        >>> Spread(0.0712, 0.055, 0.0901).text()
        '71 ms (55 to 90)'
        """
        return f"{1e3 * self.median:.0f} ms ({1e3 * self.low:.0f} to {1e3 * self.high:.0f})"


@dataclass(frozen=True)
class LatencyResult:
    """The measured latency of a camera, a screen and this program. Times in seconds."""

    source: str
    """URI of the camera."""

    flips: int
    """Flips of the pattern that were seen."""

    missed: int
    """Flips that were not."""

    interval: float
    """Median time from one picture of the camera to the next."""

    age: float
    """How old the world in a picture is when it arrives in the program, the screen's lag included:
    `picture_age`."""

    loop: Spread
    """From a flip on the screen to the arrival of the first picture that shows it: the age, and the
    wait for the next exposure."""

    program: Spread | None = None
    """From the arrival of a picture to its own picture on the way to the screen, in a session as of
    `cubeling play`; None if it was not measured."""

    motion_to_photon: Spread | None = None
    """From a movement to its light on the screen, for movements at any moment of that session: see
    `motion_to_photon`."""

    tracked: float | None = None
    """Share of that session's pictures in which the cube was found."""

    advice: str = ""
    """What would help most; "" if nothing stands out."""

    def as_json(self) -> dict[str, Any]:
        """Return the figures as a JSON object; times in seconds."""
        return asdict(self)

    def __rich__(self) -> RenderableType:
        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold", no_wrap=True)
        table.add_column()
        missed = f", {self.missed} missed" if self.missed else ""
        table.add_row("measured", f"{self.flips} flips of the pattern{missed}; median (5 to 95 %)")
        table.add_row("camera", f"a picture every {1e3 * self.interval:.0f} ms")
        table.add_row(
            "screen to program",
            f"{self.loop.text()}; a picture is {1e3 * self.age:.0f} ms old when it arrives",
        )
        if self.program is not None and self.motion_to_photon is not None:
            table.add_row(
                "program to screen",
                f"{self.program.text()}; the cube was in {100 * (self.tracked or 0):.0f} % of the "
                "pictures",
            )
            table.add_row("motion to photon", f"[bold]{self.motion_to_photon.text()}[/]")
        if self.advice:
            table.add_row("advice", literal_text(self.advice))
        title = Text.assemble(("latency of ", "bold"), literal_text(self.source))
        return Panel(Group(table), title=title, title_align="left", expand=False)


def latency_result(
    source: str,
    session: LatencySession,
    health: Health,
    renderer: str,
    program: ProgramTimes | None,
) -> LatencyResult:
    """Return the figures of a measurement.

    Parameters
    ----------
    source
        URI of the camera.
    session
        The flips.
    health
        State of the camera at the end.
    renderer
        The name of what draws: GL_RENDERER.
    program
        When a session showed its pictures; None if none was played.
    """
    detector, stamp_age = session.detector, session.stamp_age
    age = picture_age(detector.flips)
    result = LatencyResult(
        source=source,
        flips=len(detector.flips),
        missed=detector.missed,
        interval=detector.interval,
        age=age,
        loop=Spread.of([each.delay for each in detector.flips]),
    )
    if program is not None:
        photons = motion_to_photon(program, age - stamp_age)
        result = replace(
            result,
            program=Spread.of(program.shown - program.stamps - stamp_age),
            motion_to_photon=Spread.of(photons),
            tracked=program.tracked,
        )
    return replace(result, advice=advice(result, health, renderer))


def motion_to_photon(program: ProgramTimes, age: float) -> NDArray[np.float64]:
    """Return the times from movements to their light on the screen [s], one each millisecond.

    `age` is how old the world is at the timestamp of a picture, the screen's lag included [s]. A
    movement waits for the next picture that is shown, and is as late as that one. Pictures that are
    left out, as the program is busy, make the wait longer.
    """
    moments = np.arange(program.stamps[0], program.stamps[-1], 0.001)
    first = np.searchsorted(program.stamps, moments)
    return np.asarray(program.shown[first] - moments + age)


def advice(result: LatencyResult, health: Health, renderer: str) -> str:
    """Return what would help, or "": what takes the longest comes first.

    That the processor draws is said whenever drawing takes long, also if something else takes
    longer.
    """
    drawn = ""
    program = result.program
    if program is not None and program.median > SLOW_PROGRAM_S and is_software_renderer(renderer):
        drawn = (
            f"the processor draws instead of a graphics card, and the program takes "
            f"{1000 * program.median:.0f} ms: install the card's driver (see cubeling doctor), or "
            "play with --quality reduced"
        )
    first = _slowest(result, health, drawn)
    return "; ".join(dict.fromkeys(filter(None, (first, drawn))))


def _slowest(result: LatencyResult, health: Health, drawn: str) -> str:
    """Return what would help against what takes longest; `drawn` if that is drawing."""
    slow = result.age > SLOW_AGE_S
    if result.program is not None and result.program.median > max(SLOW_PROGRAM_S, result.age):
        return (
            drawn
            or "the program takes longest: close other programs, or take a smaller camera picture"
        )
    if result.interval > SLOW_INTERVAL_S:
        return (
            f"the camera gives only {1 / result.interval:.0f} pictures/s, mostly for lack of "
            "light: turn on a lamp, or set a shorter exposure, as in camera:0?exposure=8"
        )
    if slow and health.mean_queue > 0.5:
        return "pictures wait in the camera's queue: try camera:0?buffers=1"
    if slow and result.source.startswith("http"):
        return "the phone's stream is late: try a smaller picture in its app, or its USB cable"
    if slow:
        return (
            "camera or screen are late: a USB port of its own for the camera, and on the screen "
            "the game mode; switch off vertical synchronisation (vsync) and desktop effects"
        )
    return ""
