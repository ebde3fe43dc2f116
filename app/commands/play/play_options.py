"""The options of the commands that play sessions.

Those without a group matter most, and come first in a help.
"""

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from cubeling.app.commands.character_options import CHARACTER_GROUP, SPEECH_GROUP
from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import INSIDE_CHOICES, NO_REALISM, REALISM_CHOICES
from cubeling.app.scenarios import scenario_names, scenario_summary
from cubeling.app.ui.output_formats import AUTO_CODEC, ENCODERS
from cubeling.characters import CONTROLLER_CHOICES
from cubeling.characters.rendering import QUALITIES

DEFAULT_CAMERA = "camera:0"

PHONE = "phone"
"""Names the camera of whoever opens the page, as a source."""

PICTURE_GROUP = "The picture"
FILES_GROUP = "Files"
STUDY_GROUP = "For a study"
"""Headings of the options that matter less, in the help."""


def source_of(asked: str) -> str:
    """Return the URI of a source that was asked for.

    >>> source_of(PHONE), source_of("camera:0")
    ('phone:', 'camera:0')
    """
    return f"{PHONE}:" if asked == PHONE else asked


def describe(scenario: str) -> str:
    """Return what a scenario is, or what is wrong with the package that adds it."""
    try:
        text = f"{scenario_summary(scenario)}."
    except AppError as error:
        text = str(error)
    return f"{scenario}: {text}"


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
        "a video, a session (.mcap), http://PHONE:8080/video, rtsp://CAMERA/live, or "
        "synthetic:companion.",
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
PlayersOption = Annotated[
    int,
    typer.Option(
        help="How many play at once, each with a cube and a character: 1 or 2. The second one's "
        "cube is printed by: cubeling cube locomotion-2, or companion-2.",
        rich_help_panel=CHARACTER_GROUP,
    ),
]
CastOption = Annotated[
    str | None,
    typer.Option(
        help="Several characters, up to five, separated by commas: the cube leads the first, the "
        "others watch. For example --cast human,vleo.",
        rich_help_panel=CHARACTER_GROUP,
    ),
]
ControllerOption = Annotated[
    str,
    typer.Option(
        help="What moves the character: "
        + "; ".join(f"{name}, {choice.summary}" for name, choice in CONTROLLER_CHOICES.items())
        + ".",
        autocompletion=lambda: list(CONTROLLER_CHOICES),
        rich_help_panel=CHARACTER_GROUP,
    ),
]
MotionsOption = Annotated[
    list[str] | None,
    typer.Option(
        help="A motion for the controller: a .bvh, .amc or .glb file, CHARACTER.glb#CLIP, or a "
        "folder of them; may be repeated. Without it, the character's own clips.",
        rich_help_panel=CHARACTER_GROUP,
    ),
]
IdleOption = Annotated[
    Path | None,
    typer.Option(
        help="Stand as a person does: a file of cubeling idle learn.",
        rich_help_panel=CHARACTER_GROUP,
    ),
]
LanguageOption = Annotated[
    str | None,
    typer.Option(
        help="The language in which the character speaks: en, es, that of your lines, or none. In "
        "a window it speaks English unless you choose."
    ),
]
ModelOption = Annotated[
    str | None,
    typer.Option(
        "--model",
        metavar="URL",
        help="The address of a language model that is asked where the script of a talk has no "
        "answer of its own, such as http://localhost:11434/v1. What you say is sent there.",
        rich_help_panel=SPEECH_GROUP,
    ),
]
ModelNameOption = Annotated[
    str, typer.Option(help="The model's name at that address.", rich_help_panel=SPEECH_GROUP)
]
LinesOption = Annotated[
    Path | None,
    typer.Option(
        help="What the character says: a .toml file; see docs/speaking.md.",
        rich_help_panel=SPEECH_GROUP,
    ),
]
RealismOption = Annotated[
    str,
    typer.Option(
        help="What makes the characters look real, separated by commas: "
        + "; ".join(f"{name}, {meaning}" for name, meaning in REALISM_CHOICES.items())
        + f"; or {NO_REALISM}.",
        rich_help_panel=PICTURE_GROUP,
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
        f"or one of {', '.join(QUALITIES)}.",
        rich_help_panel=PICTURE_GROUP,
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
PatienceOption = Annotated[
    float,
    typer.Option(
        metavar="<s>",
        help="How long to go on without a camera that stalls or is lost, until it is back.",
        rich_help_panel=PICTURE_GROUP,
    ),
]
RobotsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--robot",
        "-r",
        metavar="<str>",
        help="sim, none, or a port: /dev/ttyACM0, COM3, socket://HOST:PORT. Other protocols than "
        "ours have a prefix: pleo:/dev/ttyACM0, opencat:COM3, sim:pleo. With --players 2, repeat "
        "it for the second player's. A name may come first: rex=sim.",
    ),
]
RobotSettingsOption = Annotated[
    Path | None,
    typer.Option(
        help="A .toml file that says what a Pleo or an OpenCat does for each mood.",
        rich_help_panel=FILES_GROUP,
    ),
]
RecordOption = Annotated[Path | None, typer.Option(help="Record the session to this .mcap file.")]
RotateMinutesOption = Annotated[
    float | None,
    typer.Option(
        help="Let a recording go on in another file after so many minutes: today-002.mcap …",
        rich_help_panel=FILES_GROUP,
    ),
]
RotateMbOption = Annotated[
    float | None,
    typer.Option(
        help="The same when a file has so many megabytes.",
        rich_help_panel=FILES_GROUP,
    ),
]
CodecOption = Annotated[
    str,
    typer.Option(
        help="How --record stores pictures: auto (the camera's own JPEG, else h264), jpeg, or h264 "
        "(smaller). Or what encodes the video of --output: "
        f"{', '.join(list(ENCODERS)[:-1])}.",
        rich_help_panel=FILES_GROUP,
    ),
]
ParticipantOption = Annotated[
    str,
    typer.Option(
        help="Code of who plays, as P07: it is recorded, and can be corrected by cubeling label.",
        rich_help_panel=STUDY_GROUP,
    ),
]
ConditionOption = Annotated[
    str, typer.Option(help="The condition of the study.", rich_help_panel=STUDY_GROUP)
]
VideoOption = Annotated[
    bool,
    typer.Option(
        "--video/--no-video",
        help="Whether recordings hold the camera's pictures; all else is recorded anyway.",
        rich_help_panel=STUDY_GROUP,
    ),
]
NotesOption = Annotated[
    str, typer.Option(help="A note on the session.", rich_help_panel=STUDY_GROUP)
]
FolderOption = Annotated[
    Path | None,
    typer.Option(
        help="Where the keys S and R put snapshots and recordings; the folder Cubeling in your "
        "home folder without it.",
        rich_help_panel=FILES_GROUP,
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
    typer.Option(
        "--pictures/--no-pictures",
        help="Draw the pictures, or only track the cube.",
        rich_help_panel=PICTURE_GROUP,
    ),
]
SoundsOption = Annotated[
    Path | None,
    typer.Option(
        help="A folder of .wav files instead of our sounds; see cubeling sounds.",
        rich_help_panel=FILES_GROUP,
    ),
]


def parts_of(minutes: float | None, megabytes: float | None) -> dict[str, Any]:
    """Return `part_s` and `part_bytes` of the options; raises AppError if they are not positive."""
    for option, value in (("--rotate-minutes", minutes), ("--rotate-mb", megabytes)):
        if value is not None and not 0.0 < value < math.inf:
            raise AppError(f"{option} is greater than 0, not {value:g}")
    return {
        "part_s": None if minutes is None else 60.0 * minutes,
        "part_bytes": None if megabytes is None else math.ceil(1e6 * megabytes),
    }


def model_of(address: str | None, name: str) -> dict[str, Any]:
    """Return the fields of the options that say which language model is asked, if any is.

    Raises AppError if the address is none.
    """
    if address is not None:
        from cubeling.app.speaking.model.chat import checked_url  # loads what TLS needs

        checked_url(address)
    return {"model": address, "model_name": name, "asks_model": address is not None}


def codecs_of(codec: str, record: Path | None, output: Path | None) -> tuple[str, str]:
    """Return how a recording and a video store pictures: what --codec names is known to one."""
    of_video = output is not None and (codec in ENCODERS or record is None)
    return (AUTO_CODEC, codec) if of_video else (codec, AUTO_CODEC)
