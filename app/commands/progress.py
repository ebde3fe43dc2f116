"""Running a session with a progress bar beside it."""

from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from app.errors import AppError
from app.pipeline.step import Step
from app.running.opening import Wish, guessed
from app.running.runner import Plan, run
from app.running.summary import Summary
from app.ui.screen import VideoFile
from tracking import FrameSource


def play_to_end(plan: Plan, console: Console, title: str) -> Summary:
    """Run a session; show how far it is where its length is known and no window shows it.

    A video that Ctrl-C cuts off is not kept.
    """
    duration = plan.source.duration
    drawn = isinstance(plan.screen, VideoFile)
    if duration is None or plan.paced or not console.is_terminal:
        summary = run(plan)
    else:
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
        )
        with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
            task = bar.add_task(title, total=duration)
            first: list[float] = []

            def progress(step: Step) -> None:
                first[:] = first or [step.frame.timestamp]
                bar.update(task, completed=step.frame.timestamp - first[0])

            summary = run(plan, progress)
    if drawn and summary.interrupted:
        raise KeyboardInterrupt
    if summary.frames == 0 and not summary.interrupted:
        raise AppError("the source gave no picture at all")
    return summary


def tell_guess(wish: Wish, source: FrameSource, console: Console) -> None:
    """Say where lengths rest on a guessed lens, and what to do about it."""
    if guessed(wish, source):
        console.print(
            "[dim]The camera is not calibrated: a lens of 60° is guessed. "
            "[cyan]cubeling calibrate[/] finds the true one in 20 s.[/]"
        )


def finished_video(path: Path) -> str:
    """One line that says where a video is."""
    return f"[bold]{path}[/] is ready: {path.stat().st_size / 1e6:.1f} MB"
