"""`cubeling play`."""

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from app.commands.access import Broker, Ca, PasswordFile, PlayerName, Site, publisher
from app.commands.progress import report_guessed_lens, run_with_progress, video_ready
from app.running.network import SITE
from app.running.opening import open_session
from app.running.options import SessionOptions
from app.scenarios import scenario_cube
from app.ui.display import require_display
from robot.network import Credentials

CAMERA = "camera:0"

Source = Annotated[
    str,
    typer.Option(
        "--source",
        "-s",
        help="camera:0 (camera:0?exposure=8 in ms, ?lock=0), a video, a session (.mcap), "
        "http://PHONE:8080/video, synthetic:NAME.",
    ),
]
Cube = Annotated[str | None, typer.Option(help="A bundled cube, or the .toml file of your own.")]
Actor = Annotated[str | None, typer.Option(help="A bundled character, or a .glb file.")]
Personality = Annotated[
    str | None,
    typer.Option(help="Who feels: a bundled personality, or the .toml file of your own."),
]
Intrinsics = Annotated[
    Path | None,
    typer.Option(help="The camera's calibration (ROS camera_info YAML); guessed without."),
]
RobotUrl = Annotated[
    str,
    typer.Option(
        "--robot",
        "-r",
        help="sim, none, or a port: /dev/ttyACM0, COM3, socket://HOST:PORT; with the protocol in "
        "front where it is not ours: pleo:/dev/ttyACM0, opencat:COM3, sim:pleo.",
    ),
]
RobotSettings = Annotated[
    Path | None,
    typer.Option(help="A .toml file for the robot: what a Pleo or an OpenCat does in each mood."),
]
Record = Annotated[Path | None, typer.Option(help="Record the session to this .mcap file.")]
Codec = Annotated[
    str, typer.Option(help="How a recording keeps the pictures: jpeg or h264 (smaller).")
]
Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Write an .mp4 video instead of opening a window."),
]
Pictures = Annotated[
    bool, typer.Option("--pictures/--no-pictures", help="Draw nothing: only track.")
]


def play(
    scenario: Annotated[str, typer.Argument(help="follow, sketch or companion.")],
    source: Source = CAMERA,
    cube: Cube = None,
    character: Actor = None,
    intrinsics: Intrinsics = None,
    robot: RobotUrl = "sim",
    robot_settings: RobotSettings = None,
    record: Record = None,
    codec: Codec = "jpeg",
    output: Output = None,
    speed_map: Annotated[
        str, typer.Option(help="corrected, or legacy as printed in the thesis.")
    ] = "corrected",
    turns: Annotated[
        float, typer.Option(help="Full turns from the least to the greatest intensity.")
    ] = 2.0,
    personality: Personality = None,
    look: Annotated[
        str, typer.Option(help="What the character's eyes follow: auto, cube, hand, camera, none.")
    ] = "auto",
    pictures: Pictures = True,
    mqtt: Broker = None,
    player: PlayerName = None,
    site: Site = SITE,
    password_file: PasswordFile = None,
    ca: Ca = None,
) -> None:
    """Play with the cube in front of a camera.

    [bold]follow[/]     the character chases the cube; turn the cube to make it walk or run
    [bold]sketch[/]     the cube draws a path of up to eight points, the character walks it
    [bold]companion[/]  Vleo kisses or shouts, and the robot feels it

    Example: [cyan]cubeling play companion --source camera:0 --robot /dev/ttyACM0[/]
    """
    options = SessionOptions(
        scenario=scenario,
        source=source,
        cube=cube,
        character=character,
        intrinsics=intrinsics,
        speed_map=speed_map,
        turns=turns,
        personality=personality,
        look=look,
        robot=robot,
        robot_settings=robot_settings,
        record=record,
        codec=codec,
        output=output,
        pictures=pictures,
    )
    scenario_cube(scenario)  # refuses a misspelt scenario before a missing display
    if options.windowed:
        require_display()
    console = Console()
    with ExitStack() as closing:
        line = publisher(mqtt, player, site, Credentials(None, password_file, ca), closing)
        session = closing.enter_context(open_session(options, player=line))
        report_guessed_lens(session, console)
        summary = run_with_progress(session, console, f"playing {scenario}")
    console.print(summary)
    if output is not None:
        console.print(video_ready(output))
    summary.check()
