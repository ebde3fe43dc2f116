"""The command `cubeling latency`."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from cubeling.app.commands.play.play_options import DEFAULT_CAMERA
from cubeling.app.errors import AppError
from cubeling.app.interrupts import CTRL_C_EXIT_CODE
from cubeling.app.output_path import check_output
from cubeling.app.scenarios import check_scenario
from cubeling.app.ui.display import has_display
from cubeling.app.workshop.latency import MIN_FLIPS
from cubeling.files import write_whole

if TYPE_CHECKING:
    from cubeling.app.workshop.latency.program import ProgramTimes
    from cubeling.app.workshop.latency.session import LatencySession

Source = Annotated[
    str, typer.Option("--source", "-s", help="A live camera: camera:0, http://PHONE:8080/video.")
]
Flips = Annotated[int, typer.Option(min=MIN_FLIPS, max=1000, help="How many flips to measure.")]
Seed = Annotated[int, typer.Option(help="Seed of the flips' times.")]
Scenario = Annotated[
    str, typer.Option(help="What is played in the second part; none for no second part.")
]
Results = Annotated[
    Path | None, typer.Option("--json", help="Write the figures to this .json file, in seconds.")
]

PLAY_S = 6.0
"""How long the second part plays [s]."""


def latency(
    source: Source = DEFAULT_CAMERA,
    flips: Flips = 40,
    scenario: Scenario = "companion",
    results: Results = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Overwrite the file of --json if it exists.")
    ] = False,
    seed: Seed = 1,
) -> None:
    """Measure how late the picture is, with your own screen and camera.

    Point the camera at the pattern that flips; a camera above the screen sees it in a hand mirror.
    Then the scenario plays for a few seconds: hold the cube in view. The result is the time from a
    movement to its light on the screen. Ctrl-C or Esc ends early and keeps what was measured.

    Example: cubeling latency --source camera:0
    """
    play = None if scenario == "none" else scenario
    if play is not None:
        check_scenario(play)
    if results is not None:
        check_output(results, "result", (".json",), overwrite=overwrite)
    if not has_display():
        raise AppError("the latency is that of a screen, and there is no display here")
    console = Console(highlight=False)
    from cubeling.app.session import SessionOptions
    from cubeling.app.workshop.latency.program import program_times
    from cubeling.app.workshop.latency.result import latency_result
    from cubeling.app.workshop.latency.session import LatencySession
    from cubeling.tracking import LiveFrames, open_source

    with ExitStack() as closing:
        frames = closing.enter_context(open_source(source))
        if not isinstance(frames, LiveFrames):
            raise AppError(f"'{source}' is no live camera: its pictures do not show the screen")
        session = LatencySession(frames, flips, seed)
        renderer, ended, interrupted = _flip(session)
        program: ProgramTimes | None = None
        if play is not None and not ended:
            seen = len(session.detector.flips)
            console.print(f"[bold]{seen} flips were seen.[/] Now {play} plays: show it the cube.")
            options = SessionOptions(scenario=play, source=source, muted=True)
            program, interrupted = program_times(options, frames, PLAY_S)
        result = latency_result(source, session, frames.health, renderer, program)
    console.print(result)
    if results is not None:
        write_whole(results, json.dumps(result.as_json(), indent=1) + "\n", AppError)
    if interrupted:
        raise typer.Exit(CTRL_C_EXIT_CODE)


def _flip(session: LatencySession) -> tuple[str, bool, bool]:
    """Run the flips in a window.

    Returns
    -------
    tuple
        What draws, whether the user ended early, and whether by Ctrl-C.
    """
    from cubeling.app.workshop.latency.window import PatternWindow  # needs a display's libraries

    interrupted = False
    with PatternWindow() as window:
        try:
            session.run(window)
        except KeyboardInterrupt:
            if len(session.detector.flips) < MIN_FLIPS:
                raise
            interrupted = True
        return str(window.context.info["GL_RENDERER"]), interrupted or window.closed, interrupted
