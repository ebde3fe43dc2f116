"""A character on the graphics card: uploaded once, skinned in every picture."""

from collections.abc import Sequence

import moderngl
import numpy as np

from cubeling.characters.body.extreme_vertices import SkinnedPoints
from cubeling.characters.face.action_units import ActionUnits
from cubeling.characters.rendering.geometry.character_geometry import (
    CharacterGeometry,
    are_vanished,
)
from cubeling.characters.rendering.geometry.detail_levels import chosen_level
from cubeling.characters.rendering.geometry.face_texture import FaceTexture
from cubeling.characters.rendering.geometry.morph_mixer import MorphMixer
from cubeling.characters.rendering.geometry.surfaces import (
    BEHIND,
    CASTER,
    VERTEX_LIT,
    Surface,
    SurfaceBuffers,
)
from cubeling.characters.rendering.geometry.vertices import CasterRun
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.scene import Drawable
from cubeling.characters.skeleton.pose import Array

RECORD_BYTES = 24
"""Bytes of the position and the normal of a vertex."""


class SkinnedCharacter:
    """All meshes of one character in one set of buffers.

    Vertices are skinned once a picture by transform feedback into `skinned`, in the table frame,
    where the passes for shadow and colour read them. The joint matrices go through a texture with
    one row for each joint, so their number is not limited.

    `geometry` is that of the character, which its copies share; None to compute it.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        character: Drawable,
        geometry: CharacterGeometry | None = None,
    ) -> None:
        self.geometry = geometry or CharacterGeometry.of(character)
        """What all copies of the character share."""
        vertices, extreme = self.geometry.vertices, self.geometry.extreme
        self._level, self._asleep = 0, False
        self._morphs = MorphMixer(
            vertices.shape_records[: vertices.moved], vertices.morphs, character.morphs
        )
        rows = sum(len(binds) for binds in vertices.binds)
        self._enclosing = SkinnedPoints(
            vertices.positions[extreme], vertices.joints[extreme], vertices.weights[extreme], rows
        )
        self._moved_extreme = np.flatnonzero(extreme < vertices.moved)
        self._moved_vertices = extreme[self._moved_extreme]
        self._shapes = context.buffer(vertices.shape_records)
        joints = context.buffer(np.hstack([vertices.joints.view(np.float32), vertices.weights]))
        colors = context.buffer(np.hstack([vertices.colors, vertices.uvs]))
        indices = context.buffer(self.geometry.indices)
        caster_indices = context.buffer(self.geometry.caster_indices)
        self.skinned = context.buffer(reserve=RECORD_BYTES * len(vertices.positions))
        """Positions and normals in the table frame, 3 + 3 float32 for each vertex."""
        self._palette = context.texture((3, rows), 4, dtype="f4")
        self._palette.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._skinning = context.vertex_array(
            programs.load_transform("skin", "skinned_position", "skinned_normal"),
            [
                (self._shapes, "3f 3f", "position", "normal"),
                (joints, "4u4 4f", "joints", "weights"),
            ],
        )
        self.caster = context.vertex_array(
            programs.load("shadow_caster", "shadow_caster"),
            [(self.skinned, "3f 12x", "position")],
            caster_indices,
        )
        """Draws its shadow, in the runs of indices `caster_runs`."""
        self._surfaces = SurfaceBuffers(context, programs, self.skinned, colors, indices)
        self._plain = [
            self._surfaces.surfaces(level.materials, start)
            for level, start in zip(self.geometry.levels, self.geometry.starts, strict=True)
        ]
        self._faced = self._plain
        self._shows_face = False
        self.face: FaceTexture | None = None
        """Wrinkles and blood, if its sidecar file has them."""
        maps = self.geometry.face
        if maps is not None:
            self.face = FaceTexture(context, maps, ActionUnits.of(character.morphs))
            self._faced = [
                self._surfaces.with_faces(plain, splits, self.face, start)
                for plain, splits, start in zip(
                    self._plain, self.geometry.splits, self.geometry.starts, strict=True
                )
            ]
        self._buffers = (self._shapes, joints, colors, indices, caster_indices, self.skinned)

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """A run of triangles for each material, at the level of detail of the last `skin`.

        Those of a face that shows something are apart.
        """
        surfaces = (self._faced if self._shows_face else self._plain)[self._level]
        level = self.geometry.levels[self._level]
        return surfaces[: level.awake - len(level.materials) or None] if self._asleep else surfaces

    @property
    def mirrored(self) -> tuple[tuple[float, float], ...]:
        """Least and greatest roughness of each of its surfaces that mirrors what is around."""
        ranges = (each.mirrored for each in self.surfaces)
        return tuple(each for each in ranges if each is not None)

    @property
    def caster_runs(self) -> tuple[CasterRun, ...]:
        """The triangles that cast its shadow in the pose of the last `skin`."""
        return tuple(run for run in self.geometry.caster_runs if not (self._asleep and run.dormant))

    @property
    def triangles(self) -> int:
        """Number of triangles that were drawn last."""
        return sum(each.count for each in self.surfaces) // 3

    def skin(
        self,
        character_from_joint: Array,
        table_from_character: Array,
        morphs: Array | None = None,
        max_error: float = 0.0,
    ) -> Array | None:
        """Skin the vertices, and return points in the table frame that enclose them, (n, 3).

        The joints are (joints, 4, 4), the weights of the morphs (morphs,), None for all zero. The
        level of detail is the coarsest with an error of at most `max_error` [m in the character
        frame]. The result is None if the pose is not finite; then there is nothing to draw.
        """
        matrices = self.geometry.vertices.palette(table_from_character @ character_from_joint)
        palette = matrices[:, :3].astype(np.float32)
        if not np.isfinite(palette).all():
            return None
        if morphs is not None and not np.isfinite(morphs).all():
            return None
        mixed = self._morphs.mix(morphs)
        if mixed is not None:
            self._shapes.write(mixed)
            self._enclosing.move(self._moved_extreme, mixed[self._moved_vertices, :3])
        self._palette.write(palette)
        self._palette.use(0)
        dormant = self.geometry.dormant
        scale = float(np.abs(table_from_character[:3, :3]).max())
        self._asleep = bool(len(dormant) and are_vanished(palette[dormant], scale).all())
        self._level = chosen_level(self.geometry.levels, self._level, max_error)
        self._skin_used()
        return self._enclosing.skin(palette)

    def render(
        self,
        context: moderngl.Context,
        features: frozenset[str] = frozenset(),
        first_surface: int = 1,
        **uniforms: "bool | float | Sequence[float] | Array",
    ) -> None:
        """Draw all surfaces with programs that have some features besides those of the surface.

        Vertices are shaded alone at coarser levels only: those are for small characters, and what
        is between their vertices differs little from them, normals included.
        `uniforms` are set once for each program; `surface_id` counts from `first_surface` on.
        """
        prepared: set[int] = set()
        if self._level == 0:
            features -= {VERTEX_LIT}
        for number, surface in enumerate(self.surfaces, first_surface):
            array = self._surfaces.array(surface.program_features(features))
            if array.program.glo not in prepared:
                prepared.add(array.program.glo)
                set_uniforms(array.program, **uniforms)
            set_uniforms(array.program, surface_id=float(number))
            surface.render(context, array, both_sides=bool(features & {BEHIND, CASTER}))

    def show_face(
        self, morphs: Array | None, blood: float, table_from_character: Array, pixel: float
    ) -> None:
        """Set wrinkles and blood of the skin; see `FaceTexture.update`."""
        if self.face is None:
            return
        scale = float(np.linalg.norm(table_from_character[:3, 1]))
        self._shows_face = self.face.update(morphs, blood, scale, pixel)

    def _skin_used(self) -> None:
        """Skin the vertices of the level, which are the first ones of each part of the buffer."""
        parts = self.geometry.levels[self._level].parts
        for first, count in parts[: 2 if self._asleep else 3]:
            if count:
                self._skinning.transform(
                    self.skinned,
                    moderngl.POINTS,
                    vertices=count,
                    first=first,
                    buffer_offset=RECORD_BYTES * first,
                )

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        for each in (self._skinning, self.caster, self._palette, self._surfaces, *self._buffers):
            each.release()
        if self.face is not None:
            self.face.release()
