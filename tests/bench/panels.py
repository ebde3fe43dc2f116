"""Time that the window's panels take in a frame: `python -m tests.bench.panels [--frames N]`.

A window of 1280×720 that needs no display shows a bundled recording, 30 frames a second, with no
panel, with the usual ones and with all. The wall time is that until the driver has drawn
everything; the processor's time is that of all its threads, which do the drawing without a graphics
card.
"""

import argparse
import itertools
import time

import imgui_bundle as imgui_bundle  # isort: skip  # sets the path of the GLFW that it contains
import glfw
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.frame_times import FrameTimes
from cubeling.app.pipeline.playground import Playground
from cubeling.app.preferences import Preferences, PreferenceStore
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.running.robots import RobotLine
from cubeling.app.session import SessionOptions
from cubeling.app.session.bundled import bundled_session
from cubeling.app.ui.panels import PANELS
from cubeling.app.ui.panels.drawing.layer import PanelLayer
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.window import Window
from cubeling.tracking import open_source
from tools.offscreen import no_display_needed

FRAME_S = 1 / 30
SETTLING_FRAMES = 10
CLOSED_TARGET_MS, OPEN_TARGET_MS = 0.05, 2.0

SETS: dict[str, tuple[str, ...] | None] = {
    "closed": None,
    "list": (),
    **{name: (name,) for name in PANELS},
    "usual": Preferences().panels,
    "all": tuple(PANELS),
}
"""Which panels are open; None for closed panels. The list is open with each of them."""


class Bench:
    """A window with some steps of a bundled recording, and a simulated robot."""

    def __init__(self, window: Window, robot: RobotLine, monitor: SessionMonitor) -> None:
        self._window, self._robot, self._monitor = window, robot, monitor
        with open_source(monitor.options.source) as source:
            intrinsics = intrinsics_for(source.intrinsics, source.size)
            self._playground = Playground("companion", intrinsics, context=window.context)
            self._steps = [self._playground.step(each) for each in itertools.islice(source, 20)]

    def measure(self, panels: tuple[str, ...] | None, frames: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the wall and the processor's time of each frame [ms]."""
        context, monitor = self._window.context, self._monitor
        given = {"panels": panels or (), "panels_shown": panels is not None}
        store = PreferenceStore(None, given)
        layer = PanelLayer(glfw.get_current_context(), context, monitor, store)
        wall, processor = [], []
        for step in itertools.islice(itertools.cycle(self._steps), frames + SETTLING_FRAMES):
            self._robot.feel(step.emotion)
            view = self._robot.view()
            assert step.picture is not None
            self._window.paint(step.picture)
            context.finish()
            began, spent = time.perf_counter(), time.process_time()
            monitor.update(step, view, self._playground)
            layer.draw()
            if layer.shown:
                context.finish()
            wall.append(time.perf_counter() - began)
            processor.append(time.process_time() - spent)
            monitor.times.lap("drawing")
            monitor.times.end_frame()
            time.sleep(max(0.0, FRAME_S - wall[-1]))
        layer.close()
        return 1e3 * np.array(wall[SETTLING_FRAMES:]), 1e3 * np.array(processor[SETTLING_FRAMES:])


def main() -> None:
    """Print a table of all sets of panels."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=150, help="frames of each set")
    frames = parser.parse_args().frames
    options = SessionOptions(scenario="companion", source=str(bundled_session("companion")))
    monitor = SessionMonitor(options, FrameTimes(time.perf_counter))
    table = Table("open", "mean ms", "median ms", "p95 ms", "processor ms", "target ms")
    robot = RobotLine.open("sim", time.monotonic, monitor.wire)
    with no_display_needed(), robot, Window((1280, 720)) as window:
        bench = Bench(window, robot, monitor)
        for name, panels in SETS.items():
            wall, processor = bench.measure(panels, frames)
            target = CLOSED_TARGET_MS if panels is None else OPEN_TARGET_MS
            verdict = "reached" if np.median(wall) <= target else "MISSED"
            figures = (wall.mean(), np.median(wall), np.percentile(wall, 95), processor.mean())
            table.add_row(name, *(f"{each:.2f}" for each in figures), f"{target:g}: {verdict}")
    Console().print(table)


if __name__ == "__main__":
    main()
