"""Reading meshes as skinned meshes in the character frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.formats.gltf.materials import MappedMaterial, read_materials
from cubeling.characters.formats.gltf.morphs import (
    MorphTable,
    read_morphs,
    renumbered_morph,
    transformed_morph,
)
from cubeling.characters.formats.gltf.nodes import NodeTree
from cubeling.characters.formats.gltf.skins import VertexSkin, read_skin, rigid_skin
from cubeling.characters.model.mesh import Material, Mesh, Morph
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import subtree_sizes
from cubeling.characters.skeleton.pose import Array

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_SAME_TURN, _SAME_PLACE = 1e-3, 1e-3  # of joints bound in the rest pose; the latter per size
_MAX_PRIMITIVES = 4096  # small ones cost time, not bytes


def read_meshes(file: GltfFile, tree: NodeTree, table: MorphTable) -> list[tuple[int, Mesh]]:
    """Return every primitive that the skeleton moves as a mesh, with the number of its node."""
    instances = [file.document["nodes"][number]["mesh"] for number in tree.mesh_nodes]
    parts = sum(len(file.document["meshes"][mesh]["primitives"]) for mesh in instances)
    if parts > _MAX_PRIMITIVES:
        raise DamagedFileError(f"has {parts} primitives, more than {_MAX_PRIMITIVES}; join them")
    materials = read_materials(file)
    rest = tree.skeleton.rest.globals(tree.skeleton)
    sizes = subtree_sizes(tree.skeleton)
    meshes: list[tuple[int, Mesh]] = []
    for number in tree.mesh_nodes:
        node = file.document["nodes"][number]
        mesh = file.document["meshes"][node["mesh"]]
        name = mesh.get("name") or node.get("name") or "mesh"
        targets, shared = table.of(number), dict[int, Array]()
        where = label("mesh", node["mesh"], mesh)
        for primitive in mesh["primitives"]:
            if primitive.get("mode", _TRIANGLES) not in (_TRIANGLES, _STRIP, _FAN):
                continue  # points and lines
            with error_context(where):
                mapped = MappedMaterial(Material())
                if "material" in primitive:
                    mapped = materials[primitive["material"]]
                geometry = _geometry(file, primitive, mapped)
                if not len(geometry.triangles):
                    continue
                vertices = len(geometry.positions)
                skin = _skin(file, primitive, number, tree, vertices, where)
                morphs = read_morphs(file, primitive, targets, vertices, shared)
                used = _without_unused_vertices(geometry, skin, morphs)
                mesh_in_frame = _in_character_frame(name, *used, mapped.material, rest, sizes)
                meshes.append((number, mesh_in_frame))
    return meshes


class _Geometry(NamedTuple):
    """Triangles and the attributes of vertices, except skin and morphs."""

    positions: Array
    normals: Array
    triangles: NDArray[np.int64]
    colors: Array | None
    uvs: Array | None


def _skin(
    file: GltfFile, primitive: Json, number: int, tree: NodeTree, vertices: int, where: str
) -> VertexSkin:
    node = file.document["nodes"][number]
    if "skin" in node:
        where = f"{file.path}: {where}"
        return read_skin(file, primitive["attributes"], node["skin"], tree, vertices, where)
    file.budget.spend(16 * len(tree.skeleton), "its bind matrices")
    return rigid_skin(tree.joint_of_node[number], vertices, len(tree.skeleton))


def _geometry(file: GltfFile, primitive: Json, mapped: MappedMaterial) -> _Geometry:
    attributes = primitive["attributes"]
    if "POSITION" not in attributes:
        raise DamagedFileError("has no positions")
    positions = file.floats(attributes["POSITION"], 3)
    if "indices" in primitive:
        indices = file.integers(primitive["indices"], 1)
    else:
        indices = np.arange(len(positions), dtype=np.int64)
    if indices.size and indices.max() >= len(positions):
        raise DamagedFileError(f"a triangle has vertex {indices.max()} of {len(positions)}")
    triangles = _triangles(indices, primitive.get("mode", _TRIANGLES))
    geometry = _Geometry(
        positions,
        _normals(file, attributes.get("NORMAL"), positions, triangles),
        triangles,
        _colors(file, attributes.get("COLOR_0")),
        _uvs(file, attributes, mapped),
    )
    for each in (geometry.normals, geometry.colors, geometry.uvs):
        if each is not None and len(each) != len(positions):
            raise DamagedFileError(f"has attributes of {len(each)} and {len(positions)} vertices")
    return geometry


def _triangles(indices: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """Return (triangles, 3) from a list, a strip or a fan."""
    count = max(len(indices) - 2, 0)
    if mode == _STRIP:
        windows = np.stack([indices[n : n + count] for n in range(3)], axis=1)
        windows[1::2] = windows[1::2, [1, 0, 2]]
        return windows
    if mode == _FAN:
        first = np.repeat(indices[:1], count)
        return np.stack([indices[1 : count + 1], indices[2 : count + 2], first], axis=1)
    return indices[: len(indices) // 3 * 3].reshape(-1, 3)


def _normals(
    file: GltfFile, accessor: int | None, positions: Array, triangles: NDArray[np.int64]
) -> Array:
    """Return the file's normals, or the area-weighted mean of the faces around each vertex."""
    if accessor is not None:
        return _unit(file.floats(accessor, 3))
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    faces = np.cross(b - a, c - a)
    normals = np.zeros_like(positions)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], faces)
    return _unit(normals)


def _unit(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.maximum(lengths, 1e-12), [0.0, 1.0, 0.0])


def _colors(file: GltfFile, accessor: int | None) -> Array | None:
    if accessor is None:
        return None
    colors = file.floats(accessor, file.width(accessor))
    if colors.ndim != 2 or colors.shape[1] not in (3, 4):
        raise DamagedFileError("has colours that are neither RGB nor RGBA")
    if colors.shape[1] == 3:
        colors = np.concatenate([colors, np.ones((len(colors), 1))], axis=1)
    return colors


def _uvs(file: GltfFile, attributes: Json, mapped: MappedMaterial) -> Array | None:
    """Return the transformed coordinates of the material's textures."""
    accessor = attributes.get(f"TEXCOORD_{mapped.uv_set}")
    if accessor is None:
        return None
    uvs = file.floats(accessor, 2)
    matrix = mapped.uv_transform
    return uvs if matrix is None else uvs @ matrix[:, :2].T + matrix[:, 2]


def _without_unused_vertices(
    geometry: _Geometry, skin: VertexSkin, morphs: tuple[Morph, ...]
) -> tuple[_Geometry, VertexSkin, tuple[Morph, ...]]:
    """Return a primitive without the vertices that only other primitives of the mesh use."""
    count = len(geometry.positions)
    kept = np.flatnonzero(np.bincount(geometry.triangles.ravel(), minlength=count))
    if len(kept) == count:
        return geometry, skin, morphs
    new_number = np.full(count, -1)
    new_number[kept] = np.arange(len(kept))
    positions, normals, triangles, colors, uvs = geometry
    return (
        _Geometry(
            positions[kept],
            normals[kept],
            new_number[triangles],
            None if colors is None else colors[kept],
            None if uvs is None else uvs[kept],
        ),
        VertexSkin(skin.joints[kept], skin.weights[kept], skin.inverse_bind),
        tuple(renumbered_morph(morph, new_number) for morph in morphs),
    )


def _character_from_mesh(
    rest: Array, inverse_bind: Array, used: NDArray[np.intp], subtrees: NDArray[np.int_]
) -> Array:
    """Return the frame (4, 4) of a mesh, from placements and bind matrices (joints, 4, 4).

    A mesh bound in another pose than at rest gets the axes of that pose by quarter turns, as no
    joint shows them exactly, and the middle of the joints at rest: those of the whole skin, so that
    its meshes agree. Joints count by the number of joints that they carry: the trunk turns least.
    """
    if not used.size:
        return np.eye(4)
    placements = rest @ inverse_bind
    first = np.asarray(placements[used[0]], np.float64)
    size = float(np.abs(first[:3, 3]).max() + np.ptp(rest[:, :3, 3], axis=0).max())
    tolerance = np.full((4, 4), _SAME_TURN)
    tolerance[:3, 3] = _SAME_PLACE * size
    if (np.abs(placements[used] - first) <= tolerance).all():
        return first
    bound = np.abs(inverse_bind - np.eye(4)).max((1, 2)) > 0
    bound[used] = True
    sizes = np.cbrt(np.abs(np.linalg.det(placements[:, :3, :3])))
    bound &= sizes > 0
    if not bound.any():
        return first
    frame = np.eye(4)
    turn = rotations.nearest_quarter_turns(
        (placements[bound, :3, :3] / sizes[bound, None, None]).mean(0)
    )
    frame[:3, :3] = float(np.median(sizes[bound])) * turn
    at = np.linalg.inv(inverse_bind[bound])[:, :3, 3]
    frame[:3, 3] = (rest[bound, :3, 3] - at @ frame[:3, :3].T).mean(0)
    return frame


def _in_character_frame(
    name: str,
    geometry: _Geometry,
    skin: VertexSkin,
    morphs: tuple[Morph, ...],
    material: Material,
    rest: Array,
    subtrees: NDArray[np.int_],
) -> Mesh:
    """Return the mesh in the character frame.

    The vertices of a skinned mesh may be in any frame; a mesh bound in the rest pose, as most are,
    gets its visible positions.
    """
    joints, weights, inverse_bind = skin
    used = np.unique(joints[weights > 0])
    character_from_mesh = _character_from_mesh(rest, inverse_bind, used, subtrees)
    positions, normals = geometry.positions, geometry.normals
    triangles = geometry.triangles
    if not np.allclose(character_from_mesh, np.eye(4), atol=1e-5):
        linear = character_from_mesh[:3, :3]
        morphs = tuple(transformed_morph(morph, normals, linear) for morph in morphs)
        positions = positions @ linear.T + character_from_mesh[:3, 3]
        normals = _unit(normals @ np.linalg.inv(linear))
        used = np.unique(joints)
        inverse_bind = inverse_bind.copy()
        inverse_bind[used] = inverse_bind[used] @ np.linalg.inv(character_from_mesh)
        if np.linalg.det(linear) < 0:  # mirrored: restores the winding order
            triangles = triangles[:, ::-1]
    uvs, colors = geometry.uvs, geometry.colors
    return Mesh(
        name=name,
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=np.ascontiguousarray(triangles, np.uint32),
        joints=joints.astype(np.uint16),
        weights=weights.astype(np.float32),
        inverse_bind=inverse_bind,
        colors=None if colors is None else colors.astype(np.float32),
        uvs=None if uvs is None else uvs.astype(np.float32),
        material=material,
        morphs=morphs,
    )
