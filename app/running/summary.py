"""The summary of a session, on one screen."""

import statistics
from dataclasses import dataclass, field
from itertools import pairwise

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from cubeling.app.counted import quantity
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.ui.literal_text import literal_text
from cubeling.robot import LogLine, RobotError
from cubeling.tracking import Health, TrackingError

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


@dataclass
class Summary:
    """Collects the figures of a session, frame by frame."""

    scenario: str
    """Name of the scenario that it begins with."""

    frames: int = 0
    """Number of frames so far, those without a cube too."""

    left_out: int = 0
    """Frames of a recording that were left out, as the computer was too slow for all."""

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

    moods: list[tuple[float, float, str]] = field(default_factory=list)
    """When, in the same way, the valence that the robot reports, and its label."""

    frame_seconds: list[float] = field(default_factory=list)
    """Processing time of each frame, from the camera's picture to the finished one [s]."""

    lost: RobotError | TrackingError | None = None
    """Why the robot could not be reached at the end, or why the camera stopped; None if neither."""

    gaps: list[tuple[float, float]] = field(default_factory=list)
    """When the camera was lost [s, its timestamps], and how long until its next frame [s]."""

    robot_log: tuple[LogLine, ...] = ()
    """The last lines of the robot's log."""

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

    def add(self, step: Step, robot: RobotView, seconds: float, *, follows: bool = True) -> None:
        """Add one frame and its processing time [s]; `follows` is false after a jump."""
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
        self.moods.append((now, robot.mood, robot.label))
        self.frame_seconds.append(seconds)

    def check(self) -> None:
        """Raise what went wrong with robot or camera; call it once everything is closed."""
        if self.lost is not None:
            raise self.lost

    @property
    def tracking_rate(self) -> float:
        """Share of the frames in which the cube was found, 0…1."""
        return self.tracked_frames / self.frames if self.frames else 0.0

    def labels(self) -> list[tuple[float, str]]:
        """Return when the label of the robot's mood changed [s], and the new label."""
        changes: list[tuple[float, str]] = []
        for time, _, label in self.moods:
            if not changes or changes[-1][1] != label:
                changes.append((time, label))
        return changes

    def frame_ms(self) -> tuple[float, float]:
        """Return the median and the 95th percentile of the processing time [ms]."""
        if len(self.frame_seconds) < 2:
            return (1000 * sum(self.frame_seconds),) * 2
        cuts = statistics.quantiles(self.frame_seconds, n=20)
        return 1000 * statistics.median(self.frame_seconds), 1000 * cuts[18]

    def __rich__(self) -> RenderableType:
        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold", no_wrap=True)
        table.add_column()
        duration = self.duration
        median, slow = self.frame_ms()
        table.add_row("played", f"{quantity(self.frames, 'frame')}, {duration:.1f} s")
        if self.left_out:
            left_out = quantity(self.left_out, "frame")
            table.add_row("left out", f"{left_out}, to keep up with the recording")
        if len(self.scenarios) > 1:
            table.add_row("scenarios", _timeline(self.scenarios, duration))
        table.add_row("cube found", f"in {100 * self.tracking_rate:.1f} % of the frames")
        if self.failed_frames:
            failed = f"in {quantity(self.failed_frames, 'frame')}: {self.tracker_error}"
            table.add_row("tracker failed", literal_text(failed))
        table.add_row("character", _timeline(self.states, duration))
        if self.hopped:
            make = "[cyan]cubeling character locomotion[/] gives it a gait"
            table.add_row("", f"it hopped, as it has no clips to walk with: {make}")
        table.add_row("robot felt", literal_text(_timeline(self.labels(), duration)))
        table.add_row(
            "", Text(self._curve(), style="green") + Text("  angry ▁  neutral ▄  happy █", "dim")
        )
        serious = [line for line in self.robot_log if line.severity != "information"]
        for line in serious[-MAX_LOG_LINES:]:
            table.add_row("robot said", literal_text(f"{line.severity}: {line.text}"))
        table.add_row(
            "a frame took", f"{median:.1f} ms in the median, {slow:.1f} ms at the 95th percentile"
        )
        if self.camera is not None:
            table.add_row("camera", camera_line(self.camera))
        if self.gaps:
            lost = sum(seconds for _, seconds in self.gaps)
            count = "once" if len(self.gaps) == 1 else f"{len(self.gaps)} times"
            table.add_row("camera lost", f"{count}, {lost:.1f} s in all")
        if self.lens is not None:
            table.add_row("lens", self.lens)
        names = dict.fromkeys([self.scenario, *(name for _, name in self.scenarios)])
        title = f"[bold]{', '.join(names)}"
        return Panel(Group(table), title=title, title_align="left", expand=False)

    def _curve(self) -> str:
        """Return the valence over time as a line of blocks."""
        if not self.moods:
            return ""
        last = len(self.moods) - 1
        picks = (self.moods[round(i * last / (CURVE_WIDTH - 1))][1] for i in range(CURVE_WIDTH))
        heights = (int((min(1.0, max(-1.0, valence)) + 1) * 3.999) for valence in picks)
        return "".join(CURVE_BLOCKS[min(7, height)] for height in heights)


def camera_line(health: Health) -> str:
    """Return the figures of a live source in one line.

    >>> camera_line(Health("camera 0", "running", 0.0, rate=30.0, latency=0.041, dropped=2))
    '30.0 pictures/s, 41 ms old (since arrival), 2 left out for newer ones, none waited'
    """
    clock = "since exposure" if health.stamped_by == "driver" else "since arrival"
    waited = f"at most {health.max_queue} waited" if health.max_queue else "none waited"
    return (
        f"{health.rate:.1f} pictures/s, {1000 * health.latency:.0f} ms old ({clock}), "
        f"{health.dropped} left out for newer ones, {waited}"
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
