"""Accuracy of calibrations on rendered images of a cube with folding errors.

Run `python -m tests.bench.calibration [--seeds 3] [--fold 0.8] [--frames 40]`. Each seed is another
motion and another cube. "drawn" is the program's synthetic camera, `synthetic:wave`; "traced" is
the renderer of the tracking benchmark, which shares no code with the program and works in linear
light with a camera's gamma curve.
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.tracking import CubeModel, Frame
from cubeling.tracking.calibration import CubeFinder, View, ViewCollector, calibrate, measured_cube
from cubeling.tracking.synthetic import open_synthetic
from cubeling.tracking.synthetic.folding import face_poses, fold_cube
from tests.bench.tracking.sequences import Sequence, sequence
from tests.tracking.calibration.waved import aligned

Array = NDArray[np.float64]

COLUMNS = (
    "renderer",
    "seed",
    "views",
    "fx %",
    "± %",
    "fy %",
    "centre px",
    "folds before mm",
    "after mm",
    "edges px",
    "solve s",
)


@dataclass(frozen=True)
class Wave:
    """Views of one folded cube by one camera, and the truth."""

    views: list[View]
    """The measured views."""

    matrix: Array
    """The true camera, (3, 3)."""

    cube: CubeModel
    """The cube with its folding errors."""

    ideal: CubeModel
    """The nominal cube."""

    size: tuple[int, int]
    """Of the pictures [px]."""


def drawn(seed: int, fold: float) -> Wave:
    """Collect views of `synthetic:wave` as `cubeling calibrate` does, at its stops."""
    source = open_synthetic(f"wave?fold={fold:g}&seed={seed}")
    ideal = CubeModel.load(source.cube.name)
    collector = ViewCollector(CubeFinder(ideal), source.size)
    for index in range(source.count):
        since = source.time(index) % 0.74
        if 0.03 < since < 0.2:
            collector.update(source.frame(index))
    assert source.intrinsics is not None
    return Wave(collector.views, source.intrinsics.matrix, source.cube, ideal, source.size)


def traced(seed: int, fold: float, frames: int) -> Wave:
    """Measure single poses in the independent renderer, with the same folding errors."""
    pictures = sequence("poses", seed, frames)
    ideal = CubeModel.load(pictures.cube)
    cube = fold_cube(ideal, fold, seed)
    finder = CubeFinder(ideal)
    views = []
    for frame in _folded_frames(pictures, cube):
        grey = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8)
        found = finder.find(grey, frame.timestamp)
        view = None if found is None else finder.measure(grey, found)
        views += [] if view is None else [view]
    return Wave(views, pictures.matrix, cube, ideal, pictures.size)


def _folded_frames(pictures: Sequence, cube: CubeModel) -> Iterator[Frame]:
    moved = face_poses(cube)
    scenes = []
    for scene in pictures.scenes:
        sides = []
        for side in scene.cube.sides:
            turn, place = moved.get(side.name, (np.eye(3), side.corners.mean(axis=0)))
            shift = place - turn @ side.corners.mean(axis=0)
            columns = turn @ side.place
            columns[:, 2] += shift
            corners = side.corners @ turn.T + shift
            normal = turn @ side.normal
            sides.append(replace(side, place=columns, corners=corners, normal=normal))
        scenes.append(replace(scene, cube=replace(scene.cube, sides=tuple(sides))))
    pictures = replace(pictures, scenes=tuple(scenes))
    for index in range(pictures.count):
        yield Frame(pictures.frame(index), pictures.timestamp(index), index)


def row(renderer: str, seed: int, wave: Wave) -> tuple[str, ...]:
    """Calibrate, and compare with the ground truth."""
    start = time.perf_counter()
    finder = CubeFinder(wave.ideal)
    found = calibrate(wave.views, finder.target(wave.size))
    seconds = time.perf_counter() - start
    matrix = found.intrinsics.matrix
    real, ideal, measured = (
        np.array([face.corners for face in cube.faces])
        for cube in (wave.cube, wave.ideal, measured_cube(wave.ideal, found.plates))
    )
    return (
        renderer,
        str(seed),
        str(found.views),
        f"{100 * (matrix[0, 0] / wave.matrix[0, 0] - 1):+.3f}",
        f"{200 * found.focal_spread:.3f}",
        f"{100 * (matrix[1, 1] / wave.matrix[1, 1] - 1):+.3f}",
        f"{np.linalg.norm(matrix[:2, 2] - wave.matrix[:2, 2]):.2f}",
        f"{1000 * aligned(ideal, real).max():.2f}",
        f"{1000 * aligned(measured, real).max():.3f}",
        f"{found.residual:.3f}",
        f"{seconds:.1f}",
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--fold", type=float, default=0.8, help="worst fold error on an axis [mm]")
    parser.add_argument("--frames", type=int, default=40, help="pictures of the traced cube")
    arguments = parser.parse_args()
    table = Table(title="Calibration from the cube alone against the truth")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "renderer" else "right")
    for seed in range(1, arguments.seeds + 1):
        table.add_row(*row("drawn", seed, drawn(seed, arguments.fold)))
        table.add_row(*row("traced", seed, traced(seed, arguments.fold, arguments.frames)))
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
