"""The summary of a session, on one screen."""

import statistics
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Generic, TypeVar

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from cubeling.app.counted import quantity
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.running.summary.gaps import Gap, gaps_line
from cubeling.app.ui.literal_text import literal_text
from cubeling.robot import LogLine, RobotError
from cubeling.tracking import Health, TrackingError

T = TypeVar("T")

CURVE_BLOCKS = "▁▂▃▄▅▆▇█"
"""The heights of a curve, from −1 to 1."""

CURVE_WIDTH = 56
"""Length of the robot's curve [characters]."""

MIN_STATE_S = 0.6
"""A state that is shorter counts as part of the one before it."""

MAX_LOG_LINES = 3
"""Lines of the robot's log that are shown, the last ones that are more than information."""

MAX_TIMELINE_ENTRIES = 12
"""Entries of a timeline before the rest is summed up."""

MAX_SAMPLES = 4096
"""Values of a session that are kept for its figures: more than two minutes, all of a short one."""


class EvenSamples(Generic[T]):
    """Values of a session of any length, as every first, second, fourth … of them is kept.

    >>> kept = EvenSamples(most=4)
    >>> for value in range(10):
    ...     kept.add(value)
    >>> kept.values
    [0, 4, 8]
    """

    def __init__(self, most: int = MAX_SAMPLES) -> None:
        self.values: list[T] = []
        """What is kept, at most `most`."""
        self._most, self._step, self._count = most, 1, 0

    def add(self, value: T) -> None:
        """Add the next value."""
        if self._count % self._step == 0:
            self.values.append(value)
        if len(self.values) > self._most:
            self.values, self._step = self.values[::2], 2 * self._step
        self._count += 1


@dataclass
class RobotFigures:
    """What a robot felt in a session, and said."""

    labels: list[tuple[float, str]] = field(default_factory=list)
    """When the label of its mood changed, by what was played until then [s], and the new label."""

    valences: EvenSamples[float] = field(default_factory=EvenSamples)
    """The valence that it reports, −1…1."""

    log: tuple[LogLine, ...] = ()
    """The last lines of its log."""

    def add(self, view: RobotView, now: float) -> None:
        """Add what it reports at a time [s]."""
        if not self.labels or self.labels[-1][1] != view.label:
            self.labels.append((now, view.label))
        self.valences.add(view.mood)

    def fill(self, table: Table, name: str, duration: float) -> None:
        """Add its rows to the table of the summary, after a duration [s]."""
        table.add_row(f"{name} felt", literal_text(_timeline(self.labels, duration)))
        table.add_row(
            "", Text(self._curve(), style="green") + Text("  angry ▁  neutral ▄  happy █", "dim")
        )
        serious = [line for line in self.log if line.severity != "information"]
        for line in serious[-MAX_LOG_LINES:]:
            table.add_row(f"{name} said", literal_text(f"{line.severity}: {line.text}"))

    def _curve(self) -> str:
        """Return the valence over time as a line of blocks."""
        valences = self.valences.values
        if not valences:
            return ""
        last = len(valences) - 1
        picks = (valences[round(i * last / (CURVE_WIDTH - 1))] for i in range(CURVE_WIDTH))
        heights = (int((min(1.0, max(-1.0, valence)) + 1) * 3.999) for valence in picks)
        return "".join(CURVE_BLOCKS[min(7, height)] for height in heights)


@dataclass
class Summary:
    """Collects the figures of a session, frame by frame."""

    scenario: str
    """Name of the scenario that it begins with."""

    frames: int = 0
    """Number of frames so far, those without a cube too."""

    left_out: int = 0
    """Frames of a recording that were not drawn, as the computer was too slow for all."""

    tracked_frames: int = 0
    """Frames in which the cube was found."""

    failed_frames: int = 0
    """Frames that an error of the tracker cost."""

    tracker_error: str = ""
    """The first of these errors; "" for none."""

    scenarios: list[tuple[float, str]] = field(default_factory=list)
    """When each scenario began, by what was played until then [s], and its name."""

    states: list[tuple[float, str]] = field(default_factory=list)
    """When each state of the character began, in the same way, and its name."""

    robots: dict[str, RobotFigures] = field(default_factory=dict)
    """The robots by their names, that of the first player first."""

    frame_seconds: EvenSamples[float] = field(default_factory=EvenSamples)
    """Processing times of the frames that were shown, from decoding to the glass [s]."""

    lost: RobotError | TrackingError | None = None
    """Why the robot could not be reached at the end, or why the camera stopped; None if neither."""

    gaps: list[Gap] = field(default_factory=list)
    """When the camera or the robot was missing, in the order of their ends."""

    camera: Health | None = None
    """State of the camera at the end; None for a source that is not live."""

    lens: str | None = None
    """What to say of the camera's lens; None if it is as claimed, or not known."""

    hopped: bool = False
    """Whether the character hopped, as it cannot walk."""

    interrupted: bool = False
    """Whether Ctrl-C ended the session."""

    duration: float = 0.0
    """How long it has played [s]; what the player jumps over does not count."""

    last: float = 0.0
    """Timestamp of the last frame [s]."""

    def add(
        self, step: Step, robot: RobotView, seconds: float | None, *, follows: bool = True
    ) -> None:
        """Add one frame and its processing time [s]; `follows` is false after a jump.

        `robot` is what the robots report. The time is None for a frame that was not drawn.
        """
        self.left_out += seconds is None
        self.hopped = self.hopped or step.outcome.icon == "hop"
        if self.frames and follows:
            self.duration += step.frame.timestamp - self.last
        now, self.last = self.duration, step.frame.timestamp
        self.frames += 1
        self.tracked_frames += step.state.visible
        self.failed_frames += bool(step.tracker_error)
        self.tracker_error = self.tracker_error or step.tracker_error
        if step.scenario != (self.scenarios[-1][1] if self.scenarios else ""):
            self.scenarios.append((now, step.scenario))
        if not self.states or self.states[-1][1] != step.posed.state:
            self.states.append((now, step.posed.state))
        for view in filter(None, (robot, robot.second)):
            self.robots.setdefault(view.name, RobotFigures()).add(view, now)
        if seconds is not None:
            self.frame_seconds.add(seconds)

    def check(self) -> None:
        """Raise what went wrong with robot or camera; call it once everything is closed."""
        if self.lost is not None:
            raise self.lost

    @property
    def tracking_rate(self) -> float:
        """Share of the frames in which the cube was found, 0…1."""
        return self.tracked_frames / self.frames if self.frames else 0.0

    def frame_ms(self) -> tuple[float, float]:
        """Return the median and the 95th percentile of the processing time [ms]."""
        taken = self.frame_seconds.values
        if len(taken) < 2:
            return (1000 * sum(taken),) * 2
        return 1000 * statistics.median(taken), 1000 * statistics.quantiles(taken, n=20)[18]

    def __rich__(self) -> RenderableType:
        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold", no_wrap=True)
        table.add_column()
        duration = self.duration
        median, slow = self.frame_ms()
        table.add_row("played", f"{quantity(self.frames, 'frame')}, {duration:.1f} s")
        if self.left_out:
            left_out = quantity(self.left_out, "frame")
            table.add_row("not drawn", f"{left_out}, to keep up with the recording")
        if len(self.scenarios) > 1:
            table.add_row("scenarios", _timeline(self.scenarios, duration))
        table.add_row("cube found", f"in {100 * self.tracking_rate:.1f} % of the frames")
        if self.failed_frames:
            failed = f"in {quantity(self.failed_frames, 'frame')}: {self.tracker_error}"
            table.add_row("tracker failed", literal_text(failed))
        table.add_row("character", _timeline(self.states, duration))
        if self.hopped:
            make = "[cyan]cubeling character locomotion[/] gives it a gait"
            table.add_row("", f"it hops, as it has no clips to walk with: {make}")
        for name, figures in self.robots.items():
            figures.fill(table, name if len(self.robots) > 1 else "robot", duration)
        table.add_row(
            "a frame took", f"{median:.1f} ms in the median, {slow:.1f} ms at the 95th percentile"
        )
        if self.camera is not None:
            table.add_row("camera", camera_line(self.camera))
        for part in sorted({gap.part for gap in self.gaps}):
            gaps = [gap for gap in self.gaps if gap.part == part]
            table.add_row(f"{part} lost", gaps_line(gaps))
        if self.lens is not None:
            table.add_row("lens", self.lens)
        names = dict.fromkeys([self.scenario, *(name for _, name in self.scenarios)])
        title = f"[bold]{', '.join(names)}"
        return Panel(Group(table), title=title, title_align="left", expand=False)


def camera_line(health: Health) -> str:
    """Return the figures of a live source in one line.

    >>> camera_line(Health("camera 0", "running", 0.0, rate=30.0, latency=0.041, dropped=2))
    '30.0 pictures/s, 41 ms old (since arrival), 2 left out for newer ones, none waited'
    """
    clock = "since exposure" if health.stamped_by == "driver" else "since arrival"
    unusable = f", {health.unusable} broken or of another size" if health.unusable else ""
    waited = f"at most {health.max_queue} waited" if health.max_queue else "none waited"
    return (
        f"{health.rate:.1f} pictures/s, {1000 * health.latency:.0f} ms old ({clock}), "
        f"{health.dropped} left out for newer ones{unusable}, {waited}"
    )


def without_short_states(
    changes: list[tuple[float, str]], duration: float
) -> list[tuple[float, str]]:
    """Leave out states that lasted less than `MIN_STATE_S`.

    >>> changes = [(0.0, "idle"), (3.0, "run"), (3.2, "idle"), (9.0, "walk")]
    >>> without_short_states(changes, 12.0)
    [(0.0, 'idle'), (9.0, 'walk')]
    """
    kept: list[tuple[float, str]] = []
    for (start, state), seconds in zip(changes, _durations(changes, duration), strict=True):
        if not kept or (seconds >= MIN_STATE_S and kept[-1][1] != state):
            kept.append((start, state))
    return kept


def _durations(changes: list[tuple[float, str]], duration: float) -> list[float]:
    """Return how long each state lasted [s]."""
    times = [*(time for time, _ in changes), duration]
    return [end - start for start, end in pairwise(times)]


def _timeline(changes: list[tuple[float, str]], duration: float) -> str:
    """Return "idle 3 s → kiss 9 s → …"."""
    changes = without_short_states(changes, duration)
    seconds = _durations(changes, duration)
    entries = [f"{name} {s:.1f} s" for (_, name), s in zip(changes, seconds, strict=True)]
    if len(entries) > MAX_TIMELINE_ENTRIES:
        shown = MAX_TIMELINE_ENTRIES - 1
        entries = [*entries[:shown], f"… and {len(entries) - shown} more"]
    return " → ".join(entries)
