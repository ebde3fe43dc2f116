"""The first camera of the computer, and what is shown where there is none."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.play.play_options import DEFAULT_CAMERA
from cubeling.app.errors import AppError
from cubeling.app.scenarios import scenario_cube
from cubeling.app.session.bundled import RECORDED_SCENARIOS

if TYPE_CHECKING:
    from cubeling.app.session import SessionOptions
    from cubeling.tracking import FrameSource

DESK = "synthetic:talk"
"""What is drawn where there is no camera: the cube beside the character."""


def way_without_camera(scenario: str) -> str:
    """Return the command that plays a scenario on a computer without a camera."""
    if scenario in RECORDED_SCENARIOS:
        return f"cubeling demo {scenario} --recording"
    if scenario == "talk":
        return "cubeling talk"  # which draws the desk
    moves = "follow" if scenario_cube(scenario) == "locomotion" else "companion"
    return f"cubeling play {scenario} --source synthetic:{moves}"


@contextmanager
def saying_how_without(scenario: str) -> Iterator[None]:
    """Say how to play a scenario without a camera, in an AppError, where there is none."""
    from cubeling.tracking import NoCameraError

    try:
        yield
    except NoCameraError as error:
        raise AppError(f"{error}; without a camera: {way_without_camera(scenario)}") from error


def open_first_camera(closing: ExitStack, instead: str = "") -> "FrameSource | None":
    """Open the first camera; without one, say so, and what there is `instead`, and return None."""
    from cubeling.tracking import TrackingError, open_source

    try:
        return closing.enter_context(open_source(DEFAULT_CAMERA))
    except TrackingError as error:
        line = f"[dim]No live picture{instead}: {escape(str(error))}[/]"
        Console().print(line, soft_wrap=True)
        return None


def open_camera_or_desk(
    options: "SessionOptions", closing: ExitStack
) -> "tuple[SessionOptions, FrameSource | None]":
    """Open the first camera; without one, return options that draw the desk, and None."""
    camera = open_first_camera(closing, ", so the desk is drawn")
    return (options, camera) if camera else (replace(options, source=DESK), None)
