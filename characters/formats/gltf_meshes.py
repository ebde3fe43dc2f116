"""From the meshes and materials of a glTF scene to skinned meshes."""

from typing import NamedTuple

import cv2
import numpy as np
import pygltflib
from numpy.typing import NDArray

from characters.formats.gltf_file import DamagedFileError, GltfFile
from characters.formats.gltf_morphs import MorphTable, morph_moved, read_morphs
from characters.formats.gltf_nodes import NodeTree
from characters.mesh import Material, Mesh, Morph

Array = NDArray[np.float64]
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


def read_meshes(file: GltfFile, tree: NodeTree, table: MorphTable) -> tuple[Mesh, ...]:
    """Return every primitive that the skeleton moves, as a mesh of its own."""
    materials = [_material(file, material) for material in file.document.materials]
    rest = tree.skeleton.rest.globals(tree.skeleton)
    meshes: list[Mesh] = []
    for number, node in enumerate(file.document.nodes):
        if node.mesh is None or (node.skin is None and number not in tree.joint_of_node):
            continue
        mesh = file.document.meshes[node.mesh]
        names = [table.names[column] for column in table.columns[number]]
        for part, primitive in enumerate(mesh.primitives):
            if primitive.mode not in (None, _TRIANGLES, _STRIP, _FAN):
                continue  # points and lines are not skin
            material = Material() if primitive.material is None else materials[primitive.material]
            geometry = _geometry(file, primitive)
            if node.skin is None:
                skin = _rigid_skin(tree.joint_of_node[number], len(geometry.positions), rest)
            else:
                skin = _skin(file, primitive, node.skin, tree)
            plain = file.plain["meshes"][node.mesh]["primitives"][part]
            morphs = read_morphs(file, plain, names, len(geometry.positions))
            name = mesh.name or node.name or "mesh"
            meshes.append(_placed(name, geometry, skin, material, rest, morphs))
    return tuple(meshes)


class _Geometry(NamedTuple):
    """What a vertex is, without what moves it."""

    positions: Array
    normals: Array
    triangles: NDArray[np.int64]
    colors: Array | None
    uvs: Array | None


class _Skin(NamedTuple):
    """What moves a vertex, in the skeleton's numbering."""

    joints: NDArray[np.int64]
    weights: Array
    inverse_bind: Array


def _geometry(file: GltfFile, primitive: pygltflib.Primitive) -> _Geometry:
    attributes = primitive.attributes
    positions = file.accessor(attributes.POSITION).astype(float)
    if primitive.indices is None:
        indices = np.arange(len(positions), dtype=np.int64)
    else:
        indices = file.accessor(primitive.indices, scaled=False).astype(np.int64)
    if indices.size and indices.max() >= len(positions):
        raise DamagedFileError("a triangle names a vertex that does not exist")
    triangles = _triangles(indices, primitive.mode)
    uvs = attributes.TEXCOORD_0
    return _Geometry(
        positions,
        _normals(file, attributes.NORMAL, positions, triangles),
        triangles,
        _colors(file, attributes.COLOR_0),
        None if uvs is None else file.accessor(uvs).astype(float),
    )


def _triangles(indices: NDArray[np.int64], mode: int | None) -> NDArray[np.int64]:
    """Return (triangles, 3) from a list, a strip or a fan."""
    count = max(len(indices) - 2, 0)
    if mode == _STRIP:
        windows = np.stack([indices[:count], indices[1 : count + 1], indices[2:]], axis=1)
        windows[1::2] = windows[1::2, [1, 0, 2]]
        return windows
    if mode == _FAN:
        first = np.broadcast_to(indices[:1], count)
        return np.stack([indices[1 : count + 1], indices[2:], first], axis=1)
    return indices[: len(indices) // 3 * 3].reshape(-1, 3)


def _normals(
    file: GltfFile, accessor: int | None, positions: Array, triangles: NDArray[np.int64]
) -> Array:
    """Return the file's normals, or the area-weighted mean of the faces around each vertex."""
    if accessor is not None:
        normals = file.accessor(accessor).astype(float)
    else:
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
    colors = file.accessor(accessor).astype(float)
    if colors.shape[1] == 3:
        colors = np.concatenate([colors, np.ones((len(colors), 1))], axis=1)
    return colors


def _skin(file: GltfFile, primitive: pygltflib.Primitive, number: int, tree: NodeTree) -> _Skin:
    """Return joints, weights and inverse bind matrices in the skeleton's numbering."""
    skin = file.document.skins[number]
    to_skeleton = np.array([tree.joint_of_node[node] for node in skin.joints])
    inverse_bind = np.tile(np.eye(4), (len(tree.skeleton), 1, 1))
    if skin.inverseBindMatrices is not None:
        matrices = file.accessor(skin.inverseBindMatrices).astype(float).reshape(-1, 4, 4)
        if len(matrices) < len(to_skeleton):
            raise DamagedFileError(f"skin {number} has fewer bind matrices than joints")
        inverse_bind[to_skeleton] = np.swapaxes(matrices, 1, 2)[: len(to_skeleton)]
    joints, weights = _strongest_four(file, primitive.attributes)
    if joints.size and joints.max() >= len(to_skeleton):
        raise DamagedFileError("a vertex names a joint that its skin lacks")
    return _Skin(to_skeleton[joints], weights, inverse_bind)


def _strongest_four(
    file: GltfFile, attributes: pygltflib.Attributes
) -> tuple[NDArray[np.int64], Array]:
    """Return four joints and weights a vertex; of eight, the strongest."""
    if attributes.JOINTS_0 is None or attributes.WEIGHTS_0 is None:
        raise DamagedFileError("a skinned mesh has no joints or weights")
    joints = [file.accessor(attributes.JOINTS_0, scaled=False).astype(np.int64)]
    weights = [file.accessor(attributes.WEIGHTS_0).astype(float)]
    if getattr(attributes, "JOINTS_1", None) is not None:
        joints.append(file.accessor(attributes.JOINTS_1, scaled=False).astype(np.int64))
        weights.append(file.accessor(attributes.WEIGHTS_1).astype(float))
    all_joints, all_weights = np.concatenate(joints, 1), np.concatenate(weights, 1)
    strongest = np.argsort(-all_weights, axis=1, kind="stable")[:, :4]
    chosen = np.maximum(np.take_along_axis(all_weights, strongest, 1), 0.0)
    totals = chosen.sum(1, keepdims=True)
    # A vertex that nothing holds would collapse to the origin: its first joint holds it.
    chosen = np.where(totals > 1e-6, chosen / np.maximum(totals, 1e-6), [1.0, 0.0, 0.0, 0.0])
    numbers = np.take_along_axis(all_joints, strongest, 1)
    return np.where(chosen > 0, numbers, 0), chosen


def _rigid_skin(joint: int, vertices: int, rest: Array) -> _Skin:
    """Return the skin of a mesh that one node carries; its vertices lie in that node's frame."""
    inverse_bind = np.tile(np.eye(4), (len(rest), 1, 1))
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (vertices, 1))
    joints = np.zeros((vertices, 4), np.int64)
    joints[:, 0] = joint
    return _Skin(joints, weights, inverse_bind)


def _placed(
    name: str,
    geometry: _Geometry,
    skin: _Skin,
    material: Material,
    rest: Array,
    morphs: tuple[Morph, ...],
) -> Mesh:
    """Return the mesh in the character frame.

    A skin may leave its vertices in any frame. That of the first joint at rest is moved into the
    vertices, so that a mesh bound at rest, which is nearly every one, lies where it is seen.
    """
    joints, weights, inverse_bind = skin
    first = int(joints[0, 0]) if len(joints) else 0
    character_from_mesh = rest[first] @ inverse_bind[first]
    positions, normals = geometry.positions, geometry.normals
    if not np.allclose(character_from_mesh, np.eye(4), atol=1e-5):
        linear = character_from_mesh[:3, :3]
        morphs = tuple(morph_moved(morph, normals, linear) for morph in morphs)
        positions = positions @ linear.T + character_from_mesh[:3, 3]
        normals = _unit(normals @ np.linalg.inv(linear))
        used = np.unique(joints)
        inverse_bind = inverse_bind.copy()
        inverse_bind[used] = inverse_bind[used] @ np.linalg.inv(character_from_mesh)
    uvs, colors = geometry.uvs, geometry.colors
    return Mesh(
        name=name,
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=geometry.triangles.astype(np.uint32),
        joints=joints.astype(np.uint16),
        weights=weights.astype(np.float32),
        inverse_bind=inverse_bind,
        colors=None if colors is None else colors.astype(np.float32),
        uvs=None if uvs is None else uvs.astype(np.float32),
        material=material,
        morphs=morphs,
    )


def _material(file: GltfFile, material: pygltflib.Material) -> Material:
    pbr = material.pbrMetallicRoughness or pygltflib.PbrMetallicRoughness()
    factor = tuple(float(c) for c in (pbr.baseColorFactor or (1.0, 1.0, 1.0, 1.0)))
    texture = None
    if pbr.baseColorTexture is not None:
        texture = _texture(file, pbr.baseColorTexture.index)
    return Material(
        base_color=(factor[0], factor[1], factor[2], factor[3]),
        metallic=1.0 if pbr.metallicFactor is None else float(pbr.metallicFactor),
        roughness=1.0 if pbr.roughnessFactor is None else float(pbr.roughnessFactor),
        texture=texture,
        double_sided=bool(material.doubleSided),
    )


def _texture(file: GltfFile, index: int) -> NDArray[np.uint8] | None:
    """Return the picture of a texture, (height, width, 4) RGBA, or None if it has none."""
    source = file.document.textures[index].source
    if source is None:
        return None
    image = file.document.images[source]
    data = file.view(image.bufferView) if image.uri is None else file.resource(image.uri)
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise DamagedFileError(f"image {source} is neither PNG nor JPEG")
    if picture.dtype == np.uint16:
        picture = np.asarray(picture // 257, np.uint8)
    code = {1: cv2.COLOR_GRAY2RGBA, 3: cv2.COLOR_BGR2RGBA, 4: cv2.COLOR_BGRA2RGBA}
    channels = 1 if picture.ndim == 2 else picture.shape[2]
    return np.asarray(cv2.cvtColor(picture, code[channels]), np.uint8)
