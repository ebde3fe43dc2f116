"""From a character to the bytes of a .glb."""

import json
import struct

import cv2
import numpy as np
import pygltflib
from numpy.typing import ArrayLike, NDArray

from characters.character import Character
from characters.clip import Clip
from characters.errors import CharacterError
from characters.formats.gltf_file import COMPONENTS, WIDTHS
from characters.mesh import Material, Mesh
from characters.pose import Array, Skeleton

_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 2: "VEC2", 16: "MAT4"}
_COMPONENT_OF = {np.dtype(dtype): code for code, dtype in COMPONENTS.items()}
_STILL = 1e-7  # [m or part of a quaternion]: what changes less does not move
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963

assert all(WIDTHS[name] == width for width, name in _TYPES.items())


def pack(character: Character) -> bytes:
    """Return a .glb with nothing in it that depends on when or where it was made.

    Raises
    ------
    CharacterError
        If the arrays of the character do not fit together.
    """
    _check(character)
    return _Packer(character).pack()


def _check(character: Character) -> None:
    joints = len(character.skeleton)
    for clip in character.clips.values():
        if clip.poses.rotations.shape[1] != joints:
            raise CharacterError(
                f"clip {clip.name!r} moves {clip.poses.rotations.shape[1]} joints, "
                f"the skeleton has {joints}"
            )
    for mesh in character.meshes:
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


class _Packer:
    """Collects arrays into one buffer while the document grows."""

    def __init__(self, character: Character) -> None:
        self.character = character
        self.blob = bytearray()
        self.skins: dict[bytes, int] = {}
        self.times: dict[bytes, int] = {}
        self.document = pygltflib.GLTF2(
            asset=pygltflib.Asset(version="2.0", generator="cubeling"), scene=0
        )

    def pack(self) -> bytes:
        joints = len(self.character.skeleton)
        self._nodes(self.character.skeleton)
        for mesh in self.character.meshes:
            self._mesh(mesh)
        for clip in self.character.clips.values():
            self._animation(clip)
        roots = [j for j, parent in enumerate(self.character.skeleton.parents) if parent < 0]
        drawn = range(joints, len(self.document.nodes))
        self.document.scenes = [pygltflib.Scene(name=self.character.name, nodes=[*roots, *drawn])]
        self.document.buffers = [pygltflib.Buffer(byteLength=len(self.blob))]
        return _container(self.document, bytes(self.blob))

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
            POSITION=self._accessor(mesh.positions, np.float32, _ARRAY_BUFFER, bounds=True),
            NORMAL=self._accessor(mesh.normals, np.float32, _ARRAY_BUFFER),
            JOINTS_0=self._accessor(mesh.joints, np.uint8 if small else np.uint16, _ARRAY_BUFFER),
            WEIGHTS_0=self._accessor(
                _levels(mesh.weights), np.uint16, _ARRAY_BUFFER, normalized=True
            ),
        )
        if mesh.colors is not None:
            levels = np.round(np.clip(mesh.colors, 0.0, 1.0) * 65535)
            attributes.COLOR_0 = self._accessor(levels, np.uint16, _ARRAY_BUFFER, normalized=True)
        if mesh.uvs is not None:
            attributes.TEXCOORD_0 = self._accessor(mesh.uvs, np.float32, _ARRAY_BUFFER)
        wide = np.uint16 if len(mesh.positions) < 65536 else np.uint32
        primitive = pygltflib.Primitive(
            attributes=attributes,
            indices=self._accessor(mesh.triangles.reshape(-1), wide, _ELEMENT_BUFFER),
            material=self._material(mesh.material, mesh.name),
        )
        number = len(self.document.meshes)
        self.document.meshes.append(pygltflib.Mesh(name=mesh.name, primitives=[primitive]))
        skin = self._skin(mesh.inverse_bind)
        self.document.nodes.append(pygltflib.Node(name=mesh.name, mesh=number, skin=skin))

    def _skin(self, inverse_bind: NDArray[np.float64]) -> int:
        """Return the number of the skin with these bind matrices, which meshes may share."""
        columns = np.ascontiguousarray(np.swapaxes(inverse_bind, 1, 2), np.float32)
        key = columns.tobytes()
        if key not in self.skins:
            self.skins[key] = len(self.document.skins)
            self.document.skins.append(
                pygltflib.Skin(
                    inverseBindMatrices=self._accessor(columns.reshape(-1, 16), np.float32),
                    joints=list(range(len(self.character.skeleton))),
                )
            )
        return self.skins[key]

    def _material(self, material: Material, name: str) -> int:
        surface = pygltflib.PbrMetallicRoughness(
            baseColorFactor=list(material.base_color),
            metallicFactor=material.metallic,
            roughnessFactor=material.roughness,
        )
        if material.texture is not None:
            surface.baseColorTexture = pygltflib.TextureInfo(index=self._texture(material.texture))
        self.document.materials.append(
            pygltflib.Material(
                name=name,
                pbrMetallicRoughness=surface,
                doubleSided=material.double_sided,
                alphaCutoff=None,
            )
        )
        return len(self.document.materials) - 1

    def _texture(self, picture: NDArray[np.uint8]) -> int:
        _, png = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGBA2BGRA))
        number = len(self.document.images)
        self.document.images.append(
            pygltflib.Image(bufferView=self._view(png.tobytes()), mimeType="image/png")
        )
        self.document.textures.append(pygltflib.Texture(source=number))
        return number

    def _animation(self, clip: Clip) -> None:
        """Write a clip; what stays as it rests is left out."""
        animation = pygltflib.Animation(
            name=clip.name, extras={"rate": float(clip.rate), "loop": clip.loop}
        )
        for joint, path, values in self._tracks(clip):
            frames = np.arange(len(clip))
            if np.ptp(values, axis=0).max() < _STILL:
                frames = frames[[0, -1]]
            sampler = pygltflib.AnimationSampler(
                input=self._times(frames / clip.rate),
                output=self._accessor(values[frames], np.float32),
            )
            target = pygltflib.AnimationChannelTarget(node=joint, path=path)
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

    def _times(self, times: Array) -> int:
        """Return the accessor of key times, which many tracks share."""
        key = times.tobytes()
        if key not in self.times:
            self.times[key] = self._accessor(times, np.float32, bounds=True)
        return self.times[key]

    def _accessor(
        self,
        values: ArrayLike,
        dtype: type[np.generic],
        target: int | None = None,
        *,
        bounds: bool = False,
        normalized: bool = False,
    ) -> int:
        """Append an array, (count, components) or (count,), and return its accessor's number."""
        array = np.ascontiguousarray(values, np.dtype(dtype).newbyteorder("<"))
        rows = array.reshape(len(array), -1)
        accessor = pygltflib.Accessor(
            bufferView=self._view(array.tobytes(), target),
            componentType=_COMPONENT_OF[np.dtype(dtype)],
            count=len(rows),
            type=_TYPES[rows.shape[1]],
            normalized=normalized,
        )
        if bounds:
            accessor.min, accessor.max = rows.min(0).tolist(), rows.max(0).tolist()
        self.document.accessors.append(accessor)
        return len(self.document.accessors) - 1

    def _view(self, data: bytes, target: int | None = None) -> int:
        view = pygltflib.BufferView(
            buffer=0, byteOffset=len(self.blob), byteLength=len(data), target=target
        )
        self.blob += data + bytes(-len(data) % 4)
        self.document.bufferViews.append(view)
        return len(self.document.bufferViews) - 1


def _levels(weights: NDArray[np.float32]) -> Array:
    """Return skin weights in 65535ths that sum to the whole: the rest goes to the largest."""
    levels = np.round(weights.astype(float) * 65535)
    rows = np.arange(len(levels))
    levels[rows, levels.argmax(1)] += 65535 - levels.sum(1)
    return levels


def _container(document: pygltflib.GLTF2, blob: bytes) -> bytes:
    """Return the header and the two chunks."""
    plain = json.loads(document.to_json())
    text = json.dumps(plain, separators=(",", ":"), sort_keys=True).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
