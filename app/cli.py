"""`cubeling`: the command line.

The module of a command is imported when the command is called, so the help of `cubeling` needs
neither OpenCV nor numpy.
"""

import io
import sys
import warnings
from importlib import import_module
from typing import Annotated, Any, TextIO

import typer
import typer.exceptions
import typer.main
from rich.console import Console

from cubeling.app.command_group import CommandGroup, HelpCommand, HelpGroup, former_spellings
from cubeling.app.interrupts import CTRL_C_EXIT_CODE, termination
from cubeling.app.ui.literal_text import literal_text
from cubeling.bad_input import BadInputError, one_line

BAD_INPUT_EXIT_CODE = 2
"""Exit code for every error that the user can correct."""


GROUPS = {
    "Play": {
        "demo": "See it work: with your camera, with the bundled recording, or as a video.",
        "play": "Play with the cube in front of a camera.",
        "talk": "Talk with a character: type, and it answers with voice, face and gestures.",
        "show": "Show a play: several characters speak and act by one file.",
        "serve": "Play in a browser: scan the code with a phone, whose camera and screen are then "
        "yours.",
        "replay": "Play a recorded session: in a window, to a video, or only to its summary.",
        "cube": "Write a cube as a sheet to print, cut, fold and glue.",
        "calibrate": "Measure the camera's lens: wave the cube in front of it for about "
        "20 seconds.",
    },
    "Make": {
        "speak": "Let a character say something, with its mouth, face and hands.",
        "behave": "Let a character perform blocks of BML: speech, gestures, gaze, postures, "
        "walking.",
        "gesture": "Make gestures that every character can perform, look at them, edit them, and "
        "learn those that beat the rhythm of speech.",
        "scenario": "Write scenarios of your own: as a file of rules, or as a package in Python.",
        "schedule": "Render a blending schedule in XML to a motion file or a video.",
        "motions": "Make motion graphs of your own recordings: where one clip can follow another.",
        "idle": "Learn how a person stands, from recordings, and let a character stand so.",
        "sounds": "Write all sounds as .wav files, to listen to them and to replace them.",
    },
    "Study": {
        "export": "Write recorded sessions as tables, in CSV and JSON Lines, with a data "
        "dictionary.",
        "label": "Say who played a recorded session, and mark moments in it; the recording "
        "stays as it was.",
        "join": "Write a recording in parts as one session, which replays like it.",
        "anonymise": "Blur the pictures of a session outside the cubes and the table around them.",
        "study": "Run a study: orders, tasks, questionnaires, simulated participants, a report.",
        "stimuli": "Make the films that bundled studies show, from recordings of your own.",
        "mood": "Plot and tabulate the moods of recorded sessions; print personalities.",
        "speech": "Look at recorded speech: its pitch, accents, words and phones.",
        "reproduce": "Make printed tables and figures of the theses again, beside what they print.",
    },
    "Robots": {
        "robot": "Simulate, try out and test robots, and list the serial ports.",
        "bridge": "Let robots follow players on other computers, over an MQTT broker; "
        "see docs/many.md.",
    },
    "Look": {
        "doctor": "Check what this computer has, and show the commands that install what is "
        "missing.",
        "inspect": "Show what is in a file: of a session its rates, gaps, tracking, actions, "
        "emotion, link.",
        "diff": "Show what differs between two sessions: what was played, their figures, their "
        "channels.",
        "character": "Inspect characters and motions, and make clips to walk with.",
        "latency": "Measure how late the picture is, with your own screen and camera.",
    },
}
"""The commands in their groups, with the first sentence of their help. A new command is registered
here; its module is in the folder of its group."""

COMMANDS = {name: summary for group in GROUPS.values() for name, summary in group.items()}
"""The commands of all groups."""

FORMER_SPELLINGS = {"lang": "language", "window-size": "size", "camera": "source"}
"""What options were called in old versions, which still works."""

RENAMED = {
    "gestures": "cubeling gesture, and its show cubeling gesture library",
    "ik": "cubeling reproduce ik-methods",
}
"""What commands of old versions are called now."""


def load_command(name: str) -> Any:
    """Import the module of a command; return its function NAME, or the group that is its `app`."""
    (folder,) = (group.lower() for group, summaries in GROUPS.items() if name in summaries)
    module = import_module(f"cubeling.app.commands.{folder}.{name}")
    group = getattr(module, "app", None)
    if group is None:
        group = CommandGroup()
        group.command(name)(getattr(module, name))
    return typer.main.get_command(group)


class LazyGroup(HelpGroup):
    """Lists `COMMANDS` with their summaries, and imports only the one that is called."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        for group, summaries in GROUPS.items():
            for name, summary in summaries.items():
                self.add_command(HelpCommand(name, help=summary, rich_help_panel=group))

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Return the name, the command and the arguments that are left for it."""
        if args[0] in RENAMED:
            ctx.fail(f"'{args[0]}' is now {RENAMED[args[0]]}")
        name, command, rest = super().resolve_command(ctx, args)
        return name, load_command(name) if name in COMMANDS else command, rest


app = CommandGroup(
    name="cubeling",
    cls=LazyGroup,
    add_completion=True,
    pretty_exceptions_enable=False,
    context_settings={
        "help_option_names": ["-h", "--help"],
        **former_spellings(FORMER_SPELLINGS),
    },
    epilog="First time here? cubeling demo, then cubeling cube companion",
)


def print_version(asked: bool) -> None:
    """Print the version, and end."""
    if asked:
        from importlib.metadata import version as installed_version  # 15 ms, only for this

        Console(highlight=False).print(f"cubeling {installed_version('cubeling')}")
        raise typer.Exit


@app.callback()
def common(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Play with a paper cube, a character on your screen and a robot on your desk."""


def main() -> None:
    """Run a command; bad input ends in one line and exit code 2."""
    arguments = [each for each in sys.argv[1:] if each != "--debug"]  # it may stand anywhere
    debug = len(arguments) < len(sys.argv) - 1
    if debug:
        show_tracebacks()
    termination.watch()
    print_what_can_be_encoded()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("default", UserWarning)  # CharacterWarning is one
            warnings.showwarning = WarningPrinter()
            code = app(arguments, prog_name="cubeling", standalone_mode=False)
    except typer.exceptions.TyperException as error:
        print_message(usage_error(error))
        code = BAD_INPUT_EXIT_CODE
    except (KeyboardInterrupt, typer.Abort):
        code = CTRL_C_EXIT_CODE
    except BadInputError as error:
        if debug:
            raise
        print_message(str(error))
        code = BAD_INPUT_EXIT_CODE
    except (OSError, MemoryError) as error:  # such as a full disk or a file that is too large
        if debug:
            raise
        print_message(system_error(error))
        code = BAD_INPUT_EXIT_CODE
    sys.exit(termination.exit_code(code if isinstance(code, int) else 0))


def show_tracebacks() -> None:
    """Print the tracebacks of errors that do not end the command, too."""
    import logging  # 5 ms, only for this

    logging.basicConfig(format="%(message)s")
    logging.getLogger("cubeling").setLevel(logging.DEBUG)


def print_what_can_be_encoded() -> None:
    """Let a "?" stand for what the encoding of the output lacks, as that of a file on Windows."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")


def usage_error(error: typer.exceptions.TyperException) -> str:
    """Return what is wrong with a command line, and which help describes it."""
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "cubeling"
    message = error.format_message() if hasattr(error, "format_message") else str(error)
    return f"{message.rstrip('.')} (see {command} --help)"


def system_error(error: OSError | MemoryError) -> str:
    """Return what the operating system refused, and for which file."""
    if isinstance(error, MemoryError):
        return "there is not enough memory for this; close other programs or take a smaller file"
    file = f"{error.filename}: " if error.filename else ""
    return f"{file}{error.strerror or error}"


class WarningPrinter:
    """Prints each warning once, as one line.

    A warning about a character's file does not name the line of code that gave it. A file that is
    read twice is repaired twice; Python alone would print its warning twice.
    """

    def __init__(self) -> None:
        self._printed: set[str] = set()

    def __call__(
        self,
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        """Print a warning; the signature is that of `warnings.showwarning`."""
        text = one_line(" ".join(str(message).split()))
        errors = sys.modules.get("cubeling.characters.errors")
        if errors is None or not issubclass(category, errors.CharacterWarning):
            text = f"{filename}:{lineno}: {category.__name__}: {text}"
        if text not in self._printed:
            print_message(text)
        self._printed.add(text)


def print_message(message: str) -> None:
    """Print a message as one line on standard error; print nothing if it is empty."""
    if message:
        Console(stderr=True, soft_wrap=True, highlight=False).print(
            literal_text("cubeling: " + " ".join(message.split()))
        )
