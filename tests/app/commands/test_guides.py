"""Every command to type in the README and the guides is one that the program understands."""

import re
import shlex
from pathlib import Path

import pytest
import typer.main
from typer.exceptions import TyperException

from cubeling import app
from cubeling.app.cli import app as cli

ROOT = Path(app.__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def commands(text):
    """Yield the arguments of each `cubeling` line in blocks of shell commands."""
    for block in re.findall(r"^```sh\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        for line in block.replace("\\\n", " ").splitlines():
            if line.startswith("cubeling "):
                words = shlex.split(line, comments=True)
                yield words[1 : words.index(">") if ">" in words else None]


def parse(command, arguments):
    """Parse the arguments as the program does, and go down to the last subcommand."""
    context = command.make_context(command.name, list(arguments))
    if hasattr(command, "resolve_command"):
        _, subcommand, rest = command.resolve_command(
            context, [*context._protected_args, *context.args]
        )
        parse(subcommand, rest)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_commands_of_a_page_are_understood(page):
    program = typer.main.get_command(cli)
    for arguments in commands(page.read_text("utf-8")):
        try:
            parse(program, arguments)
        except typer.Exit:  # --help
            pass
        except TyperException as error:
            pytest.fail(f"cubeling {shlex.join(arguments)}: {error}")
