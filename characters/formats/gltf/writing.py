"""From a character to the bytes of a .glb."""

import numpy as np
import pygltflib
from numpy.typing import NDArray

from characters.formats.gltf.buffer import ARRAY_BUFFER, ELEMENT_BUFFER, BufferWriter
from characters.formats.gltf.checks import check
from characters.formats.gltf.materials import MaterialWriter
from characters.model.character import Character
from characters.model.mesh import Mesh, Morph
from characters.motion.clip import Clip
from characters.skeleton.pose import Array, Skeleton

_STILL = 1e-7  # [m or part of a quaternion]: what changes less does not move


def pack(character: Character) -> bytes:
    """Return a .glb with nothing in it that depends on when or where it was made.

    Raises
    ------
    CharacterError
        If the arrays of the character do not fit together.
    """
    check(character)
    return _Packer(character).pack()


class _Packer:
    """Collects arrays into one buffer while the document grows."""

    def __init__(self, character: Character) -> None:
        self.character = character
        self.skins: dict[bytes, int] = {}
        self.times: dict[bytes, int] = {}
        self.document = pygltflib.GLTF2(
            asset=pygltflib.Asset(version="2.0", generator="cubeling"), scene=0
        )
        self.buffer = BufferWriter(self.document)
        self.materials = MaterialWriter(self.document, self.buffer)

    def pack(self) -> bytes:
        joints = len(self.character.skeleton)
        self._nodes(self.character.skeleton)
        for mesh in self.character.meshes:
            self._mesh(mesh)
        for clip in self.character.clips.values():
            self._animation(clip)
        roots = [j for j, parent in enumerate(self.character.skeleton.parents) if parent < 0]
        drawn = range(joints, len(self.document.nodes))
        # What a glTF has no place for: the order of morphs over all meshes, what joints are.
        noted = {
            "morphs": list(self.character.morphs),
            "semantics": dict(sorted(self.character.semantics.items())),
        }
        extras = {key: value for key, value in noted.items() if value}
        self.document.scenes = [
            pygltflib.Scene(name=self.character.name, nodes=[*roots, *drawn], extras=extras)
        ]
        return self.buffer.container()

    def _nodes(self, skeleton: Skeleton) -> None:
        rest = skeleton.rest
        for joint, name in enumerate(skeleton.names):
            node = pygltflib.Node(
                name=name,
                children=[j for j, parent in enumerate(skeleton.parents) if parent == joint],
                translation=rest.translations[joint].tolist(),
                rotation=rest.rotations[joint].tolist(),
            )
            if rest.scales is not None:
                node.scale = rest.scales[joint].tolist()
            self.document.nodes.append(node)

    def _mesh(self, mesh: Mesh) -> None:
        small = len(self.character.skeleton) <= 256
        attributes = pygltflib.Attributes(
            POSITION=self.buffer.accessor(mesh.positions, np.float32, ARRAY_BUFFER, bounds=True),
            NORMAL=self.buffer.accessor(mesh.normals, np.float32, ARRAY_BUFFER),
            JOINTS_0=self.buffer.accessor(
                mesh.joints, np.uint8 if small else np.uint16, ARRAY_BUFFER
            ),
            WEIGHTS_0=self.buffer.accessor(
                _levels(mesh.weights), np.uint16, ARRAY_BUFFER, normalized=True
            ),
        )
        if mesh.colors is not None:
            levels = np.round(np.clip(mesh.colors, 0.0, 1.0) * 65535)
            attributes.COLOR_0 = self.buffer.accessor(
                levels, np.uint16, ARRAY_BUFFER, normalized=True
            )
        if mesh.uvs is not None:
            attributes.TEXCOORD_0 = self.buffer.accessor(mesh.uvs, np.float32, ARRAY_BUFFER)
        wide = np.uint16 if len(mesh.positions) < 65536 else np.uint32
        primitive = pygltflib.Primitive(
            attributes=attributes,
            indices=self.buffer.accessor(mesh.triangles.reshape(-1), wide, ELEMENT_BUFFER),
            material=self.materials.add(mesh.material, mesh.name),
        )
        number = len(self.document.meshes)
        written = pygltflib.Mesh(name=mesh.name, primitives=[primitive])
        if mesh.morphs:
            primitive.targets = [self._target(len(mesh.positions), m) for m in mesh.morphs]
            written.extras = {"targetNames": [morph.name for morph in mesh.morphs]}
            rest = self.character.skeleton.rest.morphs
            if rest is not None:
                written.weights = rest[self._columns(mesh)].tolist()
        self.document.meshes.append(written)
        skin = self._skin(mesh.inverse_bind)
        self.document.nodes.append(pygltflib.Node(name=mesh.name, mesh=number, skin=skin))

    def _target(self, count: int, morph: Morph) -> pygltflib.Attributes:
        target = pygltflib.Attributes()
        target.POSITION = self.buffer.sparse(count, morph.vertices, morph.shifts)
        if morph.normal_shifts is not None:
            target.NORMAL = self.buffer.sparse(count, morph.vertices, morph.normal_shifts)
        return target

    def _columns(self, mesh: Mesh) -> list[int]:
        """Return where in `Pose.morphs` the weights of a mesh's morphs stand."""
        return [self.character.morphs.index(morph.name) for morph in mesh.morphs]

    def _skin(self, inverse_bind: NDArray[np.float64]) -> int:
        """Return the number of the skin with these bind matrices, which meshes may share."""
        columns = np.ascontiguousarray(np.swapaxes(inverse_bind, 1, 2), np.float32)
        key = columns.tobytes()
        if key not in self.skins:
            self.skins[key] = len(self.document.skins)
            self.document.skins.append(
                pygltflib.Skin(
                    inverseBindMatrices=self.buffer.accessor(columns.reshape(-1, 16), np.float32),
                    joints=list(range(len(self.character.skeleton))),
                )
            )
        return self.skins[key]

    def _animation(self, clip: Clip) -> None:
        """Write a clip; what stays as it rests is left out."""
        animation = pygltflib.Animation(
            name=clip.name, extras={"rate": float(clip.rate), "loop": clip.loop}
        )
        for node, path, values in [*self._tracks(clip), *self._weight_tracks(clip)]:
            frames = np.arange(len(clip))
            if len(clip) > 2 and np.ptp(values, axis=0).max() < _STILL:
                frames = frames[[0, -1]]
            keys = values[frames].reshape(-1) if path == "weights" else values[frames]
            sampler = pygltflib.AnimationSampler(
                input=self._times(frames / clip.rate),
                output=self.buffer.accessor(keys, np.float32),
            )
            target = pygltflib.AnimationChannelTarget(node=node, path=path)
            channel = pygltflib.AnimationChannel(sampler=len(animation.samplers), target=target)
            animation.samplers.append(sampler)
            animation.channels.append(channel)
        self.document.animations.append(animation)

    def _tracks(self, clip: Clip) -> list[tuple[int, str, Array]]:
        """Return joint, path and values (frames, components) of all that leaves its rest."""
        rest, poses = self.character.skeleton.rest, clip.poses
        kinds = [
            ("translation", poses.translations, rest.translations),
            ("rotation", poses.rotations, rest.rotations),
        ]
        if poses.scales is not None:
            still = np.ones_like(rest.translations) if rest.scales is None else rest.scales
            kinds.append(("scale", poses.scales, still))
        return [
            (joint, path, values[:, joint])
            for path, values, resting in kinds
            for joint in range(values.shape[1])
            if (joint == 0 and path == "rotation")  # keeps the clip's length
            or np.abs(values[:, joint] - resting[joint]).max() >= _STILL
        ]

    def _weight_tracks(self, clip: Clip) -> list[tuple[int, str, Array]]:
        """Return node, path and values (frames, targets) of the meshes whose morphs change."""
        rest = self.character.skeleton.rest.morphs
        if clip.poses.morphs is None:
            return []
        away = clip.poses.morphs - (0.0 if rest is None else rest)
        moved = np.abs(away).max(axis=0, initial=0.0) >= _STILL
        first = len(self.character.skeleton)
        return [
            (first + number, "weights", clip.poses.morphs[:, columns])
            for number, columns in enumerate(map(self._columns, self.character.meshes))
            if moved[columns].any()
        ]

    def _times(self, times: Array) -> int:
        """Return the accessor of key times, which many tracks share."""
        key = times.tobytes()
        if key not in self.times:
            self.times[key] = self.buffer.accessor(times, np.float32, bounds=True)
        return self.times[key]


def _levels(weights: NDArray[np.float32]) -> Array:
    """Return skin weights in 65535ths that sum to the whole: the rest goes to the largest."""
    levels = np.round(weights.astype(float) * 65535)
    rows = np.arange(len(levels))
    levels[rows, levels.argmax(1)] += 65535 - levels.sum(1)
    return levels
