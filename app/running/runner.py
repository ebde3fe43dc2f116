"""One session: frames in, pictures and emotions out, everything recorded that is asked for."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from app.errors import AppError
from app.pipeline.playground import Playground
from app.pipeline.scenario import Inputs
from app.pipeline.step import Given, Step
from app.running.clock import SessionClock
from app.running.gaps import Gaps
from app.running.players import PlayerLine
from app.running.robots import RobotLine
from app.running.summary import Summary
from app.session import START_OVER, Recorder, preparation
from app.ui.notice import notice
from app.ui.screen import Screen
from robot import RobotError
from tracking import Frame, FrameSource, Health, Intrinsics, LiveFrames, TrackingError

Progress = Callable[[Step], None]

BREATH_S = 0.05
"""While no frame comes, the window is served at least so often."""

PATIENCE_S = 30.0
"""So long a lost camera may take to come back while somebody is there to plug it in."""


@dataclass(frozen=True)
class Plan:
    """What a session is made of."""

    source: FrameSource
    """Where the frames come from; the caller closes it."""

    playground: Playground
    """The line that they walk; the caller closes it."""

    screen: Screen
    """Where the pictures go; the caller closes it."""

    robot: str = "none"
    """Who feels: see `RobotLine.open`."""

    record: Path | None = None
    """Where to record the session, or None."""

    codec: str = "jpeg"
    """How a recording keeps the pictures: "jpeg" or "h264"."""

    about: dict[str, str] | None = None
    """What the recording says of itself."""

    paced: bool = False
    """Whether a recording is played at the speed at which it was taken."""

    salvage: bool = False
    """Whether a source that breaks off is simply at its end."""

    cues: frozenset[float] = frozenset()
    """Times of the frames in which the player started over, in a replay [s]."""

    given: Iterator[Given] | None = None
    """Arrows of a replay that are taken as recorded, a frame at a time."""

    patience: float = PATIENCE_S
    """How long a live source may be lost before the session ends [s]."""

    player: PlayerLine | None = None
    """Who publishes what the character does and feels; the caller closes it."""

    robot_settings: Path | None = None
    """A TOML file for the robot's driver, or None."""


def run(plan: Plan, progress: Progress | None = None) -> Summary:
    """Play a session to its end, until the player closes it, or until Ctrl-C.

    Raises
    ------
    TrackingError, RobotError, AppError
        The source, the robot or the disk failed; what was recorded until then is whole.
    """
    summary = Summary(plan.playground.scenario.name)
    clock = SessionClock()
    with ExitStack() as closing:
        recorder: Recorder | None = None
        if plan.record is not None:
            recorder = closing.enter_context(Recorder(plan.record, plan.about or {}))
        tap = WireTap(recorder) if recorder is not None else None
        stepped = not plan.paced and not plan.source.live
        line = RobotLine.open(plan.robot, clock, tap, plan.robot_settings, stepped=stepped)
        robot = closing.enter_context(line)
        closing.callback(clock.release)  # a robot says goodbye in real time
        closing.enter_context(_interruptible(summary))
        play = _Play(plan, summary, recorder, robot)
        gaps = Gaps(summary, recorder)
        for frame in _frames(plan, clock, summary):
            if isinstance(frame, Health):
                _wait(plan, frame, gaps)
            else:
                gaps.back(frame)
                if tap is not None:
                    tap.align(frame.timestamp - clock())
                step = play.step(frame)
                if progress is not None:
                    progress(step)
            if plan.screen.closed:
                break
        # A robot that falls silent stops nobody's play, and the link keeps trying;
        # whether it came back is told at the end.
        try:
            robot.check()
        except RobotError as lost:
            summary.lost = summary.lost or lost
    if isinstance(plan.source, LiveFrames):
        summary.camera = plan.source.health
    return summary


class _Play:
    """Takes a session from frame to frame."""

    def __init__(
        self,
        plan: Plan,
        summary: Summary,
        recorder: Recorder | None,
        robot: RobotLine,
    ) -> None:
        self._plan, self._summary, self._recorder = plan, summary, recorder
        self._robot = robot
        self._inputs = Inputs()
        self._prepare = None
        if recorder is not None:
            self._prepare = preparation(plan.codec, plan.source.size, plan.source.rate)

    def step(self, frame: Frame) -> Step:
        """Walk a frame down the line, show it, and record it."""
        plan = self._plan
        began = time.perf_counter()
        inputs = Inputs(clear=True) if frame.timestamp in plan.cues else self._inputs
        given = next(plan.given, None) if plan.given is not None else None
        prepared = self._prepare(frame) if self._prepare else frame
        step = plan.playground.step(prepared, inputs, given)
        # First the look: right after a wish the link's thread is busy with it.
        view = self._robot.view()
        self._robot.feel(step.emotion)
        if plan.player is not None:
            plan.player.tell(step.command, step.emotion)
        seconds = time.perf_counter() - began
        if self._recorder is not None:
            if inputs.clear:
                self._recorder.event(START_OVER, frame.timestamp)
            first = self._summary.frames == 0
            _record(self._recorder, plan.playground.intrinsics, step, first=first)
        self._inputs = plan.screen.show(step, view)
        self._summary.add(step, view, seconds)
        return step


def _wait(plan: Plan, health: Health, gaps: Gaps) -> None:
    """Keep the screen alive while no frame comes."""
    words = notice(health)
    if words is not None:
        gaps.lost()
    plan.screen.wait(words)


class WireTap:
    """Records what goes over the wire in the time of the frames; called from the link's thread.

    Until the first frame the two times cannot be compared, so the greeting waits for it.

    Parameters
    ----------
    recorder
        Where it is recorded.
    """

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self._lock = threading.Lock()
        self._early: list[tuple[str, bytes, float]] = []
        self._shift: float | None = None

    def __call__(self, direction: str, data: bytes, time: float) -> None:
        """Record bytes of one direction at a time of the session's clock [s]."""
        with self._lock:
            if self._shift is None:
                self._early.append((direction, data, time))
            else:
                self._recorder.wire(direction, data, max(0.0, time + self._shift))

    def align(self, shift: float) -> None:
        """Say what to add to the clock's time for that of the frames; the first call counts."""
        with self._lock:
            if self._shift is not None:
                return
            self._shift = shift
            for direction, data, time in self._early:
                self._recorder.wire(direction, data, max(0.0, time + shift))
            self._early.clear()


def _frames(plan: Plan, clock: SessionClock, summary: Summary) -> Iterator[Frame | Health]:
    """Give out the frames: live ones as they come, recorded ones at their pace or at once.

    While a live source has none, how it fares is given out instead, again and again.
    """
    start: float | None = None
    began = time.monotonic()
    for frame in _readable(plan, summary):
        if isinstance(frame, Health):
            yield frame
            continue
        if start is None:
            start, began = frame.timestamp, time.monotonic()
        since = frame.timestamp - start
        if plan.paced and not plan.source.live:
            time.sleep(max(0.0, began + since - time.monotonic()))
        elif not plan.source.live:
            clock.drive(since)
        yield frame


def _readable(plan: Plan, summary: Summary) -> Iterator[Frame | Health]:
    """Give out what can be read; a camera that breaks off ends the session, and what it made stays.

    A file that breaks off is an error: it can be played again with `salvage`.
    """
    try:
        yield from _given_out(plan)
    except TrackingError as error:
        if plan.salvage:
            return
        if not plan.source.live or not summary.frames:
            raise
        summary.lost = error


def _given_out(plan: Plan) -> Iterator[Frame | Health]:
    if not isinstance(plan.source, LiveFrames):
        yield from plan.source
        return
    while plan.source.health.state != "closed":
        frame = plan.source.wait(BREATH_S, plan.patience)
        yield frame or plan.source.health


@contextmanager
def _interruptible(summary: Summary) -> Iterator[None]:
    """Make Ctrl-C the end of the session rather than an error."""
    try:
        yield
    except KeyboardInterrupt:
        summary.interrupted = True


def _record(recorder: Recorder, intrinsics: Intrinsics, step: Step, *, first: bool) -> None:
    if first:
        recorder.camera(intrinsics, step.frame.timestamp)
    recorder.write(step)
    if step.controls.placed:
        recorder.event(f"placed {step.controls.top_face}", step.frame.timestamp)
    if step.controls.shaken:
        recorder.event("shaken", step.frame.timestamp)
    if recorder.problem is not None:
        raise AppError(recorder.problem)
