"""Ambient occlusion of given surfaces, by any of the estimators: what tables are measured on."""

from typing import Protocol

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion import Array
from cubeling.characters.rendering import NOTHING_M, AmbientOcclusion

Floats = NDArray[np.float32]


class Surfaces(Protocol):
    """What a camera sees."""

    @property
    def normal_id(self) -> Floats:
        """Unit normals in the camera frame, and the number of the object, (height, width, 4)."""
        ...

    @property
    def position(self) -> Floats:
        """Places in the camera frame [m], and room for a number, (height, width, 4)."""
        ...

    @property
    def flat_normal(self) -> Floats:
        """Unit normals of the triangles, (height, width, 3)."""
        ...


class GBuffer:
    """The surfaces of a scene on the graphics card."""

    def __init__(
        self,
        context: moderngl.Context,
        surfaces: Surfaces,
        focal_px: float,
        depths: Floats | None = None,
    ):
        seen = surfaces.normal_id[..., 3] > 0.5
        height, width = seen.shape
        self.size = width, height
        """Width and height [px]."""
        self.focal_px = focal_px
        """Focal length [px]."""
        position = surfaces.position.copy()
        position[..., 3] = numbers_of_normals(surfaces.flat_normal)
        if depths is None:  # what is seen never ends
            depths = np.full(position.shape, NOTHING_M, np.float32)
            depths[seen, 3] = position[seen, 2]
        self.normal_id, self.position, self.depths = (
            context.texture(self.size, 4, each.tobytes(), dtype="f4")
            for each in (surfaces.normal_id, position, depths)
        )

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
        """Release its textures on the graphics card."""
        for each in (self.normal_id, self.position, self.depths):
            each.release()


def numbers_of_normals(normals: Floats) -> Floats:
    """Return unit normals (…, 3), each packed in a number as `flat_normal.glsl` does it, (…)."""
    plane = normals[..., :2] / (1.0 - normals[..., 2:])
    cells = np.floor(1024.0 * np.clip(plane, -1.999, 1.999) + 2048.5)
    return np.asarray(4096.0 * cells[..., 0] + cells[..., 1], np.float32)


def lab_difference(a: Floats, b: Floats) -> Floats:
    """Return ΔE76 of two grey pictures (h, w), whose values 0…1 are taken as sRGB.

    It is stricter than to take them as light: a grey of 0.8 then differs more from one of 0.9.
    """
    first, second = (
        cv2.cvtColor(np.repeat(each[..., None].astype(np.float32), 3, 2), cv2.COLOR_RGB2Lab)
        for each in (a, b)
    )
    return np.asarray(np.linalg.norm(first - second, axis=-1), np.float32)
