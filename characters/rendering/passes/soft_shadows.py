"""Shadows of a lamp of some size: sharp where feet touch the table, soft where hands are high."""

from collections.abc import Sequence

import moderngl
import numpy as np

from characters.rendering.blocker_map import BlockerMap
from characters.rendering.lamp import Lamp
from characters.rendering.light import Light
from characters.rendering.passes.shadows import ShadowPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.projection import Rectangle
from characters.rendering.resources import FrameResources, Region
from characters.skeleton.pose import Array

TABLE_SIDE = 256
"""Texels along each side of the square of the table whose light is found."""

LEFT_UNIT, OPENNESS_UNIT = 0, 1
"""Texture units of the key light on the table, and of the light from all around."""


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
        self._find, self._smooth = (
            context.vertex_array(programs.load("full_screen", name), [])
            for name in ("table_shadow", "tile_mean")
        )
        self._soft_tables = [
            context.vertex_array(programs.load("shadow", "soft_table", *defines), [])
            for defines in ((), ("COVERED",))
        ]
        self._left = [context.texture((TABLE_SIDE, TABLE_SIDE), 4) for _ in range(2)]
        for texture in self._left:
            texture.repeat_x = texture.repeat_y = False
        self._targets = [context.framebuffer([texture]) for texture in self._left]
        arrays = (*self._tables, *self._soft_tables, self._find, self._smooth)
        self.owned = (*arrays, *self._targets, *self._left, blockers)
        self._extent = np.zeros(4)

    def prepare(self, frame: FrameResources) -> Sequence[Rectangle]:
        """Find the light that is left on the table, and return the area that it changes."""
        super().prepare(frame)
        if not self._count:
            return ()
        casters = np.concatenate([each.enclosing for each in frame.characters])
        lamp = Lamp.over(casters, frame.light.to_light)
        self._blockers.render(frame, lamp)
        extent = _united([shadow.extent for shadow in self._maps[: self._count]])
        spread = lamp.spread(_corners(extent))
        self._extent = extent + [-spread, -spread, spread, spread]
        self._find_left()
        self._area = frame.area_of(np.concatenate([casters, _corners(self._extent)]))
        return () if self._area is None else (self._area,)

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Darken the table, except where real cubes or a hand hide it."""
        if self._area is None or not self._area.intersection(region.area):
            return
        region.target.use_openness(region.area.width, region.area.height).clear(1.0, 1.0, 1.0, 1.0)
        self._darken(frame, region)
        region.use()
        table = self._soft_tables[region.cover is not None]
        region.set_table_uniforms(table.program)
        set_uniforms(
            table.program,
            area=(*self.square, 1.0),
            extent=self._extent,
            key=super()._key_share(frame.light),
            left=LEFT_UNIT,
            openness=OPENNESS_UNIT,
        )
        self.left.use(LEFT_UNIT)
        region.target.openness_texture.use(OPENNESS_UNIT)
        table.render(moderngl.TRIANGLE_STRIP, vertices=4)

    def _key_share(self, light: Light) -> Array:
        """Return zero: the maps of `ShadowPass` hold the light from all around alone."""
        return np.zeros(3)

    @property
    def left(self) -> moderngl.Texture:
        """Key light that is left in each texel of the square, linear RGB."""
        return self._left[1]

    @property
    def square(self) -> tuple[float, float, float]:
        """Lowest x and z of the square of the table, and its side [m]."""
        x, z = self._extent[:2].tolist()
        return x, z, float((self._extent[2:] - self._extent[:2]).max())

    def _find_left(self) -> None:
        """Find the light that is left in each texel of the square."""
        context = self._context
        context.enable_only(moderngl.NOTHING)
        self._targets[0].use()
        set_uniforms(self._find.program, area=self.square, side=float(TABLE_SIDE))
        self._blockers.set_uniforms(self._find.program, np.eye(4), bias=0.5)
        self._find.render(moderngl.TRIANGLES, vertices=3)
        self._targets[1].use()
        self._left[0].use(0)
        set_uniforms(self._smooth.program, source=0)
        self._smooth.render(moderngl.TRIANGLES, vertices=3)


def _united(extents: Sequence[Array]) -> Array:
    """Return lowest x and z, highest x and z of several extents (4,)."""
    rows = np.stack(extents)
    return np.concatenate([rows[:, :2].min(axis=0), rows[:, 2:].max(axis=0)])


def _corners(extent: Array) -> Array:
    """Return the corners (4, 3) of an extent on the table."""
    x, z = extent[[0, 2, 2, 0]], extent[[1, 1, 3, 3]]
    return np.stack([x, np.zeros(4), z], axis=1)
