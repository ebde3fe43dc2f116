"""Soft shadows on the table against rays: `python -m tests.bench.soft_shadows [--rays N]`.

The share of the lamp that a point of the table sees, as the program finds it by two samplings of a
shadow map, and as rays to all parts of the lamp find it past the same character, where the camera
sees the table. Characters and
poses are our own. Exits with 1 if an error is above `MAX_ERROR`.
"""

import argparse
import sys

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters.model.character import Character
from cubeling.characters.rendering import QUALITIES, CameraView, Stage, create_context
from cubeling.characters.rendering.deferred.lamp import Lamp
from cubeling.characters.rendering.passes.deferred.soft_shadows import TABLE_SIDE, SoftShadowPass
from tests.bench.ambient_occlusion.scenes import posed
from tests.bench.picture import SIZE, scene
from tests.characters.rendering.watch import WatchPass
from tools.ray_tracing import AreaLight, RayTracer, light_fraction

MAX_ERROR = 0.06
"""RMSE of the share of the lamp, 0…1, that one blocker for each point allows: where a foot stands
in the shadow of a head, both have one distance."""

STEP = 2
"""Rays are cast for one in so many texels along each side."""

TILE_MEAN = np.array([0.5, 1.0, 1.0, 1.0, 0.5]) / 4.0
"""The mean that the program takes of the texels, along each side."""

LIFT_M = 1e-5
"""Height above the table at which rays start [m]."""


def area_of(lamp: Lamp) -> AreaLight:
    """Return the square of a lamp in the table frame."""
    pose = np.asarray(np.linalg.inv(lamp.lamp_from_table), float)
    sides = np.asarray(lamp.width * pose[:3, :2].T, float)
    return AreaLight(np.asarray(pose[:3, 3] - sides.sum(axis=0) / 2, float), sides)


def seen(tracer: RayTracer, points: NDArray[np.float64], view: CameraView) -> NDArray[np.bool_]:
    """Return which points (n, 3) of the table the camera sees past the character, (n,)."""
    camera = np.linalg.inv(np.asarray(view.camera_from_table, float))[:3, 3]
    ways = camera - points
    lengths = np.linalg.norm(ways, axis=1)
    directions = (ways / lengths[:, None]).astype("f4")
    return np.asarray(tracer.distances(points.astype("f4"), directions) > lengths)


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rays", type=int, default=400, help="for each point of the table")
    options = parser.parse_args()
    context = create_context()
    table = Table(title="share of the lamp on the table")
    for heading in ("character", "texels in shadow", "RMSE", "nothing drawn", "mean of both"):
        table.add_column(heading, justify="left" if heading == "character" else "right")
    worst = 0.0
    for name in Character.bundled_names():
        character = Character.load(name)
        view, actor = scene(character)
        stage, watch = Stage(context, SIZE), WatchPass()
        stage.quality = QUALITIES["rich"]
        stage.passes.append(watch)
        who = actor(0)
        stage.draw(view, [who])
        frame = watch.frame
        casters = np.concatenate([each.enclosing for each in frame.characters])
        lamp = Lamp.over(casters, frame.light.to_light)
        (shadows,) = (each for each in stage.passes if isinstance(each, SoftShadowPass))
        texels = np.frombuffer(shadows.left.read(), np.float16).reshape(TABLE_SIDE, TABLE_SIDE, 4)
        light = texels[..., 1].astype(np.float32)
        found = cv2.sepFilter2D(light, -1, TILE_MEAN, TILE_MEAN)[::STEP, ::STEP]
        x, z, side = shadows.square
        along = (np.arange(0, TABLE_SIDE, STEP) + 0.5) * side / TABLE_SIDE
        points = np.stack(np.meshgrid(x + along, z + along), axis=-1).reshape(-1, 2)
        points = np.insert(points, 1, LIFT_M, axis=1)
        tracer = RayTracer(posed(character, who.posed.pose, who.posed.table_from_character))
        traced = light_fraction(tracer, points.astype("f4"), area_of(lamp), rays=options.rays)
        true = traced[:, 1].reshape(found.shape)
        shade = ((true < 0.99) | (found < 0.99)) & seen(tracer, points, view).reshape(found.shape)
        error = float(np.sqrt(((found - true)[shade] ** 2).mean()))
        nothing = float(np.sqrt(((1.0 - true)[shade] ** 2).mean()))
        worst = max(worst, error)
        means = f"{found[shade].mean():.3f}, {true[shade].mean():.3f}"
        table.add_row(name, f"{shade.sum()}", f"{error:.3f}", f"{nothing:.3f}", means)
        stage.release()
    context.release()
    console = Console()
    console.print(table)
    console.print(f"worst RMSE {worst:.3f}, bound {MAX_ERROR}")
    return int(worst > MAX_ERROR)


if __name__ == "__main__":
    sys.exit(main())
