"""The command `cubeling calibrate`."""

from __future__ import annotations

import shlex
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.play.play_options import DEFAULT_CAMERA, CubeOption
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input
from cubeling.app.output_path import check_output
from cubeling.app.ui.display import has_display

if TYPE_CHECKING:
    from cubeling.app.ui.calibration.session import CalibrationSession, Coach
    from cubeling.tracking import CubeModel, FrameSource, Intrinsics
    from cubeling.tracking.calibration import Calibration, TargetFinder

CAMERA_FILE = Path("camera.yaml")

CAMERA_SUFFIXES = (".yaml", ".yml")
"""Suffixes of a camera file."""

COVERAGE_SUFFIXES = (".png", ".jpg")
"""Suffixes of a picture of the coverage."""

Source = Annotated[
    str,
    typer.Option(
        "--source",
        "-s",
        help="Where the pictures come from: camera:0, a video, a session (.mcap), "
        "http://PHONE:8080/video, or synthetic:wave.",
    ),
]
Output = Annotated[Path, typer.Option("--output", "-o", help="The camera file to write.")]
SaveCube = Annotated[
    Path | None,
    typer.Option(help="Write the cube as measured to this .toml file."),
]
BoardKind = Annotated[str, typer.Option(help="charuco: use a printed board instead of the cube.")]
PrintBoard = Annotated[Path | None, typer.Option(help="Write that board to this PDF and exit.")]
Checked = Annotated[
    Path | None,
    typer.Option("--check", help="Tell whether this camera file still fits; write nothing."),
]
Coverage = Annotated[
    Path | None, typer.Option(help="Draw where the views were to this .png or .jpg.")
]
Seconds = Annotated[
    float, typer.Option(min=5, max=600, help="Longest time for a live camera, in seconds.")
]
Shown = Annotated[
    bool, typer.Option("--window/--no-window", help="Coach in a window, or in printed lines.")
]


def calibrate(
    source: Source = DEFAULT_CAMERA,
    cube: CubeOption = None,
    output: Output = CAMERA_FILE,
    save_cube: SaveCube = None,
    board: BoardKind = "",
    print_board: PrintBoard = None,
    paper: Annotated[str, typer.Option(help="Paper of --print-board: a4, letter or a3.")] = "a4",
    checked: Checked = None,
    coverage: Coverage = None,
    seconds: Seconds = 120.0,
    window: Shown = True,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Overwrite files that exist.")
    ] = False,
) -> None:
    """Measure the camera's lens: wave the cube in front of it for about 20 seconds.

    Follow the coach: tip the cube every way, take it to every corner of the picture, near and far,
    and hold it still for a moment each time. If you have no cube, print a board:
    --print-board board.pdf, then --board charuco.

    With --check, the exit code is 0 for OK and 1 for DEGRADED.

    Example: cubeling calibrate -o camera.yaml --save-cube my-cube.toml
    """
    _check_paths(output, save_cube, coverage, overwrite)
    check_input(checked, "camera file")
    if ":" not in source:
        check_input(source, "video")
    from cubeling.app.running.kept_lens import intrinsics_for
    from cubeling.app.ui.calibration.coach_lines import write_coverage
    from cubeling.tracking import Intrinsics, open_source
    from cubeling.tracking.calibration import CubeFinder, write_board

    console = Console(soft_wrap=True, highlight=False)
    if print_board is not None:
        check_output(print_board, "board", (".pdf",), overwrite=overwrite)
        write_board(print_board, paper)
        console.print(f"[bold]{escape(str(print_board))}[/] is ready. Print it and keep it flat.")
        return
    finders = target_finders(cube, board)
    saved = None if checked is None else Intrinsics.load(checked)
    shown = window and has_display()
    with ExitStack() as closing:
        frames = closing.enter_context(open_source(source))
        if saved is not None:
            saved = intrinsics_for(saved, frames.size)
        session = _collect_views(finders, frames, "board" if board else "cube", shown, seconds)
    if coverage is not None:
        write_coverage(coverage, session)
    if checked is not None and saved is not None:
        raise typer.Exit(_report_check(session, checked, saved, frames.size, console))
    found = session.calibrate()
    found.intrinsics.save(output)
    console.print(calibration_line(output, found))
    if isinstance(session.finder, CubeFinder):
        _report_cube(session.finder.cube, found, output, save_cube, console)


def target_finders(cube: str | None, board: str) -> list[TargetFinder]:
    """Return the finders of what may be held up: the named cube, any bundled one, or the board."""
    if board not in ("", "charuco"):
        raise AppError(f"no board is called '{board}': use charuco")
    from cubeling.tracking import CubeModel, bundled_cubes
    from cubeling.tracking.calibration import Board, BoardFinder, CubeFinder

    if board:
        return [BoardFinder(Board())]
    return [CubeFinder(CubeModel.load(name)) for name in ([cube] if cube else bundled_cubes())]


def calibration_line(path: Path, found: Calibration) -> str:
    """Return the camera that was found, and its uncertainty, in one line."""
    focal = found.intrinsics.matrix[0, 0]
    advice = "" if found.good else " (tilt more for a better one)"
    return (
        f"[bold]{escape(str(path))}[/] is ready: focal length {focal:.1f} px ± "
        f"{200 * found.focal_spread:.2f} %{advice}, edges lie within {found.residual:.2f} px, "
        f"from {found.views} views"
    )


def _collect_views(
    finders: list[TargetFinder], frames: FrameSource, target: str, shown: bool, seconds: float
) -> CalibrationSession:
    """Run the coach in a window or on the terminal; Ctrl-C ends the session, not the program."""
    from cubeling.app.ui.calibration.coach_lines import CoachLines
    from cubeling.app.ui.calibration.session import CalibrationSession

    session = CalibrationSession(finders, frames.size)
    with ExitStack() as closing, suppress(KeyboardInterrupt):
        coach: Coach = CoachLines(Console(soft_wrap=True, highlight=False), target)
        if shown:
            from cubeling.app.ui.calibration.coach_window import (
                CoachWindow,  # needs a display's libraries
            )

            coach = closing.enter_context(CoachWindow(frames.size, target))
        session.run(frames, coach, seconds)
    return session


def _report_check(
    session: CalibrationSession,
    path: Path,
    saved: Intrinsics,
    size: tuple[int, int],
    console: Console,
) -> int:
    """Compare a saved camera with the views, print the result, and return the exit code."""
    session.check_seen()
    from cubeling.tracking.calibration import check_camera

    verdict = check_camera(session.collector.views, saved, session.finder.target(size))
    color, word = ("red", "DEGRADED") if verdict.degraded else ("green", "OK")
    x, y = verdict.centre_change
    console.print(
        f"[bold {color}]{word}[/]  {escape(str(path))}: focal length "
        f"{100 * verdict.focal_change:+z.2f} % (± {200 * verdict.focal_spread:.2f} %), middle "
        f"{x:+z.1f} {y:+z.1f} px, edges off by {verdict.residual:.3f} px "
        f"(at best {verdict.best_residual:.3f} px), from {quantity(verdict.views, 'view')}"
    )
    if verdict.degraded:
        console.print(f"Calibrate again: [cyan]cubeling calibrate -o {_quote(path)}[/]")
    return int(verdict.degraded)


def _report_cube(
    ideal: CubeModel, found: Calibration, camera: Path, path: Path | None, console: Console
) -> None:
    """Print how far the cube is from its design, save it if asked to, and say what comes next."""
    import numpy as np

    from cubeling.app.pipeline.cubes.other_cube import scenario_for
    from cubeling.tracking import write_cube
    from cubeling.tracking.calibration import measured_cube

    cube = measured_cube(ideal, found.plates)
    worst = 0.0
    for face in cube.faces:
        off = face.corners - cube.designed_corners(face)
        worst = max(worst, float(np.linalg.norm(off, axis=1).max()))
    if path is not None:
        write_cube(cube, path)
        name = escape(str(path))
        console.print(f"[bold]{name}[/] holds the cube: its sides are off by {worst * 1e3:.1f} mm")
    else:
        console.print(
            f"The cube's sides are off by up to {worst * 1e3:.1f} mm; "
            "--save-cube my-cube.toml keeps that"
        )
    option = "" if path is None else f" --cube {_quote(path)}"
    scenario = scenario_for(cube) or "SCENARIO"
    command = f"cubeling play {scenario} --intrinsics {_quote(camera)}{option}"
    console.print(f"Play with it: [cyan]{command}[/]")


def _quote(path: Path) -> str:
    """Return a path for a command line, as markup."""
    return escape(shlex.quote(str(path)))


def _check_paths(
    output: Path, save_cube: Path | None, coverage: Path | None, overwrite: bool
) -> None:
    """Refuse files that cannot be written, before the user waves a cube.

    The camera's file of the default name is the program's own, so it may exist.
    """
    for path, kind, suffixes in (
        (output, "camera", CAMERA_SUFFIXES),
        (save_cube, "cube", (".toml",)),
        (coverage, "picture", COVERAGE_SUFFIXES),
    ):
        if path is not None:
            check_output(path, kind, suffixes, overwrite=overwrite or path == CAMERA_FILE)
