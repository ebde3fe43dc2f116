"""Shadows of a lamp of some size: sharp where feet touch the table, soft where hands are high."""

from collections.abc import Sequence

import moderngl
import numpy as np

from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.deferred.blocker_map import TABLE_RANGE_TEXELS, BlockerMap
from cubeling.characters.rendering.deferred.lamp import Lamp
from cubeling.characters.rendering.passes.shadows import ShadowPass, key_share, sky_extent
from cubeling.characters.rendering.passes.table_image import TableImage
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import FrameResources
from cubeling.characters.rendering.target import read_bytes
from cubeling.characters.skeleton.pose import Array

TABLE_SIDE = 192
"""Texels along each side of the square of the table whose light is found."""

LEFT_UNIT, OPENNESS_UNIT = 0, 1
"""Texture units of the light on the table before it is smooth, and of the light from all around."""


class SoftShadowPass(ShadowPass):
    """Darkens the table by what the characters take from the lamp, and from the light around.

    The light around is that of `ShadowPass`. The blockers in the map are those of all characters
    together; passes that shade the characters may ask the map too.
    """

    def __init__(
        self, context: moderngl.Context, programs: ShaderPrograms, blockers: BlockerMap
    ) -> None:
        super().__init__(context, programs)
        self._blockers = blockers
        self._find, self._combine = (
            context.vertex_array(programs.load("full_screen", name), [])
            for name in ("table_shadow", "table_factor")
        )
        side = TABLE_SIDE, TABLE_SIDE
        self._openness = context.texture(side, 1)
        self.left = context.texture(side, 4, dtype="f2")
        """Share of the key light that is left in each texel of the square, linear RGB, and of the
        light from all around. Means of 4 × 4 texels are smooth."""
        self._factors = context.texture(side, 4)
        textures = (self._openness, self.left, self._factors)
        for texture in textures:
            texture.repeat_x = texture.repeat_y = False
        self._targets = [context.framebuffer([texture]) for texture in textures]
        self._table = context.vertex_array(programs.load("shadow", "shadow"), [])
        arrays = (self._table, self._find, self._combine)
        self.owned = (*arrays, *self._targets, *textures, blockers)
        self._extent = np.zeros(4)

    def prepare(self, frame: FrameResources) -> None:
        """Find the light that is left on the table."""
        super().prepare(frame)
        if not self._count:
            self._block_nothing(frame)
            return
        casters = np.concatenate([each.enclosing for each in frame.on_table])
        lamp = Lamp.over(casters, frame.light.to_light)
        self._blockers.render(frame.on_table, lamp, frame.pixel_m)
        around = [sky_extent(each.enclosing, each.height) for each in frame.on_table]
        self._extent = _unite([lamp.shadow(casters), *around])
        self._find_openness()
        self._find_left(key_share(frame.light))

    def _block_nothing(self, frame: FrameResources) -> None:
        """Empty the map of blockers, if some characters that are not on the table ask for it."""
        points = frame.points_on_layer
        if len(points):
            lamp = Lamp.over(points, frame.light.to_light)
            self._blockers.render(frame.on_table, lamp, frame.pixel_m)

    def _key_share(self, light: Light) -> Array:
        """Return zero: the maps of `ShadowPass` hold the light from all around alone."""
        return np.zeros(3)

    def _table_factors(self) -> list[TableImage]:
        """Return the light that all characters leave together."""
        x, z, side = self.square
        texel = side / TABLE_SIDE
        width, depth = np.ceil((self._extent[2:] - [x, z]) / texel).astype(int).tolist()
        factors = read_bytes(self._targets[2], (0, 0, width, depth), 3)
        return [TableImage(factors, (x, z), texel)]

    @property
    def square(self) -> tuple[float, float, float]:
        """Lowest x and z of the square of the table, and its side [m]."""
        x, z = self._extent[:2].tolist()
        return x, z, float((self._extent[2:] - self._extent[:2]).max())

    def _find_openness(self) -> None:
        """Multiply what the characters leave of the light from all around, in each texel."""
        self._targets[0].use()
        self._targets[0].clear(1.0, 1.0, 1.0, 1.0)
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        x, z, side = self.square
        square = np.zeros((4, 4))
        square[0, [0, 3]] = 2.0 / side, -2.0 * x / side - 1.0
        square[1, [2, 3]] = 2.0 / side, -2.0 * z / side - 1.0
        square[3, 3] = 1.0
        set_uniforms(self._table.program, clip_from_table=square)
        for shadow in self._maps[: self._count]:
            set_uniforms(self._table.program, area=shadow.area, extent=shadow.extent)
            shadow.texture().use(0)
            self._table.render(moderngl.TRIANGLE_STRIP, vertices=4)

    def _find_left(self, share: Array) -> None:
        """Find the light that is left in each texel of the square; see `key_share` for `share`."""
        self._context.enable_only(moderngl.NOTHING)
        self._targets[1].use()
        set_uniforms(
            self._find.program,
            area=self.square,
            side=float(TABLE_SIDE),
            openness=OPENNESS_UNIT,
        )
        self._openness.use(OPENNESS_UNIT)
        self._blockers.set_uniforms(self._find.program, np.eye(4), TABLE_RANGE_TEXELS)
        self._find.render(moderngl.TRIANGLES, vertices=3)
        self._targets[2].use()
        self.left.use(LEFT_UNIT)
        set_uniforms(self._combine.program, left=LEFT_UNIT, key=share)
        self._combine.render(moderngl.TRIANGLES, vertices=3)


def _unite(extents: Sequence[Array]) -> Array:
    """Return lowest x and z, highest x and z of several extents (4,)."""
    rows = np.stack(extents)
    return np.concatenate([rows[:, :2].min(axis=0), rows[:, 2:].max(axis=0)])
