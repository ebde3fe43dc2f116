"""The face of one character on the graphics card: its wrinkle layers composed into one texture.

The twelve layers are added on the processor, as morphs are, because few are active at once and each
covers a small part of the face: a pixel then costs one texture fetch, whatever the number of
layers. Huang, *3D emotional rendering and animation models*, 2013, section 4.3, adds them in the
shader.
"""

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.face.action_units import ActionUnits, layer_intensities
from characters.face.complexion import added_density
from characters.model.mesh import FaceMaps
from characters.skeleton.pose import Array

MIN_INTENSITY = 1e-3
"""A layer of a lower intensity is not drawn."""

WRINKLE_DEPTHS_PX = 0.85, 1.15
"""Depths of wrinkles in the picture from which on they are seen at all, and as they are [px]:
smaller ones are narrower than a pixel, and would flicker."""

SMOOTHING_TEXELS = 0.8
"""Standard deviation of the blur that takes the steps of 8 bits out of a height [texels]."""

Box = tuple[slice, slice]


class WrinkleMixer:
    """Composes the wrinkle layers of a face: the sum of intensity × height, as its slopes."""

    def __init__(self, maps: FaceMaps) -> None:
        height, width = maps.blood.shape
        self._layers: list[tuple[int, Box, NDArray[np.float32]]] = []
        for number, layer in enumerate(maps.heights):
            box = painted_box(layer)
            if box is not None:
                self._layers.append((number, box, _slopes(layer, box)))
        self.box: Box = _enclosing([box for _, box, _ in self._layers])
        """The texels that layers may change."""
        self.texels = np.zeros((height, width, 4), np.float32)
        """Slope along u and v [heights of 1 per unit of u, v], blood 0…1, 0: (height, width, 4)."""
        self.texels[..., 2] = maps.blood
        self._sum = np.zeros_like(
            self.texels[self.box][..., :2]
        )  # contiguous: it is added to often
        self._shown = np.zeros(len(maps.heights))

    def compose(self, intensities: Array) -> bool:
        """Set the slopes for intensities of all layers, (12,); return whether they changed."""
        wanted = np.where(intensities < MIN_INTENSITY, 0.0, intensities)
        if np.array_equal(wanted, self._shown):
            return False
        self._shown = wanted
        self._sum[:] = 0.0
        top, left = self.box[0].start, self.box[1].start
        for number, (rows, columns), slopes in self._layers:
            if wanted[number] > 0.0:
                part = self._sum[
                    rows.start - top : rows.stop - top, columns.start - left : columns.stop - left
                ]
                part += np.float32(wanted[number]) * slopes
        self.texels[self.box][..., :2] = self._sum
        return True

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
        units = self._units.intensities(morphs if share > 0.0 else None)
        self._blood, self._depth_on_table = blood, scale * share * self._depth
        if self._mixer.compose(layer_intensities(units)):
            rows, columns = self._mixer.box
            viewport = (
                columns.start,
                rows.start,
                columns.stop - columns.start,
                rows.stop - rows.start,
            )
            self.texture.write(np.ascontiguousarray(self._mixer.texels[rows, columns]), viewport)
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


def painted_box(values: NDArray[np.float32], margin: int = 3) -> Box | None:
    """Return the rows and columns in which an image (height, width) is not zero, with a margin."""
    spans = []
    for axis, size in zip((1, 0), values.shape, strict=True):
        painted = np.flatnonzero(values.any(axis=axis))
        if not painted.size:
            return None
        low, high = int(painted[0]) - margin, int(painted[-1]) + margin + 1
        spans.append(slice(max(low, 0), min(high, size)))
    return spans[0], spans[1]


def _enclosing(boxes: list[Box]) -> Box:
    if not boxes:
        return slice(0, 0), slice(0, 0)
    return (
        slice(min(box[0].start for box in boxes), max(box[0].stop for box in boxes)),
        slice(min(box[1].start for box in boxes), max(box[1].stop for box in boxes)),
    )


def _slopes(layer: NDArray[np.float32], box: Box) -> NDArray[np.float32]:
    """Return the slopes of a height along u and v in a box of it, (rows, columns, 2)."""
    height, width = layer.shape
    smooth = cv2.GaussianBlur(layer, (0, 0), SMOOTHING_TEXELS)
    down, along = np.gradient(smooth)
    return np.stack([along[box] * width, down[box] * height], axis=-1).astype(np.float32)
