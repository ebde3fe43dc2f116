"""What is done to a photograph before it is shown to the trackers."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.geometry.intrinsics import Intrinsics
from tests.bench.photographs.dodecahedron import camera, projected, reference
from tests.bench.photographs.marker_corners import Array, Picture

BLUR_PX = 10.0
"""Length of the motion blur that is added [px]."""

COVER_SHARE = 0.3
"""Radius of what covers a corner, as a share of a marker's side."""

COLOURS_BGR = ((95, 120, 175), (60, 75, 110), (165, 185, 200), (225, 225, 225))
"""Of light and dark skin, a table, and paper."""

BLANK_SCALE, BORDER_SCALE = 1.08, 1.2
"""Size of what blanks a marker, and of the white border around it, in sizes of the marker."""

GAMMA = 2.2
"""Grey values to this power are light, which blurs."""


@dataclass(frozen=True)
class View:
    """A picture with the lens that the trackers are told."""

    picture: Picture
    """(H, W, 3) BGR."""

    lens: Intrinsics
    """Its lens."""


def as_it_is(picture: Picture, number: int) -> View:
    """The photograph itself."""
    return View(picture, camera())


def half_size(picture: Picture, number: int) -> View:
    """The photograph at half its size."""
    height, width = picture.shape[:2]
    size = (width // 2, height // 2)
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    return View(np.asarray(small, np.uint8), camera().scale(size))


def blurred(picture: Picture, number: int) -> View:
    """The photograph as a camera takes it that moves by `BLUR_PX` in some direction."""
    angle = np.random.default_rng(number).uniform(0, np.pi)
    light = (picture.astype(np.float32) / 255) ** GAMMA
    total = np.zeros_like(light)
    shares = np.linspace(-0.5, 0.5, 21)
    for share in shares:
        dx, dy = BLUR_PX * share * np.array([np.cos(angle), np.sin(angle)])
        shift = np.array([[1, 0, dx], [0, 1, dy]])
        total += cv2.warpAffine(light, shift, light.shape[1::-1], borderMode=cv2.BORDER_REPLICATE)
    grey = 255 * (total / len(shares)) ** (1 / GAMMA)
    return View(np.asarray(np.rint(grey), np.uint8), camera())


def corner_covered(picture: Picture, number: int) -> View:
    """The photograph with a disc over one corner of each marker, of skin, of table or of paper."""
    random, hidden = np.random.default_rng(number), picture.copy()
    for square in facing_markers(number):
        corner, centre = square[random.integers(4)], square.mean(axis=0)
        x, y = np.rint(corner + 0.15 * (centre - corner)).astype(int).tolist()
        radius = COVER_SHARE * np.sqrt(_area(square))
        colour = COLOURS_BGR[random.integers(len(COLOURS_BGR))]
        cv2.circle(hidden, (x, y), round(radius), colour, -1, cv2.LINE_AA)
    return View(hidden, camera())


def one_marker(picture: Picture, number: int) -> View:
    """The photograph with all markers but the largest blanked with the white around them."""
    blanked = picture.copy()
    for square in sorted(facing_markers(number), key=_area)[:-1]:
        centre = square.mean(axis=0)
        inner, outer = (
            np.rint(centre + scale * (square - centre)).astype(np.int32)
            for scale in (BLANK_SCALE, BORDER_SCALE)
        )
        border = np.zeros(picture.shape[:2], np.uint8)
        cv2.fillConvexPoly(border, outer, 1)
        cv2.fillConvexPoly(border, inner, 0)
        if border.any():
            white = np.median(picture[border > 0], axis=0)
            cv2.fillConvexPoly(blanked, inner, white.tolist(), cv2.LINE_AA)
    return View(blanked, camera())


def nominal_lens(picture: Picture, number: int) -> View:
    """The photograph with a lens that claims no distortion."""
    return View(picture, replace(camera(), distortion=np.zeros(5)))


VARIANTS: dict[str, Callable[[Picture, int], View]] = {
    "as it is": as_it_is,
    "half size": half_size,
    "blurred": blurred,
    "corner covered": corner_covered,
    "one marker": one_marker,
    "nominal lens": nominal_lens,
}
"""Each variant by its name."""


def facing_markers(number: int) -> list[Array]:
    """Corners of the markers that face the camera in a photograph, hidden or not, (4, 2) [px]."""
    poses = reference().camera_from_body[number] @ reference().body_from_marker
    facing = [pose for pose in poses if pose[:3, 2] @ pose[:3, 3] < 0]
    return list(projected(np.stack(facing), camera()))


def _area(square: Array) -> float:
    return float(cv2.contourArea(square.astype(np.float32)))
