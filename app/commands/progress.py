"""Playing a session: its progress bar, and what is printed about it."""

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from app.errors import AppError
from app.pipeline.step import Step
from app.running.opening import OpenedSession, open_session
from app.running.players import PlayerPublisher
from app.running.runner import run
from app.running.summary import Summary
from app.session import SessionOptions
from app.ui.notice import lens_notice
from tracking import FrameSource


def play_session(
    options: SessionOptions,
    title: str,
    *,
    source: FrameSource | None = None,
    player: PlayerPublisher | None = None,
) -> None:
    """Open a session, run it, and print its summary; see `open_session`."""
    console = Console()
    with open_session(options, source=source, player=player) as session:
        if options.intrinsics is None and session.source.intrinsics is None:
            console.print(
                "[dim]The camera is not calibrated: a lens of 60° is guessed. "
                "[cyan]cubeling calibrate[/] finds the true one in 20 s.[/]"
            )
        summary = run_with_progress(session, console, title)
    console.print(summary)
    if options.output is not None:
        size = options.output.stat().st_size / 1e6
        console.print(f"[bold]{options.output}[/] is ready: {size:.1f} MB")
    summary.check()


def run_with_progress(session: OpenedSession, console: Console, title: str) -> Summary:
    """Run a session, with a progress bar if its length is known; Ctrl-C discards a video."""
    duration = session.source.duration
    say_lens = _LensLine(session, console)
    if duration is None or session.options.windowed or not console.is_terminal:
        summary = run(session, say_lens)
    else:
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
        )
        with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
            task = bar.add_task(title, total=duration)
            start: float | None = None

            def progress(step: Step) -> None:
                nonlocal start
                now = step.frame.timestamp
                start = now if start is None else start
                bar.update(task, completed=now - start)
                say_lens(step)

            summary = run(session, progress)
    writes_video = session.options.pictures and session.options.output is not None
    if writes_video and summary.interrupted:
        raise KeyboardInterrupt
    if summary.frames == 0 and not summary.interrupted:
        raise AppError("the source gave no picture at all")
    return summary


class _LensLine:
    """Prints once, as soon as the cube has shown it, that the lens is not as it claims."""

    def __init__(self, session: OpenedSession, console: Console) -> None:
        self._playground, self._console = session.playground, console
        self._said = False

    def __call__(self, step: Step) -> None:
        if self._said:
            return
        words = lens_notice(self._playground.lens, self._playground.intrinsics)
        if words is not None:
            self._console.print(words)
            self._said = True
