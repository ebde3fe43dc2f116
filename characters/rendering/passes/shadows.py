"""The characters' shadows on the table: sharp under the feet, softer with height."""

import math
from collections.abc import Sequence
from functools import lru_cache

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.geometry.character_cache import CharacterInstance
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.passes.table_factors import darken
from cubeling.characters.rendering.passes.table_image import TableImage
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources
from cubeling.characters.rendering.target import read_bytes
from cubeling.characters.skeleton.pose import Array

MAP_SIDE = 80
"""Texels along each side of a shadow map; a character covers about half of them."""

BLUR_TAPS = 10
"""Taps of the blur on each side, the middle included."""

SHADOW_LEVELS = (0.0, 0.1, 0.4, 1.0)
"""Heights whose shadows are blurred separately, as shares of the character's height."""

KEY_BLUR = (0.010, 0.022, 0.05, 0.10)
"""Standard deviation of the key light's blur at each level, as a share of the character's height:
a light of about 25° across, as a window or a ceiling light is from a desk."""

SKY_BLUR = (0.022, 0.05, 0.11, 0.13)
"""Standard deviation of the ambient light's blur at each level, as a share of the height."""

SKY_OCCLUSION = (0.78, 0.7, 0.48, 0.2)
"""Share of the ambient light that a surface at each level keeps from the table below it."""

MAX_SKY_OCCLUSION = 0.78
"""Largest share of it that is kept from the table: foot and table reflect some light."""

DISPLAY_GAMMA = 2.2
"""Exponent of the encoded picture: a power of a factor multiplies it as the factor does light."""

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

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Copy the maps to memory, before the driver gets the characters."""
        for shadow in self._maps[: self._count]:
            shadow.read_back()

    def composite(self, frame: FrameResources, cover: PictureCover | None) -> None:
        """Darken the table, except where real cubes or a hand hide it."""
        if self._count:
            for factors in self._table_factors():
                darken(frame, cover, factors)

    def _key_share(self, light: Light) -> Array:
        """Return the share of the key light in the light on the table, (3,)."""
        return key_share(light)

    def _table_factors(self) -> list[TableImage]:
        """Return the light that each character leaves."""
        return [shadow.factors() for shadow in self._maps[: self._count]]

    def release(self) -> None:
        """Release the maps too; a second call does nothing."""
        super().release()
        for shadow in self._maps:
            shadow.release()


def key_share(light: Light) -> Array:
    """Return the share of the key light in the light on a floor, in whose frame it is, (3,)."""
    return np.asarray(light.key * light.to_light[1] / light.white)


class ShadowMap:
    """The light that one character takes from the table, by colour channel.

    The graphics card draws what casts the shadow. It is softened in memory: the map is so small
    that a software driver takes several times as long for it as OpenCV does.
    """

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._caster = programs.load("shadow_caster", "shadow_caster")
        self._covered = context.texture((2 * MAP_SIDE, MAP_SIDE), 4)
        self._target = context.framebuffer([self._covered])
        self._texture: moderngl.Texture | None = None
        self._drawn: NDArray[np.uint8] | None = None
        self._share = np.zeros(3)
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
        # The light is above the table (`Light` sees to it), so this never divides by zero.
        slope = light.to_light[[0, 2]] / light.to_light[1]
        self.extent = _extent(character.enclosing, height, slope)
        self.area = _map_area(self.extent, height)
        self._share, self._drawn = share, None
        context = self._context
        set_uniforms(
            self._caster,
            area=self.area,
            slope=slope,
            levels=SHADOW_LEVELS,
            floor_from_table=floor_from_table,
        )
        self._target.use()
        self._target.clear()
        # Faces that look away from the light are drawn: they are nearest to the table, and soles
        # touch it.
        context.enable_only(moderngl.BLEND | moderngl.CULL_FACE)
        context.front_face = "ccw"
        # Each texel keeps the most that anything covers it, in whatever order triangles come.
        context.blend_equation = moderngl.MAX, moderngl.MAX
        context.blend_func = moderngl.ONE, moderngl.ONE
        for run in character.skinned.caster_runs:
            (context.disable if run.double_sided else context.enable)(moderngl.CULL_FACE)
            character.skinned.caster.render(vertices=run.count, first=run.first, instances=2)
        # The state is global: other passes expect the usual blending.
        context.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD

    def read_back(self) -> None:
        """Copy the map to memory: before more is drawn, the driver need not end that first."""
        if self._drawn is None:
            self._drawn = read_bytes(self._target, (0, 0, 2 * MAP_SIDE, MAP_SIDE), 4)

    def factors(self) -> TableImage:
        """Return what is left of the light, with one more texel on each side."""
        self.read_back()
        assert self._drawn is not None
        x, z, width, depth = self._used_texels()
        covered = self._drawn[z : z + depth]
        key, sky = covered[:, x : x + width], covered[:, MAP_SIDE + x : MAP_SIDE + x + width]
        texels_per_height = float(MAP_SIDE / self.area[2] * self.area[3])
        bgr = cv2.copyMakeBorder(
            _left_of_light(key, sky, texels_per_height, self._share),
            1,
            1,
            1,
            1,
            cv2.BORDER_REPLICATE,
        )
        texel = float(self.area[2]) / MAP_SIDE
        # One texel of margin on each side, so the picture starts one texel earlier.
        corner = self.area[:2] + texel * (np.array([x, z]) - 1)
        return TableImage(np.asarray(bgr, np.uint8), (float(corner[0]), float(corner[1])), texel)

    def texture(self) -> moderngl.Texture:
        """Return what is left of the light for other passes, BGR in the texels of `area`."""
        if self._texture is None:
            self._texture = self._context.texture((MAP_SIDE, MAP_SIDE), 3, alignment=1)
            self._texture.repeat_x = self._texture.repeat_y = False
        factors = self.factors().pixels
        x, z, _, _ = self._used_texels()
        bgr = np.full((MAP_SIDE + 2, MAP_SIDE + 2, 3), 255, np.uint8)
        bgr[z : z + factors.shape[0], x : x + factors.shape[1]] = factors
        self._texture.write(np.ascontiguousarray(bgr[1:-1, 1:-1]))
        return self._texture

    def _used_texels(self) -> tuple[int, int, int, int]:
        """Return the texels of a half that can have a shadow: first x and z, width and depth."""
        area_x, area_z, side, _ = self.area.tolist()
        left, near, right, far = self.extent.tolist()
        x, end_x = _texels((left - area_x) / side, (right - area_x) / side)
        z, end_z = _texels((near - area_z) / side, (far - area_z) / side)
        return x, z, end_x - x, end_z - z

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        for each in (self._target, self._covered, self._texture):
            if each is not None:
                each.release()


def _texels(low: float, high: float) -> tuple[int, int]:
    """Return the texels along a side of a map between two shares of it: the first, the end."""
    return max(math.floor(low * MAP_SIDE), 0), min(math.ceil(high * MAP_SIDE), MAP_SIDE)


def sky_extent(enclosing: Array, height: float) -> Array:
    """Return lowest x and z, highest x and z where a character takes light from all around [m]."""
    return _extent(enclosing, height, np.zeros(2))


def _extent(enclosing: Array, height: float, slope: Array) -> Array:
    """Return lowest x and z, highest x and z that a character's shadow can reach [m]."""
    # One row for each coordinate: numpy takes several times as long over short rows.
    above, below = np.maximum(enclosing[:, 1], 0.0), enclosing[:, [0, 2]].T
    share, ends = above / height, []
    for points, deviations in ((below, SKY_BLUR), (below - slope[:, None] * above, KEY_BLUR)):
        blur = np.interp(share, SHADOW_LEVELS, deviations)
        margin = height * np.minimum(BLUR_DEVIATIONS * blur, MAX_BLUR_MARGIN)
        ends.append(((points - margin).min(axis=1), (points + margin).max(axis=1)))
    (low, high), (key_low, key_high) = ends
    return np.concatenate([np.minimum(low, key_low), np.maximum(high, key_high)])


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


def _left_of_light(
    key: NDArray[np.uint8], sky: NDArray[np.uint8], texels_per_height: float, share: Array
) -> NDArray[np.uint8]:
    """Return what is left of all light, as factors of sRGB values, (rows, columns, 3) BGR.

    `key` and `sky` are what is covered at each level, along the key light and straight down, (rows,
    columns, levels); `share` (3,) is the share of the key light in the light on the table.
    """
    shade = _blurred_sum(key, texels_per_height, KEY_BLUR, (1.0,) * len(SHADOW_LEVELS))
    closed = _blurred_sum(sky, texels_per_height, SKY_BLUR, SKY_OCCLUSION)
    shade, closed = np.minimum(shade, 1.0), np.minimum(closed, MAX_SKY_OCCLUSION)
    left = cv2.merge(
        # 1 − share·shade − (1 − share)·closed; BGR, hence the shares in reverse.
        [cv2.addWeighted(shade, -each, closed, each - 1.0, 1.0) for each in share[::-1].tolist()]
    )
    return np.asarray(
        cv2.convertScaleAbs(cv2.pow(left, 1.0 / DISPLAY_GAMMA), alpha=255.0), np.uint8
    )


def _blurred_sum(
    covered: NDArray[np.uint8],
    texels_per_height: float,
    deviations: Sequence[float],
    weights: Sequence[float],
) -> NDArray[np.float32]:
    """Return the weighted sum of the levels, each with its own blur, (rows, columns) 0…1."""
    total: NDArray[np.float32] = np.zeros(covered.shape[:2], np.float32)
    # In an eighth of the time that `cv2.split` takes for a part of a map.
    levels = np.ascontiguousarray(covered.transpose(2, 0, 1))
    for level, deviation, weight in zip(levels, deviations, weights, strict=True):
        kernel = _gaussian_kernel(texels_per_height * deviation)
        # The weight is in one of the two kernels, which saves a pass over the map.
        weighted = np.float32(weight / 255.0) * kernel
        total += cv2.sepFilter2D(
            level, cv2.CV_32F, kernel, weighted, borderType=cv2.BORDER_REPLICATE
        )
    return total


@lru_cache(maxsize=64)
def _gaussian_kernel(deviation: float) -> NDArray[np.float32]:
    """Return a normalised kernel of at most `BLUR_TAPS` on each side, for a deviation [texels].

    Maps grow in steps, so that few deviations are asked for.
    """
    # With less, the kernel is a single tap, and edges alias to texels.
    deviation = max(deviation, 0.3)
    side = min(math.ceil(3.0 * deviation) + 1, BLUR_TAPS)
    kernel = np.exp(-0.5 * (np.arange(1 - side, side) / deviation) ** 2)
    return np.asarray(kernel / kernel.sum(), np.float32)
