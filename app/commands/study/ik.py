"""The command `cubeling ik`."""

from typing import Annotated

import typer
from rich.console import Console

from cubeling.app.command_group import CommandGroup

app = CommandGroup("Measure the solvers of inverse kinematics.")


@app.callback()
def group() -> None:
    """Measure the solvers of inverse kinematics."""


@app.command()
def bench(
    targets: Annotated[int, typer.Option(min=10, help="Random targets of each row.")] = 1000,
    seed: Annotated[int, typer.Option(help="Of the random targets.")] = 0,
) -> None:
    """Measure all solvers on chains of 6 and 10 joints, beside what the thesis of Huang prints.

    Targets are the ends of random postures within the limits, so all can be reached. The second
    table adds what all methods share: chains curl up for targets near their base, and damped least
    squares goes on from what is left unsolved, also from random postures.

    steps: of springs or angles, or sweeps over the joints; ms, µs: for a chain by itself, and in a
    batch. change: summed turn of the joints. zig-zag: changes of the sense of the bend, for targets
    near the base. twist: of a bone, for a centimetre of its target; 99 % are less (first table,
    always from the same start), or 99.9 % while a chain follows its target (second table).

    Example: cubeling ik bench
    """
    from cubeling.app.commands.study.ik_figures import (
        CHAIN_SIZES,
        alone_table,
        measure_alone,
        measure_sure,
        sure_table,
    )
    from cubeling.characters.motion import SOLVERS

    console = Console()
    alone, sure = [], []
    with console.status("solving") as status:
        for joints in CHAIN_SIZES:
            for method in SOLVERS:
                status.update(f"{method}, {joints} joints")
                alone.append(measure_alone(method, joints, targets, seed))
                sure.append(measure_sure(method, joints, targets, seed))
    console.print(alone_table(alone, targets))
    console.print(sure_table(sure))
