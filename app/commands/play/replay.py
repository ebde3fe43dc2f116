"""The command `cubeling replay`."""

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cubeling.app.commands.character_options import CHARACTER_GROUP, OwnMotionsOption
from cubeling.app.commands.output import OverwriteOption
from cubeling.app.commands.play.complete import complete_session
from cubeling.app.commands.play.instrument_options import GivenInstruments, with_instruments
from cubeling.app.commands.play.part import EndOption, LoopOption, StartOption
from cubeling.app.commands.play.play_options import (
    ALL_REALISM,
    INSIDE_HELP,
    PICTURE_GROUP,
    CastOption,
    CharacterOption,
    CodecOption,
    FolderOption,
    IdleOption,
    MotionsOption,
    OutputOption,
    PersonalityOption,
    PicturesOption,
    QualityOption,
    RealismOption,
    RecordOption,
    RobotSettingsOption,
    RobotsOption,
    RotateMbOption,
    RotateMinutesOption,
    SoundsOption,
    codecs_of,
    parts_of,
)
from cubeling.app.commands.play.preference_options import GivenPreferences, with_preferences
from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import MAX_PLAYERS, cast_of, inside_of, realism_of, robots_of
from cubeling.app.running.quality_control import AUTO_QUALITY, checked_quality
from cubeling.app.scenarios import check_scenario
from cubeling.app.ui.display import has_display
from cubeling.characters import check_controller

CHECK_GROUP = "What is computed, and how fast"


@with_preferences
@with_instruments
def replay(
    session: Annotated[Path, typer.Argument(help="A session recorded with --record.")],
    scenario: Annotated[str | None, typer.Option(help="Play it as another scenario.")] = None,
    character: CharacterOption = None,
    cast: CastOption = None,
    controller: Annotated[
        str | None,
        typer.Option(
            help="Move the character with another controller.", rich_help_panel=CHARACTER_GROUP
        ),
    ] = None,
    motions: MotionsOption = None,
    idle: IdleOption = None,
    own_motions_only: OwnMotionsOption = False,
    personality: PersonalityOption = None,
    robots: RobotsOption = None,
    robot_settings: RobotSettingsOption = None,
    record: RecordOption = None,
    rotate_minutes: RotateMinutesOption = None,
    rotate_mb: RotateMbOption = None,
    codec: CodecOption = "auto",
    output: OutputOption = None,
    overwrite: OverwriteOption = False,
    pictures: PicturesOption = True,
    realism: RealismOption = ALL_REALISM,
    inside: Annotated[
        str | None,
        typer.Option(help=f"{INSIDE_HELP}; else as recorded.", rich_help_panel=PICTURE_GROUP),
    ] = None,
    quality: QualityOption = AUTO_QUALITY,
    sounds: SoundsOption = None,
    start: StartOption = 0.0,
    end: EndOption = None,
    loop: LoopOption = False,
    folder: FolderOption = None,
    stage: Annotated[
        str,
        typer.Option(
            "--from",
            help="Take the recorded channels up to this one, and compute the others: camera "
            "(compute all), state, controls, appearance, command, pose or emotion.",
            rich_help_panel=CHECK_GROUP,
        ),
    ] = "camera",
    fast: Annotated[
        bool,
        typer.Option(
            "--fast",
            help="With a real robot, play as fast as possible, not in real time.",
            rich_help_panel=CHECK_GROUP,
        ),
    ] = False,
    salvage: Annotated[
        bool,
        typer.Option(
            help="Play the intact part of a cut-off session.", rich_help_panel=CHECK_GROUP
        ),
    ] = False,
    check: Annotated[
        bool,
        typer.Option(
            help="Process the frames again and compare every recorded channel.",
            rich_help_panel=CHECK_GROUP,
        ),
    ] = False,
    *,
    preferences: GivenPreferences,
    instruments: GivenInstruments,
) -> None:
    """Play a recorded session: in a window, to a video, or only to its summary.

    In a window, Space pauses, the arrow keys and the timeline under the picture seek, and ? shows
    all keys. Without a display and without --output, nothing is drawn and the summary is printed.
    With a real robot, the session plays in real time.

    Example: cubeling replay recordings/companion.mcap --output companion.mp4
    """
    from cubeling.app.running.option_checks import check_inputs, check_output_paths, check_part
    from cubeling.app.session import NO_VIDEO, SessionOptions, check_stage, open_session_file

    with ExitStack() as closing:
        opened = closing.enter_context(open_session_file(session))
        if scenario:
            check_scenario(scenario)
        if controller:
            check_controller(controller)
        check_stage(stage)
        if inside:
            inside_of(inside)
        record_codec, video_codec = codecs_of(codec, record, output)
        character, others = cast_of(cast, character)
        chosen_realism, chosen_quality = realism_of(realism), checked_quality(quality)
        # Of how many players the session is, is known once it is read.
        (robot, second_robot), robot_names = robots_of(robots or (), MAX_PLAYERS)
        asked = SessionOptions(
            scenario=scenario or "",
            source=str(session),
            character=character,
            others=others,
            motions=tuple(motions or ()),
            idle=idle,
            personality=personality,
            robot=robot,
            robot_settings=robot_settings,
            sounds=sounds,
            record=record,
            **parts_of(rotate_minutes, rotate_mb),
            codec=record_codec,
            video_codec=video_codec,
            output=output,
            overwrite=overwrite,
        )
        check_output_paths(asked)
        check_inputs(asked)
        # Nothing above needs numpy or OpenCV: what is misspelt is refused before they are loaded.
        from cubeling.app.commands.play.progress import ProgressLines, play_session
        from cubeling.app.running.replay_check import check_session
        from cubeling.app.session import SessionFile

        file = closing.enter_context(SessionFile(session, salvage=salvage, opened=opened))
        info, recorded = file.info, file.info.options
        (robot, second_robot), robot_names = robots_of(
            robots or (), recorded.players, recorded.robot_names
        )
        if stage == "camera" or check:
            file.check_begins()
        if not info.has_video:
            if check:
                raise AppError(f"'{session}' was recorded without video: nothing can be checked")
            stage = "state" if stage == "camera" else stage
            record_codec = NO_VIDEO  # what is recorded of it has none either
        options = replace(
            recorded,
            scenario=scenario or recorded.scenario,
            character=character or recorded.character,
            others=others if cast else recorded.others,
            controller=controller or recorded.controller,
            motions=tuple(motions) if motions else () if controller else recorded.motions,
            idle=idle or recorded.idle,
            own_motions_only=own_motions_only or (character is None and recorded.own_motions_only),
            whole_limbs=character is not None or recorded.whole_limbs,
            personality=personality or recorded.personality,
            robot=robot,
            second_robot=second_robot,
            robot_names=robot_names,
            robot_settings=robot_settings,
            record=record,
            **parts_of(rotate_minutes, rotate_mb),
            codec=record_codec,
            video_codec=video_codec,
            output=output,
            overwrite=overwrite,
            pictures=pictures and not check and (output is not None or has_display()),
            realism=recorded.realism if check else chosen_realism,
            inside=inside_of(inside or recorded.inside),
            quality=chosen_quality,
            sounds=sounds,
            fast=fast,
            salvage=salvage,
            stage=stage,
            start_s=start,
            end_s=end,
            loop=loop,
            folder=folder,
        )
        if check and (start or end is not None):
            raise AppError("--check compares a whole session: leave out --start and --end")
        check_output_paths(options)
        check_part(options)
        if (check or stage != "camera") and not file.has_channels:
            complete = closing.enter_context(complete_session(session, salvage=salvage))
            file = closing.enter_context(SessionFile(complete))
        if check:
            progress = ProgressLines(f"checking {session.name}", info.duration)
            result = check_session(file, options, progress)
            Console().print(result)
            raise typer.Exit(0 if result.identical else 1)
        if pictures and not options.pictures:
            typer.echo("No window: there is no display here; -o FILE.mp4 writes a video", err=True)
        options, kept = preferences.open(replace(options, source=str(file.path)))
        play_session(
            options,
            f"replaying {session.name}",
            replayed=file,
            instruments=closing.enter_context(instruments.open()),
            preferences=kept,
        )
