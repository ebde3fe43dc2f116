"""A wooden desk with a few things on it, as one picture that never moves."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.synthetic.lens import Lens

Array = NDArray[np.float64]
Picture = NDArray[np.float32]
Canvas = NDArray[np.uint8]

HALF = 1.3
"""Half the width of the square of desk that is drawn [m]."""

TEXELS = 2600
"""Samples along the desk's picture: one millimetre each."""

FAR_EDGE = -0.62
"""Where the desk ends, away from the camera (z in the table frame) [m]."""

WOOD = np.array([[104, 148, 190], [92, 136, 180], [116, 160, 200], [98, 140, 182]], float)
"""Colours of the planks, BGR."""

WALL = np.array([168, 186, 196], float)
"""Colour of the wall behind the desk, BGR."""


def desk_picture(random: np.random.Generator, clutter: bool) -> Picture:
    """Draw the desk from above, (TEXELS, TEXELS, 3) BGR; rows run along z, columns along x."""
    picture = _planks(random)
    if clutter:
        for thing in (_paper, _notes, _coaster):
            thing(picture, random)
    return picture


def seen_through(lens: Lens, camera_from_table: Array, picture: Picture) -> Picture:
    """Return the camera's picture of the desk and the wall behind it, (H, W, 3)."""
    x, z, _ = _places(lens, camera_from_table, 2)
    scale = TEXELS / (2 * HALF)
    desk = cv2.remap(
        picture,
        (x + HALF) * scale - 0.5,
        (z + HALF) * scale - 0.5,
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REFLECT,
    )
    small = np.asarray(cv2.resize(desk, lens.size, interpolation=cv2.INTER_AREA), np.float32)
    # Light changes slowly: one sample a pixel shows it.
    x, z, below = _places(lens, camera_from_table, 1)
    return _with_wall(_lit(small, x, z), (z < FAR_EDGE) | ~below, x, z)


def _places(
    lens: Lens, camera_from_table: Array, finer: int
) -> tuple[Picture, Picture, NDArray[np.bool_]]:
    """Return x and z of the desk's plane at every sample [m], and whether it looks down at all."""
    rays = lens.rays(lens.whole(), finer)
    table_from_camera = np.linalg.inv(camera_from_table)
    turn, eye = table_from_camera[:3, :3].astype(np.float32), table_from_camera[:3, 3]
    ways = rays @ turn[:, :2].T + turn[:, 2]
    reach = np.float32(-eye[1]) / np.minimum(ways[..., 1], np.float32(-1e-4))
    x = np.float32(eye[0]) + reach * ways[..., 0]
    z = np.float32(eye[2]) + reach * ways[..., 2]
    return x, z, ways[..., 1] < -1e-3


def _lit(desk: Picture, x: Picture, z: Picture) -> Picture:
    """Brighten towards the lamp, on the left at the back, with a faint gloss."""
    lamp = np.exp(-((x + 0.35) ** 2 + (z + 0.25) ** 2) / 0.5)[..., None]
    return np.asarray(desk * (0.80 + 0.26 * lamp) + 9.0 * lamp**3, np.float32)


def _with_wall(seen: Picture, behind: NDArray[np.bool_], x: Picture, z: Picture) -> Picture:
    height = np.clip(FAR_EDGE - z, 0.0, 2.0)[..., None]
    wall = WALL * (0.92 - 0.10 * np.tanh(height)) * (1 - 0.06 * np.tanh(np.abs(x))[..., None])
    # The desk's edge is far behind the focus: the wall fades in over some pixels.
    soft = cv2.GaussianBlur(behind.astype(np.float32), (0, 0), 4.0)[..., None]
    edge = cv2.GaussianBlur(behind.astype(np.float32), (0, 0), 9.0)[..., None]
    shade = 1.0 - 0.55 * edge * (1.0 - edge)
    return np.asarray((seen * (1 - soft) + wall * soft) * shade, np.float32)


def _planks(random: np.random.Generator) -> Picture:
    width = TEXELS // 13
    picture = np.empty((TEXELS, TEXELS, 3), np.float32)
    grain = _grain(random)
    for number, top in enumerate(range(0, TEXELS, width)):
        rows = slice(top, min(top + width, TEXELS))
        shift = int(random.integers(TEXELS))
        figure = np.roll(grain, shift, axis=1)[rows]
        color = WOOD[int(random.integers(len(WOOD)))] * random.uniform(0.95, 1.04)
        picture[rows] = color * (1.0 + 0.075 * figure[..., None] * (1.15, 1.0, 0.9))
        if number:
            picture[top - 1 : top + 1] *= 0.62  # the gap between two planks
            picture[top + 1] *= 1.05
    return picture


def _grain(random: np.random.Generator) -> Picture:
    """Return wood grain along x: fibres, rings that wander, and fine pores; about −2…2."""
    bands = np.zeros((TEXELS, TEXELS), np.float32)
    for along, across, weight in ((6, 160, 0.8), (20, 500, 0.5), (60, 1300, 0.35)):
        noise = random.standard_normal((across, along)).astype(np.float32)
        bands += weight * cv2.resize(noise, (TEXELS, TEXELS), interpolation=cv2.INTER_CUBIC)
    wander = cv2.resize(
        random.standard_normal((26, 8)).astype(np.float32),
        (TEXELS, TEXELS),
        interpolation=cv2.INTER_CUBIC,
    )
    rows = np.arange(TEXELS, dtype=np.float32)[:, None]
    rings = np.sin(rows / 9.0 + 3.4 * wander) * 0.55
    return np.asarray(bands + rings, np.float32)


def _at(x: float, z: float) -> tuple[int, int]:
    """Return the texel (column, row) of a place on the desk [m], in 1/16."""
    scale = TEXELS / (2 * HALF) * 16
    return round((x + HALF) * scale), round((z + HALF) * scale)


def _quad(x: float, z: float, width: float, depth: float, turn: float) -> NDArray[np.int32]:
    half = np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]]) / 2
    cos, sin = np.cos(turn), np.sin(turn)
    corners = half @ np.array([[cos, sin], [-sin, cos]]) + (x, z)
    return np.array([_at(*corner) for corner in corners], np.int32)


def _lay(picture: Picture, outline: NDArray[np.int32], color: tuple[float, float, float]) -> None:
    """Lay something flat on the desk, with a soft shadow under its edge."""
    low = np.maximum(outline.min(axis=0) // 16 - 32, 0)
    high = outline.max(axis=0) // 16 + 32
    picture = picture[low[1] : high[1], low[0] : high[0]]  # a view: the rest stays as it is
    mask = np.zeros(picture.shape[:2], np.float32)
    cv2.fillConvexPoly(mask, outline - low * 16, 1.0, cv2.LINE_8, 4)
    shadow = cv2.GaussianBlur(np.roll(mask, (5, 6), (0, 1)), (0, 0), 6.0)
    picture *= (1.0 - 0.34 * shadow * (1.0 - mask))[..., None]
    edge = cv2.GaussianBlur(mask, (0, 0), 0.7)[..., None]
    picture += (np.array(color, np.float32) - picture) * edge


def _paper(picture: Picture, random: np.random.Generator) -> None:
    """Lay a sheet with lines of writing."""
    turn, x, z = 0.22, 0.40, -0.20
    _lay(picture, _quad(x, z, 0.21, 0.297, turn), (206, 214, 218))
    cos, sin = np.cos(turn), np.sin(turn)
    for line in range(16):
        v = -0.115 + 0.0145 * line
        end = random.uniform(0.02, 0.08)
        points = [(x + u * cos - v * sin, z + u * sin + v * cos) for u in (-0.085, end)]
        ends = [_at(*point) for point in points]
        cv2.line(picture, ends[0], ends[1], (150.0, 128.0, 120.0), 2, cv2.LINE_AA, 4)


def _notes(picture: Picture, random: np.random.Generator) -> None:
    """Lay three sticky notes."""
    for x, z, turn, color in (
        (-0.40, 0.03, 0.20, (110, 220, 242)),
        (-0.37, 0.11, -0.12, (150, 205, 130)),
        (-0.43, 0.14, 0.45, (170, 160, 240)),
    ):
        _lay(picture, _quad(x, z, 0.076, 0.076, turn), color)


def _coaster(picture: Picture, random: np.random.Generator) -> None:
    """Lay a cork coaster where the mug stands."""
    circle = [
        _at(MUG.x + 0.058 * np.cos(a), MUG.z + 0.058 * np.sin(a))
        for a in np.linspace(0, 2 * np.pi, 60)
    ]
    _lay(picture, np.array(circle, np.int32), (92, 124, 160))


@dataclass(frozen=True)
class Mug:
    """Where the mug stands, and how large it is [m]."""

    x: float = -0.36
    z: float = -0.30
    radius: float = 0.041
    height: float = 0.095


MUG = Mug()


def add_things(seen: Picture, lens: Lens, camera_from_table: Array) -> None:
    """Draw what stands on the desk into the camera's picture, in place: a mug and two pencils."""
    # OpenCV smooths the edges of what it draws on whole numbers only.
    canvas = np.clip(np.rint(seen), 0, 255).astype(np.uint8)
    _mug(canvas, lens, camera_from_table)
    for x, z, turn, color in (
        (0.17, -0.40, 0.35, (60, 175, 240)),
        (0.21, -0.385, 0.10, (190, 120, 60)),
    ):
        _pencil(canvas, lens, camera_from_table, (x, z, turn), color)
    seen[:] = canvas


def _project(lens: Lens, camera_from_table: Array, points: Array) -> NDArray[np.int32]:
    there = points @ camera_from_table[:3, :3].T + camera_from_table[:3, 3]
    return np.round(lens.pixels(there) * 16).astype(np.int32)


def _mug(seen: Canvas, lens: Lens, camera_from_table: Array) -> None:
    angles = np.linspace(0, 2 * np.pi, 97)
    circle = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    foot = np.array([MUG.x, 0.0, MUG.z])
    rim = foot + (0.0, MUG.height, 0.0)
    _soft_shadow(seen, lens, camera_from_table, foot + circle * MUG.radius, 0.07)
    handle = foot + np.stack(
        [
            MUG.radius + 0.024 * np.sin(angles[:49]),
            0.05 + 0.026 * np.cos(angles[:49]),
            0 * angles[:49],
        ],
        axis=1,
    )
    line = _project(lens, camera_from_table, handle)
    cv2.polylines(seen, [line], False, (72.0, 92.0, 205.0), 9, cv2.LINE_AA, 4)
    for start in range(48):  # the wall of the mug in strips, each with its own light
        pair = circle[start : start + 2] * MUG.radius
        if pair[:, 2].mean() < -0.35 * MUG.radius:
            continue
        strip = np.vstack([foot + pair, (rim + pair)[::-1]])
        light = 0.55 + 0.45 * max(0.0, float(-0.75 * circle[start, 0] + 0.5 * circle[start, 2]))
        color = tuple(float(c * light) for c in (88, 108, 236))
        cv2.fillConvexPoly(seen, _project(lens, camera_from_table, strip), color, cv2.LINE_AA, 4)
    outer = _project(lens, camera_from_table, rim + circle * MUG.radius)
    inner = _project(lens, camera_from_table, rim + circle * MUG.radius * 0.88)
    coffee = _project(lens, camera_from_table, rim + circle * MUG.radius * 0.84 - (0, 0.012, 0))
    cv2.fillConvexPoly(seen, outer, (120.0, 138.0, 244.0), cv2.LINE_AA, 4)
    cv2.fillConvexPoly(seen, inner, (50.0, 62.0, 140.0), cv2.LINE_AA, 4)
    cv2.fillConvexPoly(seen, coffee, (28.0, 44.0, 66.0), cv2.LINE_AA, 4)


def _pencil(
    seen: Canvas,
    lens: Lens,
    camera_from_table: Array,
    place: tuple[float, float, float],
    color: tuple[float, float, float],
) -> None:
    x, z, turn = place
    along = np.array([np.cos(turn), 0.0, np.sin(turn)])
    aside = np.array([-np.sin(turn), 0.0, np.cos(turn)]) * 0.0037
    middle = np.array([x, 0.004, z])

    def band(start: float, end: float, taper: float, shade: tuple[float, float, float]) -> None:
        quad = [
            middle + start * along + aside,
            middle + end * along + aside * taper,
            middle + end * along - aside * taper,
            middle + start * along - aside,
        ]
        points = _project(lens, camera_from_table, np.array(quad))
        cv2.fillConvexPoly(seen, points, shade, cv2.LINE_AA, 4)

    ground = np.array([middle + s * along for s in (-0.085, 0.085)]) * (1, 0, 1) + (0.003, 0, 0.004)
    line = _project(lens, camera_from_table, ground)
    dark = np.zeros(seen.shape[:2], np.float32)
    cv2.polylines(dark, [line], False, 1.0, 8, cv2.LINE_AA, 4)
    _shade(seen, 0.45 * cv2.GaussianBlur(dark, (0, 0), 2.5))
    band(-0.088, -0.076, 1.0, (150, 140, 235))
    band(-0.076, 0.068, 1.0, color)
    band(0.068, 0.084, 0.35, (150, 190, 222))
    band(0.084, 0.090, 0.1, (50, 50, 50))


def _soft_shadow(
    seen: Canvas, lens: Lens, camera_from_table: Array, outline: Array, length: float
) -> None:
    """Darken the desk beside something that stands on it: its foot, swept away from the lamp."""
    swept = np.vstack([outline, outline + (0.5 * length, 0.0, 0.35 * length)])
    hull = cv2.convexHull(_project(lens, camera_from_table, swept))
    dark = np.zeros(seen.shape[:2], np.float32)
    cv2.fillConvexPoly(dark, hull, 1.0, cv2.LINE_AA, 4)
    _shade(seen, 0.42 * cv2.GaussianBlur(dark, (0, 0), 9.0))


def _shade(canvas: Canvas, darkness: NDArray[np.float32]) -> None:
    """Darken a picture in place by a share for each pixel, (H, W)."""
    canvas[:] = np.rint(canvas * (1.0 - darkness[..., None]))
