"""The command `cubeling show`."""

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from cubeling.app.commands.character_options import VoiceOption
from cubeling.app.commands.output import OverwriteOption, VideoCodecOption
from cubeling.app.commands.play.first_camera import DESK, open_camera_or_desk
from cubeling.app.commands.play.instrument_options import GivenInstruments, with_instruments
from cubeling.app.commands.play.play_options import (
    DEFAULT_CAMERA,
    FolderOption,
    ModelNameOption,
    ModelOption,
    OutputOption,
    RecordOption,
    RotateMbOption,
    RotateMinutesOption,
    SourceOption,
    model_of,
    parts_of,
)
from cubeling.app.commands.play.preference_options import GivenPreferences, with_preferences
from cubeling.app.errors import AppError
from cubeling.app.pipeline.registry import BLOCK_SUFFIXES, SHOW_SUFFIX
from cubeling.app.scenarios import check_scenario
from cubeling.app.ui.display import has_display

BUNDLED_PLAYS = ("antigone",)
"""Names of the plays that come with the program."""


@with_preferences
@with_instruments
def show(
    play: Annotated[
        str, typer.Argument(help="A .show file, see docs/shows.md, or .bml; or antigone.")
    ] = BUNDLED_PLAYS[0],
    source: SourceOption = DEFAULT_CAMERA,
    language: Annotated[str | None, typer.Option(help="none to show it without a sound.")] = None,
    output: OutputOption = None,
    overwrite: OverwriteOption = False,
    record: RecordOption = None,
    rotate_minutes: RotateMinutesOption = None,
    rotate_mb: RotateMbOption = None,
    voice: VoiceOption = None,
    model: ModelOption = None,
    model_name: ModelNameOption = "default",
    codec: VideoCodecOption = "auto",
    folder: FolderOption = None,
    *,
    preferences: GivenPreferences,
    instruments: GivenInstruments,
) -> None:
    """Show a play: several characters speak and act by one file.

    With --output or --record it is shown on a drawn desk, unless --source says otherwise.

    Example: cubeling show antigone -o antigone.mp4
    """
    path = str(_bundled(play)) if play in BUNDLED_PLAYS else play
    if not path.endswith((SHOW_SUFFIX, *BLOCK_SUFFIXES)):
        raise AppError(f"'{play}' is no play: give a .show file, see docs/shows.md")
    check_scenario(path)
    from cubeling.app.running.option_checks import check_inputs, check_output_paths
    from cubeling.app.session import SessionOptions

    written = output is not None or record is not None
    options = SessionOptions(
        scenario=path,
        source=DESK if written and source == DEFAULT_CAMERA else source,
        language=language,
        voice=voice,
        **model_of(model, model_name),
        record=record,
        **parts_of(rotate_minutes, rotate_mb),
        output=output,
        overwrite=overwrite,
        pictures=output is not None or not written,
        video_codec=codec,
        folder=folder,
    )
    check_output_paths(options)
    options, kept = preferences.open(options)
    check_inputs(options)
    if options.windowed and not has_display():
        raise AppError("there is no display here: write a video with --output FILE.mp4")
    from cubeling.app.commands.play.progress import play_session

    with ExitStack() as closing:
        camera = None
        if options.windowed and source == DEFAULT_CAMERA:
            options, camera = open_camera_or_desk(options, closing)
        play_session(
            options,
            f"showing {play}",
            source=camera,
            instruments=closing.enter_context(instruments.open()),
            preferences=kept,
            until_over=written,
        )


def _bundled(name: str) -> Path:
    """Return the file of a play that comes with the program."""
    import cubeling.app.show as folder

    return Path(folder.__path__[0]) / f"{name}{SHOW_SUFFIX}"
