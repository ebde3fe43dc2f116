"""Deferred effects: their time, and how near they are to what they stand for.

`python -m tests.bench.effects [--frames N] [--character NAME]`

Times are of whole pictures at 1280×720, in turn, and their minima; the time of an effect is what it
adds to deferred shading without effects. A lens is the mean of pictures from many places on its
opening. Scenes and characters are our own, so errors are lower bounds for other people's.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.step_renderer import APERTURE_M
from cubeling.characters.model.character import Character
from cubeling.characters.rendering import (
    FULL,
    QUALITIES,
    CameraView,
    Effect,
    Focus,
    Quality,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.characters.rendering.camera_picture.light import LINEAR_FROM_SRGB
from tests.bench.picture import SIZE, scene

RICH = QUALITIES["rich"]

NONE = replace(RICH, name="no effects", effects=frozenset())

LENS_SAMPLES = 96
"""Places on the lens that are drawn for the reference."""

FOCUS = Focus(0.62, 0.62, 0.02)
"""A camera that is focused on the middle of the table, with a lens of 2 cm."""

WEBCAM = replace(FOCUS, aperture=APERTURE_M)
"""The lens that the program expects."""

CLOSE_UP = 5.0
"""How many times nearer the camera is for skin: the face fills the picture."""

Image = NDArray[np.uint8]


def only(*effects: Effect) -> Quality:
    """Return the best quality with some effects."""
    return replace(RICH, name=" + ".join(effects), effects=frozenset(effects))


def close_up(view: CameraView, actor: SceneCharacter) -> CameraView:
    """Return the view of a camera with a longer lens that looks at the character's head."""
    table = np.asarray(view.camera_from_table, float)
    head = table @ actor.posed.table_from_character @ [0.0, 0.85 * _height(actor), 0.0, 1.0]
    matrix = view.matrix.copy()
    matrix[:2, :2] *= CLOSE_UP
    middle = np.array([SIZE[0] / 2, SIZE[1] / 2])
    matrix[:2, 2] = middle - matrix[:2, :2] @ (head[:2] / head[2])
    return replace(view, matrix=matrix, distortion=np.zeros(0), occluders=())


def _height(actor: SceneCharacter) -> float:
    return max(float(mesh.positions[:, 1].max()) for mesh in actor.character.meshes)


def times(
    context: moderngl.Context,
    view: CameraView,
    actors: Sequence[SceneCharacter],
    qualities: Sequence[Quality],
) -> dict[str, float]:
    """Return the shortest time of a picture in each quality [ms]."""
    stages = []
    for quality in qualities:
        stage = Stage(context, SIZE)
        stage.quality = quality
        stages.append(stage)
    found: dict[str, list[float]] = {quality.name: [] for quality in qualities}
    for actor in actors:
        for quality, stage in zip(qualities, stages, strict=True):
            context.finish()
            began = time.perf_counter()
            stage.draw(view, [actor])
            found[quality.name].append(1e3 * (time.perf_counter() - began))
    for stage in stages:
        stage.release()
    return {name: min(each[2:]) for name, each in found.items()}


def time_table(name: str, found: dict[str, float]) -> Table:
    """Return what each effect adds, and all of them against occlusion and skin."""
    table = Table(title=f"time of a picture, {name}")
    for heading in ("effects", "picture (ms)", "added (ms)"):
        table.add_column(heading, justify="left" if heading == "effects" else "right")
    base = found[NONE.name]
    for label, spent in found.items():
        added = "" if label in (FULL.name, NONE.name) else f"{spent - base:.1f}"
        table.add_row(label, f"{spent:.1f}", added)
    two = sum(found[e] - base for e in (Effect.AMBIENT_OCCLUSION, Effect.SKIN_SCATTERING))
    ratio = (found[RICH.name] - base) / two
    table.add_section()
    table.add_row("all / (ambient occlusion + skin), target ≤ 1.3", f"{ratio:.2f}", "")
    return table


def lens_table(
    context: moderngl.Context, view: CameraView, actors: Sequence[SceneCharacter]
) -> Table:
    """Return how near the depth of field is to a lens of many places."""
    view = replace(view, occluders=(), distortion=np.zeros(0))
    stage = Stage(context, SIZE)
    stage.quality = only(Effect.DEPTH_OF_FIELD)
    pinhole = stage.draw(view, actors)
    gathered = stage.draw(replace(view, focus=FOCUS), actors)
    mean = np.zeros((SIZE[1], SIZE[0], 3))
    for number in range(LENS_SAMPLES):
        away = 0.5 * FOCUS.aperture * np.sqrt((number + 0.5) / LENS_SAMPLES)
        place = away * np.array([np.cos(2.399963 * number), np.sin(2.399963 * number)])
        table, matrix = np.array(view.camera_from_table, float), view.matrix.copy()
        table[:2, 3] -= place
        matrix[:2, 2] += matrix[:2, :2] @ place / FOCUS.nearest
        mean += LINEAR_FROM_SRGB[
            stage.draw(replace(view, camera_from_table=table, matrix=matrix), actors)
        ]
    stage.release()
    reference = 255.0 * np.clip(mean / LENS_SAMPLES, 0.0, 1.0) ** (1.0 / 2.2)
    changed = (np.abs(pinhole.astype(int) - _background(context, view)) > 40).any(axis=2)
    near = cv2.dilate(np.asarray(changed, np.uint8), np.ones((15, 15), np.uint8)) > 0
    result = Table(title="depth of field against a lens of many places")
    for heading in ("picture", "RMS difference (of 255)", "PSNR (dB)"):
        result.add_column(heading, justify="left" if heading == "picture" else "right")
    for name, picture in (("sharp", pinhole), ("gathered", gathered)):
        error = float(((picture - reference)[near] ** 2).mean())
        psnr = 10.0 * np.log10(255.0**2 / error)
        result.add_row(name, f"{np.sqrt(error):.2f}", f"{psnr:.1f}")
    return result


def _background(context: moderngl.Context, view: CameraView) -> Image:
    stage = Stage(context, SIZE)
    picture = stage.draw(view, [])
    stage.release()
    return picture


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--character", default="human")
    options = parser.parse_args()
    context = create_context()
    console = Console()
    character = Character.load(options.character)
    view, actor = scene(character)
    actors = [actor(frame) for frame in range(options.frames + 2)]
    qualities = [FULL, NONE, *(only(effect) for effect in Effect), RICH]
    near = close_up(view, actors[0])
    focused = replace(view, focus=WEBCAM)
    console.print(time_table("on the table", times(context, focused, actors, qualities)))
    console.print(time_table("close up", times(context, near, actors, qualities)))
    spread = [_moved(actors[0], place) for place in ((-0.12, 0.12), (0.0, 0.0), (0.12, -0.15))]
    console.print(lens_table(context, view, spread))
    context.release()


def _moved(actor: SceneCharacter, place: tuple[float, float]) -> SceneCharacter:
    where = actor.posed.table_from_character.copy()
    where[[0, 2], 3] = place
    return replace(actor, posed=replace(actor.posed, table_from_character=where))


if __name__ == "__main__":
    main()
