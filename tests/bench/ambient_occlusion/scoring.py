"""A scene with its ray-traced truth, and how far a picture of the occlusion is from it."""

from dataclasses import dataclass
from functools import cached_property

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.deferred.ambient_occlusion import (
    NOTHING_M,
    AmbientOcclusion,
    AmbientOcclusionSettings,
)
from cubeling.characters.rendering.programs import ShaderPrograms
from cubeling.characters.skeleton.pose import Array
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


def lab_difference(a: Floats, b: Floats) -> Floats:
    """Return ΔE76 of two grey pictures (h, w), whose values 0…1 are taken as sRGB.

    It is stricter than to take them as light: a grey of 0.8 then differs more from one of 0.9.
    """
    first, second = (
        cv2.cvtColor(np.repeat(each[..., None].astype(np.float32), 3, 2), cv2.COLOR_RGB2Lab)
        for each in (a, b)
    )
    return np.asarray(np.linalg.norm(first - second, axis=-1), np.float32)


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


class GBuffer:
    """The surfaces of a scene on the graphics card."""

    def __init__(
        self,
        context: moderngl.Context,
        surfaces: VisibleSurfaces,
        focal_px: float,
        depths: Floats | None = None,
    ):
        height, width = surfaces.seen.shape
        self.size = width, height
        """Width and height [px]."""
        self.focal_px = focal_px
        """Focal length [px]."""
        position = surfaces.position.copy()
        position[..., 3] = numbers_of_normals(surfaces.flat_normal)
        if depths is None:  # what is seen never ends
            depths = np.full(position.shape, NOTHING_M, np.float32)
            depths[surfaces.seen, 3] = position[surfaces.seen, 2]
        self.normal_id, self.position, self.depths = (
            context.texture(self.size, 4, each.tobytes(), dtype="f4")
            for each in (surfaces.normal_id, position, depths)
        )

    @classmethod
    def of(cls, context: moderngl.Context, traced: TracedScene) -> "GBuffer":
        """Upload what the camera sees of a scene."""
        focal = float(traced.scene.matrix(traced.size)[0, 0])
        return cls(context, traced.surfaces, focal, traced.depths)

    def occlusion(
        self, effect: AmbientOcclusion, ground: Array | None = None, stride: int = 1
    ) -> moderngl.Texture:
        """Draw the ambient occlusion that an effect finds; see `AmbientOcclusion.draw`."""
        textures = self.normal_id, self.position, self.depths
        return effect.draw(*textures, self.size, self.focal_px, ground, stride)

    def draw(
        self, effect: AmbientOcclusion, ground: Array | None = None, stride: int = 1
    ) -> Floats:
        """Return the ambient occlusion that an effect finds, (height, width)."""
        texture = self.occlusion(effect, ground, stride)
        values = np.frombuffer(texture.read(), np.float32).reshape(*texture.size[::-1], 2)
        return values[: self.size[1], : self.size[0], 0].copy()

    def release(self) -> None:
        """Release the textures."""
        for each in (self.normal_id, self.position, self.depths):
            each.release()


def numbers_of_normals(normals: Floats) -> Floats:
    """Return unit normals (…, 3), each packed in a number as `flat_normal.glsl` does it, (…)."""
    plane = normals[..., :2] / (1.0 - normals[..., 2:])
    cells = np.floor(1024.0 * np.clip(plane, -1.999, 1.999) + 2048.5)
    return np.asarray(4096.0 * cells[..., 0] + cells[..., 1], np.float32)


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
