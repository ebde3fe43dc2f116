"""The face of one character on the graphics card: its wrinkle layers composed into one texture.

The twelve layers are composed on the processor, as morphs are, because few are active at once and
each covers a small part of the face: a pixel then costs one texture fetch, whatever the number of
layers. Huang, *3D emotional rendering and animation models*, 2013, section 4.3, adds them in the
shader. But skin folds once: where two furrows cross or meet, it is hardly deeper than the deeper of
them, so that their heights are put together by a norm (`CROSSING_POWER`), not as a sum.
"""

from functools import reduce

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.face.action_units import ActionUnits, layer_intensities
from cubeling.characters.face.complexion import added_density
from cubeling.characters.model.mesh import FaceMaps
from cubeling.characters.rendering.projection import Rectangle
from cubeling.characters.skeleton.pose import Array

INTENSITY_STEPS = 64
"""Steps of a layer's intensity, too small to be seen: layers are composed again for whole ones."""

WRINKLE_DEPTHS_PX = 0.85, 1.15
"""Depths of wrinkles in the picture from which on they are seen at all, and as they are [px]:
smaller ones are narrower than a pixel, and would flicker."""

CROSSING_POWER = 4
"""Power p of the norm (Σ hᵖ)^(1/p) of furrows, and of bulges: two alike make one that is deeper by
a fifth."""

SMOOTHING_TEXELS = 0.8
"""Standard deviation of the blur that takes the steps of 8 bits out of a height [texels]."""


class WrinkleMixer:
    """Composes the wrinkle layers of a face: the slopes of intensity × height, see above."""

    def __init__(self, maps: FaceMaps) -> None:
        height, width = maps.blood.shape
        self._layers: list[tuple[int, Rectangle, NDArray[np.float32]]] = []
        for number, layer in enumerate(maps.heights):
            area = painted_area(layer)
            if area is not None:
                self._layers.append((number, area, _surface(layer, area)))
        self.texels = np.zeros((height, width, 4), np.float32)
        """Slope along u and v [heights of 1 per unit of u, v], blood 0…1, 0: (height, width, 4)."""
        self.texels[..., 2] = maps.blood
        self._shown = np.zeros(len(maps.heights))

    def compose(self, intensities: Array) -> Rectangle | None:
        """Set the slopes for intensities of all layers, (12,); return which texels may change."""
        wanted = np.rint(intensities * INTENSITY_STEPS) / INTENSITY_STEPS
        changed = wanted != self._shown
        areas = [area for number, area, _ in self._layers if changed[number]]
        self._shown = wanted
        if not areas:
            return None
        all_changed = reduce(Rectangle.union, areas)
        total = np.zeros((2, all_changed.height, all_changed.width), np.float32)
        slopes = np.zeros((*total.shape, 2), np.float32)
        for number, area, surface in self._layers:
            shared = area.intersection(all_changed) if wanted[number] > 0.0 else None
            if shared is None:
                continue
            part = np.float32(wanted[number]) * surface[shared.within(area).slices]
            for sign, (rows, columns) in enumerate([shared.within(all_changed).slices] * 2):
                size = np.maximum(part[..., 0] * np.float32(1 - 2 * sign), np.float32(0))
                weight = size ** (CROSSING_POWER - 1)
                total[sign, rows, columns] += size * weight
                slopes[sign, rows, columns] += weight[..., None] * part[..., 1:]
        norm = np.maximum(total, np.float32(1e-20)) ** (1.0 - 1.0 / CROSSING_POWER)
        self.texels[all_changed.slices][..., :2] = (slopes / norm[..., None]).sum(axis=0)
        return all_changed

    @property
    def active(self) -> bool:
        """Whether any layer is visible."""
        return bool(self._shown.any())


class FaceTexture:
    """What wrinkles and blood of one character are drawn with."""

    def __init__(self, context: moderngl.Context, maps: FaceMaps, units: ActionUnits) -> None:
        self._mixer, self._units, self._depth = WrinkleMixer(maps), units, maps.depth
        self._depth_on_table = 0.0
        self._blood = 0.0
        height, width = maps.blood.shape
        self.texture = context.texture((width, height), 4, self._mixer.texels, dtype="f4")
        """Slopes and blood: see `WrinkleMixer.texels`."""
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False  # what is beyond the map has no paint

    def update(self, morphs: Array | None, blood: float, scale: float, pixel: float) -> bool:
        """Set the face to morph weights (morphs,) and blood, -1…1; return whether it is visible.

        `scale` is metres of the table per metre of the character; `pixel` is the size of a pixel
        of the picture [m in the character frame]: where it is large, the skin stays smooth.
        """
        share = float(np.interp(self._depth, np.multiply(WRINKLE_DEPTHS_PX, pixel), (0.0, 1.0)))
        self._blood, self._depth_on_table = blood, scale * share * self._depth
        if share > 0.0 or self._mixer.active:
            units = self._units.intensities(morphs if share > 0.0 else None)
            area = self._mixer.compose(layer_intensities(units))
            if area is not None:
                texels = np.ascontiguousarray(self._mixer.texels[area.slices])
                self.texture.write(texels, (area.x, area.y, area.width, area.height))
        return self._mixer.active or blood != 0.0

    @property
    def uniforms(self) -> dict[str, float | tuple[float, ...]]:
        """Values of the uniforms of `face.glsl`."""
        return {
            "wrinkle_depth": self._depth_on_table,
            "blood_density": added_density(self._blood),
        }

    def release(self) -> None:
        """Release the texture; a second call does nothing."""
        self.texture.release()


def painted_area(values: NDArray[np.float32], margin: int = 3) -> Rectangle | None:
    """Return the area in which an image (height, width) is not zero, with a margin."""
    x, y, width, height = cv2.boundingRect((values != 0.0).view(np.uint8))
    whole = Rectangle(0, 0, values.shape[1], values.shape[0])
    wide = Rectangle(x - margin, y - margin, width + 2 * margin, height + 2 * margin)
    return wide.intersection(whole) if width else None


def _surface(layer: NDArray[np.float32], area: Rectangle) -> NDArray[np.float32]:
    """Return a height and its slopes along u and v in an area, (rows, columns, 3)."""
    height, width = layer.shape
    smooth = cv2.GaussianBlur(layer, (0, 0), SMOOTHING_TEXELS)
    down, along = np.gradient(smooth)
    parts = smooth[area.slices], along[area.slices] * width, down[area.slices] * height
    return np.stack(parts, axis=-1).astype(np.float32)
