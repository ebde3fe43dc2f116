"""Materials of glTF: metallic-roughness with its textures, and back."""

import math
import warnings
from dataclasses import dataclass

import numpy as np
import pygltflib
from numpy.typing import NDArray

from characters.errors import CharacterWarning
from characters.formats.gltf.buffer import BufferWriter
from characters.formats.gltf.document import DamagedFileError, Json, at, called
from characters.formats.gltf.file import GltfFile
from characters.formats.gltf.images import Images, Picture, png
from characters.model.mesh import Material

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Look:
    """A material, and how its textures lie."""

    material: Material
    """What is drawn."""

    uv_set: int = 0
    """Which TEXCOORD_n its textures use."""

    place: Array | None = None
    """(2, 3): what a texture coordinate with a 1 behind it is multiplied by, or None for itself."""


def read_materials(file: GltfFile) -> list[Look]:
    """Return the look of each material."""
    images = Images(file)
    looks: list[Look] = []
    for number, material in enumerate(file.all("materials")):
        name = called("material", number, material)
        with at(name):
            looks.append(_look(material, images, f"{file.path}: {name}"))
    return looks


def _look(material: Json, images: Images, where: str) -> Look:
    pbr = material.get("pbrMetallicRoughness", {})
    unlit = "KHR_materials_unlit" in material.get("extensions", {})
    color, surface = pbr.get("baseColorTexture"), pbr.get("metallicRoughnessTexture")
    bumps = material.get("normalTexture")
    if unlit:
        surface = bumps = None
    lain = [texture for texture in (color, surface, bumps) if texture]
    uv_set, place = _lie(lain[0]) if lain else (0, None)
    if any(not _same(_lie(texture), (uv_set, place)) for texture in lain):
        # One set of coordinates a mesh: the first texture, its colour if it has one, has them.
        warnings.warn(
            f"{where} has textures that lie differently; left all but the first out",
            CharacterWarning,
            stacklevel=2,
        )
        color, surface, bumps = (
            t if t and _same(_lie(t), (uv_set, place)) else None for t in (color, surface, bumps)
        )
    factor = [float(c) for c in pbr.get("baseColorFactor", (1, 1, 1, 1))]
    return Look(
        Material(
            base_color=(factor[0], factor[1], factor[2], factor[3]),
            metallic=0.0 if unlit else float(pbr.get("metallicFactor", 1.0)),
            roughness=1.0 if unlit else float(pbr.get("roughnessFactor", 1.0)),
            texture=images.texture(color["index"], "RGBA") if color else None,
            surface=images.texture(surface["index"], "RGB") if surface else None,
            bumps=images.texture(bumps["index"], "RGB") if bumps else None,
            bump_scale=float(bumps.get("scale", 1.0)) if bumps else 1.0,
            glow=_glow(material, images),
            cutoff=_cutoff(material),
            double_sided=bool(material.get("doubleSided", False)),
        ),
        uv_set,
        place,
    )


def _lie(texture: Json) -> tuple[int, Array | None]:
    """Return the set of coordinates that a texture uses and what they go through.

    KHR_texture_transform: offset after rotation after scale. As v points down, counter-clockwise
    takes u towards −v; three.js and Khronos's sample viewer agree.
    """
    uv_set = int(texture.get("texCoord", 0))
    transform = texture.get("extensions", {}).get("KHR_texture_transform")
    if transform is None:
        return uv_set, None
    x, y = transform.get("scale", (1.0, 1.0))
    turn = transform.get("rotation", 0.0)
    cos, sin = math.cos(turn), math.sin(turn)
    u, v = transform.get("offset", (0.0, 0.0))
    place = np.array([[cos * x, sin * y, u], [-sin * x, cos * y, v]], float)
    return int(transform.get("texCoord", uv_set)), place


def _same(a: tuple[int, Array | None], b: tuple[int, Array | None]) -> bool:
    unmoved = np.eye(2, 3)
    first, second = (unmoved if place is None else place for _, place in (a, b))
    return a[0] == b[0] and np.allclose(first, second, atol=1e-6)


def _glow(material: Json, images: Images) -> tuple[float, float, float]:
    """Return the emission; of a texture of emission its mean, as one colour stands for all."""
    factor = np.array(material.get("emissiveFactor", (0.0, 0.0, 0.0)), float)
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {})
    factor *= float(strength.get("emissiveStrength", 1.0))
    texture = material.get("emissiveTexture")
    if texture and factor.any():
        picture = images.texture(texture["index"], "RGB")
        if picture is not None:
            factor *= (picture.reshape(-1, 3) / 255.0).mean(axis=0) ** 2.2  # sRGB to linear
    red, green, blue = factor.tolist()
    return red, green, blue


def _cutoff(material: Json) -> float | None:
    """Return the alpha below which nothing is drawn.

    Blended surfaces are cut at a half: drawn whole, lashes and brows would be sheets of paper.
    """
    mode = material.get("alphaMode", "OPAQUE")
    if mode == "OPAQUE":
        return None
    if mode not in ("MASK", "BLEND"):
        raise DamagedFileError(f"alphaMode is {mode!r:.20}")
    return float(material.get("alphaCutoff", 0.5)) if mode == "MASK" else 0.5


class MaterialWriter:
    """Lists materials in a document, and each of their pictures once."""

    def __init__(self, document: pygltflib.GLTF2, buffer: BufferWriter) -> None:
        self._document, self._buffer = document, buffer
        self._written: dict[bytes, int] = {}

    def add(self, material: Material, name: str) -> int:
        """Append a material and return its number."""
        surface = pygltflib.PbrMetallicRoughness(
            baseColorFactor=list(material.base_color),
            metallicFactor=material.metallic,
            roughnessFactor=material.roughness,
        )
        written = pygltflib.Material(
            name=name,
            pbrMetallicRoughness=surface,
            doubleSided=material.double_sided,
            alphaCutoff=None,
        )
        if material.texture is not None:
            surface.baseColorTexture = pygltflib.TextureInfo(index=self._texture(material.texture))
        if material.surface is not None:
            surface.metallicRoughnessTexture = pygltflib.TextureInfo(
                index=self._texture(material.surface)
            )
        if material.bumps is not None:
            written.normalTexture = pygltflib.NormalMaterialTexture(
                index=self._texture(material.bumps), scale=material.bump_scale
            )
        if any(material.glow):
            self._glow(written, material.glow)
        if material.cutoff is not None:
            written.alphaMode, written.alphaCutoff = "MASK", material.cutoff
        self._document.materials.append(written)
        return len(self._document.materials) - 1

    def _glow(self, written: pygltflib.Material, glow: tuple[float, float, float]) -> None:
        """Write the emission; what is brighter than one takes an extension."""
        brightest = max(*glow, 1.0)
        written.emissiveFactor = [part / brightest for part in glow]
        if brightest > 1.0:
            name = "KHR_materials_emissive_strength"
            written.extensions = {name: {"emissiveStrength": brightest}}
            if name not in self._document.extensionsUsed:
                self._document.extensionsUsed.append(name)

    def _texture(self, picture: Picture) -> int:
        data = png(picture)
        if data not in self._written:
            self._written[data] = len(self._document.textures)
            image = pygltflib.Image(bufferView=self._buffer.view(data), mimeType="image/png")
            self._document.images.append(image)
            source = len(self._document.images) - 1
            self._document.textures.append(pygltflib.Texture(source=source))
        return self._written[data]
