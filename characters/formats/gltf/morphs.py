"""Reading morph targets as morphs with one weight per name."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.formats.gltf.nodes import NodeTree
from cubeling.characters.model.mesh import Morph
from cubeling.characters.skeleton.pose import Array

_MIN_DISPLACEMENT = 1e-9  # in the file's unit; smaller ones are rounded zeros


@dataclass(frozen=True)
class MorphTable:
    """Which weight drives which morph target."""

    names: tuple[str, ...]
    """Names of all morphs; targets of several meshes with one name share its weight."""

    columns: dict[int, tuple[int, ...]]
    """Index in `names` of each target, by the number of the node with the mesh."""

    rest: Array | None
    """Weights without animation, (morphs,), or None for all zero."""

    def of(self, node: int) -> tuple[str, ...]:
        """Return the names of the targets of a node's mesh."""
        return tuple(self.names[column] for column in self.columns[node])


def read_morph_table(file: GltfFile, tree: NodeTree) -> MorphTable:
    """Return the names of the morphs of the skeleton's meshes, and their weights at rest."""
    of_node: dict[int, tuple[str, ...]] = {}
    defaults: dict[str, float] = {}
    for number in tree.mesh_nodes:
        node = file.document["nodes"][number]
        mesh = file.document["meshes"][node["mesh"]]
        with error_context(label("mesh", node["mesh"], mesh)):
            of_node[number] = names = target_names(mesh, node["mesh"])
            weights = node.get("weights") or mesh.get("weights") or [0.0] * len(names)
            if len(weights) != len(names):
                raise DamagedFileError(f"has {len(weights)} weights for {len(names)} morph targets")
            for name, weight in zip(names, weights, strict=True):
                defaults.setdefault(name, float(weight))
    order, stated = tuple(defaults), file.scene_extra("morphs")
    if isinstance(stated, list) and sorted(map(str, stated)) == sorted(order):
        order = tuple(stated)  # the order of our own writer
    column = {name: number for number, name in enumerate(order)}
    rest = np.array([defaults[name] for name in order])
    return MorphTable(
        order,
        {node: tuple(column[name] for name in names) for node, names in of_node.items()},
        rest if rest.any() else None,
    )


def target_names(mesh: Json, number: int) -> tuple[str, ...]:
    """Return the names of a mesh's morph targets; "MESH.0" where the file states none."""
    counts = {len(primitive.get("targets", ())) for primitive in mesh["primitives"]}
    if len(counts) > 1:
        raise DamagedFileError("has primitives with different numbers of morph targets")
    extras = mesh.get("extras")
    stated = extras.get("targetNames") if isinstance(extras, dict) else None
    stated = stated if isinstance(stated, list) else []
    names: dict[str, None] = {}
    for target in range(counts.pop() if counts else 0):
        name = stated[target] if target < len(stated) else ""
        if not isinstance(name, str) or not name:
            name = f"{mesh.get('name') or f'mesh{number}'}.{target}"
        while name in names:
            name += f".{target}"
        names[name] = None
    return tuple(names)


def read_morphs(
    file: GltfFile, primitive: Json, names: Sequence[str], vertices: int, shared: dict[int, Array]
) -> tuple[Morph, ...]:
    """Return the morph targets of a primitive, in the frame of its vertices.

    `shared` keeps arrays by accessor for the other primitives of the mesh, which often share them.
    """

    def read(accessor: int, name: str) -> Array:
        if accessor not in shared:
            shared[accessor] = file.floats(accessor, 3)
        if len(shared[accessor]) != vertices:
            raise DamagedFileError(
                f"morph target {name!r}: has {len(shared[accessor])} displacements for "
                f"{vertices} vertices"
            )
        return shared[accessor]

    morphs: list[Morph] = []
    for name, target in zip(names, primitive.get("targets", ()), strict=True):
        shifts = read(target["POSITION"], name) if "POSITION" in target else np.zeros((vertices, 3))
        turns = read(target["NORMAL"], name) if "NORMAL" in target else None
        moved = _largest(shifts) > _MIN_DISPLACEMENT
        if turns is not None:
            moved |= _largest(turns) > _MIN_DISPLACEMENT
        where = np.flatnonzero(moved)
        displacements = shifts[where].astype(np.float32)
        normal_displacements = None if turns is None else turns[where].astype(np.float32)
        morphs.append(Morph(name, where.astype(np.uint32), displacements, normal_displacements))
    return tuple(morphs)


def _largest(vectors: Array) -> Array:
    """Return the largest component of each vector (n, 3) without its sign, (n,)."""
    x, y, z = np.abs(vectors).T  # by columns: `max(axis=1)` goes through them one by one
    return np.asarray(np.maximum(np.maximum(x, y), z))


def renumbered_morph(morph: Morph, new_number: NDArray[np.int64]) -> Morph:
    """Return a morph for a mesh with renumbered vertices; −1 marks removed ones."""
    numbers = new_number[morph.vertices]
    kept = numbers >= 0
    turns = morph.normal_displacements
    return Morph(
        morph.name,
        numbers[kept].astype(np.uint32),
        morph.displacements[kept],
        None if turns is None else turns[kept],
    )


def transformed_morph(morph: Morph, normals: Array, linear: Array) -> Morph:
    """Return a morph of a mesh transformed by a matrix (3, 3); `normals` are those before."""
    turned = morph.normal_displacements
    if turned is not None:
        inverse = np.linalg.inv(linear)
        before = normals[morph.vertices]
        turned = (_unit((before + turned) @ inverse) - _unit(before @ inverse)).astype(np.float32)
    displacements = (morph.displacements @ linear.T).astype(np.float32)
    return Morph(morph.name, morph.vertices, displacements, turned)


def _unit(vectors: Array) -> Array:
    lengths: Array = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.maximum(lengths, 1e-12)
