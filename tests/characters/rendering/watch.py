"""A pass that draws nothing: what others made of the last picture is read from it."""

from functools import cached_property
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.deferred.buffers import GeometryBuffer, LightBuffer
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources

Texels = NDArray[np.float64]


class WatchPass(RenderPass):
    """Keeps the frame of one picture, and gives the light of its characters.

    The light, each (height, width, 4), is read when it is first asked for: before another picture
    is drawn, and before the stage is released.
    """

    def forget(self) -> None:
        """Read the next picture, and forget the one before."""
        for name in [name for name in vars(self) if name not in ("frame", "_light", "_geometry")]:
            delattr(self, name)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Keep them."""
        self.frame = frame
        self._light: LightBuffer = layer.target.light
        self._geometry: GeometryBuffer = layer.target.geometry

    @cached_property
    def diffuse(self) -> Texels:
        """Diffuse light before it is scattered, and 1 where a character is seen."""
        return _texels(self._light.diffuse)

    @cached_property
    def scattered(self) -> Texels:
        """Diffuse light after it was scattered, and the share of all taps that it took."""
        return _texels(self._light.scattered)

    @cached_property
    def skin(self) -> NDArray[np.bool_]:
        """Where skin is, (height, width)."""
        return np.asarray(_texels(self._light.falling)[..., 3] > 0.5)

    @property
    def is_scattered(self) -> bool:
        """Whether light was scattered."""
        return self._light.is_scattered

    @cached_property
    def rest(self) -> Texels:
        """Highlights and light from all around, (height, width, 3)."""
        return (_texels(self._light.specular) + _texels(self._light.ambient))[..., :3]

    @cached_property
    def position(self) -> Texels:
        """Position in the camera frame [m], and a number, (height, width, 4)."""
        return _texels(self._geometry.position, np.float32)

    @cached_property
    def albedo(self) -> Texels:
        """Linear RGB of the surface, (height, width, 3)."""
        return _texels(self._geometry.albedo_rough)[..., :3]

    @cached_property
    def is_skin(self) -> NDArray[np.bool_]:
        """Where skin is, whatever became of its light, (height, width)."""
        seen = _texels(self._geometry.normal_id)[..., 3] > 0.5
        return np.asarray(seen & (_texels(self._geometry.shade_metal)[..., 0] > 0.5))


def _texels(texture: moderngl.Texture, kind: type = np.float16) -> Texels:
    rows: NDArray[Any] = np.frombuffer(texture.read(), kind)
    return rows.reshape(texture.height, texture.width, 4).astype(float)
