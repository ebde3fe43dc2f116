"""The meshes of a character, concatenated for the graphics card."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.body.extreme_vertices import extreme_vertices
from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import Material, Mesh, Morph
from cubeling.characters.rendering.geometry.morph_mixer import merge_morphs
from cubeling.characters.rendering.geometry.places import are_whole
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class CasterRun:
    """Triangles that cast a shadow, drawn at once."""

    first: int
    """Position of their first index."""

    count: int
    """Number of their indices."""

    double_sided: bool
    """Whether both sides are seen."""

    dormant: bool
    """Whether they are dormant, see `DetailLevel`."""


@dataclass(frozen=True)
class CharacterVertices:
    """All vertices of a character, and its triangles by material."""

    positions: NDArray[np.float32]
    """(vertices, 3), in the bind pose [m]."""

    normals: NDArray[np.float32]
    """(vertices, 3)."""

    joints: NDArray[np.uint32]
    """Rows of the joint matrix palette that move each vertex, (vertices, 4)."""

    weights: NDArray[np.float32]
    """(vertices, 4)."""

    colors: NDArray[np.float32]
    """Linear RGBA; white if the mesh has no colours, (vertices, 4)."""

    uvs: NDArray[np.float32]
    """Texture coordinates; zero if the mesh has none, (vertices, 2)."""

    indices: NDArray[np.uint32]
    """Three for each triangle, (3 × triangles,), sorted by material."""

    materials: tuple[tuple[Material, int], ...]
    """Each material with the number of its indices, in the order of the indices."""

    binds: tuple[Array, ...]
    """The different sets of inverse bind matrices, each (joints, 4, 4), in the palette's order."""

    morphs: tuple[Morph, ...] = ()
    """Morph targets, one for each name, over all meshes."""

    moved: int = 0
    """Number of vertices that morphs move; they are the first ones."""

    @classmethod
    def of(cls, meshes: Sequence[Mesh]) -> Self:
        """Concatenate meshes.

        Raises
        ------
        CharacterError
            There is nothing to draw.
        """
        meshes = [mesh for mesh in meshes if mesh.triangles.size]
        if not meshes:
            raise CharacterError(
                "the character has no mesh to draw: load a file with a skinned mesh"
            )
        # Meshes of one material are neighbours: each change of material costs a draw call.
        keys = [_material_key(mesh.material) for mesh in meshes]
        meshes = sorted(meshes, key=lambda mesh: keys.index(_material_key(mesh.material)))
        starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)]).astype(np.uint32)
        binds, rows = _distinct_binds(meshes)
        return cls(
            positions=np.concatenate([mesh.positions for mesh in meshes]).astype(np.float32),
            normals=np.concatenate([mesh.normals for mesh in meshes]).astype(np.float32),
            joints=np.concatenate(
                [
                    mesh.joints.astype(np.uint32) + row
                    for mesh, row in zip(meshes, rows, strict=True)
                ]
            ),
            weights=np.concatenate([mesh.weights for mesh in meshes]).astype(np.float32),
            colors=np.concatenate([_or_default(mesh.colors, mesh, 4, 1.0) for mesh in meshes]),
            uvs=np.concatenate([_or_default(mesh.uvs, mesh, 2, 0.0) for mesh in meshes]),
            indices=np.concatenate(
                [
                    mesh.triangles.ravel().astype(np.uint32) + start
                    for mesh, start in zip(meshes, starts[:-1], strict=True)
                ]
            ),
            materials=_material_runs(meshes),
            binds=binds,
            morphs=merge_morphs(meshes, starts[:-1].tolist()),
        )._moved_first()

    def _moved_first(self) -> Self:
        """Return a copy with the vertices that morphs move first, for one upload of them."""
        if not self.morphs:
            return self
        moved = np.unique(np.concatenate([morph.vertices for morph in self.morphs]))
        fixed = np.ones(len(self.positions), bool)
        fixed[moved] = False
        order = np.concatenate([moved, np.flatnonzero(fixed)])
        return replace(self.reorder(order), moved=len(moved))

    def reorder(self, order: NDArray[np.intp]) -> Self:
        """Return a copy in which vertex i is the vertex `order[i]`, (vertices,), of this one."""
        new_index = np.empty(len(order), np.uint32)
        new_index[order] = np.arange(len(order))
        return replace(
            self,
            positions=self.positions[order],
            normals=self.normals[order],
            joints=self.joints[order],
            weights=self.weights[order],
            colors=self.colors[order],
            uvs=self.uvs[order],
            indices=new_index[self.indices],
            morphs=tuple(_renumber(morph, new_index) for morph in self.morphs),
        )

    def palette(self, world_from_joint: Array) -> Array:
        """Return the skinning matrices (rows, 4, 4) for the skeleton's joints (joints, 4, 4)."""
        return np.concatenate([world_from_joint @ bind for bind in self.binds])

    def skin(
        self,
        palette: Array,
        selection: NDArray[np.intp] | slice,
        positions: NDArray[np.float32] | None = None,
    ) -> Array:
        """Return selected vertices after skinning, (n, 3), as `skin.vert` computes them.

        `positions` (n, 3) are those after morphing; without, no morph is active.
        """
        positions = self.positions[selection] if positions is None else positions
        points = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
        skinned = np.zeros((len(points), 3))
        for joint, weight in zip(self.joints[selection].T, self.weights[selection].T, strict=True):
            skinned += weight[:, None] * np.einsum("vij,vj->vi", palette[joint, :3], points)
        return skinned

    def extreme(self) -> NDArray[np.intp]:
        """Return the indices of the extreme vertices, (n,).

        They are each joint's furthest vertices in 26 or 98 directions, at rest or fully morphed.
        In any pose, the box around them is that around all vertices, to within a few percent.
        """
        owner = self.owners
        at_rest = extreme_vertices(self.positions, owner)
        if not self.morphs:
            return at_rest
        moved = np.concatenate([morph.vertices for morph in self.morphs])
        displacements = np.concatenate([morph.displacements for morph in self.morphs])
        morphed = extreme_vertices(self.positions[moved] + displacements, owner[moved])
        return np.union1d(at_rest, moved[morphed]).astype(np.intp)

    @property
    def owners(self) -> NDArray[np.uint32]:
        """The palette row with the largest weight for each vertex, (vertices,)."""
        strongest = self.weights.argmax(axis=1)
        return np.asarray(self.joints[np.arange(len(strongest)), strongest], np.uint32)

    def simplify(
        self, cells: int, awake: int | None = None
    ) -> tuple[NDArray[np.uint32], tuple[CasterRun, ...]]:
        """Return fewer triangles of the same vertices, by vertex clustering.

        Vertices of one joint in one cell become one (Rossignac and Borrel 1993); the character's
        largest side has that many `cells`. The result is the indices, three for each triangle, and
        their runs. The first `awake` materials are of triangles that are not dormant.
        """
        used, number = np.unique(self.indices, return_inverse=True)
        positions = self.positions[used]
        low, high = positions.min(axis=0), positions.max(axis=0)
        cell_size = max(float((high - low).max()) / cells, 1e-9)
        grid = np.floor((positions - low) / cell_size).astype(np.int64)
        sizes = grid.max(axis=0) + 1
        # One number for cell and joint: to sort rows of four takes thirty times as long.
        keys = ((self.owners[used] * sizes[0] + grid[:, 0]) * sizes[1] + grid[:, 1]) * sizes[2]
        _, first, cluster = np.unique(keys + grid[:, 2], return_index=True, return_inverse=True)
        corners = used[first[cluster]][number].reshape(-1, 3)
        kept = are_whole(corners)
        if not kept.any():  # every triangle lies in one cell
            corners = self.indices.reshape(-1, 3)
            kept = np.ones_like(kept)
        kinds = [  # dormant runs last
            (number >= (awake or len(self.materials)), material.double_sided)
            for number, (material, _) in enumerate(self.materials)
        ]
        kind = np.repeat(kinds, [count // 3 for _, count in self.materials], axis=0) @ [2, 1]
        parts = [corners[kept & (kind == number)] for number in range(4)]
        ends = np.cumsum([0, *(part.size for part in parts)]).tolist()
        runs = (
            CasterRun(ends[number], part.size, bool(number & 1), number >= 2)
            for number, part in enumerate(parts)
        )
        return np.concatenate(parts).ravel(), tuple(run for run in runs if run.count)

    @property
    def shape_records(self) -> NDArray[np.float32]:
        """Position and normal of each vertex, (vertices, 6)."""
        return np.hstack([self.positions, self.normals])


def _renumber(morph: Morph, new_index: NDArray[np.uint32]) -> Morph:
    """Return a morph with new numbers of its vertices, ascending."""
    vertices = new_index[morph.vertices]
    order = np.argsort(vertices)
    normals = morph.normal_displacements
    return replace(
        morph,
        vertices=vertices[order],
        displacements=morph.displacements[order],
        normal_displacements=None if normals is None else normals[order],
    )


def _or_default(
    values: NDArray[np.float32] | None, mesh: Mesh, width: int, default: float
) -> NDArray[np.float32]:
    if values is None:
        return np.full((len(mesh.positions), width), default, np.float32)
    return values.astype(np.float32)


def _material_key(material: Material) -> tuple[object, ...]:
    """Return a key that two materials share if they look the same; textures by identity."""
    rest = replace(
        material,
        base_color_texture=None,
        metallic_roughness_texture=None,
        normal_texture=None,
        emissive_texture=None,
        occlusion_texture=None,
        face=None,
        toon=None if material.toon is None else replace(material.toon, texture=None),
    )
    return (rest, id(material.face), *(id(texture) for texture in material.textures))


def _material_runs(meshes: Sequence[Mesh]) -> tuple[tuple[Material, int], ...]:
    runs: list[tuple[Material, int]] = []
    for mesh in meshes:
        count = mesh.triangles.size
        if runs and _material_key(runs[-1][0]) == _material_key(mesh.material):
            count += runs.pop()[1]
        runs.append((mesh.material, count))
    return tuple(runs)


def _distinct_binds(meshes: Sequence[Mesh]) -> tuple[tuple[Array, ...], list[np.uint32]]:
    """Return the different sets of inverse bind matrices, and each mesh's first palette row."""
    binds: list[Array] = []
    rows: list[np.uint32] = []
    for mesh in meshes:
        bind = np.asarray(mesh.inverse_bind, float)
        equal = [number for number, known in enumerate(binds) if np.array_equal(known, bind)]
        if not equal:
            binds.append(bind)
        before = binds[: equal[0]] if equal else binds[:-1]
        rows.append(np.uint32(sum(len(known) for known in before)))
    return tuple(binds), rows
