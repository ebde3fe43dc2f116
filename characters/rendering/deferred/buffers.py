"""What deferred passes share: what is seen in each texel of a character layer, and its light."""

from collections.abc import Callable
from typing import Generic, TypeVar

import moderngl
import numpy as np

from cubeling.characters.rendering.geometry.character_cache import CharacterInstance
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.projection import grown_size
from cubeling.characters.skeleton.pose import Array

BUFFER_UNITS = {
    **{"normal_id": 0, "position": 1, "albedo_rough": 2, "shade_metal": 3},
    **{"diffuse": 4, "specular": 5, "ambient": 6, "falling": 7},
    **{
        "surfaces": 8,
        "glow_open": 13,
        "occlusion": 10,
        "light": 11,
        "visibility": 12,
        "pixel_position": 14,
    },
}
"""Texture units by the names that shaders have for them: the layers of `GeometryBuffer`, those of
`LightBuffer`, the records of all surfaces (see `surface_records`), emitted light, ambient
occlusion, the sum of all light, and the share of the lamp that arrives, with the places of the
pixels that it is known for."""

MAX_SURFACES = 1024
"""Surfaces of one picture that can be told apart, as 16-bit floats count to 2048: all others are
lit as the last of these."""


class GeometryBuffer:
    """What is seen in each texel of a character layer, before it is lit (G-buffer).

    Row 0 is the top row. A texel without a surface has 0 as its surface number. `depth` is that of
    the character layer, which real cubes have been drawn to.
    """

    def __init__(
        self, context: moderngl.Context, size: tuple[int, int], depth: moderngl.Renderbuffer
    ) -> None:
        self.normal_id = _texture(context, size, "f2")
        """Unit normal in the camera frame, and the number of the surface, from 1 on."""
        self.position = _texture(context, size, "f4")
        """Position in the camera frame [m], and the triangle's normal, see `flat_normal.glsl`."""
        self.albedo_rough = _texture(context, size, "f2")
        """Linear RGB of the surface, and its roughness."""
        self.shade_metal = _texture(context, size, "f2")
        """Linear RGB of what toon shading shows in the dark, or 1 for skin and 0; and metalness."""
        self.glow_open = _texture(context, size, "f2")
        """Linear RGB that it emits, and the share of the light from all around that its own folds
        let through."""
        self._layers = (
            *(self.normal_id, self.position, self.albedo_rough, self.shade_metal),
            self.glow_open,
        )
        self.framebuffer = context.framebuffer(self._layers, depth)
        """Draws on all of them."""

    def bind(self) -> None:
        """Bind the layers to their units."""
        for unit, layer in enumerate(self._layers[:4], BUFFER_UNITS["normal_id"]):
            layer.use(unit)
        self.glow_open.use(BUFFER_UNITS["glow_open"])

    def release(self) -> None:
        """Release the textures; a second call does nothing."""
        for each in (self.framebuffer, *self._layers):
            each.release()


class LightBuffer:
    """The light of each texel of a character layer, in shares that later passes change apart."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.diffuse = _texture(context, size, "f2")
        """Linear RGB of the key light that a surface scatters."""
        self.specular = _texture(context, size, "f2")
        """Linear RGB of the key light that it mirrors, and what it emits."""
        self.ambient = _texture(context, size, "f2")
        """Linear RGB of the light from all around."""
        self.falling = _texture(context, size, "f2")
        """Linear RGB of the key light that falls on skin, and 1; 0 where there is no skin."""
        self._layers = (self.diffuse, self.specular, self.ambient, self.falling)
        self.framebuffer = context.framebuffer(self._layers)
        """Draws on all of them."""
        self.scattered = _texture(context, size, "f2")
        """What stands for `diffuse` after it was scattered in skin."""
        self.scattered_framebuffer = context.framebuffer([self.scattered])
        """Draws on it."""
        self.sum = self.falling
        """Linear RGB of all light, and 1, for passes that change the picture of characters. It
        takes the place of `falling`, which nothing needs any more then."""
        self.sum_framebuffer = context.framebuffer([self.sum])
        """Draws on it."""
        self.is_scattered = False
        """Whether `scattered` is valid."""

    def bind(self) -> None:
        """Bind the layers to their units."""
        for unit, layer in enumerate(self._layers, BUFFER_UNITS["diffuse"]):
            layer.use(unit)
        if self.is_scattered:
            self.scattered.use(BUFFER_UNITS["diffuse"])

    def release(self) -> None:
        """Release the textures; a second call does nothing."""
        for framebuffer in (self.framebuffer, self.scattered_framebuffer, self.sum_framebuffer):
            framebuffer.release()
        for texture in (self.scattered, *self._layers):
            texture.release()


class OcclusionBuffer:
    """How much of the light from all around arrives."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.texture = _texture(context, size, "f4", 2)
        """Open share, and depth [m]."""
        self._framebuffer = context.framebuffer([self.texture])

    def draw(self, triangle: moderngl.VertexArray, size: tuple[int, int]) -> None:
        """Draw a triangle over the first texels."""
        self._framebuffer.use()
        self._framebuffer.viewport = (0, 0, *size)
        triangle.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Release the texture; a second call does nothing."""
        self._framebuffer.release()
        self.texture.release()


class DepthLayerBuffer:
    """Where what is seen in each cell of a character layer begins and ends, and what is behind."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self._context = context
        self.depths = _texture(context, size, "f4")
        """Depths at which what is seen ends, at which the next thing begins and ends, and at which
        what is seen begins [m]."""
        self.target = context.framebuffer([self.depths])
        """Draws on it."""
        self._copied = _texture(context, size, "f4")
        self._copy = context.framebuffer([self._copied])

    def copy(self) -> moderngl.Texture:
        """Return a copy of `depths` as they are, which can be read while they are drawn on."""
        self._context.copy_framebuffer(self._copy, self.target)
        self.target.use()
        return self._copied

    def release(self) -> None:
        """Release the textures; a second call does nothing."""
        for each in (self.target, self._copy, self.depths, self._copied):
            each.release()


class PixelBuffer:
    """What is seen in each cell of a character layer, a pixel or larger."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.normal_id = _texture(context, size, "f2")
        """Unit normal in the camera frame, and the number of the surface; 0 for none."""
        self.position = _texture(context, size, "f4")
        """Position in the camera frame [m]; z is 0 where nothing is."""
        self.framebuffer = context.framebuffer([self.normal_id, self.position])
        """Draws on both."""
        self.visibility = tuple(_texture(context, size, "f1") for _ in range(2))
        """Share of the lamp by colour: as found, and smooth."""
        self._targets = tuple(context.framebuffer([texture]) for texture in self.visibility)

    def bind(self) -> None:
        """Bind what is seen to the units of a geometry buffer."""
        self.normal_id.use(BUFFER_UNITS["normal_id"])
        self.position.use(BUFFER_UNITS["position"])

    def use_visibility(self, number: int, size: tuple[int, int]) -> None:
        """Draw on the first pixels of one of `visibility`."""
        self._targets[number].use()
        self._targets[number].viewport = (0, 0, *size)

    def release(self) -> None:
        """Release the textures; a second call does nothing."""
        for framebuffer in (self.framebuffer, *self._targets):
            framebuffer.release()
        for texture in (self.normal_id, self.position, *self.visibility):
            texture.release()


Kept = TypeVar("Kept", OcclusionBuffer, DepthLayerBuffer, PixelBuffer)


class GrowingBuffer(Generic[Kept]):
    """Keeps one buffer, which a larger one replaces when it must; it never shrinks.

    `make` returns a new one of a size (width, height).
    """

    def __init__(
        self, context: moderngl.Context, make: Callable[[moderngl.Context, tuple[int, int]], Kept]
    ) -> None:
        self._context = context
        self._make: Callable[[moderngl.Context, tuple[int, int]], Kept] = make
        self._size: tuple[int, int] | None = None
        self._kept: Kept | None = None

    def at_least(self, size: tuple[int, int]) -> Kept:
        """Return the buffer, at least of a size (width, height)."""
        grown = grown_size(self._size, size)
        if grown is not None:
            self.release()
            self._kept, self._size = self._make(self._context, grown), grown
        assert self._kept is not None
        return self._kept

    def release(self) -> None:
        """Release the buffer; a second call does nothing."""
        if self._kept is not None:
            # moderngl binds the last framebuffer again when it makes one: it must still exist.
            self._context.detect_framebuffer(0).use()
            self._kept.release()
            self._kept = self._size = None


def buffer_triangle(
    context: moderngl.Context, programs: ShaderPrograms, fragment: str, *defines: str
) -> moderngl.VertexArray:
    """Return a triangle over all texels, with a program that reads the buffers from their units."""
    program = programs.load("full_screen", fragment, *defines)
    set_uniforms(program, **BUFFER_UNITS)
    return context.vertex_array(program, [])


def surface_records(characters: tuple[CharacterInstance, ...]) -> Array:
    """Return what the lighting needs to know of each surface of a picture, (surfaces, 2, 4).

    First 1 for toon shading or 0, its shift, how toony it is, and its evenness; then how far it
    scatters light, relative to the skin of a human as tall as people are, and the height of its
    character [m]. The row of a surface is its number in `GeometryBuffer.normal_id` less 1.
    """
    rows = []
    for character in characters:
        scale = character.height / character.skinned.geometry.height
        for part in character.skinned.surfaces:
            toon = part.material.toon
            shading = (0, 0, 0, 0) if toon is None else (1, toon.shift, toon.toony, toon.evenness)
            rows.append((shading, (scale * part.material.scattering, character.height, 0, 0)))
    return np.array(rows, float).reshape(-1, 2, 4)


def _texture(
    context: moderngl.Context, size: tuple[int, int], dtype: str, components: int = 4
) -> moderngl.Texture:
    texture = context.texture(size, components, dtype=dtype)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    texture.repeat_x = texture.repeat_y = False
    return texture
