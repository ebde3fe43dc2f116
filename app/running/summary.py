"""What happened: one screen for a person, the same numbers as JSON."""

import statistics
from dataclasses import dataclass, field

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from app.pipeline.step import RobotView, Step
from robot import RobotError
from tracking import Health, TrackingError

BLOCKS = "▁▂▃▄▅▆▇█"


@dataclass
class Summary:
    """Gathers what a session was like, a frame at a time."""

    scenario: str
    """Which scenario was played."""

    frames: int = 0
    """Frames so far."""

    seen: int = 0
    """Frames in which the cube was found."""

    spans: list[tuple[float, str]] = field(default_factory=list)
    """When the character began something else [s], and what."""

    moods: list[tuple[float, float, str]] = field(default_factory=list)
    """Time [s], valence that the robot reports, and its word for it."""

    times: list[float] = field(default_factory=list)
    """How long each frame took, from the camera's picture to the finished one [s]."""

    lost: RobotError | TrackingError | None = None
    """Why the robot could not be reached at the end, or the camera stopped; None if all is well."""

    gaps: list[tuple[float, float]] = field(default_factory=list)
    """When the camera was lost [s, its timestamps], and how long until its next frame [s]."""

    camera: Health | None = None
    """How the camera fared, at the end; None where the source was none."""

    interrupted: bool = False
    """Whether the player ended it with Ctrl-C."""

    first: float = 0.0
    """Time of the first frame [s]."""

    last: float = 0.0
    """Time of the last frame [s]."""

    def add(self, step: Step, robot: RobotView, seconds: float) -> None:
        """Take in one frame and how long it took."""
        now = step.frame.timestamp
        if self.frames == 0:
            self.first = now
        self.last = now
        self.frames += 1
        self.seen += step.state.visible
        if not self.spans or self.spans[-1][1] != step.posed.state:
            self.spans.append((now - self.first, step.posed.state))
        self.moods.append((now - self.first, robot.mood, robot.label))
        self.times.append(seconds)

    def check(self) -> None:
        """Raise what went wrong with robot or camera; asked last, as all else is whole by then."""
        if self.lost is not None:
            raise self.lost

    @property
    def tracking_rate(self) -> float:
        """Share of the frames in which the cube was found, 0…1."""
        return self.seen / self.frames if self.frames else 0.0

    def labels(self) -> list[tuple[float, str]]:
        """When the robot's mood got another name [s], and which."""
        changes: list[tuple[float, str]] = []
        for time, _, label in self.moods:
            if not changes or changes[-1][1] != label:
                changes.append((time, label))
        return changes

    def frame_ms(self) -> tuple[float, float]:
        """Median and 95th percentile of the time a frame took [ms]."""
        if len(self.times) < 2:
            return (1000 * sum(self.times),) * 2
        cuts = statistics.quantiles(self.times, n=20)
        return 1000 * statistics.median(self.times), 1000 * cuts[18]

    def document(self) -> dict[str, object]:
        """Return the same as plain numbers for JSON."""
        median, slow = self.frame_ms()
        camera = {} if self.camera is None else {"camera": self._camera(self.camera)}
        return {
            "scenario": self.scenario,
            "frames": self.frames,
            "duration_s": round(self.last - self.first, 3),
            "tracking_rate": round(self.tracking_rate, 4),
            "actions": [{"t_s": round(t, 3), "state": state} for t, state in self.spans],
            "robot": [{"t_s": round(t, 3), "label": label} for t, label in self.labels()],
            "frame_ms": {"median": round(median, 2), "p95": round(slow, 2)},
            **camera,
        }

    def _camera(self, health: Health) -> dict[str, object]:
        return {
            "rate": round(health.rate, 2),
            "latency_ms": round(1000 * health.latency, 1),
            "stamped_by": health.stamped_by,
            "dropped": health.dropped,
            "queue": {"mean": round(health.depth, 2), "most": health.deepest},
            "gaps": [{"t_s": round(t - self.first, 3), "s": round(s, 3)} for t, s in self.gaps],
            "settings": {setting.name: setting.told for setting in health.settings},
        }

    def __rich__(self) -> RenderableType:
        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold", no_wrap=True)
        table.add_column()
        duration = self.last - self.first
        median, slow = self.frame_ms()
        table.add_row("played", f"{self.frames} frames, {duration:.1f} s")
        table.add_row("cube found", f"in {100 * self.tracking_rate:.1f} % of the frames")
        table.add_row("character", _story(self.spans, duration))
        table.add_row("robot felt", _story(self.labels(), duration))
        table.add_row(
            "", Text(self._curve(56), style="green") + Text("  angry ▁  neutral ▄  happy █", "dim")
        )
        table.add_row(
            "a frame took", f"{median:.1f} ms in the median, {slow:.1f} ms at the 95th percentile"
        )
        if self.camera is not None:
            table.add_row("camera", camera_line(self.camera))
        if self.gaps:
            lost = sum(seconds for _, seconds in self.gaps)
            count = "once" if len(self.gaps) == 1 else f"{len(self.gaps)} times"
            table.add_row("camera lost", f"{count}, {lost:.1f} s in all")
        return Panel(Group(table), title=f"[bold]{self.scenario}", title_align="left", expand=False)

    def _curve(self, width: int) -> str:
        if not self.moods:
            return ""
        picks = [
            self.moods[round(i * (len(self.moods) - 1) / (width - 1))][1] for i in range(width)
        ]
        return "".join(
            BLOCKS[min(7, int((min(1.0, max(-1.0, mood)) + 1) * 3.999))] for mood in picks
        )


def camera_line(health: Health) -> str:
    """Return a live source's figures in one line.

    >>> camera_line(Health("camera 0", "running", 0.0, rate=30.0, latency=0.041, dropped=2))
    '30.0 pictures/s, 41 ms old (since arrival), 2 left out for newer ones, none waited'
    """
    clock = "since exposure" if health.stamped_by == "driver" else "since arrival"
    waited = f"at most {health.deepest} waited" if health.deepest else "none waited"
    return (
        f"{health.rate:.1f} pictures/s, {1000 * health.latency:.0f} ms old ({clock}), "
        f"{health.dropped} left out for newer ones, {waited}"
    )


MOMENT = 0.6
"""A state shorter than this is told as part of the one before it [s]."""


def lasting(changes: list[tuple[float, str]], duration: float) -> list[tuple[float, str]]:
    """Leave out what lasted for a moment only.

    >>> lasting([(0.0, "idle"), (3.0, "run"), (3.2, "idle"), (9.0, "walk")], 12.0)
    [(0.0, 'idle'), (9.0, 'walk')]
    """
    kept: list[tuple[float, str]] = []
    for (start, state), end in zip(changes, [*(t for t, _ in changes[1:]), duration], strict=True):
        if kept and (end - start < MOMENT or kept[-1][1] == state):
            continue
        kept.append((start, state))
    return kept


def _story(changes: list[tuple[float, str]], duration: float) -> str:
    """Return "idle 3 s → kiss 9 s → …", at most a dozen entries."""
    changes = lasting(changes, duration)
    ends = [time for time, _ in changes[1:]] + [duration]
    told = [f"{what} {end - time:.1f} s" for (time, what), end in zip(changes, ends, strict=True)]
    if len(told) > 12:
        told = [*told[:11], f"… and {len(told) - 11} more"]
    return " → ".join(told)
