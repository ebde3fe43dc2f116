"""The meshes of a character, laid out one after the other for the graphics card."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.model.mesh import Material, Mesh, Morph
from characters.rendering.geometry.morphing import joined
from characters.rendering.geometry.outline import furthest

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Geometry:
    """All vertices of a character, and which triangles share a material."""

    positions: NDArray[np.float32]
    """(vertices, 3), in the bind pose [m]."""

    normals: NDArray[np.float32]
    """(vertices, 3)."""

    joints: NDArray[np.uint32]
    """Rows of the palette that move each vertex, (vertices, 4)."""

    weights: NDArray[np.float32]
    """(vertices, 4)."""

    colors: NDArray[np.float32]
    """Linear RGBA, white where the mesh has none, (vertices, 4)."""

    uvs: NDArray[np.float32]
    """(vertices, 2), zero where the mesh has none."""

    indices: NDArray[np.uint32]
    """Three a triangle, (3 × triangles,), sorted by material."""

    materials: tuple[tuple[Material, int], ...]
    """Each material with the number of its indices, in their order."""

    binds: tuple[Array, ...]
    """The different sets of inverse bind matrices, each (joints, 4, 4).

    The palette is one after the other.
    """

    morphs: tuple[Morph, ...] = ()
    """Other shapes of its vertices, one a name, whichever meshes it moves."""

    moved: int = 0
    """How many vertices, the first ones, some morph moves."""

    @classmethod
    def of(cls, meshes: Sequence[Mesh]) -> Self:
        """Gather some meshes; a `CharacterError` where there is nothing to draw."""
        meshes = [mesh for mesh in meshes if mesh.triangles.size]
        if not meshes:
            raise CharacterError(
                "the character has no mesh to draw: load a file with a skinned mesh"
            )
        # Meshes of one material in a row: each change of it costs a call of the driver.
        keys = [_key(mesh.material) for mesh in meshes]
        meshes = sorted(meshes, key=lambda mesh: keys.index(_key(mesh.material)))
        starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)]).astype(np.uint32)
        binds, rows = _distinct_binds(meshes)
        geometry = cls(
            positions=np.concatenate([mesh.positions for mesh in meshes]).astype(np.float32),
            normals=np.concatenate([mesh.normals for mesh in meshes]).astype(np.float32),
            joints=np.concatenate(
                [
                    mesh.joints.astype(np.uint32) + row
                    for mesh, row in zip(meshes, rows, strict=True)
                ]
            ),
            weights=np.concatenate([mesh.weights for mesh in meshes]).astype(np.float32),
            colors=np.concatenate([_filled(mesh.colors, mesh, 4, 1.0) for mesh in meshes]),
            uvs=np.concatenate([_filled(mesh.uvs, mesh, 2, 0.0) for mesh in meshes]),
            indices=np.concatenate(
                [
                    mesh.triangles.ravel().astype(np.uint32) + start
                    for mesh, start in zip(meshes, starts[:-1], strict=True)
                ]
            ),
            materials=_runs(meshes),
            binds=binds,
            morphs=joined(meshes, starts[:-1].tolist()),
        )
        return geometry._with_the_moved_first()

    def _with_the_moved_first(self) -> Self:
        """Return the same in another order: what morphs move is sent to the card in one piece."""
        if not self.morphs:
            return self
        moved = np.unique(np.concatenate([morph.vertices for morph in self.morphs]))
        stays = np.ones(len(self.positions), bool)
        stays[moved] = False
        order = np.concatenate([moved, np.flatnonzero(stays)])
        place = np.empty(len(order), np.uint32)
        place[order] = np.arange(len(order))
        return replace(
            self,
            positions=self.positions[order],
            normals=self.normals[order],
            joints=self.joints[order],
            weights=self.weights[order],
            colors=self.colors[order],
            uvs=self.uvs[order],
            indices=place[self.indices],
            morphs=tuple(replace(m, vertices=place[m.vertices]) for m in self.morphs),
            moved=len(moved),
        )

    def palette(self, world_from_joint: Array) -> Array:
        """Return `world_from_bind` (rows, 4, 4) for joints (joints, 4, 4) of the skeleton."""
        return np.concatenate([world_from_joint @ bind for bind in self.binds])

    def skinned(
        self,
        palette: Array,
        chosen: NDArray[np.intp] | slice,
        positions: NDArray[np.float32] | None = None,
    ) -> Array:
        """Return some vertices under a palette, (n, 3), as `skin.vert` does on the card.

        `positions` (n, 3) is where they are before, if not where they are without morphs.
        """
        positions = self.positions[chosen] if positions is None else positions
        points = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
        placed = np.zeros((len(points), 3))
        for joint, weight in zip(self.joints[chosen].T, self.weights[chosen].T, strict=True):
            placed += weight[:, None] * (palette[joint, :3] @ points[:, :, None])[..., 0]
        return placed

    def outline(self) -> NDArray[np.intp]:
        """Return the numbers of vertices that stand out (n,).

        Of each joint's own they are the furthest in 26 or 98 directions, at rest or where a morph
        takes them. The box around them is that around all vertices in any pose, to within a few
        hundredths of its size.
        """
        owner = self._owners
        still = furthest(self.positions, owner)
        if not self.morphs:
            return still
        taken = np.concatenate([morph.vertices for morph in self.morphs])
        shifts = np.concatenate([morph.shifts for morph in self.morphs])
        shifted = furthest(self.positions[taken] + shifts, owner[taken])
        return np.union1d(still, taken[shifted]).astype(np.intp)

    @property
    def _owners(self) -> NDArray[np.uint32]:
        """The row of the palette that moves each vertex most, (vertices,)."""
        strongest = self.weights.argmax(axis=1)
        return np.asarray(self.joints[np.arange(len(strongest)), strongest], np.uint32)

    def coarse(self, cells: int) -> tuple[NDArray[np.uint32], tuple[tuple[int, int, bool], ...]]:
        """Return fewer triangles of the same vertices: those of one joint and one cell become one.

        Rossignac and Borrel's vertex clustering (1993), with a vertex of each cluster as its
        representative, so that the same skinned vertices serve.

        Returns
        -------
        indices
            Three a triangle.
        runs
            (first index, count, double-sided), one or two: closed surfaces, then double-sided ones.
        """
        low, high = self.positions.min(axis=0), self.positions.max(axis=0)
        cell = max(float((high - low).max()) / cells, 1e-9)
        places = np.floor((self.positions - low) / cell).astype(np.int64)
        sizes = places.max(axis=0) + 1
        # One number a cell and joint: rows of four are sorted thirty times as slowly.
        numbers = ((self._owners * sizes[0] + places[:, 0]) * sizes[1] + places[:, 1]) * sizes[2]
        _, first, cluster = np.unique(
            numbers + places[:, 2], return_index=True, return_inverse=True
        )
        corners = first[cluster].astype(np.uint32)[self.indices].reshape(-1, 3)
        kept = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        if not kept.any():  # a body of specks, each in a cell of its own
            corners, kept = self.indices.reshape(-1, 3), np.ones_like(kept)
        sides = np.repeat(
            [material.double_sided for material, _ in self.materials],
            [count // 3 for _, count in self.materials],
        )
        groups = [corners[kept & (sides == double)] for double in (False, True)]
        closed, double = (group.size for group in groups)
        runs = ((0, closed, False), (closed, double, True))
        return np.concatenate(groups).ravel(), tuple(run for run in runs if run[1])

    @property
    def shape_records(self) -> NDArray[np.float32]:
        """Position and normal of each vertex without morphs, (vertices, 6)."""
        return np.hstack([self.positions, self.normals])

    @property
    def bone_records(self) -> NDArray[np.float32]:
        """Joints and weights of each vertex, (vertices, 8); the bits of the joints are uint32."""
        return np.hstack([self.joints.view(np.float32), self.weights])

    @property
    def paint_records(self) -> NDArray[np.float32]:
        """Linear RGBA and texture coordinates of each vertex, (vertices, 6)."""
        return np.hstack([self.colors, self.uvs])


def _filled(
    values: NDArray[np.float32] | None, mesh: Mesh, width: int, default: float
) -> NDArray[np.float32]:
    if values is None:
        return np.full((len(mesh.positions), width), default, np.float32)
    return values.astype(np.float32)


def _key(material: Material) -> tuple[object, ...]:
    """Return what makes two materials look the same; textures are the same only if they are one."""
    pictures = (material.texture, material.surface, material.bumps)
    rest = replace(material, texture=None, surface=None, bumps=None)
    return (rest, *(id(picture) for picture in pictures))


def _runs(meshes: Sequence[Mesh]) -> tuple[tuple[Material, int], ...]:
    runs: list[tuple[Material, int]] = []
    for mesh in meshes:
        count = mesh.triangles.size
        if runs and _key(runs[-1][0]) == _key(mesh.material):
            count += runs.pop()[1]
        runs.append((mesh.material, count))
    return tuple(runs)


def _distinct_binds(meshes: Sequence[Mesh]) -> tuple[tuple[Array, ...], list[np.uint32]]:
    """Return the different sets of inverse bind matrices, and each mesh's first palette row."""
    binds: list[Array] = []
    rows: list[np.uint32] = []
    for mesh in meshes:
        bind = np.asarray(mesh.inverse_bind, float)
        same = [number for number, known in enumerate(binds) if np.array_equal(known, bind)]
        if not same:
            binds.append(bind)
        before = binds[: same[0]] if same else binds[:-1]
        rows.append(np.uint32(sum(len(known) for known in before)))
    return tuple(binds), rows
