"""`cubeling`: the command line."""

import signal
import sys
import warnings
from typing import Annotated, TextIO

import typer
import typer.exceptions
from rich.console import Console

from affect import AffectError
from app.commands import bridge, calibrate, character, cube, demo, doctor, mood, play, replay, robot
from app.errors import AppError
from characters import CharacterError
from characters.errors import CharacterWarning
from robot import RobotError
from tracking import TrackingError

BAD_INPUT = 2
"""Exit code for anything a person can put right."""

app = typer.Typer(
    name="cubeling",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="First time here? [bold]cubeling demo[/], then [bold]cubeling cube companion[/]",
)
app.command()(demo.demo)
app.command()(play.play)
app.command()(replay.replay)
app.command()(bridge.bridge)
app.command()(cube.cube)
app.command()(calibrate.calibrate)
app.add_typer(character.app, name="character")
app.add_typer(robot.app, name="robot")
app.add_typer(mood.app, name="mood")
app.command()(doctor.doctor)


@app.callback()
def common(
    debug: Annotated[
        bool, typer.Option("--debug", help="Show where in the program an error came from.")
    ] = False,
) -> None:
    """Play with a paper cube, a character on your screen and a robot on your desk."""


def main() -> None:
    """Run a command; bad input ends in one line and exit code 2."""
    debug = "--debug" in sys.argv
    say_goodbye()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("default", CharacterWarning)
            warnings.showwarning = Mentions()
            code = app(prog_name="cubeling", standalone_mode=False)
    except typer.exceptions.TyperException as error:
        told = usage(error)
        complain(told)
        code = BAD_INPUT if told else 0  # a bare `cubeling` shows its help, which is no mistake
    except (AppError, AffectError, TrackingError, CharacterError, RobotError) as error:
        if debug:
            raise
        complain(str(error))
        code = BAD_INPUT
    except (OSError, MemoryError) as error:  # a full disk, a file too large: no fault of the code
        if debug:
            raise
        complain(trouble(error))
        code = BAD_INPUT
    except (KeyboardInterrupt, typer.Abort):
        code = 130
    sys.exit(code if isinstance(code, int) else 0)


def say_goodbye() -> None:
    """Let a closed terminal and `kill` end a command as Ctrl-C does.

    A robot that has no failsafe of its own keeps its servos on if nobody says goodbye to it.
    """
    for name in ("SIGTERM", "SIGHUP"):  # Windows lacks the second
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:  # not under nohup
            signal.signal(number, signal.default_int_handler)


def usage(error: typer.exceptions.TyperException) -> str:
    """Return what is wrong with a command line, and where to read how it should be."""
    context = getattr(error, "ctx", None)
    where = context.command_path if context else "cubeling"
    message = error.format_message() if hasattr(error, "format_message") else str(error)
    return f"{message.rstrip('.')} (see {where} --help)" if message else ""


def trouble(error: OSError | MemoryError) -> str:
    """Return what the system refused, and of which file."""
    if isinstance(error, MemoryError):
        return "there is not enough memory for this; close other programs or take a smaller file"
    where = f"{error.filename}: " if error.filename else ""
    return f"{where}{error.strerror or error}"


class Mentions:
    """Prints warnings as one line each, once; one about input does not name the code that gave it.

    A file that is read twice is repaired twice, and Python would tell of it again.
    """

    def __init__(self) -> None:
        self._told: set[str] = set()

    def __call__(
        self,
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        """Take the place of `warnings.showwarning`."""
        repaired = issubclass(category, CharacterWarning)
        told = str(message) if repaired else f"{filename}:{lineno}: {category.__name__}: {message}"
        if told not in self._told:
            complain(told)
        self._told.add(told)


def complain(line: str) -> None:
    """Print one line on standard error; nothing where there is nothing to say."""
    if not line:
        return
    Console(stderr=True, soft_wrap=True, highlight=False, markup=False).print(
        "cubeling: " + " ".join(line.split())
    )
