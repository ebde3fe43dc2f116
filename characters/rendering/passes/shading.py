"""The passes that draw the characters on their layer, for each way to shade them."""

import moderngl

from characters.rendering.passes.characters import CharacterPass
from characters.rendering.passes.deferred_composite import DeferredCompositePass
from characters.rendering.passes.deferred_geometry import DeferredGeometryPass
from characters.rendering.passes.deferred_lighting import DeferredLightingPass
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms
from characters.rendering.quality import Quality


def shading_passes(
    quality: Quality, context: moderngl.Context, programs: ShaderPrograms
) -> list[RenderPass]:
    """Return new passes that draw the characters, in their order; the caller releases them."""
    if not quality.deferred:
        return [CharacterPass()]
    return [
        DeferredGeometryPass(),
        DeferredLightingPass(context, programs),
        DeferredCompositePass(context, programs),
    ]
