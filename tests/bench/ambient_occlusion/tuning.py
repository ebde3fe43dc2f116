"""Search for the constants of the estimators: `python -m tests.bench.ambient_occlusion.tuning`.

Every combination of a grid is drawn on the scenes of `TUNED`; the gain of the occlusion follows by
least squares. For each estimator the combination is printed whose mean squared error against the
ray-traced pictures is least over the scenes: the constants in `ESTIMATORS`. It is the method of
XeGTAO (Intel 2021), which was tuned by the mean squared error against its own ray tracer.
"""

import argparse
from collections.abc import Iterator
from dataclasses import astuple, fields, replace
from itertools import product

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.rendering import create_context
from cubeling.characters.rendering.deferred.ambient_occlusion import (
    ESTIMATORS,
    Estimator,
)
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.bench.ambient_occlusion.scenes import TUNED, load
from tests.bench.ambient_occlusion.scoring import THESIS, TracedScene, buffer_of, drawn

SIZE, RAYS = (320, 240), 128
GRID = {
    "bias": (0.02, 0.05, 0.1),
    "crowding": (0.0, 0.5, 0.75, 1.0),
    "reach": (0.2, 0.3, 0.45, 0.7, 1.0),
    "by_area": (0.0, 1.0),
}
"""Values of the constants for estimators that add up samples."""

HORIZON_GRID = {
    "bias": (0.02, 0.05, 0.1),
    "crowding": (0.0, 0.5, 0.75, 1.0),
    "reach": (1.0,),
    "fill": (0.0, 0.2, 0.3, 0.4, 0.5, 0.6),
}
"""Values for those that look for what hides the light; the falloff limits how far they look."""

HORIZONS = ("hbao", "gtao", "bitmask")


def combinations(name: str) -> Iterator[Estimator]:
    """Yield the grid of an estimator, with a gain of 1."""
    grid = HORIZON_GRID if name in HORIZONS else GRID
    for values in product(*grid.values()):
        changed = dict(zip(grid, values, strict=True))
        yield replace(ESTIMATORS[name], darkness=1.0, **changed)


def main() -> None:
    """Search, and print the best of each estimator beside what is in the program."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--samples", type=int, default=11)
    samples = options.parse_args().samples
    context = create_context()
    programs = ShaderPrograms(context)
    scenes = [TracedScene(load(name), SIZE, RAYS) for name in TUNED]
    buffers = [buffer_of(context, scene) for scene in scenes]
    table = Table("estimator", *(each.name for each in fields(Estimator)), "RMSE", *TUNED)
    for name in ESTIMATORS:
        best: tuple[float, list[float], Estimator] | None = None
        for constants in combinations(name):
            pairs = []
            for scene, buffer in zip(scenes, buffers, strict=True):
                settings = replace(
                    THESIS,
                    estimator=name,
                    samples=samples,
                    radius_m=scene.scene.radius_m,
                    constants=constants,
                )
                seen = scene.surfaces.seen
                found = drawn(context, programs, buffer, settings)[seen]
                pairs.append((1.0 - found.astype(float), 1.0 - scene.truth[seen].astype(float)))
            gain = sum(np.mean(a * b) for a, b in pairs) / sum(np.mean(a * a) for a, b in pairs)
            errors = [float(np.mean((gain * a - b) ** 2)) for a, b in pairs]
            if best is None or np.mean(errors) < best[0]:
                chosen = replace(constants, darkness=float(gain))
                best = float(np.mean(errors)), errors, chosen
        assert best is not None
        error, errors, chosen = best
        table.add_row(
            name,
            *(f"{figure:.2f}" for figure in astuple(chosen)),
            *(f"{np.sqrt(each):.4f}" for each in (error, *errors)),
        )
    Console(width=120).print(table)
    for buffer in buffers:
        buffer.release()
    programs.release()
    context.release()


if __name__ == "__main__":
    main()
