"""Skinned geometry in the layout of vertex buffers."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ToonShading:
    """The shading of MToon, VRM's toon shader: two colours instead of light and dark."""

    color: tuple[float, float, float]
    """Linear RGB of what the light does not reach, multiplied by the texture below."""

    texture: NDArray[np.uint8] | None = None
    """Colour of the shade, (height, width, 3) sRGB, or None."""

    shift: float = 0.0
    """What is added to the cosine between normal and light: above 0, more is lit."""

    toony: float = 0.9
    """0 for a soft transition from one colour to the other … 1 for an edge."""

    evenness: float = 0.9
    """0 for ambient light by direction … 1 for the same from everywhere."""


@dataclass(frozen=True)
class FaceMaps:
    """What the skin of a face does beyond its shape, in texture coordinates."""

    heights: NDArray[np.float32]
    """Wrinkle layers, (12, height, width): -1 the deepest groove, 0 flat … 1; see `face_maps`."""

    blood: NDArray[np.float32]
    """How much blood shows, (height, width), 0…1."""

    depth: float
    """Height of 1 [m in the character frame]."""


@dataclass(frozen=True)
class Material:
    """The part of glTF's metallic-roughness material that is drawn."""

    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    """Linear RGBA, multiplied by vertex colour and texture."""

    metallic: float = 0.0
    """0 dielectric … 1 metal."""

    roughness: float = 0.8
    """0 mirror … 1 chalk."""

    base_color_texture: NDArray[np.uint8] | None = None
    """Base colour, (height, width, 4) sRGB with alpha, or None."""

    metallic_roughness_texture: NDArray[np.uint8] | None = None
    """Roughness in green and metalness in blue, (height, width, 3) linear, or None; multiplied by
    the values above."""

    normal_texture: NDArray[np.uint8] | None = None
    """Normals in tangent space, (height, width, 3), +y up as in glTF, or None."""

    normal_scale: float = 1.0
    """Strength of the normal texture."""

    emissive: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Emitted light, linear RGB; above 1 as with KHR_materials_emissive_strength. Multiplied by the
    texture below."""

    emissive_texture: NDArray[np.uint8] | None = None
    """Where it is emitted, (height, width, 3) sRGB, or None for everywhere."""

    occlusion_texture: NDArray[np.uint8] | None = None
    """Share of the light from all around that arrives, in red, (height, width, 3) linear; or None
    for all of it."""

    occlusion_strength: float = 1.0
    """How much of that takes effect, 0…1."""

    alpha_cutoff: float | None = None
    """Alpha below which nothing is drawn; None for an opaque surface."""

    scattering: float = 0.0
    """How far light spreads below the surface, relative to human skin; 0 for not at all. Only parts
    with texture coordinates other than (0, 0) are skin."""

    blended: bool = False
    """Whether alpha is a share that is covered, not a cutoff, where a renderer can draw that."""

    double_sided: bool = False
    """Whether back faces are drawn."""

    toon: ToonShading | None = None
    """Its shading if it is MToon's; metalness and roughness do not count then."""

    face: FaceMaps | None = None
    """Wrinkles and blood, of the file beside a character."""

    @property
    def textures(self) -> tuple[NDArray[np.uint8] | None, ...]:
        """Colour, metalness and roughness, normals, toon shade, emission, and occlusion."""
        return (
            self.base_color_texture,
            self.metallic_roughness_texture,
            self.normal_texture,
            None if self.toon is None else self.toon.texture,
            self.emissive_texture,
            self.occlusion_texture,
        )


@dataclass(frozen=True)
class Morph:
    """A morph target of a mesh, such as a closed eye or an open mouth.

    The position of a vertex is that in the mesh plus, for each morph target, its weight times its
    displacement.
    """

    name: str
    """One of `Character.morphs`; VRM's names of expressions if possible: "blink", "aa" …"""

    vertices: NDArray[np.uint32]
    """Indices of the vertices that move, (n,), ascending."""

    displacements: NDArray[np.float32]
    """Displacements of these vertices in the bind pose, (n, 3) [m]."""

    normal_displacements: NDArray[np.float32] | None = None
    """Changes of their normals, (n, 3), or None for no change."""


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

    morphs: tuple[Morph, ...] = ()
    """Morph targets, each with as many vertices as the mesh."""

    @property
    def movers(self) -> NDArray[np.intp]:
        """The joint that moves each vertex most, (vertices,)."""
        strongest = np.argmax(self.weights, axis=1)
        joints = np.take_along_axis(self.joints, strongest[:, None], axis=1)[:, 0]
        return joints.astype(np.intp)
