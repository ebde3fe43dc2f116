"""Which triangles of a character have wrinkles or blood: only they pay for them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import FaceMaps
from cubeling.characters.rendering.geometry.vertices import CharacterVertices


@dataclass(frozen=True)
class FaceSplit:
    """A run of triangles of one material, a second time: plain ones first, then painted ones.

    The first time they stay in the order of the mesh, in which a face at rest is drawn.
    """

    run: int
    """Number of the run among those of the character."""

    first: int
    """Position of its first index in this second copy."""

    plain: int
    """Number of indices of triangles without paint."""

    painted: int
    """Number of indices of triangles with wrinkles or blood."""


def split_faces(
    vertices: CharacterVertices,
) -> tuple[tuple[FaceSplit, ...], NDArray[np.uint32]]:
    """Return the split of every run of triangles with face maps, and the indices to append."""
    splits: list[FaceSplit] = []
    appended: list[NDArray[np.uint32]] = []
    first, end = 0, len(vertices.indices)
    for number, (material, count) in enumerate(vertices.materials):
        if material.face is not None:
            corners = vertices.indices[first : first + count].reshape(-1, 3)
            painted = painted_triangles(vertices.uvs[corners], material.face)
            appended += [corners[~painted].ravel(), corners[painted].ravel()]
            splits.append(FaceSplit(number, end, *(len(each) for each in appended[-2:])))
            end += count
        first += count
    return tuple(splits), np.concatenate([np.zeros(0, np.uint32), *appended])


def painted_triangles(uvs: NDArray[np.float32], maps: FaceMaps) -> NDArray[np.bool_]:
    """Return which triangles may have paint, (n,), from their texture coordinates (n, 3, 2)."""
    painted = (maps.heights != 0.0).any(axis=0) | (maps.blood != 0.0)
    sums = np.pad(painted.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    height, width = painted.shape
    at = uvs * [width, height]
    low = np.clip(np.floor(at.min(axis=1)) - 1, 0, [width, height]).astype(int)
    high = np.clip(np.ceil(at.max(axis=1)) + 1, 0, [width, height]).astype(int)
    inside = (
        sums[high[:, 1], high[:, 0]]
        - sums[low[:, 1], high[:, 0]]
        - sums[high[:, 1], low[:, 0]]
        + sums[low[:, 1], low[:, 0]]
    )
    return np.asarray(inside > 0)
