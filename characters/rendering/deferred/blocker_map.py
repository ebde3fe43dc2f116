"""What stands between the lamp and the table, for shadows that are soft with distance."""

from collections.abc import Sequence

import moderngl

from cubeling.characters.rendering.deferred.lamp import Lamp
from cubeling.characters.rendering.geometry.character_cache import CharacterInstance
from cubeling.characters.rendering.geometry.surfaces import CASTER
from cubeling.characters.rendering.programs import set_uniforms
from cubeling.characters.skeleton.pose import Array

MAP_SIDE, CLOSE_UP_SIDE = 360, 720
"""Texels along each side of the map, and close up: where one texel would be wider in the picture
than `CLOSE_UP_PX`."""

CLOSE_UP_PX = 2.0

BLOCKER_UNIT = 9
"""Texture unit of the map."""

FREE_M = 1e3
"""Distance in the map where nothing blocks the light [m]."""

NO_ENTRY = 1e9
"""What the map says where light comes to no surface, see `entries.glsl`."""

CHARACTER_RANGE_TEXELS = (3.0, 6.0)
"""Distances behind a surface from which on it shadows a character, and shadows it completely, in
texels of the map: less is rounding, as the map has one distance for a whole texel."""

SURFACE_RANGE_TEXELS = (1.0, 2.0)
"""Heights above a triangle at which an opaque surface begins to shadow it, and does so completely,
in texels: both are known where the texel has its distance, so that there is little rounding."""

TABLE_RANGE_TEXELS = (-4.0, -3.0)
"""The same for the table, which is in no map: soles shadow it that sink into it a little."""


class BlockerMap:
    """A shadow map of all characters, seen from the lamp, with a distance for each colour.

    Glass and gauze block some of the light of each colour: they are in the map in a share of the
    texels, another one for red, green and blue (M. McGuire and E. Enderton, "Colored stochastic
    shadow maps", 2011; the masks are those of screen-door transparency).
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._lamp: Lamp | None = None
        self._allocate(MAP_SIDE)

    def _allocate(self, side: int) -> None:
        self.texture = self._context.texture((side, side), 4, dtype="f4")
        """Distance of the nearest surface that blocks red, green and blue from the lamp [m], and
        where light first comes to a surface, see `entries.glsl`."""
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._target = self._context.framebuffer([self.texture])

    def render(self, characters: Sequence[CharacterInstance], lamp: Lamp, pixel_m: float) -> None:
        """Draw characters as a lamp sees them, for a picture with pixels of some size [m]."""
        self._lamp = lamp
        side = MAP_SIDE if _texel_m(lamp) < CLOSE_UP_PX * pixel_m else CLOSE_UP_SIDE
        if side != self.texture.width:
            self.release()
            self._allocate(side)
        context = self._context
        self._target.use()
        self._target.clear(FREE_M, FREE_M, FREE_M, NO_ENTRY)
        context.enable_only(moderngl.BLEND)
        context.blend_equation = moderngl.MIN, moderngl.MIN
        context.front_face = "cw"
        for character in characters:
            character.skinned.render(
                context,
                frozenset([CASTER]),
                clip_from_table=lamp.clip_from_table,
                lamp_axis=lamp.lamp_from_table[2],
            )
        context.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        context.front_face = "ccw"

    def set_uniforms(
        self,
        program: moderngl.Program,
        table_from_point: Array,
        range_texels: tuple[float, float],
    ) -> None:
        """Bind the map, and set the uniforms of a program that asks which light is left.

        `table_from_point` (4, 4) is the frame in which the program has its points. `range_texels`
        is one of the ranges above.
        """
        assert self._lamp is not None
        lamp = self._lamp
        texel = _texel_m(lamp)  # close up, no finer ranges: pieces of skin overlap by as much
        self.texture.use(BLOCKER_UNIT)
        set_uniforms(
            program,
            blockers=BLOCKER_UNIT,
            lamp_from_point=lamp.lamp_from_table @ table_from_point,
            lamp_area=(*lamp.low.tolist(), *(1.0 / (lamp.high - lamp.low)).tolist()),
            lamp_width=lamp.width,
            nearest_blocker=lamp.nearest,
            shadow_range=[each * texel for each in range_texels],
            surface_range=[each * texel for each in SURFACE_RANGE_TEXELS],
        )

    def release(self) -> None:
        """Release the map; a second call does nothing."""
        self._target.release()
        self.texture.release()


def _texel_m(lamp: Lamp) -> float:
    """Return the size of a texel of a map of `MAP_SIDE` on what is furthest from a lamp [m]."""
    return float((lamp.high - lamp.low).max()) / MAP_SIDE * lamp.furthest
