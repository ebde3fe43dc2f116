"""Commands of the command line, and what `--help` prints of them.

A help is plain text of at most 80 columns, so that it reads the same in a terminal, in a pipe and
in a file, and nothing in it is markup: `[mm]` is a unit. Only a terminal shows colours.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import typer
import typer.core

if TYPE_CHECKING:
    from typer._click.core import Context
    from typer._click.formatting import HelpFormatter

NAME_WIDTH = 26
"""A longer name of an option has a line to itself, and its help begins below it [columns]."""


def former_spellings(spellings: dict[str, str]) -> dict[str, Any]:
    """Return context settings with which options are also understood as they were spelt once.

    No help, completion or suggestion shows the former spellings.

    Parameters
    ----------
    spellings
        The present spelling of each former one, without dashes: `{"lang": "language"}`.
    """
    return {"token_normalize_func": lambda word: spellings.get(word, word)}


class HelpCommand(typer.core.TyperCommand):
    """A command whose help lists the options in groups: those without a group come first."""

    def format_options(self, ctx: Context, formatter: HelpFormatter) -> None:
        """Write the arguments and options."""
        write_parameters(self, ctx, formatter)


class HelpGroup(typer.core.TyperGroup):
    """Commands whose help lists them in groups; without arguments it is shown."""

    def parse_args(self, ctx: Context, args: list[str]) -> list[str]:
        """Parse the arguments; none at all ask for the help."""
        return super().parse_args(ctx, args or ["--help"])

    def format_options(self, ctx: Context, formatter: HelpFormatter) -> None:
        """Write the commands, then the options: the commands are what one looks for."""
        shown = [each for each in self.commands.values() if not each.hidden]
        write_sections(
            (
                (getattr(each, "rich_help_panel", None) or "Commands", _record(each))
                for each in shown
            ),
            formatter,
        )
        write_parameters(self, ctx, formatter)


class CommandGroup(typer.Typer):
    """A `typer.Typer` whose commands have our help."""

    def __init__(self, help: str | None = None, **attributes: Any) -> None:
        defaults = {"cls": HelpGroup, "add_completion": False}
        super().__init__(help=help, rich_markup_mode=None, **{**defaults, **attributes})

    def command(self, name: str | None = None, **attributes: Any) -> Callable[[Any], Any]:
        """Return the decorator that adds a function as a command, as `typer.Typer.command` does."""
        return super().command(name, **{"cls": HelpCommand, **attributes})


def write_parameters(command: Any, ctx: Context, formatter: HelpFormatter) -> None:
    """Write the arguments of a command, then its options, those without a group first."""
    arguments, options, grouped = [], [], []
    for each in command.get_params(ctx):
        record = each.get_help_record(ctx)
        group = getattr(each, "rich_help_panel", None)
        if record is None:  # a hidden one
            continue
        if each.param_type_name == "argument":
            arguments.append(("Arguments", record))
        elif group is None:
            options.append(("Options", record))
        else:
            grouped.append((group, record))
    write_sections([*arguments, *options, *grouped], formatter)


def write_sections(rows: Iterable[tuple[str, tuple[str, str]]], formatter: HelpFormatter) -> None:
    """Write names with their help, under the heading of each section in the order of its first."""
    sections: dict[str, list[tuple[str, str]]] = {}
    for heading, (name, text) in rows:
        plain = name.strip(" /")  # one that only says no, as --no-preferences, begins with a slash
        sections.setdefault(heading, []).append((typer.style(plain, fg="cyan"), text))
    for heading, names in sections.items():
        with formatter.section(typer.style(heading, bold=True)):
            formatter.write_dl(names, col_max=NAME_WIDTH)


def _record(command: Any) -> tuple[str, str]:
    """Return the name of a command and the first paragraph of its help."""
    return command.name, " ".join((command.help or "").partition("\n\n")[0].split())
