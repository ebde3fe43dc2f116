"""How smoothly the window plays a recording: `python -m tests.bench.window [--seconds S]`.

The bundled recordings at 1280×720 in a window on a virtual screen (Xvfb), in real time, as a player
without a graphics card sees them. Showing is what the window takes for a picture, to the glass. CPU
time is of all threads, and of the main one alone: it counts where the machine has other work, as
then pictures are late that are not slow. "Beside it" is the mean CPU time of the other threads
during a part: those of a software driver, which draw on all cores, and those that read frames.
"""

import argparse
import json
import subprocess
import sys
import time
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.frame_times import FrameTimes
from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.app.session.options import SessionOptions
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.window import Window
from tests.virtual_screen import VirtualScreen

TARGET_RATE, TARGET_SHOWING_MS = 25.0, 8.0
"""Pictures a second of a recording with 30, and the time to show one [ms]."""

FIRST_S = 2.0
"""What does not count of a session [s]: shaders are compiled in it."""


def measure(scenario: str, seconds: float, quality: str, every: bool) -> dict[str, Any]:
    """Play the beginning of a recording in a window, and return its figures."""
    options = SessionOptions(
        scenario=scenario,
        source=str(bundled_session(scenario)),
        quality=quality,
        end_s=FIRST_S + seconds,
    )
    parts: list[dict[str, float]] = []
    beside: list[dict[str, float]] = [{}]
    lap, others = FrameTimes.lap, [_others()]

    def lap_of_all(self: FrameTimes, part: str) -> None:
        lap(self, part)
        now = _others()
        beside[-1][part] = beside[-1].get(part, 0.0) + now - others[0]
        others[0] = now

    FrameTimes.lap = lap_of_all  # type: ignore[method-assign]
    began: list[tuple[float, float, float, int]] = []
    with open_session(options) as session:
        times, window = session.monitor.times, session.screen
        assert isinstance(window, Window)
        if every:
            assert session.pace is not None
            session.pace.max_late, session.pace._sleep = float("inf"), lambda seconds: None
            times._clock, times._last = time.thread_time, time.thread_time()
        end_frame = times.end_frame

        def counted() -> None:
            parts.append(times._frame)
            beside.append({})
            end_frame()

        times.end_frame = counted  # type: ignore[method-assign]
        report = window.report

        def quit_at_the_end(status: SessionStatus) -> None:
            report(status)
            if status.ending is not None:
                window.quit()

        window.report = quit_at_the_end  # type: ignore[method-assign]
        first: list[float] = []

        def progress(step: Step) -> None:
            first[:] = first or [step.frame.timestamp]
            played = step.frame.timestamp - first[0]
            if played >= FIRST_S and not began:
                began.append((time.perf_counter(), *_cpu(), len(parts) + 1))
            began[1:] = [(time.perf_counter(), *_cpu(), len(parts) + 1)] if began else []

        summary = run(session, progress)
        renderer = window.context.info["GL_RENDERER"]
    start, end = began[0], began[-1]
    counted_parts, counted_beside = parts[start[3] : end[3]], beside[start[3] : end[3]]
    names = dict.fromkeys(name for each in counted_parts for name in each)
    shown = end[3] - start[3]
    return {
        "renderer": renderer,
        "rate": shown / (end[0] - start[0]),
        "cpu": 1000 * (end[1] - start[1]) / shown,
        "main": 1000 * (end[2] - start[2]) / shown,
        "left_out": summary.left_out / (summary.left_out + summary.frames),
        "summary": summary.frame_ms(),
        "parts": {name: [1000 * each.get(name, 0.0) for each in counted_parts] for name in names},
        "beside": {
            name: 1000 * float(np.mean([each.get(name, 0.0) for each in counted_beside]))
            for name in names
        },
    }


def _cpu() -> tuple[float, float]:
    return time.process_time(), time.thread_time()


def _others() -> float:
    """Return the CPU time of all threads but the main one [s]."""
    return time.process_time() - time.thread_time()


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="of each recording")
    parser.add_argument("--scenario", choices=list(RECORDED_SCENARIOS), action="append")
    parser.add_argument("--quality", default="auto")
    parser.add_argument(
        "--every",
        action="store_true",
        help="show every frame, without waiting, and print the main thread's CPU time of each part",
    )
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    scenarios = given.scenario or list(RECORDED_SCENARIOS)
    if given.here:
        sys.stdout.write(
            json.dumps(measure(scenarios[0], given.seconds, given.quality, given.every))
        )
        return
    table = Table("scenario", "part", "mean ms", "median ms", "p95 ms", "beside it")
    with VirtualScreen() as screen:
        for name in scenarios:
            arguments = ["--here", "--seconds", f"{given.seconds}", "--quality", given.quality]
            arguments += ["--every"] * given.every
            done = subprocess.run(
                [sys.executable, "-m", "tests.bench.window", "--scenario", name, *arguments],
                env=screen.environment,
                stdout=subprocess.PIPE,
                check=True,
            )
            found = json.loads(done.stdout)
            for part, values in found["parts"].items():
                figures = np.mean(values), np.median(values), np.percentile(values, 95)
                shown_figures = (*figures, found["beside"][part])
                table.add_row(name, part, *(f"{each:.2f}" for each in shown_figures))
            table.add_row(name, "CPU of all threads", f"{found['cpu']:.2f}")
            table.add_row(name, "CPU of the main thread", f"{found['main']:.2f}")
            median, slow = found["summary"]
            table.add_row(name, "the summary says", "", f"{median:.2f}", f"{slow:.2f}")
            showing = float(np.median(found["parts"]["showing"]))
            reached = found["rate"] >= TARGET_RATE and showing <= TARGET_SHOWING_MS
            table.add_row(
                name,
                f"{found['rate']:.1f} pictures/s, {100 * found['left_out']:.0f} % left out: "
                f"{'reached' if reached else 'MISSED'}",
                end_section=True,
            )
    Console(width=100).print(found["renderer"], table)


if __name__ == "__main__":
    main()
