"""A character on the graphics card: sent there once, posed there in every picture."""

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.geometry.buffers import Geometry
from characters.rendering.geometry.morphing import Morphing
from characters.rendering.geometry.surfaces import Part, Surfaces
from characters.rendering.programs import Programs
from characters.rendering.scene import Drawable

Array = NDArray[np.float64]

CASTER_CELLS = 44
"""Cells along a character's height to which the caster of its shadow is simplified: the map of
the shadow is not much finer."""


class SkinnedCharacter:
    """All meshes of one character in one set of buffers.

    Vertices are skinned once a picture by transform feedback into `skinned`, in the table frame,
    from where the passes for shadow and colour read them. The joint matrices go through a texture
    with a row a joint, so that their number has no limit.

    Parameters
    ----------
    context, programs
        Where to draw.
    character
        Its meshes and skeleton.
    """

    def __init__(self, context: moderngl.Context, programs: Programs, character: Drawable) -> None:
        self._geometry = geometry = Geometry.of(character.meshes)
        self._outline = geometry.outline()
        rest = geometry.palette(character.skeleton.rest.globals(character.skeleton))
        heights = geometry.skinned(rest, slice(None))[:, 1]
        self.height = float(max(heights.max() - min(heights.min(), 0.0), 1e-6))
        """Of the rest pose above the ground [m in the character frame]."""
        self._morphing = Morphing(
            geometry.shape_records[: geometry.moved], geometry.morphs, character.morphs
        )
        self._outlining = geometry.positions[self._outline]
        self._shapes = context.buffer(geometry.shape_records)
        bones = context.buffer(geometry.bone_records)
        paint = context.buffer(geometry.paint_records)
        indices = context.buffer(geometry.indices)
        coarse, self.coarse_runs = geometry.coarse(CASTER_CELLS)
        coarse_indices = context.buffer(coarse)
        self.skinned = context.buffer(reserve=24 * len(geometry.positions))
        """Positions and normals in the table frame, 3 + 3 float32 a vertex."""
        self._palette = context.texture((3, len(rest)), 4, dtype="f4")
        self._palette.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._skin = context.vertex_array(
            programs.skin,
            [
                (self._shapes, "3f 3f", "position", "normal"),
                (bones, "4u4 4f", "joints", "weights"),
            ],
        )
        self.caster = context.vertex_array(
            programs.caster, [(self.skinned, "3f 12x", "position")], coarse_indices
        )
        """Draws its shadow, in runs of indices `coarse_runs`: (first, count, double-sided)."""
        self._surfaces = Surfaces(context, programs, self.skinned, paint, indices)
        self.parts: tuple[Part, ...] = self._surfaces.parts(geometry)
        """What to draw with which material."""
        self._buffers = (self._shapes, bones, paint, indices, coarse_indices, self.skinned)

    def pose(
        self, character_from_joint: Array, table_from_character: Array, morphs: Array | None = None
    ) -> Array | None:
        """Skin the vertices, and return points in the table frame that enclose them, (n, 3).

        Parameters
        ----------
        character_from_joint
            Of every joint of the skeleton, (joints, 4, 4).
        table_from_character
            Where it stands, (4, 4).
        morphs
            How far each morph of the character is on, (morphs,), or None for not at all.

        Returns
        -------
        NDArray or None
            None where the pose is not finite: there is nothing to draw then.
        """
        palette = self._geometry.palette(table_from_character @ character_from_joint)
        if not np.isfinite(palette).all():
            return None
        if morphs is not None and not np.isfinite(morphs).all():
            return None
        self._shape(morphs)
        self._palette.write(np.ascontiguousarray(palette[:, :3], "f4"))
        self._palette.use(0)
        self._skin.transform(self.skinned, moderngl.POINTS, vertices=len(self._geometry.positions))
        return self._geometry.skinned(palette, self._outline, self._outlining)

    def _shape(self, morphs: Array | None) -> None:
        """Send the vertices that morphs move, if another shape is asked for than last time."""
        mixed = self._morphing.mix(morphs)
        if mixed is None:
            return
        self._shapes.write(mixed)
        moved = self._outline < len(mixed)
        self._outlining[moved] = mixed[self._outline[moved], :3]

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        for array in (self._skin, self.caster):
            array.release()
        self._palette.release()
        self._surfaces.release()
        for buffer in self._buffers:
            buffer.release()
