"""Playing a session: its progress, and what is printed about it at the end."""

import shlex
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import Step
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.front_end import FrontEnd
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.running.summary.summary import Summary
from cubeling.app.session import SessionFile, SessionOptions, session_info
from cubeling.app.ui.notice import focal_length, lens_notice
from cubeling.app.ui.playback.status import EndCard
from cubeling.tracking import FrameSource, Intrinsics

LINE_INTERVAL_S = 5.0
"""Time between two lines of progress outside a terminal [s]."""


def play_session(
    options: SessionOptions,
    title: str,
    *,
    source: FrameSource | None = None,
    replayed: SessionFile | None = None,
    front_end: FrontEnd | None = None,
    instruments: Sequence[Instrument] = (),
    ending: EndCard | None = None,
    preferences: PreferenceStore | None = None,
    typed: Iterable[str] | None = None,
    until_over: bool = False,
) -> None:
    """Open a session, run it, and print its summary and what was kept; see `open_session`.

    Raises KeyboardInterrupt if Ctrl-C ended it before its output was complete.
    """
    console = Console()
    preferences = preferences or PreferenceStore()
    with ExitStack() as at_end:
        at_end.enter_context(_keep_preferences(preferences, console))
        if options.record is not None:
            at_end.callback(report_recording, options.record, console)
        with open_session(
            options,
            source=source,
            replayed=replayed,
            front_end=front_end,
            instruments=instruments,
            ending=ending,
            preferences=preferences,
            typed=typed,
            until_over=until_over,
        ) as session:
            at_end.callback(report_kept, session, console)
            if options.intrinsics is None and session.source.intrinsics is None:
                _say_lens(session, console)
                at_end.callback(_keep_lens, session, console)
            open_ended = typed is not None or until_over
            summary = run_with_progress(session, console, title, open_ended=open_ended)
        console.print(summary)
        if options.output is not None:
            report_output(options.output, summary, console)
    summary.check()
    if session.recording_problem:
        raise AppError(session.recording_problem)


@contextmanager
def _keep_preferences(preferences: PreferenceStore, console: Console) -> Iterator[None]:
    """Keep what the player changes of the preferences; print why they are not read or kept."""
    reported = preferences.problem
    if reported is not None:
        console.print(f"[dim]{escape(reported)}[/]", soft_wrap=True)
    try:
        yield
    finally:
        preferences.save()
        if preferences.problem != reported:
            console.print(f"[dim]{escape(str(preferences.problem))}[/]", soft_wrap=True)


def _say_lens(session: OpenedSession, console: Console) -> None:
    """Print through which lens a camera that was not calibrated is looked through."""
    lens = session.playground.intrinsics
    words = "a lens of 60° is guessed, and measured while you turn the cube"
    if lens.focal_deviation != Intrinsics.guess(lens.size).focal_deviation:
        words = f"its lens is the one that play has measured, {focal_length(lens)}"
    console.print(
        f"[dim]The camera is not calibrated: {words}. "
        "[cyan]cubeling calibrate[/] finds the true one in 20 s.[/]"
    )
    _say_lens_problem(session, console)


def _say_lens_problem(session: OpenedSession, console: Console) -> None:
    if session.lenses.problem:
        console.print(f"[dim]{escape(session.lenses.problem)}[/]", soft_wrap=True)
        session.lenses.problem = ""


def _keep_lens(session: OpenedSession, console: Console) -> None:
    """Keep the lens that play has measured, and print where."""
    path = session.keep_lens()
    if path is not None:
        lens = focal_length(session.playground.tracked.measured_intrinsics)
        console.print(
            f"[dim]The lens of this camera, {lens}, is kept in {escape(str(path))}[/]",
            soft_wrap=True,
        )
    _say_lens_problem(session, console)


def report_output(path: Path, summary: Summary, console: Console) -> None:
    """Print what was written; raise KeyboardInterrupt if Ctrl-C ended the session."""
    name, size = escape(str(path)), path.stat().st_size / 1e6
    if summary.interrupted:
        kept = f"Stopped: {summary.duration:.1f} s are kept in [bold]{name}[/], {size:.1f} MB"
        console.print(kept, soft_wrap=True)
        raise KeyboardInterrupt
    console.print(f"[bold]{name}[/] is ready: {size:.1f} MB", soft_wrap=True)


def report_kept(session: OpenedSession, console: Console) -> None:
    """Print what the recordings hold that the player made by a key."""
    for path in session.recorded:
        if path != session.asked.record:
            report_recording(path, console)


def report_recording(path: Path, console: Console) -> None:
    """Print what a recording holds, and the command that plays it."""
    name = escape(str(path))
    if not path.exists():
        console.print(f"Nothing was recorded to {name}: there was no picture", soft_wrap=True)
        return
    replay = f"cubeling replay {escape(shlex.quote(str(path)))}"
    try:
        info = session_info(path)
    except AppError:  # the disk is full, for example; the session has ended with that error
        console.print(f"[bold]{name}[/] was cut off: [cyan]{replay} --salvage[/]", soft_wrap=True)
        return
    size = path.stat().st_size / 1e6
    if info.first_part:
        replay += " --from pose"
    console.print(
        f"Recorded to [bold]{name}[/]: {info.duration:.1f} s, {quantity(info.frames, 'frame')}, "
        f"{size:.1f} MB. "
        f"Play it again: [cyan]{replay}[/]",
        soft_wrap=True,
    )


def run_with_progress(
    session: OpenedSession, console: Console, title: str, *, open_ended: bool = False
) -> Summary:
    """Run a session and show its progress; raise KeyboardInterrupt if no picture came before it.

    One that is open-ended is over before its source is.
    """
    lens_line, sound_line = _LensLine(session, console), _SoundLine(session, console)
    hop_line = _HopLine(session, console)
    with _progress(session, console, title, open_ended) as report:

        def progress(step: Step) -> None:
            report(step)
            lens_line(step)
            hop_line(step)
            sound_line()

        summary = run(session, progress, lambda line: typer.echo(line, err=True))
    if summary.frames == 0:
        if summary.interrupted:
            raise KeyboardInterrupt
        raise AppError("the source gave no picture at all")
    return summary


@contextmanager
def _progress(
    session: OpenedSession, console: Console, title: str, open_ended: bool
) -> Iterator[Callable[[Step], None]]:
    """Show the progress of a session, except next to a window."""
    duration = None if open_ended else session.source.duration
    if duration is not None and session.options.end_s is not None:
        duration = min(duration, session.options.end_s)
    if session.options.windowed:
        yield lambda step: None
    else:
        with show_progress(title, duration, console) as report:
            yield report


@contextmanager
def show_progress(
    title: str, duration: float | None, console: Console
) -> Iterator[Callable[[Step], None]]:
    """Show how far the frames are of a duration [s]: a bar in a terminal, else lines.

    Lines are on standard error; the bar is where the console is, and goes at the end.
    """
    if duration is None or not console.is_terminal:
        yield ProgressLines(title, duration)
    else:
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
        )
        with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
            task = bar.add_task(title, total=duration)
            elapsed = _Elapsed()
            yield lambda step: bar.update(task, completed=elapsed(step))


class _Elapsed:
    """Returns how far a step is after the first one [s]."""

    def __init__(self) -> None:
        self._start: float | None = None

    def __call__(self, step: Step) -> float:
        now = step.frame.timestamp
        self._start = now if self._start is None else self._start
        return now - self._start


class ProgressLines:
    """Prints a line on standard error every few seconds: plain text, for logs and pipes.

    Parameters
    ----------
    title
        What is done.
    duration
        Length of the session [s]; None if it is not known.
    clock
        Returns the time [s].
    """

    def __init__(
        self, title: str, duration: float | None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._title, self._duration, self._clock = title, duration, clock
        self._began = self._printed = clock()
        self._elapsed = _Elapsed()
        self._frames = 0

    def __call__(self, step: Step) -> None:
        """Count a frame, and print a line if it is time."""
        self._frames += 1
        elapsed, now = self._elapsed(step), self._clock()
        if now - self._printed < LINE_INTERVAL_S:
            return
        self._printed = now
        typer.echo(f"{self._title}: {self._state(elapsed, now - self._began)}", err=True)

    def _state(self, elapsed: float, taken: float) -> str:
        """Return how far the session is [s], and how long the rest will take."""
        if not self._duration or elapsed <= 0.0:
            return f"frame {self._frames}, {elapsed:.0f} s so far"
        share = min(1.0, elapsed / self._duration)
        left = taken * (1.0 - share) / share
        return f"{100 * share:.0f} %, frame {self._frames}, about {left:.0f} s left"


class _LensLine:
    """Prints once, as soon as the cube has shown it, that the lens is not as it claims."""

    def __init__(self, session: OpenedSession, console: Console) -> None:
        self._playground, self._console = session.playground, console
        self._said = False

    def __call__(self, step: Step) -> None:
        if self._said:
            return
        words = lens_notice(
            self._playground.tracked.lens, self._playground.tracked.measured_intrinsics
        )
        if words is not None:
            self._console.print(words)
            self._said = True


class _HopLine:
    """Prints once, when the character hops as it cannot walk, what would give it a walk."""

    def __init__(self, session: OpenedSession, console: Console) -> None:
        self._name = session.playground.character.name
        self._file = session.options.character or self._name
        self._console, self._said = console, False

    def __call__(self, step: Step) -> None:
        if self._said or step.outcome.icon != "hop":
            return
        self._said = True
        file = escape(shlex.quote(self._file))
        self._console.print(
            f"{escape(self._name)} has no walk, so it hops: "
            f"[cyan]cubeling character locomotion {file} --walk WALK.bvh[/] gives it one",
            soft_wrap=True,
        )


class _SoundLine:
    """Prints once why nothing is heard or said, as soon as it is known."""

    def __init__(self, session: OpenedSession, console: Console) -> None:
        sound = session.sound
        self._watched: dict[str, Callable[[], str]] = {
            "No sound": lambda: "" if sound is None else sound.problem,
            "No speech": lambda: session.speaker.problem,
        }
        self._console = console

    def __call__(self) -> None:
        for words, problem_of in tuple(self._watched.items()):
            if problem := problem_of():
                self._console.print(f"[dim]{words}: {escape(problem)}[/]", soft_wrap=True)
                del self._watched[words]
