"""The command `cubeling play`."""

from typing import Annotated

import typer

from cubeling.app.commands.character_options import (
    CHARACTER_GROUP,
    OwnMotionsOption,
    ProfileOption,
    SettingsOption,
    VoiceOption,
    profile_of,
)
from cubeling.app.commands.output import OverwriteOption
from cubeling.app.commands.play.first_camera import saying_how_without
from cubeling.app.commands.play.instrument_options import GivenInstruments, with_instruments
from cubeling.app.commands.play.play_options import (
    ALL_REALISM,
    DEFAULT_CAMERA,
    INSIDE_HELP,
    PICTURE_GROUP,
    CastOption,
    CharacterOption,
    CodecOption,
    ConditionOption,
    ControllerOption,
    CubesOption,
    FolderOption,
    IdleOption,
    IntrinsicsOption,
    LanguageOption,
    LinesOption,
    ModelNameOption,
    ModelOption,
    MotionsOption,
    NotesOption,
    OutputOption,
    ParticipantOption,
    PatienceOption,
    PersonalityOption,
    PicturesOption,
    PlayersOption,
    QualityOption,
    RealismOption,
    RecordOption,
    RobotSettingsOption,
    RobotsOption,
    RotateMbOption,
    RotateMinutesOption,
    ScenarioArgument,
    SoundsOption,
    SourceOption,
    VideoOption,
    codecs_of,
    model_of,
    parts_of,
)
from cubeling.app.commands.play.preference_options import GivenPreferences, with_preferences
from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import (
    cast_of,
    checked_players,
    inside_of,
    realism_of,
    robots_of,
)
from cubeling.app.running.quality_control import AUTO_QUALITY, checked_quality
from cubeling.app.scenarios import check_scenario
from cubeling.app.ui.display import has_display


@with_preferences
@with_instruments
def play(
    scenario: ScenarioArgument,
    source: SourceOption = DEFAULT_CAMERA,
    cubes: CubesOption = None,
    character: CharacterOption = None,
    cast: CastOption = None,
    players: PlayersOption = 1,
    controller: ControllerOption = "tree",
    motions: MotionsOption = None,
    idle: IdleOption = None,
    own_motions_only: OwnMotionsOption = False,
    intrinsics: IntrinsicsOption = None,
    patience: PatienceOption = 30.0,
    robots: RobotsOption = None,
    record: RecordOption = None,
    rotate_minutes: RotateMinutesOption = None,
    rotate_mb: RotateMbOption = None,
    output: OutputOption = None,
    overwrite: OverwriteOption = False,
    speed_map: Annotated[
        str,
        typer.Option(
            help="For follow and sketch: corrected, or legacy, as printed in the thesis.",
            rich_help_panel=CHARACTER_GROUP,
        ),
    ] = "corrected",
    turns: Annotated[
        float,
        typer.Option(
            help="For companion: full turns from least to greatest intensity.",
            rich_help_panel=CHARACTER_GROUP,
        ),
    ] = 2.0,
    personality: PersonalityOption = None,
    language: LanguageOption = None,
    lines: LinesOption = None,
    model: ModelOption = None,
    model_name: ModelNameOption = "default",
    profile: ProfileOption = "usual",
    settings: SettingsOption = None,
    voice: VoiceOption = None,
    look: Annotated[
        str,
        typer.Option(
            help="Where the character looks: auto, cube, hand, camera or none.",
            rich_help_panel=CHARACTER_GROUP,
        ),
    ] = "auto",
    pictures: PicturesOption = True,
    realism: RealismOption = ALL_REALISM,
    inside: Annotated[
        str, typer.Option(help=f"{INSIDE_HELP}.", rich_help_panel=PICTURE_GROUP)
    ] = "auto",
    quality: QualityOption = AUTO_QUALITY,
    robot_settings: RobotSettingsOption = None,
    codec: CodecOption = "auto",
    sounds: SoundsOption = None,
    folder: FolderOption = None,
    participant: ParticipantOption = "",
    condition: ConditionOption = "",
    notes: NotesOption = "",
    video: VideoOption = True,
    *,
    preferences: GivenPreferences,
    instruments: GivenInstruments,
) -> None:
    """Play with the cube in front of a camera.

    Example: cubeling play companion --record today.mcap
    """
    check_scenario(scenario)
    from cubeling.app.running.option_checks import check_inputs, check_output_paths
    from cubeling.app.session import NO_VIDEO, SessionOptions

    record_codec, video_codec = codecs_of(codec, record, output)
    character, others = cast_of(cast, character)
    (robot, second_robot), robot_names = robots_of(robots or (), players)
    options = SessionOptions(
        scenario=scenario,
        source=source,
        cubes=tuple(cubes or ()),
        character=character,
        others=others,
        players=checked_players(players),
        controller=controller,
        motions=tuple(motions or ()),
        idle=idle,
        own_motions_only=own_motions_only,
        intrinsics=intrinsics,
        patience_s=patience,
        speed_map=speed_map,
        turns=turns,
        personality=personality,
        language=language,
        lines=lines,
        voice=voice,
        **model_of(model, model_name),
        profile=profile_of(profile, settings),
        look=look,
        realism=realism_of(realism),
        inside=inside_of(inside),
        quality=checked_quality(quality),
        robot=robot,
        second_robot=second_robot,
        robot_names=robot_names,
        robot_settings=robot_settings,
        record=record,
        **parts_of(rotate_minutes, rotate_mb),
        codec=record_codec if video else NO_VIDEO,
        video_codec=video_codec,
        output=output,
        overwrite=overwrite,
        pictures=pictures,
        sounds=sounds,
        folder=folder,
        participant=participant,
        condition=condition,
        notes=notes,
    )
    check_output_paths(options)
    options, kept = preferences.open(options)
    check_inputs(options)
    # Nothing above needs numpy or OpenCV: what is misspelt is refused before they are loaded.
    from cubeling.app.commands.play.progress import play_session
    from cubeling.app.scenarios.roles import check_cubes

    check_cubes(scenario, options.cubes)  # before a display is missing
    if options.windowed and not has_display():
        raise AppError(
            "there is no display here: write a video with --output FILE.mp4, or add --no-pictures"
        )
    with saying_how_without(scenario), instruments.open() as opened:
        play_session(options, f"playing {scenario}", instruments=opened, preferences=kept)
