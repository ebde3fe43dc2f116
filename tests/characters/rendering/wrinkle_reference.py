"""Wrinkle normals against geometry that is really displaced: an ellipsoid as large as a head."""

from dataclasses import dataclass
from functools import cache

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import FaceMaps
from cubeling.characters.rendering.geometry.face_texture import (
    CROSSING_POWER,
    SMOOTHING_TEXELS,
    WrinkleMixer,
)
from cubeling.characters.rendering.programs import SHADER_FOLDER, set_uniforms

Array = NDArray[np.float64]

RADII_M = np.array([0.207, 0.21, 0.197])
"""Half axes of the ellipsoid [m]: the bundled human's skull."""

HALF_TURN_RAD = np.deg2rad(120.0)
"""Directions to both sides that its texture coordinates cover."""

FINE_GRID = 960, 480
"""Quads of the displaced surface along u and v: finer than the bundled human's maps."""

MIN_BEND_DEG = 1.0
"""Pixels count whose normal either way is bent by more [°]: smooth skin would flatter the mean."""

SMOOTH_GRID = 240, 120
"""Quads of the smooth surface, on which the wrinkles are drawn: about as wide as a wrinkle."""

VERTEX = """
#version 330 core
uniform mat4 clip_from_table;
in vec3 position; in vec3 normal; in vec2 uv;
out vec3 place; out vec3 facing; out vec2 where;
void main() {
    place = position; facing = normal; where = uv;
    gl_Position = clip_from_table * vec4(position, 1.0);
}
"""

FRAGMENT = """
#version 330 core
in vec3 place; in vec3 facing; in vec2 where;
out vec4 color;
FACE
void main() {
    vec3 n = normalize(facing);
    if (wrinkle_depth > 0.0) n = wrinkled(n, place, where, texture(face_map, where).xy);
    color = vec4(n, 1.0);
}
"""


@dataclass(frozen=True)
class Agreement:
    """How far wrinkle normals are from those of displaced geometry, in pixels with wrinkles."""

    mean_deg: float
    """Mean angle [°]."""

    p95_deg: float
    """95 % of pixels are below this angle [°]."""

    bend_deg: float
    """Mean angle by which the displaced normals differ from those of the smooth surface [°]."""

    bumped_deg: float
    """Mean angle by which the wrinkle normals differ from those of the smooth surface [°], over the
    whole surface."""


def agreement(
    context: moderngl.Context,
    maps: FaceMaps,
    intensities: Array,
    yaw_rad: float = 0.0,
    shifted: bool = True,
    grid: tuple[int, int] = FINE_GRID,
    side_px: int = 420,
) -> Agreement:
    """Return how well wrinkles of intensities (12,) agree, seen from a direction.

    Displaced points are seen elsewhere than those of the smooth surface, which no bump map shows:
    unless `shifted`, normals are compared at the same point of the surface instead of at the same
    pixel.
    """
    program = context.program(
        vertex_shader=VERTEX.strip(),
        fragment_shader=FRAGMENT.strip().replace(
            "FACE", (SHADER_FOLDER / "face.glsl").read_text(encoding="utf-8")
        ),
    )
    mixer = WrinkleMixer(maps)
    mixer.compose(intensities)
    height, width = maps.blood.shape
    texture = context.texture((width, height), 4, mixer.texels, dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.use(0)
    target = context.framebuffer(
        [context.texture((side_px, side_px), 4, dtype="f4")],
        context.depth_renderbuffer((side_px, side_px)),
    )

    def drawn(points: Array, normals: Array, depth_m: float) -> Array:
        rows, columns = points.shape[:2]
        of = columns - 1, rows - 1
        vertices = np.concatenate([points, normals, _uvs(of)], axis=-1).astype(np.float32)
        array = context.vertex_array(
            program,
            [(context.buffer(vertices), "3f 3f 2f", "position", "normal", "uv")],
            context.buffer(_triangles(of)),
        )
        set_uniforms(program, clip_from_table=_camera(yaw_rad), wrinkle_depth=depth_m, face_map=0)
        target.use()
        context.viewport = (0, 0, side_px, side_px)
        context.enable_only(moderngl.DEPTH_TEST)
        context.clear()
        array.render()
        read = np.frombuffer(target.read(components=4, dtype="f4"), np.float32)
        array.release()
        return read.reshape(side_px, side_px, 4).astype(float)

    coarse = _ellipsoid(SMOOTH_GRID)
    smooth, flat = _ellipsoid(grid)
    displaced = smooth + flat * _heights(maps, intensities, grid)[..., None]
    plain = drawn(*coarse, 0.0)
    bumped = drawn(*coarse, maps.depth)
    true = drawn(displaced if shifted else smooth, _grid_normals(displaced, flat), 0.0)
    both = (bumped[..., 3] > 0) & (true[..., 3] > 0)
    bend = _angles_deg(plain, true)
    bumped_bend = _angles_deg(plain, bumped)
    wrinkled = both & (np.maximum(bend, bumped_bend) > MIN_BEND_DEG)
    error = _angles_deg(bumped, true)[wrinkled]
    context.detect_framebuffer(0).use()  # moderngl binds the last one again: it must still exist
    texture.release()
    target.release()
    program.release()
    if not error.size:
        return Agreement(0.0, 0.0, 0.0, float(bumped_bend[both].mean()))
    return Agreement(
        float(error.mean()),
        float(np.quantile(error, 0.95)),
        float(bend[wrinkled].mean()),
        float(bumped_bend[both].mean()),
    )


@cache
def _uvs(grid: tuple[int, int]) -> Array:
    u, v = (np.linspace(0.0, 1.0, count + 1) for count in grid)
    return np.stack(np.meshgrid(u, v), axis=-1)


@cache
def _ellipsoid(grid: tuple[int, int]) -> tuple[Array, Array]:
    """Return points and unit normals of the smooth surface, (rows, columns, 3) each."""
    u, v = np.moveaxis(_uvs(grid), -1, 0)
    around, up = (2.0 * u - 1.0) * HALF_TURN_RAD, np.arcsin(np.clip(1.0 - 2.0 * v, -0.995, 0.995))
    unit = np.stack([np.sin(around) * np.cos(up), np.sin(up), np.cos(around) * np.cos(up)], -1)
    normals = unit / RADII_M
    return unit * RADII_M, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def _heights(maps: FaceMaps, intensities: Array, grid: tuple[int, int]) -> Array:
    """Return the height of the composed layers at the points of the grid [m]."""
    layers = [cv2.GaussianBlur(each, (0, 0), SMOOTHING_TEXELS) for each in maps.heights]
    each = np.asarray(intensities)[:, None, None] * np.stack(layers).astype(float)
    bulges, furrows = (
        (np.maximum(sign * each, 0.0) ** CROSSING_POWER).sum(axis=0) ** (1.0 / CROSSING_POWER)
        for sign in (1.0, -1.0)
    )
    smooth = bulges - furrows
    height, width = smooth.shape
    at = (_uvs(grid) * [width, height] - 0.5).astype(np.float32)
    cubic = cv2.remap(
        smooth.astype(np.float32), at[..., 0], at[..., 1], cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REPLICATE,
    )  # fmt: skip
    return maps.depth * np.asarray(cubic, float)


def _grid_normals(points: Array, outward: Array) -> Array:
    """Return the unit normals of a grid of points by central differences."""
    across = np.cross(np.gradient(points, axis=1), np.gradient(points, axis=0))
    across *= np.sign(np.sum(across * outward, axis=-1, keepdims=True))
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    unit = across / np.maximum(length, 1e-15)
    return np.asarray(np.where(length > 0.0, unit, outward))  # 0: at the poles


@cache
def _triangles(grid: tuple[int, int]) -> NDArray[np.uint32]:
    columns, rows = grid
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    a, b, c, d = corner, corner + columns + 1, corner + columns + 2, corner + 1
    return np.stack([a, b, c, a, c, d], axis=-1).astype(np.uint32)


def _camera(yaw_rad: float) -> Array:
    """Return clip_from_table of a parallel projection from in front, turned by an angle."""
    sine, cosine = np.sin(yaw_rad), np.cos(yaw_rad)
    turned = np.array([[cosine, 0, -sine, 0], [0, 1, 0, 0], [sine, 0, cosine, 0], [0, 0, 0, 1]])
    return np.asarray(np.diag([4.4, 4.4, -2.0, 1.0]) @ turned)


def _angles_deg(a: Array, b: Array) -> Array:
    cross = np.linalg.norm(np.cross(a[..., :3], b[..., :3]), axis=-1)
    return np.asarray(np.rad2deg(np.arctan2(cross, np.sum(a[..., :3] * b[..., :3], axis=-1))))
