"""Triangles with smooth normals."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float32]
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Triangles:
    """A mesh in one frame."""

    positions: Floats
    """Vertices, (vertices, 3) [m]."""

    normals: Floats
    """Unit normals for shading, (vertices, 3)."""

    corners: NDArray[np.int32]
    """Vertices of each triangle, (triangles, 3)."""

    objects: NDArray[np.int32]
    """The object that each triangle belongs to, 1 or more, (triangles,)."""

    @classmethod
    def of(cls, positions: ArrayLike, normals: ArrayLike, corners: ArrayLike) -> Self:
        """Return one object's mesh from arrays of any precision."""
        triangles = np.ascontiguousarray(corners, np.int32)
        return cls(
            np.ascontiguousarray(positions, np.float32),
            np.ascontiguousarray(normals, np.float32),
            triangles,
            np.ones(len(triangles), np.int32),
        )

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Return all parts in one mesh; each part is an object of its own."""
        starts = np.cumsum([0, *(len(part.positions) for part in parts)])
        numbers = np.repeat(np.arange(len(parts)) + 1, [len(part.corners) for part in parts])
        return cls(
            np.concatenate([part.positions for part in parts]),
            np.concatenate([part.normals for part in parts]),
            np.concatenate(
                [part.corners + start for part, start in zip(parts, starts, strict=False)]
            ).astype(np.int32),
            numbers.astype(np.int32),
        )

    def transformed(self, target_from_mesh: Array) -> Self:
        """Return the mesh in another frame; the transform (4, 4) is rigid or scales evenly."""
        linear = target_from_mesh[:3, :3]
        positions = self.positions @ linear.T + target_from_mesh[:3, 3]
        normals = self.normals @ (linear / np.cbrt(np.linalg.det(linear))).T
        return type(self)(
            positions.astype(np.float32), normals.astype(np.float32), self.corners, self.objects
        )
