"""A scene with its ray-traced truth, and how far a picture of the occlusion is from it."""

from dataclasses import dataclass
from functools import cached_property

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.app.workshop.reproduction.bodies.occlusion_buffer import GBuffer, lab_difference
from cubeling.characters.rendering.deferred.ambient_occlusion import (
    AmbientOcclusion,
    AmbientOcclusionSettings,
)
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.bench.ambient_occlusion.scenes import Scene
from tools.ray_tracing import (
    RayTracer,
    VisibleSurfaces,
    ambient_occlusion,
    trace_camera,
    trace_depth_layers,
)

Floats = NDArray[np.float32]

THESIS = AmbientOcclusionSettings(pattern_size=4, blur_size=4)
"""With the tile and the blur of Huang 2013, for figures beside the thesis'."""


@dataclass(frozen=True)
class Score:
    """How far two pictures of ambient occlusion are apart, over the pixels of surfaces."""

    rmse: float
    """Root of the mean squared difference, of values 0…1."""

    correlation: float
    """Pearson's; nan if one of them is even."""

    delta_e: float
    """Mean ΔE76 of the pictures in grey."""

    delta_e_95: float
    """95th percentile of it."""


def score(found: Floats, truth: Floats, pixels: NDArray[np.bool_]) -> Score:
    """Compare a picture (h, w) with the truth over some pixels (h, w)."""
    a, b = found[pixels].astype(float), truth[pixels].astype(float)
    difference = lab_difference(found, truth)[pixels]
    even = min(a.std(), b.std()) < 1e-6
    return Score(
        float(np.sqrt(np.mean((a - b) ** 2))),
        np.nan if even else float(np.corrcoef(a, b)[0, 1]),
        float(difference.mean()),
        float(np.percentile(difference, 95)),
    )


def gain_between(found: Floats, target: Floats, pixels: NDArray[np.bool_]) -> float:
    """Return the factor of the occlusion that brings a picture closest to another."""
    a, b = (1.0 - each[pixels].astype(float) for each in (found, target))
    return float(a @ b) / max(float(a @ a), 1e-12)


@dataclass(frozen=True)
class TracedScene:
    """A scene with its G-buffer and its true ambient occlusion; both by the same rays."""

    scene: Scene
    """The scene."""

    size: tuple[int, int]
    """Of the picture [px]."""

    rays: int
    """For each pixel."""

    @cached_property
    def tracer(self) -> RayTracer:
        """Of its mesh."""
        return RayTracer(self.scene.mesh)

    @cached_property
    def surfaces(self) -> VisibleSurfaces:
        """What the camera sees."""
        return trace_camera(self.tracer, self.scene.matrix(self.size), self.size)

    @cached_property
    def depths(self) -> Floats:
        """Where that begins and ends, and what is behind; see `trace_depth_layers`."""
        return trace_depth_layers(self.tracer, self.scene.matrix(self.size), self.size)

    @cached_property
    def truth(self) -> Floats:
        """Ambient occlusion by rays, (height, width)."""
        return self.trace(0)

    def trace(self, seed: int) -> Floats:
        """Return the truth with other random numbers: their difference is its noise."""
        return ambient_occlusion(self.tracer, self.surfaces, self.scene.radius_m, self.rays, seed)


def buffer_of(context: moderngl.Context, traced: TracedScene) -> GBuffer:
    """Upload what the camera sees of a scene."""
    focal = float(traced.scene.matrix(traced.size)[0, 0])
    return GBuffer(context, traced.surfaces, focal, traced.depths)


def drawn(
    context: moderngl.Context,
    programs: ShaderPrograms,
    buffer: GBuffer,
    settings: AmbientOcclusionSettings,
) -> Floats:
    """Return the ambient occlusion of a G-buffer with some settings, (height, width)."""
    effect = AmbientOcclusion(context, programs, settings)
    try:
        return buffer.draw(effect)
    finally:
        effect.release()
