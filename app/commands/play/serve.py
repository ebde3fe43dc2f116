"""The command `cubeling serve`."""

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from cubeling.app.admission import Token
from cubeling.app.commands.play.instrument_options import GivenInstruments, with_instruments
from cubeling.app.commands.play.play_options import (
    FILES_GROUP,
    PHONE,
    CastOption,
    CharacterOption,
    CodecOption,
    CubesOption,
    FolderOption,
    IntrinsicsOption,
    LanguageOption,
    ModelNameOption,
    ModelOption,
    PersonalityOption,
    PlayersOption,
    QualityOption,
    RecordOption,
    RobotsOption,
    RotateMbOption,
    RotateMinutesOption,
    codecs_of,
    describe,
    model_of,
    parts_of,
    source_of,
)
from cubeling.app.commands.play.preference_options import DEFAULT_FILE, GivenPreferences
from cubeling.app.pipeline.choices import cast_of, checked_players, robots_of
from cubeling.app.running.quality_control import AUTO_QUALITY, checked_quality
from cubeling.app.scenarios import check_scenario, scenario_names

if TYPE_CHECKING:
    from cubeling.app.running.instrument import Instrument
    from cubeling.app.session import SessionOptions
    from cubeling.app.ui.web.server import WebServer

DEFAULT_PORT = 8420
"""The usual port; no registered service has it."""


@with_instruments
def serve(
    scenario: Annotated[
        str,
        typer.Option(
            help="What is played first: "
            + "; ".join(map(describe, scenario_names()))
            + " The page shows them all.",
            autocompletion=lambda: list(scenario_names()),
        ),
    ] = "companion",
    lan: Annotated[
        bool,
        typer.Option("--lan", help="Let phones of your network in, over TLS; else this computer."),
    ] = False,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="The TCP port; 0: any.")
    ] = DEFAULT_PORT,
    source: Annotated[
        str,
        typer.Option(
            "--source",
            "-s",
            help="phone, the camera of whoever opens the page; or another, as in cubeling play.",
        ),
    ] = PHONE,
    players: PlayersOption = 1,
    cubes: CubesOption = None,
    character: CharacterOption = None,
    cast: CastOption = None,
    personality: PersonalityOption = None,
    language: LanguageOption = None,
    model: ModelOption = None,
    model_name: ModelNameOption = "default",
    intrinsics: IntrinsicsOption = None,
    quality: QualityOption = AUTO_QUALITY,
    robots: RobotsOption = None,
    record: RecordOption = None,
    rotate_minutes: RotateMinutesOption = None,
    rotate_mb: RotateMbOption = None,
    codec: CodecOption = "auto",
    folder: FolderOption = None,
    token: Annotated[
        str | None,
        typer.Option(
            help="The secret of the address, of 8 to 128 characters; without it, a new one.",
            rich_help_panel=FILES_GROUP,
        ),
    ] = None,
    preferences_file: Annotated[
        Path,
        typer.Option(
            "--preferences",
            help="The file beside which lenses and the certificate are kept.",
            show_default=False,
            rich_help_panel=FILES_GROUP,
        ),
    ] = DEFAULT_FILE,
    *,
    instruments: GivenInstruments,
) -> None:
    """Play in a browser: scan the code with a phone, whose camera and screen are then yours.

    On this computer, open the printed address. With --lan, the phone's browser asks once whether to
    trust this computer, as its certificate is made on the spot; over USB (adb reverse) it does not.

    Example: cubeling serve --lan
    """
    check_scenario(scenario)
    secret = Token.generate() if token is None else Token(token)
    from cubeling.app.running.option_checks import check_inputs, check_output_paths
    from cubeling.app.session import SessionOptions

    first, others = cast_of(cast, character)
    (robot, second_robot), robot_names = robots_of(robots or (), players)
    record_codec, _ = codecs_of(codec, record, None)
    options = SessionOptions(
        scenario=scenario,
        source=source_of(source),
        cubes=tuple(cubes or ()),
        character=first,
        others=others,
        players=checked_players(players),
        personality=personality,
        language=language,
        **model_of(model, model_name),
        intrinsics=intrinsics,
        quality=checked_quality(quality),
        robot=robot,
        second_robot=second_robot,
        robot_names=robot_names,
        record=record,
        **parts_of(rotate_minutes, rotate_mb),
        codec=record_codec,
        folder=folder,
    )
    check_output_paths(options)
    check_inputs(options)
    from cubeling.app.scenarios.roles import check_cubes

    check_cubes(scenario, options.cubes)
    from cubeling.app.running.pages import open_pages

    with closing(
        open_pages(port, secret, lan=lan, folder=preferences_file.parent, camera=source == PHONE)
    ) as server:
        from cubeling.app.ui.web.opening import page_address

        console = Console(soft_wrap=True, highlight=False)
        for line in page_address(server):
            console.print(line)
        with instruments.open(server=server) as opened:
            _play(options, server, preferences_file, opened)


def _play(
    options: "SessionOptions",
    server: "WebServer",
    preferences_file: Path,
    instruments: "tuple[Instrument, ...]",
) -> None:
    # Loaded while the phone is scanning.
    from cubeling.app.commands.play.progress import play_session
    from cubeling.app.running.pages import awaited_camera, page_front_end
    from cubeling.app.thread_turns import often_switching

    front_end = page_front_end(server)
    with awaited_camera(options, server) as (options, camera):
        options, kept = GivenPreferences({}, preferences_file).open(options)
        with often_switching():
            play_session(
                options,
                f"playing {options.scenario}",
                source=camera,
                front_end=front_end,
                instruments=instruments,
                preferences=kept,
            )
