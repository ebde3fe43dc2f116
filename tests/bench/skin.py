"""Light in skin against random walks: `python -m tests.bench.skin [--head FILE]`.

A head fills the picture, lit from the side and from behind. The reference replaces what the key
light does by what walks below the skin find (`tools/ray_tracing/subsurface.py`), and keeps
everything else of the picture: albedo, highlights, light from all around. `FILE` is a .glb of one
mesh, as a scanned head is; the program's own human is always drawn. Exits with 1 if scattering
changes the terminator by less than `MIN_CHANGE`, or is not nearer to the reference by `MIN_GAIN`.
"""

import argparse
import json
import struct
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import (
    QUALITIES,
    CameraView,
    Effect,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.deferred.lamp import Lamp
from cubeling.characters.rendering.portrait_camera import PortraitCamera
from tests.bench.ambient_occlusion.scenes import posed
from tests.bench.soft_shadows import area_of
from tests.characters.rendering.shapes import Still, mesh
from tests.characters.rendering.watch import WatchPass
from tools.ray_tracing import RayTracer, Triangles
from tools.ray_tracing.subsurface import SKIN, flat_reflectance, walk

SIZE = (640, 640)
STEP = 6
"""Walks begin at one in so many texels along each side."""

WALKS = 48
"""For each of them and each colour."""

HEAD_HEIGHT_M = 0.32
"""Height of a scanned head with its neck [m]."""

BAND = 0.3
"""The terminator: cosines between normal and light of less than this."""

MIN_CHANGE, MIN_GAIN = 2.0, 0.5
"""Least mean difference of the terminator on against off [of 255], and least share of the error to
the reference that scattering takes away there."""

RICH = QUALITIES["rich"]
KINDS = {
    "off": RICH.effects - {Effect.SKIN_SCATTERING},
    "full": RICH.effects - {Effect.AMBIENT_OCCLUSION},
    "adaptive": RICH.effects,
}

LIGHTS = {"side": (0.85, 0.62, 0.1), "behind": (0.35, 0.6, -0.75)}
"""Directions to the key light in the table frame."""

Floats = NDArray[np.floating[Any]]


@dataclass
class FixedLight:
    """Stands for the stage's estimator: always the same light."""

    light: Light

    def update(self, *_: object) -> Light:
        """Return it."""
        return self.light


@dataclass(frozen=True)
class Head:
    """A head to draw."""

    name: str
    actor: SceneCharacter
    triangles: Triangles
    """In the table frame."""
    points: NDArray[np.float64]
    """Around what fills the picture, (n, 3) in the table frame."""
    scale: float
    """How much further light goes than in the skin of a human of life size."""


def own_head() -> Head:
    """Return the head of the program's human."""
    human = Character.load("human")
    scale = 0.18 / human.height
    place = np.diag([scale, scale, scale, 1.0])
    pose = human.skeleton.rest
    actor = SceneCharacter(human, PosedCharacter(pose, place, True, "", 0.0, 0.0, 0.0, 0.0))
    scattering = max(each.material.scattering for each in human.meshes)
    points = np.array([0.0, 1.47, 0.0]) + 0.26 * np.concatenate([np.eye(3), -np.eye(3)])
    triangles = posed(human, pose, place)
    return Head("human", actor, triangles, scale * points, scale * scattering)


def scanned_head(path: Path) -> Head:
    """Return a head of one mesh from a .glb file without joints."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    tree, start = json.loads(data[20 : 20 + length]), 28 + length

    def read(number: int) -> NDArray[np.generic]:
        accessor = tree["accessors"][number]
        view = tree["bufferViews"][accessor["bufferView"]]
        kind = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        columns = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        at = start + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(data, kind, columns * accessor["count"], at).reshape(-1, columns)

    primitive = tree["meshes"][0]["primitives"][0]
    positions = read(primitive["attributes"]["POSITION"]).astype(float)
    low, high = positions.min(axis=0), positions.max(axis=0)
    scale = HEAD_HEIGHT_M / (high[1] - low[1])
    positions = scale * (positions - [0.0, low[1], 0.0])
    colors = path.with_name("Map-COL.jpg")
    skin = Material(base_color=(0.55, 0.36, 0.28, 1.0), roughness=0.5, scattering=1.0)
    if colors.exists():
        texture = np.asarray(cv2.imread(str(colors)), np.uint8)[..., ::-1]
        skin = replace(skin, base_color=(1.0,) * 4, base_color_texture=texture)
    shape = mesh(
        positions,
        read(primitive["attributes"]["NORMAL"]),
        read(primitive["indices"]).reshape(-1, 3),
        skin,
    )
    shape = replace(shape, uvs=np.asarray(read(primitive["attributes"]["TEXCOORD_0"]), np.float32))
    triangles = Triangles.of(shape.positions, shape.normals, shape.triangles)
    upper = positions[positions[:, 1] > 0.4 * HEAD_HEIGHT_M]
    return Head(path.stem, Still((shape,)).posed(), triangles, upper[::20], 1.0)


@dataclass(frozen=True)
class Drawn:
    """A picture, before it is put together: its shares of light, linear RGB, on one in `STEP`."""

    picture: Floats
    """(height, width, 3) of 255, as shown."""
    unspread: Floats
    """The same, if light left skin where it enters."""
    rest: Floats
    """Highlights and light from all around."""
    albedo: Floats
    points: Floats
    """In the table frame [m]."""
    skin: NDArray[np.bool_]
    taps: Floats
    """Share of all taps that was taken."""


def draw(context: moderngl.Context, head: Head, light: Light, kind: str) -> Drawn:
    """Draw a head by one of `KINDS`."""
    camera = PortraitCamera.around(head.points, 0.05, SIZE)
    stage, watch = Stage(context, SIZE), WatchPass()
    stage._light = FixedLight(light)  # type: ignore[assignment]
    stage.quality = replace(RICH, name=kind, effects=KINDS[kind], max_error_px=0.0)
    stage.passes.append(watch)
    backdrop = np.full((SIZE[1], SIZE[0], 3), 60, np.uint8)
    view = CameraView(backdrop, camera.matrix, np.zeros(0), camera.camera_from_table)
    stage.draw(view, [head.actor])
    layer = watch.frame.layer
    assert layer is not None
    rows = slice(0, layer.texels[1], STEP), slice(0, layer.texels[0], STEP)
    diffuse = (watch.scattered if watch.is_scattered else watch.diffuse)[rows]
    rest = watch.rest[rows]
    unspread = shown(watch.diffuse[rows][..., :3] + rest)
    position, albedo, skin = watch.position[rows], watch.albedo[rows], watch.is_skin[rows]
    table_from_camera = np.linalg.inv(camera.camera_from_table)
    points = position[..., :3] @ table_from_camera[:3, :3].T + table_from_camera[:3, 3]
    stage.release()
    return Drawn(
        shown(diffuse[..., :3] + rest),
        unspread,
        rest,
        albedo,
        points,
        skin,
        diffuse[..., 3],
    )


def shown(light: Floats) -> Floats:
    """Return what a picture shows of linear light, 0…255, as `encoding.glsl`."""
    light = light * 1.06 / (1.0 + 0.12 * light)
    root = np.sqrt(light)
    a, b = root, np.sqrt(root)
    encoded = 0.82443678 * a + 0.30650353 * b - 0.05245525 * light - 0.07884886
    return np.asarray(255.0 * np.clip(encoded, 0.0, 1.0))


def error(picture: Floats, light: Floats, chosen: NDArray[np.bool_]) -> float:
    """Return the mean difference of pixels (n, 3) from those of linear light, of 255."""
    return float(np.abs(picture - shown(light))[chosen].mean())


@dataclass(frozen=True)
class Reference:
    """What walks found for each point of skin."""

    scattered: Floats
    """Share of the key light, (points, 3): 1 on flat skin that faces it."""
    cosine: Floats
    """Between normal and light, (points,)."""


def trace(head: Head, eye: Floats, points: Floats, light: Light, walks: int) -> Reference:
    """Walk from points that an eye sees on a head."""
    rng = np.random.default_rng(1)
    tracer = RayTracer(head.triangles)
    triangles = head.triangles
    lamp = area_of(Lamp.over(triangles.positions.astype(float), light.to_light))
    ways = points - eye
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    hits = tracer.hits(np.tile(eye, (len(points), 1)).astype("f4"), ways.astype("f4"))
    flat = tracer.flat_normals(hits.triangles)
    flat *= -np.sign(np.einsum("ij,ij->i", flat, ways))[:, None]
    origins = (eye + hits.distances[:, None] * ways).astype("f4")

    def normals(numbers: NDArray[np.integer[Any]], barycentric: Floats) -> Floats:
        u, v = barycentric.T
        weights = np.stack([1.0 - u - v, u, v], axis=1)
        smooth = np.einsum("nk,nkc->nc", weights, triangles.normals[triangles.corners[numbers]])
        return np.asarray(smooth / np.linalg.norm(smooth, axis=1, keepdims=True))

    def falling(places: Floats, smooth: Floats) -> Floats:
        toward = rng.random((len(places), 2)) @ lamp.sides + lamp.corner - places
        toward /= np.linalg.norm(toward, axis=1, keepdims=True)
        cosine = np.einsum("ij,ij->i", smooth, toward)
        lit = cosine > 0.0
        start = places[lit] + 2e-4 * head.scale * smooth[lit]
        free = np.isinf(tracer.distances(start.astype("f4"), toward[lit].astype("f4")))
        result = np.zeros(len(places))
        result[lit] = cosine[lit] * free
        return result

    found = np.zeros((len(points), 3))
    for color in range(3):
        scattering = SKIN.scattering[color] / head.scale
        absorption = SKIN.absorption[color] / head.scale
        for _ in range(walks):
            exits = walk(tracer, origins, -flat, scattering, absorption, rng)
            arriving = falling(exits.points, normals(exits.triangles, exits.barycentric))
            found[:, color] += np.bincount(exits.starts, arriving, minlength=len(points))
        found[:, color] /= walks * flat_reflectance(scattering, absorption)
    cosine = normals(hits.triangles, hits.barycentric) @ light.to_light
    return Reference(found, cosine)


def heads(path: Path | None) -> Iterator[Head]:
    """Return what is drawn."""
    yield own_head()
    if path is not None:
        yield scanned_head(path)


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--head", type=Path, help="a .glb of one mesh in parts of a head")
    parser.add_argument("--pictures", type=Path, help="where to write off, on, adaptive, reference")
    parser.add_argument("--walks", type=int, default=WALKS)
    options = parser.parse_args()
    context = create_context()
    table = Table(title="skin: differences in the picture, of 255")
    headings = (
        "head, light",
        "texels",
        "on − off",
        "off",
        "unspread",
        "full",
        "adaptive",
        "gain",
        "saved",
    )
    for heading in headings:
        table.add_column(heading, justify="left" if heading == headings[0] else "right")
    failed = False
    for head in heads(options.head):
        for name, direction in LIGHTS.items():
            light = fixed_light(direction)
            drawn = {kind: draw(context, head, light, kind) for kind in KINDS}
            adaptive = drawn["adaptive"]
            skin = adaptive.skin
            camera = PortraitCamera.around(head.points, 0.05, SIZE)
            eye = np.linalg.inv(camera.camera_from_table)[:3, 3]
            traced = trace(head, eye, adaptive.points[skin], light, options.walks)
            true = adaptive.albedo[skin] * light.key * traced.scattered
            band = np.abs(traced.cosine) < BAND
            for part, chosen in (("terminator", band), ("all skin", np.ones_like(band))):
                errors = {
                    kind: error(each.picture[skin], true + each.rest[skin], chosen)
                    for kind, each in drawn.items()
                }
                unspread = error(adaptive.unspread[skin], true + adaptive.rest[skin], chosen)
                change = np.abs(adaptive.picture - drawn["off"].picture)[skin][chosen].mean()
                gain = 1.0 - errors["adaptive"] / errors["off"]
                failed |= part == "terminator" and (change < MIN_CHANGE or gain < MIN_GAIN)
                table.add_row(
                    f"{head.name}, {name}, {part}",
                    f"{chosen.sum()}",
                    f"{change:.2f}",
                    f"{errors['off']:.2f}",
                    f"{unspread:.2f}",
                    f"{errors['full']:.2f}",
                    f"{errors['adaptive']:.2f}",
                    f"{gain:.0%}",
                    f"{1.0 - adaptive.taps[skin][chosen].mean():.0%}",
                )
            if options.pictures is not None:
                options.pictures.mkdir(parents=True, exist_ok=True)
                reference = adaptive.picture.copy()
                reference[skin] = shown(true + adaptive.rest[skin])
                row = [drawn["off"].picture, drawn["full"].picture, adaptive.picture, reference]
                target = options.pictures / f"{head.name}_{name}.png"
                joined = np.rint(np.concatenate(row, axis=1)[..., ::-1]).astype(np.uint8)
                cv2.imwrite(str(target), joined)
    context.release()
    Console().print(table)
    return int(failed)


def fixed_light(direction: tuple[float, float, float]) -> Light:
    """Return a light from some direction of the table frame."""
    to_light = np.array(direction) / np.linalg.norm(direction)
    return Light(np.full(3, 0.8), np.full(3, 0.25), np.full(3, 0.15), to_light)


if __name__ == "__main__":
    sys.exit(main())
