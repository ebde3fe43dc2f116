"""The surfaces of a character on the graphics card: materials with their maps and programs."""

from dataclasses import dataclass

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.model.mesh import Material
from characters.rendering.geometry.buffers import Geometry
from characters.rendering.programs import Programs

SRGB8_ALPHA8 = 0x8C43
"""OpenGL's name of the format that decodes sRGB when it is sampled."""


@dataclass(frozen=True)
class Part:
    """A run of triangles with one material."""

    first: int
    """Number of the first index."""

    count: int
    """How many indices."""

    material: Material
    """The surface."""

    looks: frozenset[str]
    """Which of `LOOKS` it has."""

    array: moderngl.VertexArray
    """All triangles, with the program for these looks."""

    textures: tuple[tuple[int, moderngl.Texture], ...]
    """Units and textures of the maps that it has: 0 base colour, 1 surface, 2 bumps."""


class Surfaces:
    """Makes what the parts of one character are drawn with, and keeps it.

    Parameters
    ----------
    context, programs
        Where to draw.
    skinned
        Position and normal of each vertex in the table frame, 3 + 3 float32.
    paint
        Linear RGBA and texture coordinates of each vertex, 4 + 2 float32.
    indices
        Three a triangle.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: Programs,
        skinned: moderngl.Buffer,
        paint: moderngl.Buffer,
        indices: moderngl.Buffer,
    ) -> None:
        self._context = context
        self._programs = programs
        self._skinned, self._paint, self._indices = skinned, paint, indices
        self._arrays: dict[frozenset[str], moderngl.VertexArray] = {}
        self._textures: dict[tuple[int, bool], moderngl.Texture] = {}

    def parts(self, geometry: Geometry) -> tuple[Part, ...]:
        """Return a part for each material of a character."""
        parts: list[Part] = []
        first = 0
        for material, count in geometry.materials:
            looks = looks_of(material)
            maps = (material.texture, material.surface, material.bumps)
            textures = tuple(
                (unit, self._texture(image, srgb=unit == 0))
                for unit, image in enumerate(maps)
                if image is not None
            )
            parts.append(Part(first, count, material, looks, self._array(looks), textures))
            first += count
        return tuple(parts)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        for array in self._arrays.values():
            array.release()
        for texture in self._textures.values():
            texture.release()

    def _array(self, looks: frozenset[str]) -> moderngl.VertexArray:
        """Return all triangles with the program for some looks."""
        if looks not in self._arrays:
            program = self._programs.figure(looks)
            mapped = "uv" in program
            content = (
                (self._paint, "4f 2f", "color", "uv") if mapped else (self._paint, "4f 8x", "color")
            )
            placed = (self._skinned, "3f 3f", "position", "normal")
            self._arrays[looks] = self._context.vertex_array(
                program, [placed, content], self._indices
            )
        return self._arrays[looks]

    def _texture(self, image: NDArray[np.uint8], srgb: bool) -> moderngl.Texture:
        """Return a picture on the card; one that several materials share is sent once."""
        key = id(image), srgb
        if key not in self._textures:
            texture = self._sent(image, SRGB8_ALPHA8 if srgb else None)
            texture.build_mipmaps()
            texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
            self._textures[key] = texture
        return self._textures[key]

    def _sent(self, image: NDArray[np.uint8], internal_format: int | None) -> moderngl.Texture:
        limit = int(self._context.info["GL_MAX_TEXTURE_SIZE"])
        height, width = image.shape[:2]
        if max(height, width) > limit:
            scale = limit / max(height, width)
            width, height = max(int(width * scale), 1), max(int(height * scale), 1)
            image = np.asarray(
                cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8
            )
        if image.shape[2] == 3:  # four bytes a texel are read faster, and need no padding
            image = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2RGBA), np.uint8)
        pixels = np.ascontiguousarray(image)
        if internal_format is None:
            return self._context.texture((width, height), 4, pixels)
        return self._context.texture((width, height), 4, pixels, internal_format=internal_format)


def looks_of(material: Material) -> frozenset[str]:
    """Return which of `LOOKS` a material has.

    >>> sorted(looks_of(Material(glow=(0.0, 0.2, 0.0), cutoff=0.5)))
    ['CUTOFF', 'GLOW']
    """
    has = {
        "TEXTURED": material.texture is not None,
        "SURFACE": material.surface is not None,
        "BUMPS": material.bumps is not None and material.bump_scale != 0.0,
        "GLOW": any(material.glow),
        "CUTOFF": material.cutoff is not None,
    }
    return frozenset(look for look, is_there in has.items() if is_there)
