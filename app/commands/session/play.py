"""The command `cubeling play`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from cubeling.app.commands.access import Broker, Ca, PasswordFile, PlayerName, Site, publisher
from cubeling.app.commands.output import OverwriteOption
from cubeling.app.commands.session.preference_options import GivenPreferences, with_preferences
from cubeling.app.commands.speech_options import ProfileOption, SettingsOption, profile_of
from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import (
    INSIDE_CHOICES,
    NO_REALISM,
    REALISM_CHOICES,
    inside_of,
    realism_of,
)
from cubeling.app.running.quality_control import AUTO_QUALITY, checked_quality
from cubeling.app.scenarios import check_scenario, scenario_names, scenario_summary
from cubeling.app.ui.display import has_display
from cubeling.app.ui.output_formats import AUTO_CODEC, ENCODERS
from cubeling.characters import CONTROLLER_CHOICES, check_controller
from cubeling.characters.rendering import QUALITIES
from cubeling.robot.network import DEFAULT_SITE

DEFAULT_CAMERA = "camera:0"

VOICE_VARIABLE = "CUBELING_VOICE"
"""Environment variable of the option `--voice`."""


def describe(scenario: str) -> str:
    """Return what a scenario is, or what is wrong with the package that adds it, as markup."""
    try:
        text = f"{scenario_summary(scenario)}."
    except AppError as error:
        text = str(error)
    return f"[bold]{escape(scenario)}[/]: {escape(text)}"


ScenarioArgument = Annotated[
    str,
    typer.Argument(
        help="\n\n".join(map(describe, scenario_names())),
        autocompletion=lambda: list(scenario_names()),
    ),
]
SourceOption = Annotated[
    str,
    typer.Option(
        "--source",
        "-s",
        help='Where the pictures come from: camera:0 (with options: "camera:0?exposure=8"), '
        "a video, a session (.mcap), http://PHONE:8080/video, or synthetic:companion.",
    ),
]
CubeOption = Annotated[str | None, typer.Option(help="A bundled cube, or your own .toml file.")]
CubesOption = Annotated[
    list[str] | None,
    typer.Option(
        "--cube",
        metavar="<str>",
        help="A bundled cube, or your own .toml file. Repeat the option to name more cubes: they "
        "are recognised when you show them.",
    ),
]
CharacterOption = Annotated[
    str | None, typer.Option(help="A bundled character, or a .glb, .gltf or .vrm file.")
]
ControllerOption = Annotated[
    str,
    typer.Option(
        help="What moves the character: "
        + "; ".join(f"{name}, {choice.summary}" for name, choice in CONTROLLER_CHOICES.items())
        + ".",
        autocompletion=lambda: list(CONTROLLER_CHOICES),
    ),
]
MotionsOption = Annotated[
    list[str] | None,
    typer.Option(
        help="A motion for the controller: a .bvh, .amc or .glb file, CHARACTER.glb#CLIP, or a "
        "folder of them; may be repeated. Without it, the character's own clips.",
    ),
]
IdleOption = Annotated[
    Path | None,
    typer.Option(help="Stand as a person does: a file of [cyan]cubeling idle learn[/]."),
]
OwnMotionsOption = Annotated[
    bool,
    typer.Option(
        "--own-motions-only",
        help="A character without clips keeps its rest pose, instead of playing those of a bundled "
        "one of its kind.",
    ),
]
LanguageOption = Annotated[
    str | None,
    typer.Option(
        help="The language in which the character speaks: en, es, that of your lines, or none. In "
        "a window it speaks English unless you choose."
    ),
]
LinesOption = Annotated[
    Path | None,
    typer.Option(help="What the character says: a .toml file; see docs/speaking.md."),
]
VoiceOption = Annotated[
    str | None,
    typer.Option(
        help="A program that speaks, instead of eSpeak NG; see docs/speaking.md.",
        envvar=VOICE_VARIABLE,
    ),
]
RealismOption = Annotated[
    str,
    typer.Option(
        help="What makes the characters look real, separated by commas: "
        + "; ".join(f"{name}, {meaning}" for name, meaning in REALISM_CHOICES.items())
        + f"; or {NO_REALISM}.",
    ),
]
ALL_REALISM = ",".join(REALISM_CHOICES)
INSIDE_HELP = "When the cube is a window with the character inside: " + "; ".join(
    f"{name}, {meaning}" for name, meaning in INSIDE_CHOICES.items()
)
QualityOption = Annotated[
    str,
    typer.Option(
        help="How finely characters are drawn: auto, the best that holds the camera's rate, "
        f"or one of {', '.join(QUALITIES)}."
    ),
]
PersonalityOption = Annotated[
    str | None,
    typer.Option(help="A bundled personality, or your own .toml file."),
]
IntrinsicsOption = Annotated[
    Path | None,
    typer.Option(
        help="File of the calibrated camera (ROS camera_info YAML); without it, a lens is guessed."
    ),
]
RobotOption = Annotated[
    str,
    typer.Option(
        "--robot",
        "-r",
        help="sim, none, or a port: /dev/ttyACM0, COM3, socket://HOST:PORT. Other protocols than "
        "ours have a prefix: pleo:/dev/ttyACM0, opencat:COM3, sim:pleo.",
    ),
]
RobotSettingsOption = Annotated[
    Path | None,
    typer.Option(help="A .toml file that says what a Pleo or an OpenCat does for each mood."),
]
RecordOption = Annotated[Path | None, typer.Option(help="Record the session to this .mcap file.")]
CodecOption = Annotated[
    str,
    typer.Option(
        help="How --record stores pictures: auto (the camera's own JPEG, else h264), jpeg, or h264 "
        "(smaller). Or what encodes the video of --output: "
        f"{', '.join(list(ENCODERS)[:-1])}."
    ),
]
FolderOption = Annotated[
    Path | None,
    typer.Option(
        help="Where the keys S and R put snapshots and recordings; the folder Cubeling in your "
        "home folder without it."
    ),
]
OutputOption = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        help="Write a video (.mp4, .mkv, .webm), an animation (.gif) or a sheet of pictures (.png) "
        "instead of opening a window.",
    ),
]
PicturesOption = Annotated[
    bool,
    typer.Option("--pictures/--no-pictures", help="Draw the pictures, or only track the cube."),
]
SoundsOption = Annotated[
    Path | None,
    typer.Option(help="A folder of .wav files instead of our sounds; see cubeling sounds."),
]


def codecs_of(codec: str, record: Path | None, output: Path | None) -> tuple[str, str]:
    """Return how a recording and a video store pictures: what --codec names is known to one."""
    of_video = output is not None and (codec in ENCODERS or record is None)
    return (AUTO_CODEC, codec) if of_video else (codec, AUTO_CODEC)


@with_preferences
def play(
    scenario: ScenarioArgument,
    source: SourceOption = DEFAULT_CAMERA,
    cubes: CubesOption = None,
    character: CharacterOption = None,
    controller: ControllerOption = "tree",
    motions: MotionsOption = None,
    idle: IdleOption = None,
    own_motions_only: OwnMotionsOption = False,
    intrinsics: IntrinsicsOption = None,
    robot: RobotOption = "sim",
    robot_settings: RobotSettingsOption = None,
    record: RecordOption = None,
    codec: CodecOption = "auto",
    output: OutputOption = None,
    overwrite: OverwriteOption = False,
    speed_map: Annotated[
        str,
        typer.Option(help="For follow and sketch: corrected, or legacy, as printed in the thesis."),
    ] = "corrected",
    turns: Annotated[
        float, typer.Option(help="For companion: full turns from least to greatest intensity.")
    ] = 2.0,
    personality: PersonalityOption = None,
    language: LanguageOption = None,
    lines: LinesOption = None,
    profile: ProfileOption = "usual",
    settings: SettingsOption = None,
    voice: VoiceOption = None,
    look: Annotated[
        str, typer.Option(help="Where the character looks: auto, cube, hand, camera or none.")
    ] = "auto",
    pictures: PicturesOption = True,
    realism: RealismOption = ALL_REALISM,
    inside: Annotated[str, typer.Option(help=f"{INSIDE_HELP}.")] = "auto",
    quality: QualityOption = AUTO_QUALITY,
    sounds: SoundsOption = None,
    folder: FolderOption = None,
    mqtt: Broker = None,
    player: PlayerName = None,
    site: Site = DEFAULT_SITE,
    password_file: PasswordFile = None,
    ca: Ca = None,
    *,
    preferences: GivenPreferences,
) -> None:
    """Play with the cube in front of a camera.

    Example: [cyan]cubeling play companion --record today.mcap[/]
    """
    check_scenario(scenario)
    check_controller(controller)
    from cubeling.app.running.option_checks import check_output_paths
    from cubeling.app.session import SessionOptions

    record_codec, video_codec = codecs_of(codec, record, output)
    options = SessionOptions(
        scenario=scenario,
        source=source,
        cubes=tuple(cubes or ()),
        character=character,
        controller=controller,
        motions=tuple(motions or ()),
        idle=idle,
        own_motions_only=own_motions_only,
        intrinsics=intrinsics,
        speed_map=speed_map,
        turns=turns,
        personality=personality,
        language=language,
        lines=lines,
        voice=voice,
        profile=profile_of(profile, settings),
        look=look,
        realism=realism_of(realism),
        inside=inside_of(inside),
        quality=checked_quality(quality),
        robot=robot,
        robot_settings=robot_settings,
        record=record,
        codec=record_codec,
        video_codec=video_codec,
        output=output,
        overwrite=overwrite,
        pictures=pictures,
        sounds=sounds,
        folder=folder,
    )
    check_output_paths(options)
    # Nothing above needs numpy or OpenCV: what is misspelt is refused before they are loaded.
    from cubeling.app.commands.session.progress import play_session
    from cubeling.app.scenarios.roles import check_cubes

    check_cubes(scenario, options.cubes)  # before a display is missing
    if options.windowed and not has_display():
        raise AppError("there is no display here: write a video with --output FILE.mp4")
    options, kept = preferences.open(options)
    with publisher(mqtt, player, site, password_file, ca) as line:
        play_session(options, f"playing {scenario}", player=line, preferences=kept)
