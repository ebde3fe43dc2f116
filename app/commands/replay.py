"""`cubeling replay`."""

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from app.commands.access import Broker, Ca, PasswordFile, PlayerName, Site, publisher
from app.commands.play import (
    Actor,
    Codec,
    Output,
    Personality,
    Pictures,
    Record,
    RobotSettings,
    RobotUrl,
)
from app.commands.progress import finished_video, play_to_end, tell_guess
from app.running.network import SITE
from app.running.opening import Wish, open_session
from app.running.replay_check import check_session
from app.session import about, salvaged
from app.ui.display import has_display
from robot.network import Credentials


def replay(
    session: Annotated[
        Path, typer.Argument(help="A session recorded with --record, or a bundled one.")
    ],
    scenario: Annotated[str | None, typer.Option(help="Play it as another scenario.")] = None,
    character: Actor = None,
    personality: Personality = None,
    robot: RobotUrl = "sim",
    robot_settings: RobotSettings = None,
    record: Record = None,
    codec: Codec = "jpeg",
    output: Output = None,
    pictures: Pictures = True,
    start: Annotated[
        str,
        typer.Option(
            "--from",
            help="Take the recorded channels up to this one: camera (none), state, controls, "
            "command or pose.",
        ),
    ] = "camera",
    salvage: Annotated[
        bool, typer.Option(help="Play what is whole of a session that was cut off.")
    ] = False,
    check: Annotated[
        bool, typer.Option(help="Compare every recorded channel with what the frames lead to now.")
    ] = False,
    mqtt: Broker = None,
    player: PlayerName = None,
    site: Site = SITE,
    password_file: PasswordFile = None,
    ca: Ca = None,
) -> None:
    """Play a recorded session: in a window, to a video, or only to its summary.

    Without a display and without --output nothing is drawn, and the summary is printed.

    Example: [cyan]cubeling replay recordings/companion.mcap --output companion.mp4[/]
    """
    console = Console()
    told = salvaged(session) if salvage else about(session)
    drawing = pictures and not check and (output is not None or has_display())
    wish = Wish(
        scenario or told.scenario,
        str(session),
        cube=told.cube or None,
        character=character or told.character or None,
        speed_map=told.speed_map,
        turns=told.turns,
        personality=personality or told.personality or None,
        look=told.look,
        robot=robot,
        robot_settings=robot_settings,
        record=record,
        codec=codec,
        output=output,
        pictures=drawing,
        salvage=salvage,
        start=start,
    )
    if check:
        verdict = check_session(session, wish)
        console.print(verdict)
        raise typer.Exit(0 if verdict.identical else 1)
    with ExitStack() as closing:
        line = publisher(mqtt, player, site, Credentials(None, password_file, ca), closing)
        plan = open_session(wish, closing)
        if line is not None:  # others live in real time
            plan = replace(plan, player=line, paced=True)
        tell_guess(wish, plan.source, console)
        summary = play_to_end(plan, console, f"replaying {session.name}")
    console.print(summary)
    if output is not None:
        console.print(finished_video(output))
    summary.check()
