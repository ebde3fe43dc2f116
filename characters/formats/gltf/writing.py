"""Writing a character as a .glb."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.gltf.buffer import ARRAY_BUFFER, ELEMENT_BUFFER, GlbBuilder
from cubeling.characters.formats.gltf.document import Json
from cubeling.characters.formats.gltf.followers import EXTRA, followers_of
from cubeling.characters.formats.gltf.materials import MaterialWriter
from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Mesh, Morph
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.files import write_whole

MIN_CHANGE = 1e-7  # [m or part of a quaternion]: smaller changes are not written


def save(character: Character, path: Path) -> None:
    """Write a .glb; the same character gives the same bytes."""
    _check_character(character)
    data = _CharacterWriter(character).glb()
    write_whole(path, data, CharacterError)


class _CharacterWriter:
    """Builds the document of a character."""

    def __init__(self, character: Character) -> None:
        self._character = character
        self._skins: dict[bytes, int] = {}
        self._time_accessors: dict[bytes, int] = {}
        self._builder = GlbBuilder()
        self._materials = MaterialWriter(self._builder)

    def glb(self) -> bytes:
        character = self._character
        self._add_joints(character.skeleton)
        for mesh in character.meshes:
            self._add_mesh(mesh)
        for clip in character.clips.values():
            self._add_animation(clip)
        roots = [j for j, parent in enumerate(character.skeleton.parents) if parent < 0]
        joints = len(character.skeleton)
        scene: Json = {
            "name": character.name,
            "nodes": [*roots, *range(joints, joints + len(character.meshes))],
        }
        # glTF has no place for the order of morphs over all meshes and for body parts.
        extras = {
            "morphs": list(character.morphs),
            "semantics": dict(character.semantics),
            EXTRA: followers_of(character),
        }
        if any(extras.values()):
            scene["extras"] = {key: value for key, value in extras.items() if value}
        self._builder.add("scenes", scene)
        return self._builder.glb()

    def _add_joints(self, skeleton: Skeleton) -> None:
        rest = skeleton.rest
        for joint, name in enumerate(skeleton.names):
            node: Json = {
                "name": name,
                "translation": rest.translations[joint].tolist(),
                "rotation": rest.rotations[joint].tolist(),
            }
            children = [j for j, parent in enumerate(skeleton.parents) if parent == joint]
            if children:
                node["children"] = children
            if rest.scales is not None:
                node["scale"] = rest.scales[joint].tolist()
            self._builder.add("nodes", node)

    def _add_mesh(self, mesh: Mesh) -> None:
        add = self._builder.accessor
        joint_type = np.uint8 if len(self._character.skeleton) <= 256 else np.uint16
        attributes = {
            "POSITION": add(mesh.positions, np.float32, ARRAY_BUFFER, bounds=True),
            "NORMAL": add(mesh.normals, np.float32, ARRAY_BUFFER),
            "JOINTS_0": add(mesh.joints, joint_type, ARRAY_BUFFER),
            "WEIGHTS_0": add(_quantise(mesh.weights), np.uint16, ARRAY_BUFFER, normalized=True),
        }
        if mesh.colors is not None:
            levels = np.round(np.clip(mesh.colors, 0.0, 1.0) * 65535)
            attributes["COLOR_0"] = add(levels, np.uint16, ARRAY_BUFFER, normalized=True)
        if mesh.uvs is not None:
            attributes["TEXCOORD_0"] = add(mesh.uvs, np.float32, ARRAY_BUFFER)
        index_type = np.uint16 if len(mesh.positions) < 65536 else np.uint32
        primitive: Json = {
            "attributes": attributes,
            "indices": add(mesh.triangles.reshape(-1), index_type, ELEMENT_BUFFER),
            "material": self._materials.add(mesh.material, mesh.name),
        }
        item: Json = {"name": mesh.name, "primitives": [primitive]}
        if mesh.morphs:
            primitive["targets"] = [self._target(len(mesh.positions), m) for m in mesh.morphs]
            item["extras"] = {"targetNames": [morph.name for morph in mesh.morphs]}
            rest = self._character.skeleton.rest.morphs
            if rest is not None:
                item["weights"] = rest[self._columns(mesh)].tolist()
        number = self._builder.add("meshes", item)
        skin = self._skin(mesh.inverse_bind)
        self._builder.add("nodes", {"name": mesh.name, "mesh": number, "skin": skin})

    def _target(self, count: int, morph: Morph) -> dict[str, int]:
        target = {"POSITION": self._builder.sparse(count, morph.vertices, morph.displacements)}
        if morph.normal_displacements is not None:
            target["NORMAL"] = self._builder.sparse(
                count, morph.vertices, morph.normal_displacements
            )
        return target

    def _columns(self, mesh: Mesh) -> list[int]:
        """Return the columns of a mesh's morphs in `Pose.morphs`."""
        return [self._character.morphs.index(morph.name) for morph in mesh.morphs]

    def _skin(self, inverse_bind: NDArray[np.float64]) -> int:
        """Return the number of the skin with these matrices; meshes may share it."""
        columns = np.ascontiguousarray(np.swapaxes(inverse_bind, 1, 2), np.float32)
        key = columns.tobytes()
        if key not in self._skins:
            matrices = self._builder.accessor(columns.reshape(-1, 16), np.float32)
            joints = list(range(len(self._character.skeleton)))
            skin = {"inverseBindMatrices": matrices, "joints": joints}
            self._skins[key] = self._builder.add("skins", skin)
        return self._skins[key]

    def _add_animation(self, clip: Clip) -> None:
        """Write a clip without the values that stay at rest."""
        samplers: list[Json] = []
        channels: list[Json] = []
        for node, path, values in [*self._joint_tracks(clip), *self._weight_tracks(clip)]:
            frames = np.arange(len(clip))
            if len(clip) > 2 and np.ptp(values, axis=0).max() < MIN_CHANGE:
                frames = frames[[0, -1]]
            keys = values[frames].reshape(-1) if path == "weights" else values[frames]
            times = self._times(frames / clip.rate)
            channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
            samplers.append({"input": times, "output": self._builder.accessor(keys, np.float32)})
        animation = {
            "name": clip.name,
            "samplers": samplers,
            "channels": channels,
            "extras": {"rate": float(clip.rate), "loop": clip.loop},
        }
        self._builder.add("animations", animation)

    def _joint_tracks(self, clip: Clip) -> list[tuple[int, str, Array]]:
        """Return joint, path and values (frames, components) that differ from the rest pose."""
        rest, poses = self._character.skeleton.rest, clip.poses
        kinds = [
            ("translation", poses.translations, rest.translations),
            ("rotation", poses.rotations, rest.rotations),
        ]
        if poses.scales is not None:
            kinds.append(("scale", poses.scales, rest.scales_or_ones))
        return [
            (joint, path, values[:, joint])
            for path, values, resting in kinds
            for joint in range(values.shape[1])
            if (joint == 0 and path == "rotation")  # keeps the clip's duration
            or np.abs(values[:, joint] - resting[joint]).max() >= MIN_CHANGE
        ]

    def _weight_tracks(self, clip: Clip) -> list[tuple[int, str, Array]]:
        """Return node, path and values (frames, targets) of the meshes whose weights change."""
        rest = self._character.skeleton.rest.morphs
        if clip.poses.morphs is None:
            return []
        change = clip.poses.morphs - (0.0 if rest is None else rest)
        moved = np.abs(change).max(axis=0, initial=0.0) >= MIN_CHANGE
        first = len(self._character.skeleton)
        return [
            (first + number, "weights", clip.poses.morphs[:, columns])
            for number, columns in enumerate(map(self._columns, self._character.meshes))
            if moved[columns].any()
        ]

    def _times(self, times: Array) -> int:
        """Return the accessor of key times, which many samplers share."""
        key = times.tobytes()
        if key not in self._time_accessors:
            self._time_accessors[key] = self._builder.accessor(times, np.float32, bounds=True)
        return self._time_accessors[key]


def _quantise(weights: NDArray[np.float32]) -> Array:
    """Return skin weights in 65535ths with an exact sum: the remainder goes to the largest."""
    levels = np.round(weights.astype(float) * 65535)
    rows = np.arange(len(levels))
    levels[rows, levels.argmax(1)] += 65535 - levels.sum(1)
    return levels


def _check_character(character: Character) -> None:
    """Refuse a character whose arrays do not fit together."""
    joints, morphs = len(character.skeleton), len(character.morphs)
    for clip in character.clips.values():
        if clip.poses.rotations.shape[1] != joints:
            raise CharacterError(
                f"clip {clip.name!r} moves {clip.poses.rotations.shape[1]} joints, "
                f"the skeleton has {joints}"
            )
        if clip.poses.morphs is not None and clip.poses.morphs.shape != (len(clip), morphs):
            raise CharacterError(
                f"clip {clip.name!r} has morphs of shape {clip.poses.morphs.shape}, "
                f"not {(len(clip), morphs)}"
            )
    for mesh in character.meshes:
        _check_mesh(mesh, joints)
    _check_morphs(character)


def _check_mesh(mesh: Mesh, joints: int) -> None:
    count = len(mesh.positions)
    fits = (
        mesh.normals.shape == (count, 3)
        and mesh.joints.shape == mesh.weights.shape == (count, 4)
        and mesh.inverse_bind.shape == (joints, 4, 4)
        and (not mesh.triangles.size or int(mesh.triangles.max()) < count)
        and (not mesh.joints.size or int(mesh.joints.max()) < joints)
    )
    if not fits:
        raise CharacterError(f"mesh {mesh.name!r}: its arrays do not fit together")
    if count and np.abs(mesh.weights.sum(1) - 1).max() > 1e-3:
        raise CharacterError(f"mesh {mesh.name!r}: its skin weights do not sum to one")
    for morph in mesh.morphs:
        shape = (len(morph.vertices), 3)
        ascends = bool((np.diff(morph.vertices.astype(np.int64)) > 0).all())
        inside = not len(morph.vertices) or int(morph.vertices[-1]) < count
        normals_fit = (
            morph.normal_displacements is None or morph.normal_displacements.shape == shape
        )
        if not (ascends and inside and normals_fit and morph.displacements.shape == shape):
            raise CharacterError(
                f"mesh {mesh.name!r}: the arrays of its morph {morph.name!r} do not fit together"
            )


def _check_morphs(character: Character) -> None:
    """Refuse names that reading the file would not give back."""
    for mesh in character.meshes:
        names = [morph.name for morph in mesh.morphs]
        if len(set(names)) < len(names) or not set(names) <= set(character.morphs):
            raise CharacterError(
                f"mesh {mesh.name!r}: each of its morphs needs a name of its own out of "
                f"Character.morphs, which are {', '.join(character.morphs) or 'none'}"
            )
    used = {morph.name for mesh in character.meshes for morph in mesh.morphs}
    unused = [name for name in character.morphs if name not in used]
    if unused or len(set(character.morphs)) < len(character.morphs):
        raise CharacterError(
            f"Character.morphs {', '.join(unused or character.morphs)}: each must be named once, "
            "and be a morph of some mesh"
        )
