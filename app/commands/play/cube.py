"""The command `cubeling cube`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.output import OverwriteOption, chosen_output

USUAL_PAPER = "a4"
"""Sheets on other paper are named by it: neither overwrites the other."""


def cube(
    name: Annotated[str, typer.Argument(help="companion, locomotion, or your own .toml file.")],
    edge_mm: Annotated[float | None, typer.Option(help="Edge [mm]; the markers scale.")] = None,
    paper: Annotated[str, typer.Option(help="Paper: a4, letter or a3.")] = USUAL_PAPER,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The PDF; by default NAME.pdf, or NAME-PAPER.pdf."),
    ] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Write a cube as a sheet to print, cut, fold and glue.

    Print it at 100 % ("actual size"), and check the ruler on the sheet.
    Strong paper (160 g/m²) lasts longest.

    Example: cubeling cube companion --paper letter -o cube.pdf
    """
    from cubeling.app.scenarios.roles import check_roles
    from cubeling.tracking import CubeModel, write_sheet

    model = CubeModel.load(name)
    check_roles(model, name)
    size = "" if paper.lower() == USUAL_PAPER else f"-{paper.lower()}"
    path = chosen_output(output, f"{Path(name).stem}{size}.pdf", "sheet", (".pdf",), overwrite)
    write_sheet(model, path, edge_mm=edge_mm, paper=paper)
    Console().print(
        f"[bold]{escape(str(path))}[/] is ready. Print it at 100 %, cut along the solid line, and "
        "fold along the dashed ones.",
        soft_wrap=True,
    )
