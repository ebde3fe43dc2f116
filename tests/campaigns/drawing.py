"""Draw for minutes in every quality, and look for growth of memory and of OpenGL's objects.

`python -m tests.campaigns.drawing [--minutes M]` prints a table; the exit code is 1 if something
grew. Characters of all kinds walk through the picture, come and go, and the quality and the size of
what is drawn change all the time, as while a camera's rate is held.
"""

import argparse
import ctypes
import ctypes.util
import gc
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import moderngl
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.model.character import Character
from cubeling.characters.rendering import (
    QUALITIES,
    Focus,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.tracking.appearance import HandMask
from tests.bench.picture import SIZE, scene

MAX_GROWTH_BYTES = 20e6
"""Growth of the least memory that is not noise."""

KINDS = ("Texture", "Buffer", "Framebuffer", "VertexArray")
"""Objects of OpenGL that are counted."""

PICTURES_OF_A_QUALITY = 7
"""After so many pictures, the quality changes."""

SETTLING_PICTURES = 5
"""The same pictures before memory is read: the driver frees what earlier ones used only then."""


@dataclass(frozen=True)
class Held:
    """What the program holds at one time."""

    pictures: int
    """Drawn so far."""

    memory: int
    """Resident memory [bytes]; 0 where the system does not tell."""

    counts: tuple[int, ...]
    """Number of each of `KINDS`."""


def held(context: moderngl.Context, pictures: int) -> Held:
    """Return what is held now.

    OpenGL gives out ascending names, so all that exist are below that of a new object.
    """
    gc.collect()
    texture, buffer = context.texture((1, 1), 4), context.buffer(reserve=4)
    framebuffer = context.framebuffer([texture])
    program = context.program(vertex_shader="#version 330\nvoid main() { gl_Position = vec4(0); }")
    array = context.vertex_array(program, [])
    names = (texture.glo, buffer.glo, framebuffer.glo, array.glo)
    counts = tuple(_count(kind, name) for kind, name in zip(KINDS, names, strict=True))
    context.detect_framebuffer(0).use()
    for each in (texture, buffer, framebuffer, array, program):
        each.release()
    context.finish()
    if hasattr(ctypes.CDLL(None), "malloc_trim"):  # glibc keeps what was freed, as it likes
        ctypes.CDLL(None).malloc_trim(0)
    statm = Path("/proc/self/statm")
    memory = int(statm.read_text().split()[1]) * 4096 if statm.exists() else 0
    return Held(pictures, memory, counts)


def _count(kind: str, end: int) -> int:
    """Return how many names below one are objects of a kind."""
    library = ctypes.util.find_library("GL")
    exists = getattr(ctypes.CDLL(library), f"glIs{kind}")
    exists.restype = ctypes.c_ubyte
    return sum(exists(name) for name in range(1, end))


def draw(context: moderngl.Context, seconds: float, report_s: float) -> Iterator[Held]:
    """Draw for a time, and yield what is held now and then; the first one after some warming up."""
    characters = [Character.load(name) for name in ("human", "vleo", "robot")]
    view, _ = scene(characters[0])
    actors = [scene(character)[1] for character in characters]
    stage = Stage(context, SIZE)
    qualities = list(QUALITIES.values())
    rng = np.random.default_rng(1)
    began = reported = time.perf_counter()
    number, warm = 0, False
    while time.perf_counter() - began < seconds:
        if number % PICTURES_OF_A_QUALITY == 0:
            stage.quality = qualities[rng.integers(len(qualities))]
        shown = [actor(number) for actor in actors if rng.random() < 0.6]
        stage.draw(
            replace(
                view,
                hand=HandMask(
                    500, 200, np.full((90, 80), 128, np.uint8), np.array([0.0, 0.0, 0.5])
                ),
                focus=Focus(0.6, 0.6, 0.01 * rng.random()),
            ),
            [_placed(actor, rng) for actor in shown],
        )
        number += 1
        if time.perf_counter() - reported > report_s:
            stage.quality = qualities[-1]
            stage.quality = qualities[0]  # what is held does not depend on the last sizes now
            for _ in range(SETTLING_PICTURES):
                stage.draw(view, [actors[0](0)])
            if warm:
                yield held(context, number)
            warm, reported = True, time.perf_counter()
    stage.release()


def _placed(actor: SceneCharacter, rng: np.random.Generator) -> SceneCharacter:
    """Return an actor somewhere, in some size."""
    place = actor.posed.table_from_character.copy()
    place[:3, :3] *= rng.uniform(0.4, 1.6)
    place[[0, 2], 3] = rng.uniform(-0.2, 0.2, 2)
    return replace(actor, posed=replace(actor.posed, table_from_character=place))


def grown(reports: list[Held]) -> bool:
    """Return whether objects, or the least memory, grew from the first reports to the last.

    What is held besides depends on the last pictures, and software rendering gives memory back
    late: a leak raises the least of many values.
    """
    first, last, half = reports[0], reports[-1], len(reports) // 2
    more = any(after > before for before, after in zip(first.counts, last.counts, strict=True))
    early, late = (min(r.memory for r in part) for part in (reports[:half], reports[half:]))
    return more or late - early > MAX_GROWTH_BYTES


def main() -> int:
    """Print the table; return 1 if something grew."""
    parser = argparse.ArgumentParser(description="Draw, and look for growth.")
    parser.add_argument("--minutes", type=float, default=10.0)
    wanted = parser.parse_args()
    context = create_context()
    seconds = 60.0 * wanted.minutes
    reports = list(draw(context, seconds, report_s=seconds / 11))
    table = Table(title="what drawing holds")
    for heading in ("pictures", "memory (MB)", "textures", "buffers", "framebuffers", "arrays"):
        table.add_column(heading, justify="right")
    for report in reports:
        counts = (str(count) for count in report.counts)
        table.add_row(f"{report.pictures}", f"{report.memory / 1e6:.0f}", *counts)
    console = Console()
    console.print(table)
    wrong, error = grown(reports), context.error
    console.print(f"{'something grew' if wrong else 'nothing grew'}; OpenGL says {error}")
    context.release()
    return int(wrong or error != "GL_NO_ERROR")


if __name__ == "__main__":
    sys.exit(main())
