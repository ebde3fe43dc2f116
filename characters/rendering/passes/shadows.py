"""The characters' shadows on the table: sharp under the feet, softer with height."""

import moderngl
import numpy as np

from characters.rendering.cover import PictureCover
from characters.rendering.geometry.character_cache import CharacterInstance
from characters.rendering.light import Light
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.passes.table_factors import TableFactors, darken
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.resources import FrameResources
from characters.rendering.target import read_bytes
from characters.skeleton.pose import Array

MAP_SIDE = 80
"""Texels along each side of a shadow map; a character covers about half of them."""

BLUR_TAPS = 10
"""Taps of the blur on each side; `BLUR_TAPS` in `shadow_blur` and `shadow_factor` too."""

SHADOW_LEVELS = (0.0, 0.1, 0.4, 1.0)
"""Heights whose shadows are blurred separately, as shares of the character's height."""

KEY_BLUR = (0.010, 0.022, 0.05, 0.10)
"""Standard deviation of the key light's blur at each level, as a share of the character's height:
a light of about 25° across, as a window or a ceiling light is from a desk."""

SKY_BLUR = (0.022, 0.05, 0.11, 0.13)
"""Standard deviation of the ambient light's blur at each level, as a share of the height."""

SKY_OCCLUSION = (0.78, 0.7, 0.48, 0.2)
"""Share of the ambient light that a surface at each level keeps from the table below it."""

ON_TABLE = np.eye(4)
"""`floor_from_table` of the table itself."""

BLUR_DEVIATIONS, MAX_BLUR_MARGIN = 2.2, 0.22
"""Margin around a shadow for the blur, in standard deviations of it, and at most as a share of the
character's height."""


class ShadowPass(RenderPass):
    """Renders a shadow map for each character, and darkens the table with them."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._programs = programs
        self._maps: list[ShadowMap] = []
        self._count = 0

    def prepare(self, frame: FrameResources) -> None:
        """Render the shadow maps."""
        self._count = len(frame.on_table)
        while len(self._maps) < self._count:
            self._maps.append(ShadowMap(self._context, self._programs))
        share = self._key_share(frame.light)
        for shadow, character in zip(self._maps, frame.on_table, strict=False):
            shadow.render(character, frame.light, share)

    def composite(self, frame: FrameResources, cover: PictureCover | None) -> None:
        """Darken the table, except where real cubes or a hand hide it."""
        if self._count:
            for factors in self._table_factors():
                darken(frame, cover, factors)

    def _key_share(self, light: Light) -> Array:
        """Return the share of the key light in the light on the table, (3,)."""
        return key_share(light)

    def _table_factors(self) -> list[TableFactors]:
        """Return the light that each character leaves."""
        return [shadow.read() for shadow in self._maps[: self._count]]

    def release(self) -> None:
        """Release the maps too; a second call does nothing."""
        super().release()
        for shadow in self._maps:
            shadow.release()


def key_share(light: Light) -> Array:
    """Return the share of the key light in the light on a floor, in whose frame it is, (3,)."""
    return np.asarray(light.key * light.to_light[1] / light.white)


class ShadowMap:
    """The light that one character takes from the table, by colour channel."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._caster = programs.load("shadow_caster", "shadow_caster")
        self._blur = programs.load("full_screen", "shadow_blur")
        self._factor = programs.load("full_screen", "shadow_factor")
        self._blur_triangle = context.vertex_array(self._blur, [])
        self._factor_triangle = context.vertex_array(self._factor, [])
        self._textures = [context.texture((2 * MAP_SIDE, MAP_SIDE), 4) for _ in range(2)]
        for texture in self._textures:
            texture.repeat_x = texture.repeat_y = False
        self._targets = [context.framebuffer([texture]) for texture in self._textures]
        self.texture = self._textures[0]
        """What is left of the light, in its left half."""
        self.area = np.zeros(4)
        """Origin x, z and side of the square that the map covers, and the character's height."""
        self.extent = np.zeros(4)
        """Lowest x and z, highest x and z that the shadow can reach [m]."""

    def render(
        self,
        character: CharacterInstance,
        light: Light,
        share: Array,
        floor_from_table: Array = ON_TABLE,
    ) -> None:
        """Render the map of a character.

        `share` (3,) is the share of the key light in the light on the table. On another floor
        than the table, its frame (4, 4) has +y up and the floor at y = 0; what encloses the
        character and the light are in that frame.
        """
        height = character.height
        # Horizontal offset (x, z) of a point from its shadow, for each metre of the point's height.
        slope = light.to_light[[0, 2]] / light.to_light[1]
        self.extent = _extent(character.enclosing, height, slope)
        self.area = _map_area(self.extent, height)
        context = self._context
        set_uniforms(
            self._caster,
            area=self.area,
            slope=slope,
            levels=SHADOW_LEVELS,
            floor_from_table=floor_from_table,
        )
        target = self._targets[0]
        target.use()
        target.viewport = (0, 0, 2 * MAP_SIDE, MAP_SIDE)
        target.clear()
        # Faces that look away from the light are drawn: they are nearest to the table, and soles
        # touch it.
        context.enable_only(moderngl.BLEND | moderngl.CULL_FACE)
        context.front_face = "ccw"
        context.blend_equation = moderngl.MAX, moderngl.MAX
        context.blend_func = moderngl.ONE, moderngl.ONE
        for run in character.skinned.caster_runs:
            (context.disable if run.double_sided else context.enable)(moderngl.CULL_FACE)
            character.skinned.caster.render(vertices=run.count, first=run.first, instances=2)
        context.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        context.enable_only(moderngl.NOTHING)
        self._soften(height, share)

    def read(self) -> TableFactors:
        """Return what is left of the light, with one more texel on each side."""
        x, z, width, depth = self._used_texels()
        low = np.maximum([x - 1, z - 1], 0)
        columns, rows = (np.minimum([x + width + 1, z + depth + 1], MAP_SIDE) - low).tolist()
        left_of_light = read_bytes(self._targets[0], (*low.tolist(), columns, rows), 3)
        texel = float(self.area[2]) / MAP_SIDE
        left, near = (self.area[:2] + texel * low).tolist()
        return TableFactors(left_of_light, (left, near), texel)

    def _soften(self, height: float, key_share: Array) -> None:
        """Blur the part of the map that can have a shadow along x; then along z, to one factor.

        The factor is what is left of both lights: the map has fewer texels than the table.
        """
        texels_per_height = MAP_SIDE / self.area[2] * height
        key, sky = (
            _gaussian_kernels(texels_per_height * np.array(deviations))
            for deviations in (KEY_BLUR, SKY_BLUR)
        )
        x, z, width, depth = self._used_texels()
        used = x, z, x + width - 1, z + depth - 1
        self._targets[1].use()
        self._textures[0].use(0)
        for left, weights in ((0, key), (MAP_SIDE, sky)):
            self._targets[1].viewport = (x + left, z, width, depth)
            set_uniforms(self._blur, weights=weights, first=x + left, last=x + left + width - 1)
            self._blur_triangle.render(moderngl.TRIANGLES, vertices=3)
        self._targets[0].use()
        # One more texel on each side, for the interpolation between texels.
        self._targets[0].viewport = (x - 1, z - 1, width + 2, depth + 2)
        self._textures[1].use(0)
        set_uniforms(
            self._factor,
            key_weights=key,
            sky_weights=sky,
            used=used,
            side=MAP_SIDE,
            key=key_share,
            sky_occlusion=SKY_OCCLUSION,
        )
        self._factor_triangle.render(moderngl.TRIANGLES, vertices=3)

    def _used_texels(self) -> tuple[int, int, int, int]:
        """Return the texels of a half that can have a shadow: first x and z, width and depth."""
        area = self.area
        x, z = np.floor((self.extent[:2] - area[:2]) / area[2] * MAP_SIDE).astype(int).tolist()
        right, far = np.ceil((self.extent[2:] - area[:2]) / area[2] * MAP_SIDE).astype(int).tolist()
        return x, z, right - x, far - z

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        self._blur_triangle.release()
        self._factor_triangle.release()
        for target, texture in zip(self._targets, self._textures, strict=True):
            target.release()
            texture.release()


def sky_extent(enclosing: Array, height: float) -> Array:
    """Return lowest x and z, highest x and z where a character takes light from all around [m]."""
    return _extent(enclosing, height, np.zeros(2))


def _extent(enclosing: Array, height: float, slope: Array) -> Array:
    """Return lowest x and z, highest x and z that a character's shadow can reach [m]."""
    above = np.maximum(enclosing[:, 1:2], 0.0)
    below = enclosing[:, [0, 2]]
    ends = []
    for points, deviations in ((below, SKY_BLUR), (below - slope * above, KEY_BLUR)):
        blur = np.interp(above / height, SHADOW_LEVELS, deviations)
        margin = height * np.minimum(BLUR_DEVIATIONS * blur, MAX_BLUR_MARGIN)
        ends.append((points - margin, points + margin))
    low = np.minimum(*(low.min(axis=0) for low, _ in ends))
    high = np.maximum(*(high.max(axis=0) for _, high in ends))
    return np.concatenate([low, high])


def _map_area(extent: Array, height: float) -> Array:
    """Return the area of the map that covers an extent.

    The side grows in steps and the origin moves by whole texels, so that edges do not crawl.
    """
    low, high = extent[:2], extent[2:]
    step = height / 8
    side = (np.ceil((high - low).max() / step) + 1) * step
    texel = side / MAP_SIDE
    origin = np.floor((low + high - side) / 2 / texel) * texel
    return np.array([*origin, side, height])


def _gaussian_kernels(deviations: Array) -> Array:
    """Return one half of four normalised kernels, (taps, 4)."""
    taps = np.arange(BLUR_TAPS)[:, None]
    kernels = np.exp(-0.5 * (taps / np.maximum(deviations, 0.3)) ** 2)
    kernels /= kernels[0] + 2.0 * kernels[1:].sum(axis=0)
    return np.asarray(kernels)
