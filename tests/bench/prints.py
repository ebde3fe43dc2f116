"""How often a print that differs from its file is named, and a right one wrongly: a command.

Drawn cubes are folded askew and shown with a lens that is off, in one pose a look; the recordings
and the photographs show right prints. `python -m tests.bench.prints`.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.registry import SCENARIOS
from cubeling.app.session.bundled import RECORDED_SCENARIOS
from cubeling.tracking import CubeModel, Frame, open_source
from cubeling.tracking.synthetic.folding import fold_cube
from cubeling.tracking.tracker.print_check import PrintCheck, PrintFault, cube_with, with_markers
from tests.bench.photographs import sequence
from tests.bench.photographs.dodecahedron import camera, paths, photograph
from tests.tracking import drawn

LOOKS = 12
"""Pictures of one cube, each in a pose of its own."""

FOLD_MM = (0.0, 0.4, 0.8)
"""Folds are off by up to so much along and about each axis [mm, °]."""

FOCAL_ERRORS = (1.0, 0.8, 1.3)
"""The focal length is told wrong by such factors."""

Change = Callable[[CubeModel], CubeModel]


def looked_at(printed: CubeModel, file: CubeModel, focal: float, seed: int) -> PrintFault | None:
    """Draw a print in `LOOKS` poses and return what is found."""
    random, lens = np.random.default_rng(seed), drawn.CAMERA
    told = replace(lens, matrix=lens.matrix * np.array([[focal], [focal], [1.0]]))
    told.matrix[:2, 2] = lens.matrix[:2, 2]
    check = PrintCheck(file, told)
    for number in range(LOOKS):
        x, y, z = random.uniform(-0.8, 0.8, 3)
        at = (*random.uniform(-0.05, 0.05, 2), random.uniform(0.3, 0.5))
        pose = drawn.held(x, y, z, (float(at[0]), float(at[1]), float(at[2])))
        picture = drawn.photograph(drawn.scene((printed, pose)), seed=seed + number)
        check.look(Frame(picture, float(number), number))
    return check.fault


def changes() -> Iterator[tuple[str, str, Change]]:
    """Yield the name, the kind and the print of each fault."""
    for turn in (90, 180, 270):
        fault = PrintFault("rolled", ("front",), turn)
        yield f"rolled by {turn}°", "rolled", partial(cube_with, fault=fault)
    for pair in (("front", "right"), ("front", "back")):
        fault = PrintFault("swapped", pair)
        yield " and ".join(pair), "swapped", partial(cube_with, fault=fault)
    for percent in (-10, -6, -3, 3, 6, 10):
        share = 1 + percent / 100
        yield f"markers {percent:+} %", "size", partial(with_markers, share=share)


def recorded(name: str) -> PrintFault | None:
    """Look at a bundled recording once a second."""
    path = Path(__file__).parents[2] / "recordings" / f"{name}.mcap"
    with open_source(str(path)) as source:
        assert source.intrinsics is not None
        check = PrintCheck(CubeModel.load(SCENARIOS[name].cube), source.intrinsics)
        for frame in source:
            if frame.index % 30 == 0:
                check.look(frame)
    return check.fault


def photographed(change: Change = lambda body: body) -> PrintFault | None:
    """Look at every third photograph of the dodecahedron with a file that differs from it."""
    check = PrintCheck(change(CubeModel.load(sequence.BODY_FILE)), camera())
    for number in range(0, len(paths()), 3):
        check.look(Frame(photograph(number), float(number), number))
    return check.fault


def main() -> None:
    """Print the table and the false hints."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--prints", type=int, default=4, help="prints of each kind (%(default)s)")
    count = parser.parse_args().prints
    cube, console = CubeModel.load("companion"), Console(width=140)
    columns = [(fold, focal) for fold in FOLD_MM for focal in FOCAL_ERRORS]
    titles = [f"{fold:g} mm, f × {focal:g}" for fold, focal in columns]
    table = Table(f"named, of {count}", *titles)
    false = shown = 0
    for name, kind, change in (*changes(), ("right: nothing is named", "", lambda cube: cube)):
        cells = []
        for fold, focal in columns:
            found = [
                looked_at(fold_cube(change(cube), fold, seed), cube, focal, seed)
                for seed in range(count)
            ]
            kinds = [fault.kind if fault else "" for fault in found]
            false += sum(each not in ("", kind) for each in kinds)
            shown += count
            cells.append(f"{kinds.count(kind)}")
        table.add_row(name, *cells)
    console.print(table)
    console.print(f"named wrongly: {false} of {shown} prints")
    for name in RECORDED_SCENARIOS:
        console.print(f"recording {name}: {recorded(name)}")
    if paths():
        console.print(f"dodecahedron: {photographed()}")
        small = photographed(lambda body: with_markers(body, 0.97))
        console.print(f"dodecahedron, its markers 3 % too small in the file: {small}")


if __name__ == "__main__":
    main()
