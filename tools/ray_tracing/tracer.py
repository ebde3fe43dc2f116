"""Rays against triangles, by Intel's Embree."""

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from tools.ray_tracing.mesh import Floats, Triangles

FAR_M = 1e9
"""Length of a ray that has no end [m]."""


@dataclass(frozen=True)
class RayHits:
    """The first triangle on each ray."""

    distances: Floats
    """From the origin [m], (rays,); `inf` where nothing is hit."""

    triangles: NDArray[np.int32]
    """Number of the triangle, (rays,); −1 where nothing is hit."""

    barycentric: Floats
    """Weights of the triangle's second and third vertex, (rays, 2)."""


class RayTracer:
    """Casts rays at a mesh. Triangles have no front: a ray hits them from both sides."""

    def __init__(self, mesh: Triangles) -> None:
        self.mesh = mesh
        """What the rays hit."""
        self._scene = EmbreeScene()
        self._geometry = TriangleMesh(self._scene, mesh.positions, mesh.corners)

    def distances(self, origins: Floats, directions: Floats, max_distance: float = FAR_M) -> Floats:
        """Return how far each ray goes before it hits something [m], (rays,).

        Origins and unit directions are (rays, 3). A ray that hits nothing within `max_distance`
        gives `inf`.
        """
        limits = np.full(len(origins), max_distance, np.float32)
        # Embree returns the limits themselves, shortened where something is hit.
        found = self._scene.run(*_contiguous(origins, directions), limits, query="DISTANCE")
        return np.where(found < np.float32(max_distance), found, np.float32(np.inf))

    def hits(self, origins: Floats, directions: Floats, max_distance: float = FAR_M) -> RayHits:
        """Return what each ray hits first; parameters as of `distances`."""
        limits = np.full(len(origins), max_distance, np.float32)
        found = self._scene.run(*_contiguous(origins, directions), limits, output=1)
        triangles = found["primID"]
        return RayHits(
            np.where(triangles >= 0, found["tfar"], np.float32(np.inf)),
            triangles,
            np.stack([found["u"], found["v"]], axis=1),
        )

    def flat_normals(self, triangles: NDArray[np.int32]) -> Floats:
        """Return unit normals of triangles by their number, (n, 3), by the right-hand rule."""
        a, b, c = np.moveaxis(self.mesh.positions[self.mesh.corners[triangles]], 1, 0)
        normals = np.cross(b - a, c - a)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return np.asarray(normals / np.maximum(lengths, 1e-30), np.float32)


def _contiguous(*arrays: Floats) -> tuple[Floats, ...]:
    return tuple(np.ascontiguousarray(array, np.float32) for array in arrays)
