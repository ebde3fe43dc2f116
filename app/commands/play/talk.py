"""The command `cubeling talk`."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
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
    FILES_GROUP,
    CharacterOption,
    FolderOption,
    ModelNameOption,
    ModelOption,
    OutputOption,
    PersonalityOption,
    RecordOption,
    RobotSettingsOption,
    RotateMbOption,
    RotateMinutesOption,
    model_of,
    parts_of,
)
from cubeling.app.commands.play.preference_options import GivenPreferences, with_preferences
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input
from cubeling.app.pipeline.registry import SCRIPT_SUFFIX
from cubeling.app.scenarios import find_scenario
from cubeling.app.ui.display import has_display
from cubeling.files import FileKind

BUNDLED_DIALOGUE = "talk"
"""Name of the dialogue that comes with the program."""

TYPED_FILE = FileKind(
    "text", (".txt",), AppError, 1_000_000, "cubeling.app.commands.play.talk:read_typed"
)
"""Lines that are typed."""


@with_preferences
@with_instruments
def talk(
    script: Annotated[
        str, typer.Argument(help="A dialogue: an .xml file, see docs/talking.md.")
    ] = BUNDLED_DIALOGUE,
    character: CharacterOption = None,
    language: Annotated[
        str,
        typer.Option(
            help="The language in which it begins, such as es, or none for no sound; it follows "
            "that of what you type."
        ),
    ] = "",
    typed: Annotated[
        Path | None,
        typer.Option(help="A file with what is typed, a line each, instead of the keyboard."),
    ] = None,
    microphone: Annotated[
        list[Path] | None,
        typer.Option(
            help="A sound file with something said in English, instead of the keyboard; more than "
            "once for more. See docs/talking.md.",
        ),
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(
            "--source",
            "-s",
            help="Where the pictures come from, as for cubeling play; a drawn desk without a "
            "camera.",
        ),
    ] = None,
    robot: Annotated[
        str,
        typer.Option("--robot", "-r", help="What feels along: a robot as for cubeling play."),
    ] = "sim",
    output: OutputOption = None,
    overwrite: OverwriteOption = False,
    record: RecordOption = None,
    rotate_minutes: RotateMinutesOption = None,
    rotate_mb: RotateMbOption = None,
    personality: PersonalityOption = None,
    voice: VoiceOption = None,
    model: ModelOption = None,
    model_name: ModelNameOption = "default",
    robot_settings: RobotSettingsOption = None,
    codec: VideoCodecOption = "auto",
    folder: FolderOption = None,
    only_text: Annotated[
        bool,
        typer.Option(
            "--only-text",
            help="Talk in the terminal, without a picture.",
            rich_help_panel=FILES_GROUP,
        ),
    ] = False,
    *,
    preferences: GivenPreferences,
    instruments: GivenInstruments,
) -> None:
    """Talk with a character: type, and it answers with voice, face and gestures.

    With --output or --record, lines come from --typed or the standard input. Without a display, the
    talk is in the terminal.

    Example: cubeling talk --character vleo
    """
    if script != BUNDLED_DIALOGUE and not script.endswith(SCRIPT_SUFFIX):
        raise AppError(f"'{script}' is no dialogue: give an .xml file, see docs/talking.md")
    check_input(typed, "text")
    for path in microphone or ():
        check_input(path, "sound")
    asked = model_of(model, model_name)
    if typed is not None and microphone:
        raise AppError("give --typed or --microphone, not both")
    from cubeling.app.running.option_checks import check_inputs, check_output_paths
    from cubeling.app.session import SessionOptions

    written = output is not None or record is not None
    options = SessionOptions(
        scenario=script,
        source=source or (DESK if written or typed or microphone else DEFAULT_CAMERA),
        character=character,
        language=language if language == "none" else None,
        talk_language="" if language == "none" else language,
        personality=personality,
        voice=voice,
        **asked,
        robot=robot,
        robot_settings=robot_settings,
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
    said = None if not microphone else _heard(microphone, script, options.talk_language)
    lines = _lines(typed) if said is None else said
    if only_text or not (written or has_display()):
        if instruments.asked:
            raise AppError("a talk in the terminal has nothing that other programs could follow")
        from cubeling.app.commands.play.terminal_talk import talk_in_terminal

        talk_in_terminal(options, lines)
        return
    from cubeling.app.commands.play.progress import play_session

    with ExitStack() as closing:
        camera = None
        by_itself = written or typed is not None or said is not None
        if options.windowed and source is None and not by_itself:
            options, camera = open_camera_or_desk(options, closing)
        play_session(
            options,
            f"talking: {script}",
            source=camera,
            instruments=closing.enter_context(instruments.open()),
            preferences=kept,
            typed=lines if by_itself else None,
        )


def read_typed(path: Path) -> list[str]:
    """Return the lines of a text file; AppError if it cannot be read."""
    return TYPED_FILE.read_text(path).splitlines()


def _lines(typed: Path | None) -> Iterable[str]:
    if typed is not None:
        return read_typed(typed)
    return _asked_lines() if sys.stdin.isatty() else sys.stdin


def _heard(files: list[Path], script: str, language: str) -> Iterator[str]:
    """Return what is understood in sound files, as it is asked for."""
    from cubeling.app.scenarios.dialogue.scenario import DialogueScenario
    from cubeling.app.speaking.listener import MAX_LISTEN_S, recognizer_for
    from cubeling.characters.speech import read_speech

    scenario = find_scenario(script)
    assert issubclass(scenario, DialogueScenario)
    recognizer = recognizer_for(scenario.script, language or scenario.script.languages[0])

    def heard(path: Path) -> str:
        sound = read_speech(path, MAX_LISTEN_S)
        text = recognizer.hear(sound.samples, sound.rate)
        typer.echo(f"{path.name}: {text or 'nothing that is in the script'}", err=True)
        return text

    return map(heard, files)


def _asked_lines() -> Iterator[str]:
    """Yield the lines that are typed after a prompt, until their end (Ctrl-D)."""
    while True:
        try:
            yield input("> ")
        except EOFError:
            return
