"""A character on the graphics card: sent there once, posed there in every picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.mesh import Mesh
from characters.rendering.programs import Programs
from characters.rendering.view import Drawable

Array = NDArray[np.float64]

SRGB8_ALPHA8 = 0x8C43
"""OpenGL's name of the format that decodes sRGB when it is sampled."""


@dataclass(frozen=True)
class Part:
    """A run of triangles with one material."""

    first: int
    """Number of the first index."""

    count: int
    """How many indices."""

    base_color: tuple[float, float, float]
    """Linear RGB."""

    metallic: float
    """0 dielectric … 1 metal."""

    roughness: float
    """0 mirror … 1 chalk."""

    texture: moderngl.Texture | None
    """Base colour, or None."""

    double_sided: bool
    """Whether back faces are drawn."""


class SkinnedCharacter:
    """All meshes of one character in one set of buffers.

    Vertices are skinned once a picture by transform feedback into `skinned`, in the table frame, from
    where the passes for shadow and colour read them. The joint matrices go through a texture with
    a row a joint, so that their number has no limit.

    Parameters
    ----------
    context, programs
        Where to draw.
    character
        Its meshes and skeleton.
    """

    def __init__(self, context: moderngl.Context, programs: Programs, character: Drawable) -> None:
        meshes, skeleton = character.meshes, character.skeleton
        if not meshes:
            raise CharacterError(
                "the character has no mesh to draw: load a file with a skinned mesh"
            )
        self._binds, offsets = _distinct_binds(meshes)
        vertices = _merged(meshes, offsets)
        self.vertex_count = len(vertices.positions)
        self._boxes = _boxes_of_joints(vertices, sum(len(bind) for bind in self._binds))
        rest = self._palette_of(skeleton.rest.globals(skeleton), np.eye(4))
        self.height = _height(vertices, rest)
        """Of the rest pose above the ground [m in the character frame]."""
        bind = context.buffer(vertices.interleaved)
        surface = context.buffer(np.hstack([vertices.colors, vertices.uvs]).astype("f4"))
        indices = context.buffer(vertices.indices)
        self.skinned = context.buffer(reserve=24 * self.vertex_count)
        """Positions and normals in the table frame, 3 + 3 float32 a vertex."""
        rows = sum(len(bind) for bind in self._binds)
        self._palette = context.texture((3, rows), 4, dtype="f4")
        self._palette.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._skin = context.vertex_array(
            programs.skin, [(bind, "3f 3f 4u4 4f", "position", "normal", "joints", "weights")]
        )
        self.surface = context.vertex_array(
            programs.character,
            [(self.skinned, "3f 3f", "position", "normal"), (surface, "4f 2f", "color", "uv")],
            indices,
        )
        """Draws the character."""
        self.caster = context.vertex_array(
            programs.caster, [(self.skinned, "3f 12x", "position")], indices
        )
        """Draws its shadow."""
        self.parts = _parts(context, meshes)
        textures = [part.texture for part in self.parts if part.texture is not None]
        self._owned: list[moderngl.Buffer | moderngl.Texture | moderngl.VertexArray] = [
            self._skin, self.surface, self.caster, self._palette, *textures,
            bind, surface, indices, self.skinned,
        ]  # fmt: skip

    def pose(self, character_from_joint: Array, table_from_character: Array) -> Array | None:
        """Skin the vertices, and return points in the table frame that enclose them, (n, 3).

        Parameters
        ----------
        character_from_joint
            Of every joint of the skeleton, (joints, 4, 4).
        table_from_character
            Where it stands, (4, 4).

        Returns
        -------
        NDArray or None
            None where the pose is not finite: there is nothing to draw then.
        """
        palette = self._palette_of(character_from_joint, table_from_character)
        if not np.isfinite(palette).all():
            return None
        self._palette.write(np.ascontiguousarray(palette[:, :3], "f4"))
        self._palette.use(0)
        self._skin.transform(self.skinned, moderngl.POINTS, vertices=self.vertex_count)
        joints, corners = self._boxes
        enclosing = corners @ palette[joints, :3, :3].transpose(0, 2, 1)
        return np.asarray((enclosing + palette[joints, None, :3, 3]).reshape(-1, 3))

    def _palette_of(self, character_from_joint: Array, table_from_character: Array) -> Array:
        """Return `table_from_bind` of every joint for every set of inverse bind matrices, (rows, 4, 4)."""
        table_from_joint = table_from_character @ character_from_joint
        return np.concatenate([table_from_joint @ bind for bind in self._binds])

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        while self._owned:
            self._owned.pop(0).release()


@dataclass(frozen=True)
class _Vertices:
    """The meshes of a character, one after the other."""

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    joints: NDArray[np.uint32]
    weights: NDArray[np.float32]
    colors: NDArray[np.float32]
    uvs: NDArray[np.float32]
    indices: NDArray[np.uint32]

    @property
    def interleaved(self) -> bytes:
        """Position, normal, joints and weights of each vertex, 56 bytes."""
        record = np.empty((len(self.positions), 14), np.float32)
        record[:, :3], record[:, 3:6], record[:, 10:] = self.positions, self.normals, self.weights
        record[:, 6:10] = self.joints.view(np.float32)
        return record.tobytes()


def _merged(meshes: Sequence[Mesh], offsets: Sequence[int]) -> _Vertices:
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    ones = [np.ones((len(mesh.positions), 4), np.float32) for mesh in meshes]
    zeros = [np.zeros((len(mesh.positions), 2), np.float32) for mesh in meshes]
    return _Vertices(
        positions=np.concatenate([mesh.positions for mesh in meshes], dtype=np.float32),
        normals=np.concatenate([mesh.normals for mesh in meshes], dtype=np.float32),
        joints=np.concatenate(
            [
                mesh.joints.astype(np.uint32) + offset
                for mesh, offset in zip(meshes, offsets, strict=True)
            ]
        ),
        weights=np.concatenate([mesh.weights for mesh in meshes], dtype=np.float32),
        colors=np.concatenate(
            [
                white if mesh.colors is None else mesh.colors
                for mesh, white in zip(meshes, ones, strict=True)
            ],
            dtype=np.float32,
        ),
        uvs=np.concatenate(
            [
                zero if mesh.uvs is None else mesh.uvs
                for mesh, zero in zip(meshes, zeros, strict=True)
            ],
            dtype=np.float32,
        ),
        indices=np.concatenate(
            [
                mesh.triangles.ravel().astype(np.uint32) + np.uint32(start)
                for mesh, start in zip(meshes, starts, strict=False)
            ]
        ),
    )


def _height(vertices: _Vertices, palette: Array) -> float:
    up = palette[vertices.joints, 1]  # (vertices, 4, 4)
    rows = np.einsum("vj,vji->vi", vertices.weights, up)
    heights = (rows[:, :3] * vertices.positions).sum(axis=1) + rows[:, 3]
    return float(max(heights.max() - min(heights.min(), 0.0), 1e-6))


def _distinct_binds(meshes: Sequence[Mesh]) -> tuple[list[Array], list[int]]:
    """Return the different sets of inverse bind matrices, and where each mesh's begins among them all."""
    binds: list[Array] = []
    offsets: list[int] = []
    for mesh in meshes:
        bind = np.asarray(mesh.inverse_bind, float)
        same = next(
            (number for number, known in enumerate(binds) if np.array_equal(known, bind)), None
        )
        if same is None:
            same = len(binds)
            binds.append(bind)
        offsets.append(sum(len(known) for known in binds[:same]))
    return binds, offsets


def _boxes_of_joints(vertices: _Vertices, rows: int) -> tuple[NDArray[np.intp], Array]:
    """Return which rows of the palette move vertices, and the corners (n, 8, 3) of what each moves.

    A skinned vertex is a mean of its place under each of its joints, hence inside the hull of the corners.
    """
    moves = vertices.weights > 0.0
    joints = vertices.joints[moves]
    points = np.repeat(vertices.positions, moves.sum(axis=1), axis=0)
    low, high = np.full((rows, 3), np.inf), np.full((rows, 3), -np.inf)
    np.minimum.at(low, joints, points)
    np.maximum.at(high, joints, points)
    used = np.flatnonzero(np.isfinite(low).all(axis=1))
    pick = np.array([[(corner >> axis) & 1 for axis in range(3)] for corner in range(8)], bool)
    return used, np.where(pick, high[used, None], low[used, None])


def _parts(context: moderngl.Context, meshes: Sequence[Mesh]) -> list[Part]:
    parts: list[Part] = []
    first = 0
    for mesh in meshes:
        surface = mesh.material
        red, green, blue = surface.base_color[:3]
        texture = None if surface.texture is None else _texture(context, surface.texture)
        parts.append(
            Part(
                first, mesh.triangles.size, (red, green, blue), surface.metallic,
                surface.roughness, texture, surface.double_sided,
            )
        )  # fmt: skip
        first += mesh.triangles.size
    return parts


def _texture(context: moderngl.Context, image: NDArray[np.uint8]) -> moderngl.Texture:
    height, width = image.shape[:2]
    texture = context.texture(
        (width, height), 4, np.ascontiguousarray(image), internal_format=SRGB8_ALPHA8
    )
    texture.build_mipmaps()
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    return texture
