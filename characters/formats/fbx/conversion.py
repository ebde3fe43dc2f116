"""Writes an .fbx as a .glb: `python -m cubeling.characters.formats.fbx.conversion FOLDER`.

The .fbx comes by the standard input, the .glb goes to the standard output; textures may lie in the
folder. What is wrong with a file goes to the error output.

This is a process of its own, which ends without freeing anything: ufbx 0.0.5 crashes when its
objects are freed, and a damaged file may crash it as well.
"""

import os
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import ufbx
from numpy.typing import NDArray

from cubeling.characters.formats.gltf.buffer import ARRAY_BUFFER, ELEMENT_BUFFER, GlbBuilder
from cubeling.characters.formats.gltf.document import Json
from cubeling.characters.skeleton.pose import Array
from cubeling.files import first_bytes

RATE_HZ = 30.0
"""Rate at which curves are baked; keys of the file beyond it are kept."""

MAX_INFLUENCES = 8
"""Joints of a vertex that are written, the strongest first; glTF has four to an attribute."""

_LINEAR_FROM_SRGB = 2.2  # exponent: Blender writes colours of vertices as sRGB, glTF wants linear
_IMAGES = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def convert(data: bytes, folder: Path) -> bytes:
    """Return the .glb of an .fbx whose textures may lie in a folder.

    Raises
    ------
    ufbx.UfbxError
        If the file cannot be read.
    """
    scene = ufbx.load_memory(
        data,
        target_axes=ufbx.axes_right_handed_y_up,
        target_unit_meters=1.0,
        space_conversion=ufbx.SpaceConversion.MODIFY_GEOMETRY,
        geometry_transform_handling=ufbx.GeometryTransformHandling.MODIFY_GEOMETRY,
        inherit_mode_handling=ufbx.InheritModeHandling.COMPENSATE,
        generate_missing_normals=True,
        clean_skin_weights=True,
    )
    writer = _Writer(_Kept(scene), GlbBuilder(), folder)
    writer.write()
    return writer.builder.glb()


_KEPT: list[object] = []
"""Every object of ufbx, since none may be freed; see the top of this module."""


class _Kept:
    """An object of ufbx, and through it all that it leads to; none is freed."""

    def __init__(self, held: Any) -> None:
        self.held = held
        _KEPT.append(held)

    def __getattr__(self, name: str) -> Any:
        return _kept(getattr(self.held, name))

    def __len__(self) -> int:
        return len(self.held)

    def __getitem__(self, index: int) -> Any:
        return _kept(self.held[index])

    def __iter__(self) -> Iterator[Any]:
        return (self[index] for index in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.held, dtype)


def _kept(value: Any) -> Any:
    return _Kept(value) if type(value).__module__ == "ufbx" else value


@dataclass
class _Writer:
    """Adds what a scene has to a glTF."""

    scene: Any
    builder: GlbBuilder
    folder: Path

    def write(self) -> None:
        """Add nodes, meshes and animations."""
        nodes = list(self.scene.nodes)
        number_of = {node.typed_id: number for number, node in enumerate(nodes)}
        textures: dict[int, int | None] = {}
        materials = [
            self.builder.add("materials", self._material(each, textures))
            for each in self.scene.materials
        ]
        for node in nodes:
            translation, rotation, scale = node.local_transform
            item: Json = {
                "name": node.name or ("Root" if node.is_root else f"node{node.typed_id}"),
                "translation": list(translation),
                "rotation": list(rotation),
                "scale": list(scale),
            }
            children = [number_of[child.typed_id] for child in node.children]
            if children:
                item["children"] = children
            self.builder.add("nodes", item)
        for number, node in enumerate(nodes):
            if node.mesh is not None and node.mesh.num_faces:
                self._add_mesh(number, node.mesh, materials, number_of)
        roots = [n for n, node in enumerate(nodes) if node.parent is None]
        self.builder.add("scenes", {"nodes": roots})
        for stack in self.scene.anim_stacks:
            self._add_animation(stack, number_of)

    def _material(self, material: Any, textures: dict[int, int | None]) -> Json:
        color = material.pbr.base_color
        factor = [float(part) for part in tuple(color.value_vec4)[:3]] if color.has_value else None
        pbr: Json = {"metallicFactor": 0.0, "roughnessFactor": 0.8}
        texture = color.texture
        if texture is not None:
            if texture.typed_id not in textures:
                textures[texture.typed_id] = self._texture(texture)
            index = textures[texture.typed_id]
            if index is not None:
                pbr["baseColorTexture"], factor = {"index": index}, None
        if factor is not None:
            pbr["baseColorFactor"] = [*(min(max(part, 0.0), 1.0) for part in factor), 1.0]
        return {"name": material.name, "pbrMetallicRoughness": pbr, "doubleSided": True}

    def _texture(self, texture: Any) -> int | None:
        """Add an image of the file, or one beside it by its name; None if there is none."""
        data = bytes(texture.content or b"")
        name = Path((texture.relative_filename or texture.filename).replace("\\", "/")).name
        if not data and name:
            data = first_bytes(self.folder / name, 1 << 28)
        kind = next((kind for magic, kind in _IMAGES.items() if data.startswith(magic)), None)
        if kind is None:
            return None
        item = {"bufferView": self.builder.view(data), "mimeType": kind, "name": name}
        return self.builder.add("textures", {"source": self.builder.add("images", item)})

    def _add_mesh(
        self, number: int, mesh: Any, materials: list[int], number_of: dict[int, int]
    ) -> None:
        corners, faces = _triangles(mesh)
        attributes = [("POSITION", _values(mesh.vertex_position, corners))]
        if mesh.vertex_normal.exists:
            attributes.append(("NORMAL", _unit(_values(mesh.vertex_normal, corners))))
        if mesh.vertex_uv.exists:
            uvs = _values(mesh.vertex_uv, corners)
            attributes.append(("TEXCOORD_0", np.stack([uvs[:, 0], 1.0 - uvs[:, 1]], axis=1)))
        if mesh.vertex_color.exists:
            colors = np.clip(_values(mesh.vertex_color, corners), 0.0, 1.0)
            colors[:, :3] **= _LINEAR_FROM_SRGB
            attributes.append(("COLOR_0", colors))
        vertices = np.asarray(mesh.vertex_indices, np.int64)[corners]
        # Corners that agree in everything are one vertex of glTF.
        table = np.concatenate([vertices[:, None], *(values for _, values in attributes)], axis=1)
        _, kept, indices = np.unique(
            table.astype(np.float32), axis=0, return_index=True, return_inverse=True
        )
        written: Json = {
            name: self.builder.accessor(
                values[kept], np.float32, ARRAY_BUFFER, bounds=name == "POSITION"
            )
            for name, values in attributes
        }
        node = self.builder.document["nodes"][number]
        shape: Json = {"name": mesh.name or node["name"]}
        if len(mesh.skin_deformers):
            node["skin"] = self._add_skin(mesh, vertices[kept], written, number_of)
        targets, names, weights = self._targets(mesh, vertices[kept])
        if targets:
            shape |= {"extras": {"targetNames": names}, "weights": weights}
        indices = indices.reshape(-1, 3)
        of_face = np.asarray(mesh.face_material, np.int64) if len(mesh.face_material) else None
        chosen = np.zeros(len(indices), np.int64) if of_face is None else of_face[faces]
        primitives = []
        for used in np.unique(chosen):
            primitive: Json = {
                "attributes": written,
                "indices": self.builder.accessor(
                    indices[chosen == used].reshape(-1), np.uint32, ELEMENT_BUFFER
                ),
            }
            if used < len(mesh.materials):
                primitive["material"] = materials[mesh.materials[int(used)].typed_id]
            if targets:
                primitive["targets"] = targets
            primitives.append(primitive)
        node["mesh"] = self.builder.add("meshes", shape | {"primitives": primitives})

    def _add_skin(
        self, mesh: Any, vertices: NDArray[np.int64], written: Json, number_of: dict[int, int]
    ) -> int:
        skin = mesh.skin_deformers[0]
        clusters = [each for each in skin.clusters if each.bone_node is not None]
        weights = np.zeros((mesh.num_vertices, len(clusters)))
        for column, cluster in enumerate(clusters):
            np.add.at(
                weights[:, column],
                np.asarray(cluster.vertices, np.int64),
                np.asarray(cluster.weights, float),
            )
        strongest = np.argsort(-weights, axis=1, kind="stable")[:, :MAX_INFLUENCES]
        chosen = np.take_along_axis(weights, strongest, 1)
        sums = chosen.sum(axis=1, keepdims=True)
        chosen = np.where(sums > 0.0, chosen / np.where(sums > 0.0, sums, 1.0), 0.0)
        missing = MAX_INFLUENCES - strongest.shape[1]
        joints = np.pad(np.where(chosen > 0.0, strongest, 0), ((0, 0), (0, missing)))
        chosen = np.pad(chosen, ((0, 0), (0, missing)))
        for part in range(MAX_INFLUENCES // 4):
            columns = slice(4 * part, 4 * part + 4)
            for name, values, kind in (
                (f"JOINTS_{part}", joints, np.uint16),
                (f"WEIGHTS_{part}", chosen, np.float32),
            ):
                written[name] = self.builder.accessor(values[vertices, columns], kind, ARRAY_BUFFER)
        binds = np.array([_columns(each.geometry_to_bone) for each in clusters])
        return self.builder.add(
            "skins",
            {
                "joints": [number_of[each.bone_node.typed_id] for each in clusters],
                "inverseBindMatrices": self.builder.accessor(binds, np.float32),
            },
        )

    def _targets(
        self, mesh: Any, vertices: NDArray[np.int64]
    ) -> tuple[list[Json], list[str], list[float]]:
        """Return the morph targets of a mesh, their names and their weights at rest."""
        targets, names, weights = [], [], []
        for channel in (each for blend in mesh.blend_deformers for each in blend.channels):
            shape = channel.target_shape
            if shape is None:
                continue
            offsets = np.zeros((mesh.num_vertices, 3))
            offsets[np.asarray(shape.offset_vertices, np.int64)] = np.asarray(
                shape.position_offsets
            )
            moved = offsets[vertices]
            where = np.flatnonzero(np.abs(moved).max(axis=1) > 0.0).astype(np.uint32)
            targets.append({"POSITION": self.builder.sparse(len(vertices), where, moved[where])})
            names.append(channel.name or shape.name)
            weights.append(min(max(float(channel.weight), 0.0), 1.0))
        return targets, names, weights

    def _add_animation(self, stack: Any, number_of: dict[int, int]) -> None:
        baked = _Kept(ufbx.bake_anim(self.scene.held, stack.anim.held, resample_rate=RATE_HZ))
        animation: Json = {"name": stack.name.rpartition("|")[2], "samplers": [], "channels": []}
        for node in baked.nodes:
            for path, keys, constant in (
                ("translation", node.translation_keys, node.constant_translation),
                ("rotation", node.rotation_keys, node.constant_rotation),
                ("scale", node.scale_keys, node.constant_scale),
            ):
                times, values = _keys(keys, constant, float(stack.time_begin))
                sampler = {
                    "input": self.builder.accessor(times, np.float32, bounds=True),
                    "output": self.builder.accessor(values, np.float32),
                }
                animation["samplers"].append(sampler)
                target = {"node": number_of[node.typed_id], "path": path}
                animation["channels"].append(
                    {"sampler": len(animation["samplers"]) - 1, "target": target}
                )
        if animation["channels"]:
            self.builder.add("animations", animation)


def _triangles(mesh: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the corners of all triangles, three each, and the face of each triangle."""
    faces = np.asarray(mesh.faces, np.int64).reshape(-1, 2)
    begins, counts = faces[:, 0], faces[:, 1]
    most = int(counts.max(initial=0))
    corners, owners = [], []
    for step in range(1, most - 1):  # a fan: faces of characters are nearly convex
        found = np.flatnonzero(counts > step + 1)
        corners.append(begins[found, None] + np.array([0, step, step + 1]))
        owners.append(found)
    if not corners:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    return np.concatenate(corners).reshape(-1), np.concatenate(owners)


def _values(attribute: Any, corners: NDArray[np.int64]) -> Array:
    """Return an attribute at corners, (corners, components)."""
    values: Array = np.asarray(attribute.values, float)
    return values[np.asarray(attribute.indices, np.int64)[corners]]


def _unit(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 1e-9, vectors / np.maximum(lengths, 1e-9), [0.0, 1.0, 0.0])


def _columns(matrix: Iterable[float]) -> list[float]:
    """Return a matrix of ufbx, four columns of three numbers, as the 16 of glTF."""
    numbers = np.asarray(tuple(matrix), float).reshape(4, 3)
    return np.concatenate([numbers, [[0.0], [0.0], [0.0], [1.0]]], axis=1).reshape(-1).tolist()


def _keys(keys: Any, constant: bool, begin: float) -> tuple[Array, Array]:
    """Return times from the beginning of the clip [s], ascending, and values of keys."""
    found = list(_first(keys) if constant else keys)
    times = np.array([key.time for key in found]) - begin
    values = np.array([tuple(key.value) for key in found])
    _, ascending = np.unique(times.astype(np.float32), return_index=True)
    return times[ascending], values[ascending]


def _first(keys: Any) -> Iterator[Any]:
    yield keys[0]


def main() -> None:
    """Convert what comes in; end with the exit code 2 if it cannot be read."""
    code = 0
    try:
        sys.stdout.buffer.write(convert(sys.stdin.buffer.read(), Path(sys.argv[1])))
        sys.stdout.flush()
    except (ufbx.UfbxError, ValueError, LookupError, TypeError, AttributeError) as error:
        sys.stderr.write(f"{error or type(error).__name__}\n")
        code = 2
    sys.stderr.flush()
    os._exit(code)  # frees nothing


if __name__ == "__main__":
    main()
