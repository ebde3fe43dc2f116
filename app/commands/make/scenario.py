"""The command `cubeling scenario`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.command_group import CommandGroup
from cubeling.app.errors import AppError
from cubeling.app.output_path import check_output
from cubeling.files import write_whole

app = CommandGroup("Write scenarios of your own: as a file of rules, or as a package in Python.")


@app.command()
def new(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="A file of rules that ends in .toml, or the name of a package in Python.",
        ),
    ],
) -> None:
    """Write a scenario that plays: the character waves when the cube is lifted.

    NAME.toml is a file of rules; see docs/rules.md. Without .toml, it is a folder with a package
    and its test; see docs/your-own-scenario.md.

    Example: cubeling scenario new hello.toml
    """
    from cubeling.app.workshop import scenario_templates as templates

    console = Console(highlight=False, soft_wrap=True)
    if name.endswith(".toml"):
        path = Path(name)
        check_output(path, "scenario", (".toml",), overwrite=False, remedy="remove it")
        write_whole(path, templates.RULES, AppError)
        console.print(
            f"[bold]{escape(name)}[/] is written: [cyan]cubeling play {escape(name)}[/]; "
            "[cyan]cubeling scenario words[/] lists what rules may say"
        )
        return
    folder = templates.write_package(name)
    console.print(
        f"[bold]{escape(str(folder))}[/] is written. Install it, test it, and play it:\n"
        f"[cyan]python -m pip install pytest --editable {escape(str(folder))}\n"
        f"python -m pytest {escape(str(folder))}\n"
        f"cubeling play {escape(name)}[/]"
    )


@app.command()
def words() -> None:
    """List the conditions and actions that a file of rules may name.

    Example: cubeling scenario words
    """
    from cubeling.app.scenarios.rules.vocabulary import ACTIONS, CONDITIONS

    console = Console(highlight=False)
    table = Table("condition", "holds when", box=None, pad_edge=False)
    for name, condition in CONDITIONS.items():
        usual = f"; {condition.default} without a number" if condition.default else ""
        table.add_row(f"{name} {condition.argument}".strip(), f"{condition.meaning}{usual}")
    console.print(table)
    console.print()
    table = Table("key", "does", box=None, pad_edge=False)
    table.add_row("say", "say a text, or one of a list of texts in turn")
    for name, action in ACTIONS.items():
        choices = f": {', '.join(action.choices)}" if action.choices else ""
        table.add_row(name, f"{action.meaning}{choices}")
    console.print(table)
