"""The passes that draw a picture, for each quality."""

import moderngl

from cubeling.characters.rendering.deferred.blocker_map import BlockerMap
from cubeling.characters.rendering.passes.characters import CharacterPass
from cubeling.characters.rendering.passes.cube_occlusion import CubeOcclusionPass
from cubeling.characters.rendering.passes.cube_window import CubeWindowPass
from cubeling.characters.rendering.passes.deferred.composite import DeferredCompositePass
from cubeling.characters.rendering.passes.deferred.depth_of_field import DepthOfFieldPass
from cubeling.characters.rendering.passes.deferred.geometry import DeferredGeometryPass
from cubeling.characters.rendering.passes.deferred.lighting import DeferredLightingPass
from cubeling.characters.rendering.passes.deferred.occlusion import DeferredOcclusionPass
from cubeling.characters.rendering.passes.deferred.scattering import DeferredScatteringPass
from cubeling.characters.rendering.passes.deferred.soft_shadows import SoftShadowPass
from cubeling.characters.rendering.passes.deferred.visibility import DeferredVisibilityPass
from cubeling.characters.rendering.passes.floor_paths import FloorPathPass
from cubeling.characters.rendering.passes.hand_occlusion import HandOcclusionPass
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.passes.resolve import ResolvePass
from cubeling.characters.rendering.passes.shadows import ShadowPass
from cubeling.characters.rendering.programs import ShaderPrograms
from cubeling.characters.rendering.quality import Effect, Quality


def passes_for(
    quality: Quality, context: moderngl.Context, programs: ShaderPrograms
) -> list[RenderPass]:
    """Return new passes in the order in which they draw; the caller releases them."""
    blockers = BlockerMap(context) if Effect.SOFT_SHADOWS in quality.effects else None
    shadows = (
        ShadowPass(context, programs)
        if blockers is None
        else SoftShadowPass(context, programs, blockers)
    )
    shading: list[RenderPass] = [CharacterPass()]
    if quality.deferred:
        shading = _deferred_shading(quality.effects, context, programs, blockers)
    return [
        FloorPathPass(),
        shadows,
        CubeOcclusionPass(context, programs),
        CubeWindowPass(context, programs),
        *shading,
        HandOcclusionPass(context, programs),
        ResolvePass(),
    ]


def _deferred_shading(
    effects: frozenset[Effect],
    context: moderngl.Context,
    programs: ShaderPrograms,
    blockers: BlockerMap | None,
) -> list[RenderPass]:
    """Return the passes that light what is seen after all of it is drawn."""
    occlusion = visibility = None
    if Effect.AMBIENT_OCCLUSION in effects:
        occlusion = DeferredOcclusionPass(context, programs)
    if blockers is not None:
        visibility = DeferredVisibilityPass(context, programs, blockers)
    composite = DeferredCompositePass(context, programs)
    scattering = Effect.SKIN_SCATTERING in effects
    finding = [each for each in (occlusion, visibility) if each is not None]
    passes: list[RenderPass] = [DeferredGeometryPass(), *finding]
    passes.append(DeferredLightingPass(context, programs, visibility, occlusion, scattering))
    if scattering:
        adaptive = occlusion is not None
        passes.append(DeferredScatteringPass(context, programs, adaptive, blockers))
    if Effect.DEPTH_OF_FIELD in effects:
        return [*passes, DepthOfFieldPass(context, programs, composite)]
    return [*passes, composite]
