"""Skinned geometry in the layout of vertex buffers."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Material:
    """The part of glTF's metallic-roughness material that is drawn."""

    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    """Linear RGBA factor of vertex colour and texture."""

    metallic: float = 0.0
    """0 dielectric … 1 metal."""

    roughness: float = 0.8
    """0 mirror … 1 chalk."""

    texture: NDArray[np.uint8] | None = None
    """Base colour, (height, width, 4) sRGB with alpha, or None."""

    surface: NDArray[np.uint8] | None = None
    """Roughness in green and metalness in blue, (height, width, 3) linear, or None; factors of the
    values above."""

    bumps: NDArray[np.uint8] | None = None
    """Normal map in tangent space, (height, width, 3), +y up as in glTF, or None."""

    bump_scale: float = 1.0
    """Strength of the normal map."""

    glow: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Emission, linear RGB."""

    cutoff: float | None = None
    """Alpha below which nothing is drawn; None for an opaque surface."""

    double_sided: bool = False
    """Whether back faces are drawn."""


@dataclass(frozen=True)
class Morph:
    """A morph target of a mesh: a closed eye, an open mouth.

    The position of a vertex is that in the mesh plus, for each morph, its weight times the shift.
    """

    name: str
    """One of `Character.morphs`; VRM's names of expressions if possible: "blink", "aa" …"""

    vertices: NDArray[np.uint32]
    """Indices of the vertices that it moves, (n,), ascending."""

    shifts: NDArray[np.float32]
    """Displacement of each in the bind pose, (n, 3) [m]."""

    normal_shifts: NDArray[np.float32] | None = None
    """Change of their normals, (n, 3), or None for no change."""


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
    """Vertex indices, (triangles, 3), counter-clockwise from outside."""

    joints: NDArray[np.uint16]
    """Indices of the joints that move each vertex, (vertices, 4)."""

    weights: NDArray[np.float32]
    """Skin weights, (vertices, 4); each row sums to one."""

    inverse_bind: NDArray[np.float64]
    """Inverse bind matrices, (joints of the skeleton, 4, 4); identity for unused joints."""

    colors: NDArray[np.float32] | None = None
    """Linear RGBA of vertices, (vertices, 4), or None."""

    uvs: NDArray[np.float32] | None = None
    """Texture coordinates, (vertices, 2), v down as in glTF, or None."""

    material: Material = field(default_factory=Material)
    """The surface."""

    morphs: tuple[Morph, ...] = ()
    """Its morph targets."""
