"""Time of drawing one picture, pass by pass: `python -m tests.bench.picture [--frames N]`.

A bundled character of 18 cm at arm's length in a frame of 1280×720 with lens distortion. The first
row is the time of a whole picture. For the rows below it, the benchmark waits for the graphics card
after each part, which adds a little. CPU time is of all threads: software rendering has several.
"""

import argparse
import statistics
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import moderngl
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.character import Character
from cubeling.characters.rendering import (
    Box,
    CameraView,
    FloorPath,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.characters.rendering.camera_picture.light import LightEstimator
from cubeling.characters.rendering.camera_picture.undistortion import Undistorter
from cubeling.characters.rendering.geometry.skinned_character import SkinnedCharacter
from cubeling.characters.rendering.passes.characters import CharacterPass
from cubeling.characters.rendering.passes.cube_occlusion import CubeOcclusionPass
from cubeling.characters.rendering.passes.floor_paths import FloorPathPass
from cubeling.characters.rendering.passes.resolve import ResolvePass
from cubeling.characters.rendering.passes.shadows import ShadowPass
from cubeling.characters.rendering.target import LayerTarget

SIZE = (1280, 720)
TARGET_MS = 12.0
PARTS = (
    ("undistort", Undistorter, "undistort"),
    ("estimate the light", LightEstimator, "update"),
    ("skin", SkinnedCharacter, "skin"),
    ("render shadow maps", ShadowPass, "prepare"),
    ("floor paths", FloorPathPass, "composite"),
    ("shadows", ShadowPass, "composite"),
    ("cube occlusion", CubeOcclusionPass, "draw_layer"),
    ("characters", CharacterPass, "draw_layer"),
    ("resolve", ResolvePass, "composite"),
    ("read back", LayerTarget, "read"),
)


def scene(character: Character) -> tuple[CameraView, Callable[[int], SceneCharacter]]:
    """Return a desk with a cube on it, and the actor in each frame."""
    width, height = SIZE
    matrix = np.array([[1108.5, 0, 639.5], [0, 1108.5, 359.5], [0, 0, 1.0]])
    pitch = np.deg2rad(33.0)
    table = np.eye(4)
    table[1, 1:3] = -np.cos(pitch), np.sin(pitch)
    table[2, 1:3] = -np.sin(pitch), -np.cos(pitch)
    table[:3, 3] = 0.0, 0.05, 0.62
    place = np.eye(4)
    place[:3, 3] = -0.09, 0.03, 0.04
    noise = np.random.default_rng(1).normal(140, 12, (height, width, 3))
    image = cv2.GaussianBlur(noise.astype(np.float32), (0, 0), 1.5).astype(np.uint8)
    distortion = np.array([0.06, -0.12, 0.0, 0.0, 0.02])
    view = CameraView(image, matrix, distortion, table, (Box(table @ place, 0.06),))
    clip = character.clips.get("Walk") or next(iter(character.clips.values()))
    scale = 0.18 / character.height

    def actor(frame: int) -> SceneCharacter:
        where = np.diag([scale, scale, scale, 1.0])
        where[0, 3] = 0.05 * np.sin(frame / 10)
        pose = clip.sample(frame / 30 % clip.duration)
        return SceneCharacter(
            character, PosedCharacter(pose, where, True, "walk", 2.0, 0.0, 0.0, 0.0)
        )

    return view, actor


def loop() -> FloorPath:
    """Return the path of the sketch: eight points around the middle of the desk."""
    turn = np.arange(8) * np.pi / 4
    points = np.stack([0.2 * np.cos(turn), 0.13 * np.sin(turn)], axis=1)
    return FloorPath(points, closed=True, highlight=2)


def timed(call: Callable[[], object], spent: list[tuple[float, float]]) -> None:
    """Run a call and note its wall and CPU milliseconds."""
    wall, cpu = time.perf_counter(), time.process_time()
    call()
    spent.append((1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - cpu)))


def instrument(context: moderngl.Context, spent: dict[str, list[tuple[float, float]]]) -> None:
    """Let each part note its time, and wait for the card at its end."""

    def noting(inner: Callable[..., Any], name: str) -> Callable[..., Any]:
        def part(*args: Any, **kwargs: Any) -> Any:
            wall, cpu = time.perf_counter(), time.process_time()
            result = inner(*args, **kwargs)
            context.finish()
            spent[name].append(
                (1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - cpu))
            )
            return result

        return part

    for name, owner, method in PARTS:
        setattr(owner, method, noting(getattr(owner, method), name))


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--character", default="human")
    parser.add_argument("--sketch", action="store_true", help="with a path on the table")
    parser.add_argument("--faces", action="store_true", help="shadows on faces against rays")
    parser.add_argument("--rays", type=int, default=64, help="for each cell of a face")
    parser.add_argument("--pictures", type=Path, help="where to write the faces")
    options = parser.parse_args()
    context = create_context()
    if options.faces:
        from tests.bench.face_shadows import print_faces

        return print_faces(context, options.rays, options.pictures)
    character = Character.load(options.character)
    stage = Stage(context, SIZE)
    view, actor = scene(character)
    floor = [loop()] if options.sketch else []

    whole: list[tuple[float, float]] = []
    for frame in range(options.frames + 5):
        timed(partial(stage.draw, view, [actor(frame)], floor), whole)
    spent: dict[str, list[tuple[float, float]]] = defaultdict(list)
    instrument(context, spent)
    for frame in range(options.frames):
        stage.draw(view, [actor(frame)], floor)

    triangles = sum(len(mesh.triangles) for mesh in character.meshes)
    table = Table(
        title=f"{options.character}, {triangles} triangles, {context.info['GL_RENDERER']}"
    )
    for heading in ("part", "wall [ms]", "CPU [ms]"):
        table.add_column(heading, justify="left" if heading == "part" else "right")
    median = [statistics.median(column) for column in zip(*whole[5:], strict=True)]
    verdict = "within" if median[0] <= TARGET_MS else "over"
    table.add_row(f"picture ({verdict} {TARGET_MS:g} ms)", f"{median[0]:.2f}", f"{median[1]:.2f}")
    table.add_section()
    for name, _, _ in PARTS:
        wall, cpu = (sum(column) / options.frames for column in zip(*spent[name], strict=True)) if (
            spent[name]
        ) else (0.0, 0.0)  # fmt: skip
        table.add_row(name, f"{wall:.2f}", f"{cpu:.2f}")
    Console().print(table)
    stage.release()
    context.release()
    return 0


if __name__ == "__main__":
    sys.exit(main())
