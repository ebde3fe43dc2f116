"""Light that spreads below the skin of the characters before it leaves again."""

import moderngl
import numpy as np

from cubeling.characters.rendering.deferred.blocker_map import CHARACTER_RANGE_TEXELS, BlockerMap
from cubeling.characters.rendering.deferred.buffers import buffer_triangle
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources

LEVEL_RADII_M = (0.00121, 0.00437, 0.01328)
"""Radii of the levels in human skin [m]. What walks through the skin of an arm find at a distance
(`tools/ray_tracing/subsurface.py`; Jensen et al., "A practical model for subsurface light
transport", 2001, skin 1), as a sum of three Wendland functions, to 0.8 % of the light."""

LEVEL_SHARES = ((0.210, 0.384, 0.577), (0.415, 0.458, 0.258), (0.324, 0.065, 0.0))
"""Share of each level in red, green and blue light, from the same fit."""

UNSCATTERED = tuple(1.0 - sum(shares) for shares in zip(*LEVEL_SHARES, strict=True))
"""Share of the light that leaves where it enters."""

THIN_SHARE = (1.18, 2.15, 3.58)
THROUGH_LENGTHS_M = (0.00346, 0.00145, 0.00077)
"""Light that comes through a layer of this skin: it falls with the way as an exponential function,
of the light that flat skin would reflect."""

OPEN_LIMITS = (0.5, 0.7)
"""Open shares of the light from all around in a fold, and on open skin."""

BEND_LIMITS, PROBE_REACH = (0.016, 0.042), 0.4
"""How far the mean of two opposite points within this share of the widest level differs from the
light between them on open skin, as a share of the key light, from which on it is filtered, and
completely; in folds, less is enough."""

MIN_REACH_TEXELS = 1.0
"""Levels that reach less far are not seen: the light is left as it is."""


class DeferredScatteringPass(RenderPass):
    """Scatters the diffuse light of skin; if `adaptive`, only in folds and where light bends.

    The adaptive form needs ambient occlusion, which is part of the ambient light. `blockers` knows
    where light comes in behind ears and fingers; None: it does not come through.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        adaptive: bool,
        blockers: BlockerMap | None,
    ) -> None:
        self._blockers = blockers
        features = [*["ADAPTIVE"] * adaptive, *["THROUGH"] * (blockers is not None)]
        self._triangle = buffer_triangle(context, programs, "deferred_scattering", *features)
        self.owned = (self._triangle,)
        set_uniforms(
            self._triangle.program,
            level_radius=LEVEL_RADII_M,
            unscattered=UNSCATTERED,
            level_share=np.array(LEVEL_SHARES),
            open_limits=OPEN_LIMITS,
            bend_limits=BEND_LIMITS,
            probe_reach=PROBE_REACH,
            thin_share=THIN_SHARE,
            through_length=THROUGH_LENGTHS_M,
        )

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Replace the diffuse light of skin by what is scattered."""
        if self._reach(frame) * layer.target.fineness < MIN_REACH_TEXELS:
            return
        layer.use_scattered()
        frame.context.enable_only(moderngl.NOTHING)
        target = layer.target
        target.geometry.bind()
        target.light.bind()
        set_uniforms(
            self._triangle.program,
            focal=float(target.fineness * frame.camera_matrix[1, 1]),
            key=frame.light.key,
            to_light=frame.camera_from_table[:3, :3] @ frame.light.to_light,
        )
        if self._blockers is not None:
            table_from_camera = np.asarray(np.linalg.inv(frame.camera_from_table), float)
            self._blockers.set_uniforms(
                self._triangle.program, table_from_camera, CHARACTER_RANGE_TEXELS
            )
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
        target.light.is_scattered = True

    def _reach(self, frame: FrameResources) -> float:
        """Return how far light spreads in the skin that is nearest to the camera [px]."""
        reaches = [0.0]
        for character in frame.characters:
            nearest, _ = frame.depths_of(character)
            scattering = max(each.material.scattering for each in character.skinned.surfaces)
            scale = character.height / character.skinned.geometry.height
            reaches.append(scale * scattering * LEVEL_RADII_M[-1] / nearest)
        return max(reaches) * float(frame.camera_matrix[1, 1])
