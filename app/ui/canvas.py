"""Cards over the picture, drawn at the size at which they are shown."""

import importlib.util
from copy import copy
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from cubeling.app.ui.palette import PAPER, Color
from cubeling.tracking import icon_mask

PICTURE_HEIGHT = 720.0
"""Height of a picture in design units, in which lengths are given."""

SUBPIXEL_BITS = 4
"""Fractional bits of the coordinates that OpenCV draws with."""

WIDE_FONT = Path("assets/fonts/Roboto/Roboto-Regular.ttf")
"""The font of imgui-bundle with the letters that Pillow's lacks, also the panels' second font."""

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
UNIT_CIRCLE = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)
"""Points of a circle of radius one, (48, 2)."""

_cached_icon = lru_cache(maxsize=32)(icon_mask)


@dataclass(frozen=True)
class Card:
    """A small picture with rounded corners, to be blended over another."""

    x: int
    """Left edge in the other picture [px]."""

    y: int
    """Top edge [px]."""

    color: NDArray[np.uint8]
    """(height, width, 3) BGR."""

    opacity: NDArray[np.float32]
    """(height, width): 0 is transparent, 1 is opaque."""

    transparency: NDArray[np.float32]
    """1 − `opacity`, (height, width)."""

    def box(self, scale: float) -> tuple[float, float, float, float]:
        """Return left, top, right and bottom in units of a canvas of a scale."""
        height, width = self.opacity.shape
        left, top = self.x / scale, self.y / scale
        return left, top, left + width / scale, top + height / scale

    def blend_over(self, picture: NDArray[np.uint8]) -> None:
        """Blend the card over a picture (H, W, 3), in place; it is clipped to the picture."""
        height, width = self.opacity.shape
        top, left = max(0, self.y), max(0, self.x)
        part = picture[top : self.y + height, left : self.x + width]
        if part.size == 0:
            return
        rows, columns = part.shape[:2]
        inside = np.s_[top - self.y : top - self.y + rows, left - self.x : left - self.x + columns]
        part[:] = cv2.blendLinear(
            self.color[inside], part, self.opacity[inside], self.transparency[inside]
        )


class Canvas:
    """A card that is being drawn. Lengths are in design units, see `PICTURE_HEIGHT`."""

    def __init__(self, width: float, height: float, scale: float) -> None:
        self.scale = scale
        self.size = (width, height)
        shape = (round(height * scale), round(width * scale))
        self.color = np.empty((*shape, 3), np.uint8)
        self.color[:] = PAPER

    def card(self, x: float, y: float, opacity: float = 0.93) -> Card:
        """Return the finished card with its top left corner at (x, y)."""
        height, width = self.color.shape[:2]
        radius = round(min(18 * self.scale, height / 2))
        masks = _blend_masks(width, height, radius, round(255 * opacity))
        return Card(round(x * self.scale), round(y * self.scale), self.color, *masks)

    def strip(self, y: float) -> Card:
        """Return it as a card without round corners, at the left edge and at `y`."""
        height, width = self.color.shape[:2]
        masks = _plain_masks(width, height)
        return Card(0, round(y * self.scale), self.color, *masks)

    def copy(self) -> "Canvas":
        """Return a copy to draw on; what never changes is drawn once, on the original."""
        canvas = copy(self)
        canvas.color = self.color.copy()
        return canvas

    def text(
        self, x: float, y: float, words: str, size: float, color: Color, align: str = "left"
    ) -> None:
        """Write a line of text; (x, y) is on its baseline, at its left end, middle or right end."""
        mask, ascent = text_mask(words, round(size * self.scale))
        shift = {"left": 0.0, "middle": 0.5, "right": 1.0}[align] * mask.shape[1]
        left, top = round(x * self.scale - shift), round(y * self.scale) - ascent
        self._stamp(mask, left, top, color)

    def icon(self, x: float, y: float, size: float, name: str, color: Color) -> None:
        """Draw an icon in a square of `size` whose top left corner is (x, y)."""
        mask = _cached_icon(name, round(size * self.scale))
        self._stamp(mask, round(x * self.scale), round(y * self.scale), color)

    def picture(self, x: float, y: float, image: NDArray[np.uint8], radius: float) -> None:
        """Draw a picture (height, width, 3) with round corners; (x, y) is its top left corner."""
        height, width = image.shape[:2]
        left, top = round(x * self.scale), round(y * self.scale)
        part = self.color[top : top + height, left : left + width]
        rows, columns = part.shape[:2]
        masks = _blend_masks(width, height, round(radius * self.scale), 255)
        opacity, transparency = (mask[:rows, :columns] for mask in masks)
        part[:] = cv2.blendLinear(image[:rows, :columns], part, opacity, transparency)

    def disc(self, x: float, y: float, radius: float, color: Color) -> None:
        """Fill a circle around a point [px]."""
        # Small circles of OpenCV's own look like polygons.
        self.fill(np.array([x, y]) + radius * UNIT_CIRCLE, color)

    def fill(self, points: NDArray[np.float64], color: Color) -> None:
        """Fill a convex polygon (n, 2)."""
        corners = self._fixed_point(points)
        cv2.fillConvexPoly(self.color, corners, color, cv2.LINE_AA, SUBPIXEL_BITS)

    def line(self, points: object, color: Color, width: float, closed: bool = False) -> None:
        """Draw a line with round ends through points (n, 2)."""
        path = self._fixed_point(np.asarray(points, float))
        thickness = max(1, round(width * self.scale))
        cv2.polylines(self.color, [path], closed, color, thickness, cv2.LINE_AA, SUBPIXEL_BITS)

    def bar(self, x: float, y: float, width: float, height: float, color: Color) -> None:
        """Fill a bar with round ends; (x, y) is the middle of its left end."""
        ends = np.array([[x + height / 2, y], [x + width - height / 2, y]])
        self.line(ends, color, height)

    def _fixed_point(self, points: NDArray[np.float64]) -> NDArray[np.int32]:
        return np.asarray(np.round((points * self.scale - 0.5) * 2**SUBPIXEL_BITS), np.int32)

    def _stamp(self, mask: NDArray[np.uint8], left: int, top: int, color: Color) -> None:
        height, width = self.color.shape[:2]
        first_x, first_y = max(0, left), max(0, top)
        part = self.color[first_y : top + mask.shape[0], first_x : left + mask.shape[1]]
        if part.size == 0 or first_x >= width or first_y >= height:
            return
        seen = mask[first_y - top :, first_x - left :][: part.shape[0], : part.shape[1]]
        share = seen.astype(np.float32)[..., None] / 255.0
        part[:] = np.round(part + (np.array(color, np.float32) - part) * share).astype(np.uint8)


@lru_cache(maxsize=256)
def text_mask(words: str, size: int) -> tuple[NDArray[np.uint8], int]:
    """Return the coverage of a line of text (height, width), and its ascent [px]."""
    font = _font(words, max(6, size))
    left, top, right, bottom = (round(side) for side in font.getbbox(words, anchor="ls"))
    image = Image.new("L", (max(1, right - left + 2), max(1, bottom - top + 2)))
    ImageDraw.Draw(image).text((1 - left, 1 - top), words, 255, font, anchor="ls")
    return np.asarray(image, np.uint8), 1 - top


def _font(words: str, size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return the font of the cards, which is Pillow's own, or one that has letters with accents."""
    foreign = any(not letter.isascii() and (letter.isalpha() or letter in "¡¿") for letter in words)
    spec = importlib.util.find_spec("imgui_bundle") if foreign else None
    if spec is None or spec.origin is None:
        return ImageFont.load_default(size)
    return ImageFont.truetype(Path(spec.origin).parent / WIDE_FONT, size)


def can_be_written(words: str) -> bool:
    """Return whether there are glyphs for words: for Latin, Greek and Cyrillic ones.

    >>> can_be_written("¿Qué? Ça alors!"), can_be_written("你好")
    (True, False)
    """
    return all(
        not letter.isalpha() or ord(letter) < 0x530 or 0x1E00 <= ord(letter) < 0x2000
        for letter in words
    )


def text_width(words: str, size: float) -> float:
    """Return the width of a line of text, in the units of `size`."""
    return float(text_mask(words, 100)[0].shape[1] * size / 100)


def wrap_text(words: str, width: float, size: float) -> list[str]:
    """Return words in lines of at most this width; a longer word has a line of its own."""
    lines = [""]
    for word in words.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and text_width(longer, size) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines


def rounded_rectangle(width: int, height: int, radius: int, value: int) -> NDArray[np.uint8]:
    """Return a mask (height, width) of a rectangle with round corners; `value` inside."""
    y, x = np.mgrid[:height, :width] + 0.5
    dx = np.maximum(np.abs(x - width / 2) - (width / 2 - radius), 0.0)
    dy = np.maximum(np.abs(y - height / 2) - (height / 2 - radius), 0.0)
    inside = np.clip(radius - np.hypot(dx, dy) + 0.5, 0.0, 1.0)
    return np.asarray(np.round(inside * value), np.uint8)


@lru_cache(maxsize=32)
def _blend_masks(
    width: int, height: int, radius: int, value: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the opacity of a card and its complement, each (height, width)."""
    opacity = rounded_rectangle(width, height, radius, value).astype(np.float32) / 255.0
    return opacity, 1.0 - opacity


@lru_cache(maxsize=4)
def _plain_masks(width: int, height: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    opacity = np.ones((height, width), np.float32)
    return opacity, np.zeros_like(opacity)
