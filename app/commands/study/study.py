"""The commands of `cubeling study`."""

import shlex
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.text import Text

from cubeling.app.command_group import CommandGroup
from cubeling.app.commands.play.instrument_options import GivenInstruments, with_instruments
from cubeling.app.commands.play.play_options import (
    PHONE,
    RotateMbOption,
    RotateMinutesOption,
    parts_of,
    source_of,
)
from cubeling.app.commands.play.preference_options import DEFAULT_FILE
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character
from cubeling.app.output_path import check_output, check_output_folder, output_folder
from cubeling.app.ui.display import has_display
from cubeling.files import write_whole

if TYPE_CHECKING:
    from cubeling.app.ui.web.server import WebServer
    from cubeling.app.workshop.study.participants.live_task import TaskSetup
    from cubeling.app.workshop.study.participants.running import StudyDesk
    from cubeling.app.workshop.study.protocols.protocol import Protocol

app = CommandGroup("Run a study: orders, tasks, questionnaires, simulated participants, a report.")

MAX_SIMULATED = 2000
"""Most simulated participants of a study."""

PLAY_GROUP = "How tasks are played"


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="The .toml file to write.")],
    like: Annotated[
        str | None, typer.Option(help="Begin with a bundled protocol instead of the template.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Overwrite the file.")] = False,
) -> None:
    """Write the protocol of a study, which runs as it is, to change it.

    Example: cubeling study new turns.toml
    """
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    check_output(path, "protocol", (".toml",), overwrite=overwrite)
    from cubeling.app.workshop.study.protocols.protocol_file import load_protocol, protocol_text

    if like is not None:
        load_protocol(like)
    write_whole(path, protocol_text(like).replace("NAME.toml", path.name), AppError)
    console = Console(highlight=False, soft_wrap=True)
    console.print(Text.assemble("Written: ", (str(path), "bold")))
    run = f"cubeling study run {shlex.quote(str(path))} -o trial --simulated 8"
    console.print(Text.assemble("Try it: ", (run, "cyan")))


@app.command()
@with_instruments
def run(
    protocol: Annotated[str, typer.Argument(help="A .toml file, or the name of a bundled one.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the study.")],
    participant: Annotated[str, typer.Option(help="Code of who takes part, as P07.")] = "",
    pilot: Annotated[
        bool, typer.Option("--pilot", help="Who takes part does not count for the study.")
    ] = False,
    simulated: Annotated[
        int,
        typer.Option(
            min=0,
            max=MAX_SIMULATED,
            help="Let so many simulated participants take part, and write the report.",
        ),
    ] = 0,
    page: Annotated[
        bool,
        typer.Option(
            "--page", help="Ask and play on a page, in a browser, not in terminal and window."
        ),
    ] = False,
    lan: Annotated[
        bool, typer.Option("--lan", help="Let a phone of your network be that browser, over TLS.")
    ] = False,
    window: Annotated[
        bool, typer.Option("--window", help="Ask in a window, not in the terminal.")
    ] = False,
    source: Annotated[
        str,
        typer.Option(
            "--source",
            "-s",
            help="The camera; with --page, phone is that of whoever opens the page.",
            rich_help_panel=PLAY_GROUP,
        ),
    ] = "camera:0",
    robot: Annotated[
        str, typer.Option("--robot", "-r", help="The robot.", rich_help_panel=PLAY_GROUP)
    ] = "sim",
    intrinsics: Annotated[
        Path | None,
        typer.Option(help="File of the calibrated camera.", rich_help_panel=PLAY_GROUP),
    ] = None,
    pictures: Annotated[
        bool,
        typer.Option(
            "--pictures/--no-pictures",
            help="Whether there is a window.",
            rich_help_panel=PLAY_GROUP,
        ),
    ] = True,
    rotate_minutes: RotateMinutesOption = None,
    rotate_mb: RotateMbOption = None,
    *,
    instruments: GivenInstruments,
) -> None:
    """Lead a participant through a study; who was interrupted goes on where they were.

    Each answer is kept before the next question is asked. See docs/studies.md.

    Example: cubeling study run vleo-and-pleo -o trial --simulated 24
    """
    if simulated and (participant or pilot):
        raise AppError("simulated participants have codes of their own: leave out --participant")
    if not simulated and not participant:
        raise AppError("who takes part needs a code: --participant P01, or --simulated 24")
    if page and window:
        raise AppError("questions are asked on a page or in a window: leave out one")
    if (lan or source == PHONE) and not page:
        raise AppError("a phone takes part with --page: add that")
    parts = parts_of(rotate_minutes, rotate_mb)
    if not output.parent.is_dir():
        raise AppError(f"there is no folder '{output.parent}' for the study '{output.name}'")
    from cubeling.app.workshop.study.participants.running import run_participant, run_simulated
    from cubeling.app.workshop.study.participants.study_log import StudyFolder, participants_in
    from cubeling.app.workshop.study.protocols.protocol_file import load_protocol

    if simulated:
        _needs_scipy()
    loaded, file = load_protocol(protocol)
    console = Console(highlight=False, soft_wrap=True)
    if simulated:
        run_simulated(StudyFolder(output, loaded, file, "simulated"), simulated)
        _report(output, console)
        pilot_run = ["cubeling", "study", "run", protocol, "-o", "pilot", "--pilot"]
        words = shlex.join([*pilot_run, "--participant", "X1", "--window"])
        console.print(Text.assemble("Next, try it yourself: ", (words, "cyan")))
        return
    from dataclasses import replace
    from datetime import datetime

    from cubeling.app.session import check_participant
    from cubeling.app.workshop.study.participants.live_task import TaskSetup, check_tasks

    check_participant(participant)
    setup = TaskSetup(source_of(source), robot, pictures, intrinsics, parts=parts)
    begins = all(person.code != participant for person in participants_in(output))
    check_tasks(loaded, setup, camera=begins and source != PHONE)
    study = StudyFolder(output, loaded, file, "pilot" if pilot else "study")
    try:
        with ExitStack() as closing:
            server = None
            if page:
                from cubeling.app.running.pages import open_pages

                server = open_pages(
                    lan=lan, folder=DEFAULT_FILE.parent, camera=source == PHONE, study=True
                )
                closing.callback(server.close)
            opened = closing.enter_context(instruments.open(loaded.wizard, server))
            setup = replace(setup, instruments=opened)
            desk = _open_desk(loaded, setup, file, console, server, closing, window=window)
            log = study.begin(participant, datetime.now())  # once all is open: it counts as begun
            done = len(log.plan) - len(log.left)
            if done:
                console.print(Text(f"{participant} goes on after {quantity(done, 'step')}.", "dim"))
            run_participant(loaded, log, desk)
            desk.thank()
    except KeyboardInterrupt:
        again = shlex.join(["cubeling", *sys.argv[1:]])
        console.print(Text(f"\nStopped; all answers are kept. Go on: {again}"))
        raise
    console.print(Text(f"Thank you, {participant}. All answers are kept in {log.folder}"))
    words = shlex.join(["cubeling", "study", "report", str(output)])
    console.print(Text.assemble("Tables and report so far: ", (words, "cyan")))


def _open_desk(
    protocol: "Protocol",
    setup: "TaskSetup",
    file: Path,
    console: Console,
    server: "WebServer | None",
    closing: ExitStack,
    *,
    window: bool,
) -> "StudyDesk":
    """Open what asks the participant: a page, a window or a terminal; the stack closes it."""
    from cubeling.app.workshop.study.protocols.protocol_file import BUNDLED_FOLDER

    folder = Path() if file.parent == BUNDLED_FOLDER else file.parent
    if server is not None:
        from cubeling.app.ui.web.opening import page_address
        from cubeling.app.workshop.study.participants.page_desk import PageDesk

        desk = PageDesk(protocol, setup, folder, server)
        console.print("The participant's page:")
        for line in page_address(server):
            console.print(line)
        return desk
    if window:
        if not has_display():
            raise AppError(
                "there is no display here for a window: leave out --window to be asked in the "
                "terminal, or take --page instead"
            )
        from cubeling.app.workshop.study.window.window_desk import WindowDesk

        shown = WindowDesk(protocol, setup, folder, say=lambda line: console.print(Text(line)))
        return closing.enter_context(shown)
    from cubeling.app.workshop.study.participants.terminal import TerminalDesk

    return TerminalDesk(protocol, setup, console)


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(help="The folder of a study.")],
) -> None:
    """Write the tables of a study, and its report as one page.

    Needs SciPy: pip install scipy

    Example: cubeling study report trial
    """
    _needs_scipy()
    _report(folder, Console(highlight=False, soft_wrap=True))


@app.command()
def faces(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the stimuli.")],
    woman: Annotated[
        str, typer.Option(help="Who is the woman: a bundled character or a file.")
    ] = "human",
    man: Annotated[str, typer.Option(help="Who is the man.")] = "human",
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Overwrite stimuli.")] = False,
) -> None:
    """Draw the 128 pictures and animations of the protocol single-facial-actions.

    One human is bundled: for two faces, name two characters with morphs for brows, cheeks and
    mouth (ARKit's or VRM's names). The file manifest.csv says what each file shows.

    Example: cubeling study faces -o faces --woman her.vrm --man him.vrm
    """
    check_output_folder(output, ["manifest.csv"], "stimuli", overwrite=overwrite)
    for name in (woman, man):
        check_character(name)
    from cubeling.app.workshop.study.face_stimuli import draw_faces

    console = Console(highlight=False, soft_wrap=True)
    with output_folder(output), Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("Drawing", total=128)
        count = draw_faces(
            {"woman": woman, "man": man}, output, drawn=lambda: progress.advance(task)
        )
    console.print(Text.assemble((str(output), "bold"), f": {count} stimuli and manifest.csv"))


def _needs_scipy() -> None:
    from importlib.util import find_spec

    if find_spec("scipy") is None:
        raise AppError("the report of a study needs SciPy: pip install scipy")


def _report(folder: Path, console: Console) -> None:
    from cubeling.app.workshop.study.participants.study_log import participants_in, read_study
    from cubeling.app.workshop.study.reporting.report import report_page
    from cubeling.app.workshop.study.reporting.tables import gather, write_tables

    protocol, kind, changed = read_study(folder)
    data = gather(protocol, kind, participants_in(folder))
    if not data.tables["answers"] and not data.tables["tasks"]:
        raise AppError(f"nobody has answered anything in '{folder}' yet: cubeling study run")
    page = report_page(data, changed)
    write_tables(data, folder)
    write_whole(folder / "report.html", page, AppError)
    people = quantity(len(data.people), "participant")
    kind_words = "" if kind == "study" else f" ({kind})"
    console.print(Text(f"{people}{kind_words}, {quantity(len(data.tables['answers']), 'answer')}"))
    console.print(Text.assemble((str(folder / "report.html"), "bold"), " and tables as .csv"))
