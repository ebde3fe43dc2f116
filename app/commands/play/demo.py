"""The command `cubeling demo`."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from cubeling.app.commands.output import OverwriteOption, VideoCodecOption
from cubeling.app.commands.play.first_camera import open_first_camera, way_without_camera
from cubeling.app.commands.play.part import EndOption, LoopOption, StartOption
from cubeling.app.commands.play.play_options import (
    DEFAULT_CAMERA,
    FolderOption,
    OutputOption,
    PersonalityOption,
    ScenarioArgument,
)
from cubeling.app.commands.play.preference_options import GivenPreferences, with_preferences
from cubeling.app.errors import AppError
from cubeling.app.scenarios import check_scenario, scenario_cube
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.app.ui.display import has_display

if TYPE_CHECKING:
    from cubeling.app.session import SessionOptions
    from cubeling.app.ui.playback.status import EndCard

DEFAULT_VIDEO = Path("demo.mp4")
"""The program's own output: it is overwritten without being asked."""


@with_preferences
def demo(
    scenario: ScenarioArgument = "companion",
    recording: Annotated[
        bool,
        typer.Option("--recording", help="Play the bundled recording even if there is a camera."),
    ] = False,
    output: OutputOption = None,
    overwrite: OverwriteOption = False,
    codec: VideoCodecOption = "auto",
    personality: PersonalityOption = None,
    start: StartOption = 0.0,
    end: EndOption = None,
    loop: LoopOption = False,
    folder: FolderOption = None,
    *,
    preferences: GivenPreferences,
) -> None:
    """See it work: with your camera, with the bundled recording, or as a video.

    With a camera and a display, the live window opens. With a display only, the bundled recording
    plays in it as if it were live. Without a display, the recording is rendered to demo.mp4.
    A simulated robot on a real serial port shows the mood.

    Example: cubeling demo follow --recording
    """
    check_scenario(scenario)
    from cubeling.app.session import SessionOptions

    console = Console()
    part = SessionOptions(
        scenario=scenario,
        source="",
        personality=personality,
        start_s=start,
        end_s=end,
        loop=loop,
        folder=folder,
    )
    if output is not None or not has_display():
        options = replace(
            _of_recording(part),
            output=(output or DEFAULT_VIDEO).resolve(),
            overwrite=overwrite or output is None,
            video_codec=codec,
        )
        why = "as there is no display" if output is None else "as --output asks"
        render(preferences.open(options)[0], console, why)
        return
    with ExitStack() as closing:
        camera = None
        if not (recording or loop or start or end is not None):
            camera = open_first_camera(closing)
        if camera is None:
            console.print(
                f"Playing the bundled recording of [bold]{scenario}[/]; ? shows the keys, Esc ends."
            )
            options = _of_recording(part)
        else:
            console.print(
                f"Playing [bold]{scenario}[/] with your camera; ? shows the keys, Esc ends. "
                "No cube yet? "
                f"[cyan]cubeling cube {scenario_cube(scenario)}[/], "
                "or [cyan]cubeling demo --recording[/]"
            )
            options = replace(part, source=DEFAULT_CAMERA)
        options, kept = preferences.open(options)
        from cubeling.app.commands.play.progress import play_session

        ending = end_card(scenario)
        play_session(options, scenario, source=camera, ending=ending, preferences=kept)


def render(options: SessionOptions, console: Console, why: str) -> None:
    """Render the bundled recording of a scenario to a file, and print why, and the summary."""
    from cubeling.app.running.option_checks import check_output_paths

    assert options.output is not None
    check_output_paths(options)
    from cubeling.app.commands.play.progress import play_session
    from cubeling.app.session import session_info

    console.print(
        f"The bundled recording of [bold]{options.scenario}[/] "
        f"({session_info(Path(options.source)).duration:.0f} s) "
        f"is rendered to [bold]{options.output}[/], {why}"
    )
    ending = end_card(options.scenario)
    play_session(options, f"rendering {options.output.name}", ending=ending)
    console.print("Next, print the cube: [cyan]cubeling cube companion[/]")


def end_card(scenario: str) -> EndCard:
    """Return the card that says what to do after a demo."""
    from cubeling.app.ui.playback.status import EndCard

    return EndCard(
        f"That was {scenario}",
        (
            ("Print the cube", f"cubeling cube {scenario_cube(scenario)}"),
            ("Play it with your camera", f"cubeling play {scenario}"),
            ("Watch it again", f"cubeling demo {scenario} --recording"),
        ),
    )


def _of_recording(options: SessionOptions) -> SessionOptions:
    """Return the options with the bundled recording of the scenario as the source."""
    scenario = options.scenario
    if scenario not in RECORDED_SCENARIOS:
        raise AppError(
            f"there is no recording of '{scenario}': take a camera, or "
            f"{way_without_camera(scenario)}"
        )
    return replace(options, source=str(bundled_session(scenario)))
