"""The passes that draw a picture, for each quality."""

import moderngl

from characters.rendering.blocker_map import BlockerMap
from characters.rendering.passes.background import BackgroundPass
from characters.rendering.passes.characters import CharacterPass
from characters.rendering.passes.cube_occlusion import CubeOcclusionPass
from characters.rendering.passes.deferred_composite import DeferredCompositePass
from characters.rendering.passes.deferred_geometry import DeferredGeometryPass
from characters.rendering.passes.deferred_lighting import DeferredLightingPass
from characters.rendering.passes.floor_paths import FloorPathPass
from characters.rendering.passes.hand_occlusion import HandOcclusionPass
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.passes.resolve import ResolvePass
from characters.rendering.passes.shadows import ShadowPass
from characters.rendering.passes.soft_shadows import SoftShadowPass
from characters.rendering.programs import ShaderPrograms
from characters.rendering.quality import Effect, Quality


def passes_for(
    quality: Quality, context: moderngl.Context, programs: ShaderPrograms
) -> list[RenderPass]:
    """Return new passes in the order in which they draw; the caller releases them."""
    blockers = BlockerMap(context) if Effect.SOFT_SHADOWS in quality.effects else None
    shading: list[RenderPass] = [CharacterPass()]
    if quality.deferred:
        shading = [
            DeferredGeometryPass(),
            DeferredLightingPass(context, programs, blockers),
            DeferredCompositePass(context, programs),
        ]
    return [
        BackgroundPass(),
        FloorPathPass(context, programs),
        SoftShadowPass(context, programs, blockers) if blockers else ShadowPass(context, programs),
        CubeOcclusionPass(context, programs),
        *shading,
        HandOcclusionPass(context, programs),
        ResolvePass(context, programs),
    ]
