"""The table behind the benchmark's cube, with what lies on it: drawn once for each sequence."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.bench.tracking.light import UP, Light
from tests.bench.tracking.optics import LensModel, sampled
from tests.bench.tracking.paper import marker_cells

DENSITY, LONG, WIDE = 900, 3600, 2700
"""Grain of the drawing [1/m], and its size: 4 m by 3 m."""

Picture = NDArray[np.uint8]


def desk(
    lens: LensModel,
    height: float,
    light: Light,
    random: np.random.Generator,
    dictionary: str = "",
    foreign: tuple[int, ...] = (),
) -> NDArray[np.float32]:
    """Linear light (height, width, 3) BGR of a table, blurred by the lens.

    Parameters
    ----------
    lens
        The camera.
    height
        How far above the table it is [m].
    light
        What falls on the table; shadows fall on it too.
    random
        What lies there.
    dictionary, foreign
        Markers of this dictionary with these numbers lie there too.
    """
    drawing = _wood(random)
    for _ in range(26):
        THINGS[int(random.integers(len(THINGS)))](drawing, random)
    for index, number in enumerate(foreign):
        _lay_marker(drawing, random, marker_cells(dictionary, number), index / len(foreign))
    linear = np.float32(0.75) * cv2.pow(drawing.astype(np.float32) / np.float32(255), 2.2)
    up = UP / np.linalg.norm(UP)
    right, front = np.array([1.0, 0, 0]), np.cross(up, [1.0, 0, 0])
    # The point of the table on the optical axis lies in the drawing's lower half.
    middle = np.array([0, 0, -height / up[2]])
    place = np.stack([right, -front, middle * DENSITY - right * LONG / 2 + front * WIDE * 0.7], 1)
    place /= DENSITY
    rays = lens.rays
    grid = np.asarray(cv2.perspectiveTransform(rays, np.linalg.inv(place)), np.float32)
    fine = sampled(np.asarray(linear, np.float32), grid, smooth=True)
    fine = fine * light.on(up, place, grid)[..., None]
    blurred = cv2.filter2D(fine, cv2.CV_32F, lens.spread(float(middle[2])))
    picture = cv2.resize(blurred, lens.size, interpolation=cv2.INTER_AREA)
    return np.asarray(picture * lens.vignette[..., None], np.float32)


def _wood(random: np.random.Generator) -> Picture:
    """Boards with a grain, and broad stains."""
    grain = cv2.resize(random.standard_normal((WIDE // 3, 40), np.float32), (LONG, WIDE))
    stains = cv2.resize(random.standard_normal((9, 12), np.float32), (LONG, WIDE), None, 0, 0, 2)
    tone = 1 + 0.05 * grain + 0.10 * stains
    shade, warmth = random.uniform(75, 175), random.uniform(0.0, 0.22)
    colour = (shade * (1 + warmth * np.array([-2, 0, 1]))).astype(np.float32)
    boards = tone[..., None] * colour
    return np.clip(boards, 20, 240, out=boards).astype(np.uint8)


def _spot(random: np.random.Generator) -> tuple[float, float]:
    """Somewhere that the camera sees [drawing's pixels]."""
    return float(random.uniform(0.2, 0.8) * LONG), float(random.uniform(0.2, 0.95) * WIDE)


def _quad(centre: tuple[float, float], size: tuple[float, float], turn: float) -> NDArray[np.int32]:
    return cv2.boxPoints((centre, size, turn)).astype(np.int32)


def _book(drawing: Picture, random: np.random.Generator) -> None:
    spot, turn = _spot(random), float(random.uniform(0, 180))
    size = (float(random.uniform(110, 240)), float(random.uniform(150, 300)))
    cover = (random.integers(40, 200) + random.integers(-40, 41, 3)).tolist()
    cv2.fillConvexPoly(drawing, _quad(spot, size, turn), cover, cv2.LINE_AA)
    for share in (0.8, 0.55):
        smaller = (size[0] * share, size[1] * share)
        cv2.polylines(
            drawing,
            [_quad(spot, smaller, turn)],
            True,
            random.integers(0, 256, 3).tolist(),
            int(random.integers(1, 9)),
            cv2.LINE_AA,
        )


def _page(drawing: Picture, random: np.random.Generator) -> None:
    """Draw a white sheet with rows of marks like text, some bold."""
    sheet = np.full((270, 190, 3), int(random.integers(215, 250)), np.uint8)
    for row in range(24, 250, int(random.integers(9, 16))):
        column, bold = 16, int(random.integers(1, 5))
        while column < 165:
            length = int(random.integers(4, 22))
            cv2.line(sheet, (column, row), (min(column + length, 172), row), (50, 45, 45), bold)
            column += length + 5
    if random.random() < 0.6:
        cv2.rectangle(sheet, (30, 40), (110, 110), (25, 25, 25), int(random.choice([-1, 6, 12])))
    _paste(drawing, sheet, _spot(random), random.uniform(0, 360), random.uniform(0.9, 1.3))


def _pen(drawing: Picture, random: np.random.Generator) -> None:
    (x, y), angle = _spot(random), random.uniform(0, 2 * np.pi)
    end = (int(x + 130 * np.cos(angle)), int(y + 130 * np.sin(angle)))
    colour = random.integers(10, 200, 3).tolist()
    cv2.line(drawing, (int(x), int(y)), end, colour, int(random.integers(6, 12)), cv2.LINE_AA)


def _cable(drawing: Picture, random: np.random.Generator) -> None:
    steps = np.cumsum(random.normal(0, 40, (30, 2)), 0)
    smooth = cv2.GaussianBlur(steps, (1, 9), 0, sigmaY=2.0) + np.array(_spot(random))
    colour = (25, 25, 28) if random.random() < 0.6 else (225, 225, 220)
    cv2.polylines(drawing, [smooth.astype(np.int32)], False, colour, 5, cv2.LINE_AA)


def _cup(drawing: Picture, random: np.random.Generator) -> None:
    x, y = (int(value) for value in _spot(random))
    for radius in (46, 40, 30):
        colour = random.integers(30, 240, 3).tolist()
        cv2.circle(drawing, (x, y), radius, colour, -1, cv2.LINE_AA)


def _chequers(drawing: Picture, random: np.random.Generator) -> None:
    """Draw squares of black and white, which look like a marker from afar."""
    count = int(random.integers(3, 7))
    cells = np.where(random.random((count, count)) < 0.5, 20, 235).astype(np.uint8)
    cells = np.pad(cells, 1, constant_values=20 if random.random() < 0.5 else 235)
    tile = cv2.cvtColor(cv2.resize(cells, None, fx=12, fy=12, interpolation=0), 8)
    _paste(drawing, tile, _spot(random), random.uniform(0, 360), random.uniform(0.5, 1.0))


THINGS = (_book, _page, _page, _pen, _cable, _cup, _chequers)


def _lay_marker(
    drawing: Picture, random: np.random.Generator, cells: NDArray[np.bool_], share: float
) -> None:
    """Lay a marker of 30 to 70 mm with its white border where the camera sees it."""
    padded = np.pad(np.where(cells, 238, 22).astype(np.uint8), 1, constant_values=238)
    tile = cv2.cvtColor(cv2.resize(padded, None, fx=20, fy=20, interpolation=0), 8)
    size = random.uniform(0.030, 0.070) * DENSITY * len(padded) / len(cells)
    spot = ((0.36 + 0.28 * share) * LONG, random.uniform(0.60, 0.84) * WIDE)
    _paste(drawing, tile, spot, random.uniform(0, 360), size / len(tile))


def _paste(
    drawing: Picture,
    tile: cv2.typing.MatLike,
    spot: tuple[float, float],
    turn_deg: float,
    scale: float,
) -> None:
    """Lay a picture on the drawing with its middle at `spot`."""
    height, width = tile.shape[:2]
    motion = cv2.getRotationMatrix2D((width / 2, height / 2), float(turn_deg), float(scale))
    reach = int(np.hypot(width, height) * scale / 2) + 2
    motion[:, 2] += reach - np.array([width / 2, height / 2])
    left, top = int(spot[0]) - reach, int(spot[1]) - reach
    part = drawing[max(top, 0) : top + 2 * reach, max(left, 0) : left + 2 * reach]
    motion[:, 2] += np.minimum((left, top), 0)
    size = (part.shape[1], part.shape[0])
    if min(size) == 0:
        return
    share = cv2.warpAffine(np.ones((height, width), np.float32), motion, size)[..., None]
    laid = cv2.warpAffine(tile.astype(np.float32), motion, size)
    part[:] = (laid + (1 - share) * part).astype(np.uint8)
