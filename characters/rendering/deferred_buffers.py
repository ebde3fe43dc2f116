"""What deferred passes share: what is seen in each texel of a character layer, and its light."""

import moderngl
import numpy as np

from characters.rendering.geometry.character_cache import CharacterInstance
from characters.skeleton.pose import Array

NORMAL_UNIT, POSITION_UNIT, ALBEDO_UNIT, SHADE_UNIT = 0, 1, 2, 3
"""Texture units of the four layers of `GeometryBuffer`."""

DIFFUSE_UNIT, SPECULAR_UNIT, AMBIENT_UNIT = 4, 5, 6
"""Texture units of the three shares of the light, see `LightBuffer`."""

SURFACES_UNIT = 8
"""Texture unit of the records of all surfaces, see `surface_records`."""


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
        """Position in the camera frame [m], and 1."""
        self.albedo_rough = _texture(context, size, "f2")
        """Linear RGB of the surface, and its roughness."""
        self.shade_metal = _texture(context, size, "f2")
        """Linear RGB of what toon shading shows in the dark, and metalness."""
        self._layers = (self.normal_id, self.position, self.albedo_rough, self.shade_metal)
        self.framebuffer = context.framebuffer(self._layers, depth)
        """Draws on all of them."""

    def bind(self) -> None:
        """Bind the layers to their units."""
        for unit, layer in enumerate(self._layers):
            layer.use(unit)

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
        self._shares = (self.diffuse, self.specular, self.ambient)
        self.framebuffer = context.framebuffer(self._shares)
        """Draws on all of them."""

    def bind(self) -> None:
        """Bind the shares to their units."""
        for unit, share in enumerate(self._shares, DIFFUSE_UNIT):
            share.use(unit)

    def release(self) -> None:
        """Release the textures; a second call does nothing."""
        for each in (self.framebuffer, *self._shares):
            each.release()


def surface_records(characters: tuple[CharacterInstance, ...]) -> Array:
    """Return what the lighting needs to know of each surface of a picture, (surfaces, 2, 4).

    First 1 for toon shading or 0, its shift, how toony it is, and its evenness; then what the
    surface emits, linear RGB, and the height of its character [m]. The row of a surface is its
    number in `GeometryBuffer.normal_id` less 1.
    """
    rows = []
    for character in characters:
        for part in character.skinned.surfaces:
            toon = part.material.toon
            shading = (0, 0, 0, 0) if toon is None else (1, toon.shift, toon.toony, toon.evenness)
            rows.append((shading, (*part.material.emissive, character.height)))
    return np.array(rows, float).reshape(-1, 2, 4)


def _texture(context: moderngl.Context, size: tuple[int, int], dtype: str) -> moderngl.Texture:
    texture = context.texture(size, 4, dtype=dtype)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    texture.repeat_x = texture.repeat_y = False
    return texture
