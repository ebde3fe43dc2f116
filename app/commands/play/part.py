"""The options of commands that play a part of a recording."""

from typing import Annotated

import typer

StartOption = Annotated[
    float, typer.Option(help="Start so many seconds after the first frame of the recording.")
]
EndOption = Annotated[
    float | None, typer.Option(help="End so many seconds after the first frame of the recording.")
]
LoopOption = Annotated[bool, typer.Option("--loop", help="In a window, begin again at the end.")]
