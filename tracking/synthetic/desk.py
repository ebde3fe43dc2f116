"""The static background: a wooden desk with a few objects, and a wall behind it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry.arrays import Array, Flags, Floats, Image
from cubeling.tracking.synthetic.camera_rays import CameraRays

Colour = tuple[float, float, float]
"""Blue, green, red, 0…255."""

HALF_WIDTH_M = 1.3
"""Half the side of the desk's square texture."""

DESK_TEXELS = 2600
"""Texels along a side of the texture: one per millimetre."""

FAR_EDGE_M = -0.62
"""Far edge of the desk (z in the table frame)."""

WOOD_BGR = np.array([[104, 148, 190], [92, 136, 180], [116, 160, 200], [98, 140, 182]], float)
"""Colours of the planks."""

WALL_BGR = np.array([168, 186, 196], float)
"""Colour of the wall behind the desk."""

MUG_X_M, MUG_Z_M, MUG_RADIUS_M, MUG_HEIGHT_M = -0.36, -0.30, 0.041, 0.095
"""Place and size of the mug, in the table frame."""


def desk_texture(random: np.random.Generator, clutter: bool) -> Floats:
    """Draw the desk from above, (DESK_TEXELS, DESK_TEXELS, 3) BGR; rows along z, columns x."""
    texture = _planks(random)
    if clutter:
        _draw_paper(texture, random)
        _draw_notes(texture)
        _draw_coaster(texture)
    return texture


def render_desk(camera: CameraRays, texture: Floats) -> Floats:
    """Return the image of the desk and the wall behind it, (H, W, 3)."""
    x, z, _ = _desk_points(camera, 2)
    scale = DESK_TEXELS / (2 * HALF_WIDTH_M)
    desk = cv2.remap(
        texture,
        (x + HALF_WIDTH_M) * scale - 0.5,
        (z + HALF_WIDTH_M) * scale - 0.5,
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REFLECT,
    )
    small = np.asarray(cv2.resize(desk, camera.size, interpolation=cv2.INTER_AREA), np.float32)
    # Light varies slowly: one sample per pixel is enough.
    x, z, below = _desk_points(camera, 1)
    return _with_wall(_illuminate(small, x, z), (z < FAR_EDGE_M) | ~below, x, z)


def _desk_points(camera: CameraRays, samples: int) -> tuple[Floats, Floats, Flags]:
    """Return x and z where each sample's ray meets the desk [m], and whether it points down."""
    rays = camera.rays(camera.whole(), samples)
    table_from_camera = np.linalg.inv(camera.camera_from_table)
    rotation, eye = table_from_camera[:3, :3].astype(np.float32), table_from_camera[:3, 3]
    # A row for each coordinate: loops over three values at a time take four times as long.
    directions = rotation[:, :2] @ rays.reshape(-1, 2).T
    directions += rotation[:, 2:]
    across, down, ahead = directions.reshape(3, *rays.shape[:2])
    reach = np.float32(-eye[1]) / np.minimum(down, np.float32(-1e-4))
    x = np.float32(eye[0]) + reach * across
    z = np.float32(eye[2]) + reach * ahead
    return x, z, down < -1e-3


def _illuminate(desk: Floats, x: Floats, z: Floats) -> Floats:
    """Light the desk by a lamp at the far left, with a faint gloss."""
    lamp = np.exp(-((x + 0.35) ** 2 + (z + 0.25) ** 2) / 0.5)[..., None]
    return np.asarray(desk * (0.80 + 0.26 * lamp) + 9.0 * lamp**3, np.float32)


def _with_wall(image: Floats, behind: Flags, x: Floats, z: Floats) -> Floats:
    height = np.clip(FAR_EDGE_M - z, 0.0, 2.0)[..., None]
    wall = WALL_BGR * (0.92 - 0.10 * np.tanh(height)) * (1 - 0.06 * np.tanh(np.abs(x))[..., None])
    # The far edge is out of focus, so the wall fades in over some pixels.
    soft = cv2.GaussianBlur(behind.astype(np.float32), (0, 0), 4.0)[..., None]
    edge = cv2.GaussianBlur(behind.astype(np.float32), (0, 0), 9.0)[..., None]
    shade = 1.0 - 0.55 * edge * (1.0 - edge)
    return np.asarray((image * (1 - soft) + wall * soft) * shade, np.float32)


def _planks(random: np.random.Generator) -> Floats:
    width = DESK_TEXELS // 13
    texture = np.empty((DESK_TEXELS, DESK_TEXELS, 3), np.float32)
    grain = _grain(random)
    for number, top in enumerate(range(0, DESK_TEXELS, width)):
        rows = slice(top, min(top + width, DESK_TEXELS))
        shift = int(random.integers(DESK_TEXELS))
        figure = (0.075 * np.roll(grain[rows], shift, axis=1)).astype(float)
        shade = np.empty_like(figure)
        colour = WOOD_BGR[int(random.integers(len(WOOD_BGR)))] * random.uniform(0.95, 1.04)
        # One channel at a time: loops over three values take three times as long.
        for channel, contrast in enumerate((1.15, 1.0, 0.9)):
            np.multiply(figure, contrast, out=shade)
            shade += 1.0
            texture[rows, :, channel] = np.multiply(shade, colour[channel], out=shade)
        if number:
            texture[top - 1 : top + 1] *= 0.62  # the gap between two planks
            texture[top + 1] *= 1.05
    return texture


def _grain(random: np.random.Generator) -> Floats:
    """Return wood grain along x: fibres and wavy rings; about −2…2."""
    side = DESK_TEXELS, DESK_TEXELS
    bands = np.zeros(side, np.float32)
    for along, across, weight in ((6, 160, 0.8), (20, 500, 0.5), (60, 1300, 0.35)):
        noise = random.standard_normal((across, along)).astype(np.float32)
        band = np.asarray(cv2.resize(noise, side, interpolation=cv2.INTER_CUBIC), np.float32)
        band *= weight
        bands += band
    noise = random.standard_normal((26, 8)).astype(np.float32)
    rings = np.asarray(cv2.resize(noise, side, interpolation=cv2.INTER_CUBIC), np.float32)
    rings *= 3.4
    rings += np.arange(DESK_TEXELS, dtype=np.float32)[:, None] / 9.0
    np.sin(rings, out=rings)
    rings *= 0.55
    bands += rings
    return bands


def _texel(x: float, z: float) -> tuple[int, int]:
    """Return the texel (column, row) of a point on the desk [m], in 1/16."""
    scale = DESK_TEXELS / (2 * HALF_WIDTH_M) * 16
    return round((x + HALF_WIDTH_M) * scale), round((z + HALF_WIDTH_M) * scale)


def _quad(x: float, z: float, width: float, depth: float, turn: float) -> NDArray[np.int32]:
    half = np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]]) / 2
    cos, sin = np.cos(turn), np.sin(turn)
    corners = half @ np.array([[cos, sin], [-sin, cos]]) + (x, z)
    return np.array([_texel(*corner) for corner in corners], np.int32)


def _draw_flat(texture: Floats, outline: NDArray[np.int32], colour: Colour) -> None:
    """Draw a flat object on the desk, with a soft shadow at its edge."""
    low = np.maximum(outline.min(axis=0) // 16 - 32, 0)
    high = outline.max(axis=0) // 16 + 32
    texture = texture[low[1] : high[1], low[0] : high[0]]  # a view, drawn in place
    mask = np.zeros(texture.shape[:2], np.float32)
    cv2.fillConvexPoly(mask, outline - low * 16, 1.0, cv2.LINE_8, 4)
    shadow = cv2.GaussianBlur(np.roll(mask, (5, 6), (0, 1)), (0, 0), 6.0)
    texture *= (1.0 - 0.34 * shadow * (1.0 - mask))[..., None]
    edge = cv2.GaussianBlur(mask, (0, 0), 0.7)[..., None]
    texture += (np.array(colour, np.float32) - texture) * edge


def _draw_paper(texture: Floats, random: np.random.Generator) -> None:
    """Draw a sheet with lines of writing."""
    turn, x, z = 0.22, 0.40, -0.20
    _draw_flat(texture, _quad(x, z, 0.21, 0.297, turn), (206, 214, 218))
    cos, sin = np.cos(turn), np.sin(turn)
    for line in range(16):
        v = -0.115 + 0.0145 * line
        end = random.uniform(0.02, 0.08)
        points = [(x + u * cos - v * sin, z + u * sin + v * cos) for u in (-0.085, end)]
        ends = [_texel(*point) for point in points]
        cv2.line(texture, ends[0], ends[1], (150.0, 128.0, 120.0), 2, cv2.LINE_AA, 4)


def _draw_notes(texture: Floats) -> None:
    """Draw three sticky notes."""
    _draw_flat(texture, _quad(-0.40, 0.03, 0.076, 0.076, 0.20), (110, 220, 242))
    _draw_flat(texture, _quad(-0.37, 0.11, 0.076, 0.076, -0.12), (150, 205, 130))
    _draw_flat(texture, _quad(-0.43, 0.14, 0.076, 0.076, 0.45), (170, 160, 240))


def _draw_coaster(texture: Floats) -> None:
    """Draw a cork coaster under the mug."""
    angles = np.linspace(0, 2 * np.pi, 60)
    points = [(MUG_X_M + 0.058 * np.cos(a), MUG_Z_M + 0.058 * np.sin(a)) for a in angles]
    _draw_flat(texture, np.array([_texel(*at) for at in points], np.int32), (92, 124, 160))


def draw_objects(image: Floats, camera: CameraRays) -> None:
    """Draw a mug and two pencils into the camera's image, in place."""
    # OpenCV anti-aliases on integer images only.
    canvas = np.clip(np.rint(image), 0, 255).astype(np.uint8)
    _draw_mug(canvas, camera)
    _draw_pencil(canvas, camera, 0.17, -0.40, 0.35, (60, 175, 240))
    _draw_pencil(canvas, camera, 0.21, -0.385, 0.10, (190, 120, 60))
    image[:] = canvas


def _project(camera: CameraRays, points: Array) -> NDArray[np.int32]:
    return np.round(camera.pixels(camera.from_table(points)) * 16).astype(np.int32)


def _draw_mug(image: Image, camera: CameraRays) -> None:
    angles = np.linspace(0, 2 * np.pi, 97)
    circle = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    foot = np.array([MUG_X_M, 0.0, MUG_Z_M])
    rim = foot + (0.0, MUG_HEIGHT_M, 0.0)
    _draw_shadow(image, camera, foot + circle * MUG_RADIUS_M, 0.07)
    arc = angles[:49]
    right, up = MUG_RADIUS_M + 0.024 * np.sin(arc), 0.05 + 0.026 * np.cos(arc)
    line = _project(camera, foot + np.stack([right, up, 0 * arc], axis=1))
    cv2.polylines(image, [line], False, (72.0, 92.0, 205.0), 9, cv2.LINE_AA, 4)
    for start in range(48):  # the mug's side in strips, each with its own shade
        pair = circle[start : start + 2] * MUG_RADIUS_M
        if pair[:, 2].mean() < -0.35 * MUG_RADIUS_M:
            continue
        strip = np.vstack([foot + pair, (rim + pair)[::-1]])
        light = 0.55 + 0.45 * max(0.0, float(-0.75 * circle[start, 0] + 0.5 * circle[start, 2]))
        colour = tuple(float(c * light) for c in (88, 108, 236))
        cv2.fillConvexPoly(image, _project(camera, strip), colour, cv2.LINE_AA, 4)
    outer = _project(camera, rim + circle * MUG_RADIUS_M)
    inner = _project(camera, rim + circle * MUG_RADIUS_M * 0.88)
    coffee = _project(camera, rim + circle * MUG_RADIUS_M * 0.84 - (0, 0.012, 0))
    cv2.fillConvexPoly(image, outer, (120.0, 138.0, 244.0), cv2.LINE_AA, 4)
    cv2.fillConvexPoly(image, inner, (50.0, 62.0, 140.0), cv2.LINE_AA, 4)
    cv2.fillConvexPoly(image, coffee, (28.0, 44.0, 66.0), cv2.LINE_AA, 4)


def _draw_pencil(
    image: Image, camera: CameraRays, x: float, z: float, turn: float, colour: Colour
) -> None:
    along = np.array([np.cos(turn), 0.0, np.sin(turn)])
    aside = np.array([-np.sin(turn), 0.0, np.cos(turn)]) * 0.0037
    middle = np.array([x, 0.004, z])

    def band(start: float, end: float, taper: float, shade: Colour) -> None:
        quad = [
            middle + start * along + aside,
            middle + end * along + aside * taper,
            middle + end * along - aside * taper,
            middle + start * along - aside,
        ]
        points = _project(camera, np.array(quad))
        cv2.fillConvexPoly(image, points, shade, cv2.LINE_AA, 4)

    ground = np.array([middle + s * along for s in (-0.085, 0.085)]) * (1, 0, 1) + (0.003, 0, 0.004)
    line = _project(camera, ground)
    dark = np.zeros(image.shape[:2], np.float32)
    cv2.polylines(dark, [line], False, 1.0, 8, cv2.LINE_AA, 4)
    _shade(image, 0.45 * cv2.GaussianBlur(dark, (0, 0), 2.5))
    band(-0.088, -0.076, 1.0, (150, 140, 235))
    band(-0.076, 0.068, 1.0, colour)
    band(0.068, 0.084, 0.35, (150, 190, 222))
    band(0.084, 0.090, 0.1, (50, 50, 50))


def _draw_shadow(image: Image, camera: CameraRays, outline: Array, length: float) -> None:
    """Darken the desk next to an object: its footprint, swept away from the lamp."""
    swept = np.vstack([outline, outline + (0.5 * length, 0.0, 0.35 * length)])
    hull = cv2.convexHull(_project(camera, swept))
    dark = np.zeros(image.shape[:2], np.float32)
    cv2.fillConvexPoly(dark, hull, 1.0, cv2.LINE_AA, 4)
    _shade(image, 0.42 * cv2.GaussianBlur(dark, (0, 0), 9.0))


def _shade(canvas: Image, darkness: Floats) -> None:
    """Darken an image in place; `darkness` (H, W) is 0…1."""
    canvas[:] = np.rint(canvas * (1.0 - darkness[..., None]))
