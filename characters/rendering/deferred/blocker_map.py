"""What stands between the lamp and the table, for shadows that are soft with distance."""

from collections.abc import Sequence

import moderngl

from cubeling.characters.rendering.deferred.lamp import Lamp
from cubeling.characters.rendering.geometry.character_cache import CharacterInstance
from cubeling.characters.rendering.geometry.surfaces import CASTER
from cubeling.characters.rendering.programs import set_uniforms
from cubeling.characters.skeleton.pose import Array

MAP_SIDE = 360
"""Texels along each side of the map."""

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
        self.texture = context.texture((MAP_SIDE, MAP_SIDE), 4, dtype="f4")
        """Distance of the nearest surface that blocks red, green and blue from the lamp [m], and
        where light first comes to a surface, see `entries.glsl`."""
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._target = context.framebuffer([self.texture])
        self._lamp: Lamp | None = None

    def render(self, characters: Sequence[CharacterInstance], lamp: Lamp) -> None:
        """Draw characters as a lamp sees them."""
        self._lamp = lamp
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
        texel = float((lamp.high - lamp.low).max()) / MAP_SIDE * lamp.furthest
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
