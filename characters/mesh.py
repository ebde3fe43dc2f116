"""Skinned geometry as the graphics card wants it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Material:
    """How a surface answers light; the subset of glTF's metallic-roughness that is drawn."""

    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    """Linear RGBA factor; multiplies vertex colour and texture."""

    metallic: float = 0.0
    """0 dielectric … 1 metal."""

    roughness: float = 0.8
    """0 mirror … 1 chalk."""

    texture: NDArray[np.uint8] | None = None
    """Base colour, (height, width, 4) sRGB with alpha, or None."""

    double_sided: bool = False
    """Whether back faces are drawn."""


@dataclass(frozen=True)
class Mesh:
    """One skinned mesh in the bind pose, in the character frame."""

    name: str
    """Name in the file."""

    positions: NDArray[np.float32]
    """Vertices, (vertices, 3) [m]."""

    normals: NDArray[np.float32]
    """Unit normals, (vertices, 3)."""

    triangles: NDArray[np.uint32]
    """Vertex numbers, (triangles, 3), counter-clockwise from outside."""

    joints: NDArray[np.uint16]
    """Numbers of the skeleton's joints that move each vertex, (vertices, 4)."""

    weights: NDArray[np.float32]
    """Skin weights, (vertices, 4); each row sums to one."""

    inverse_bind: NDArray[np.float64]
    """Inverse bind matrices, (joints of the skeleton, 4, 4); identity for unused joints."""

    colors: NDArray[np.float32] | None = None
    """Linear RGBA a vertex, (vertices, 4), or None."""

    uvs: NDArray[np.float32] | None = None
    """Texture coordinates, (vertices, 2), v down as in glTF, or None."""

    material: Material = field(default_factory=Material)
    """The surface."""
