"""What is there before a character: the camera's picture, and the real cubes that hide things."""

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.programs import Programs, assign
from characters.rendering.projection import is_rigid, part_that_shows
from characters.rendering.view import Box, Rectangle

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

_FACE = np.array([(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, -1, 1), (1, 1, 1), (-1, 1, 1)]) / 2
UNIT_CUBE = np.concatenate([s * np.roll(_FACE, axis, axis=1) for axis in range(3) for s in (1, -1)])
"""Corners of its twelve triangles, (36, 3)."""


class Ground:
    """Lays the camera's picture, and the depth of the real cubes in it.

    Parameters
    ----------
    context, programs
        Where to draw.
    """

    def __init__(self, context: moderngl.Context, programs: Programs) -> None:
        self._context = context
        self._programs = programs
        self._patches = Patches(context)
        self._screen = context.vertex_array(programs.backdrop, [])
        self._corners = context.buffer(UNIT_CUBE.astype("f4"))
        self._box = context.vertex_array(programs.box, [(self._corners, "3f", "position")])

    def draw(self, patch: Image) -> None:
        """Lay a part of the picture (height, width, 3) into the framebuffer in use."""
        self._patches.upload(patch).use(0)
        self._context.enable_only(moderngl.NOTHING)
        self._screen.render(moderngl.TRIANGLES, vertices=3)

    def hide(self, boxes: Sequence[Box], clip_from_camera: Array) -> None:
        """Write the depth of the real cubes into the framebuffer in use, and no colour."""
        if not boxes:
            return
        framebuffer = self._context.fbo
        framebuffer.color_mask = False, False, False, False
        framebuffer.use()  # masks take effect then
        self._context.enable_only(moderngl.DEPTH_TEST)
        for box in boxes:
            clip = clip_from_camera @ box.camera_from_box @ np.diag([*(3 * [box.edge]), 1.0])
            assign(self._programs.box, clip_from_box=clip)
            self._box.render(moderngl.TRIANGLES)
        framebuffer.color_mask = True, True, True, True
        framebuffer.use()

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        self._patches.release()
        self._screen.release()
        self._box.release()
        self._corners.release()


def that_show(
    boxes: Sequence[Box], matrix: Array, size: tuple[int, int]
) -> list[tuple[Box, Rectangle]]:
    """Return the boxes that are seen, each with the part of the picture around it."""
    seen = []
    for box in boxes:
        if is_rigid(box.camera_from_box) and np.isfinite(box.edge) and box.edge > 0.0:
            part = part_that_shows(box.edge * UNIT_CUBE, matrix, box.camera_from_box, size)
            if part is not None:
                seen.append((box, part))
    return seen


class Patches:
    """One texture that takes patches of pictures, made anew when one is larger.

    Parameters
    ----------
    context
        Where it lives.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None

    def upload(self, patch: Image) -> moderngl.Texture:
        """Send a patch (height, width, 3) to the first texels of the texture, first row first."""
        height, width = patch.shape[:2]
        texture = self._texture
        if texture is None or texture.width < width or texture.height < height:
            room = (0, 0) if texture is None else texture.size
            self.release()
            texture = self._context.texture((max(room[0], width), max(room[1], height)), 3)
            texture.repeat_x = texture.repeat_y = False
            self._texture = texture
        texture.write(np.ascontiguousarray(patch), viewport=(0, 0, width, height), alignment=1)
        return texture

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None
