"""Reading and writing metallic-roughness materials with their textures.

Images are measured before they are decoded, and written as PNG.
"""

import io
import math
import warnings
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterWarning
from cubeling.characters.formats.gltf.buffer import GlbBuilder
from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from cubeling.characters.formats.gltf.file import GltfFile, without_ktx
from cubeling.characters.formats.gltf.vrm import mtoon
from cubeling.characters.model.mesh import Material, ToonShading
from cubeling.characters.skeleton.pose import Array

Image = NDArray[np.uint8]
"""(height, width, 3 or 4), RGB or RGBA."""

_KTX_MAGIC = b"\xabKTX 20"

MAX_SIDE_PX = 8192  # graphics cards guarantee hardly more


class _ImageDecoder:
    """Decodes each requested image of a file once."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._decoded: dict[tuple[int, str], Image] = {}
        self._has_ktx = False

    def texture(self, index: int, mode: Literal["RGB", "RGBA"]) -> Image | None:
        """Return the image of a texture, or None if it has none that is read."""
        texture = self._file.document["textures"][index]
        webp, basis = (
            texture.get("extensions", {}).get(name, {})
            for name in ("EXT_texture_webp", "KHR_texture_basisu")
        )
        source = webp.get("source", texture.get("source", basis.get("source")))
        if source is None:
            return None
        if (source, mode) not in self._decoded:
            image = self._file.document["images"][source]
            name = label("image", source, image)
            if "uri" in image:
                data: bytes | memoryview = self._file.resource(image["uri"])
            elif "bufferView" in image:
                data = self._file.view(image["bufferView"])
            else:
                raise DamagedFileError(f"{name} has no data")
            if data[:7] == _KTX_MAGIC:
                self._warn_of_ktx()
                return None
            self._decoded[source, mode] = self._decode(data, name, mode)
        return self._decoded[source, mode]

    def _warn_of_ktx(self) -> None:
        if not self._has_ktx:
            self._has_ktx = True
            advice = without_ktx(self._file.path, self._file.document)
            self._file.warn(f"its textures are KTX2 and are not drawn; {advice}")

    def _decode(self, data: bytes | memoryview, name: str, mode: Literal["RGB", "RGBA"]) -> Image:
        import PIL.Image

        try:
            # Warnings of the library, for example about palettes, need no action.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with PIL.Image.open(io.BytesIO(data), formats=("PNG", "JPEG", "WEBP")) as opened:
                    self._check_size(opened.size, name)
                    if opened.mode.startswith("I;16") or opened.mode == "I":
                        grey = (np.asarray(opened).astype(np.uint32) >> 8).astype(np.uint8)
                        return np.asarray(PIL.Image.fromarray(grey).convert(mode))
                    return np.asarray(opened.convert(mode))
        except PIL.UnidentifiedImageError:
            raise DamagedFileError(f"{name} is neither PNG, JPEG nor WebP") from None
        except PIL.Image.DecompressionBombError:
            raise DamagedFileError(f"{name} is larger than {MAX_SIDE_PX} pixels per side") from None
        # PIL raises any of these for a truncated or invalid file.
        except (OSError, SyntaxError, EOFError, IndexError, OverflowError, TypeError) as error:
            raise DamagedFileError(f"{name} is damaged ({error})") from None

    def _check_size(self, size: tuple[int, int], name: str) -> None:
        """Refuse an image by its header, before it is decoded."""
        width, height = size
        if not (0 < width <= MAX_SIDE_PX and 0 < height <= MAX_SIDE_PX):
            raise DamagedFileError(
                f"{name} has {width} × {height} pixels; scale it to {MAX_SIDE_PX} at most"
            )
        self._file.budget.spend_pixels(width * height, name)


@dataclass(frozen=True)
class MappedMaterial:
    """A material with the mapping of its textures."""

    material: Material

    uv_set: int = 0
    """The number n of the TEXCOORD_n that its textures use."""

    uv_transform: Array | None = None
    """(2, 3): the affine transform of texture coordinates, or None for the identity."""


def read_materials(file: GltfFile) -> list[MappedMaterial]:
    """Return all materials of a file."""
    images = _ImageDecoder(file)
    materials: list[MappedMaterial] = []
    for number, material in enumerate(file.all("materials")):
        name = label("material", number, material)
        with error_context(name):
            toon = mtoon.extension_of(file, number, material)
            materials.append(_material(material, toon, images, f"{file.path}: {name}"))
    return materials


def _material(
    material: Json, toon: Json | None, images: _ImageDecoder, where: str
) -> MappedMaterial:
    pbr = material.get("pbrMetallicRoughness", {})
    unlit = toon is None and "KHR_materials_unlit" in material.get("extensions", {})
    diffuse = unlit or toon is not None
    color, surface = pbr.get("baseColorTexture"), pbr.get("metallicRoughnessTexture")
    bumps, shade = material.get("normalTexture"), (toon or {}).get("shadeMultiplyTexture")
    open_share, glow = material.get("occlusionTexture"), material.get("emissiveTexture")
    surface, open_share = (None if diffuse else each for each in (surface, open_share))
    bumps = None if unlit else bumps
    textures = [each for each in (color, surface, bumps, shade, glow, open_share) if each]
    mapping = _mapping(textures[0]) if textures else (0, None)
    if any(not _same(_mapping(texture), mapping) for texture in textures):
        # A mesh has one set of coordinates: that of its first texture.
        warnings.warn(
            f"{where} has textures with different coordinates; kept those of the first",
            CharacterWarning,
            stacklevel=2,
        )
        color, surface, bumps, shade, glow, open_share = (
            t if t and _same(_mapping(t), mapping) else None
            for t in (color, surface, bumps, shade, glow, open_share)
        )
    factor = [float(c) for c in pbr.get("baseColorFactor", (1, 1, 1, 1))]
    return MappedMaterial(
        Material(
            base_color=(factor[0], factor[1], factor[2], factor[3]),
            metallic=0.0 if diffuse else float(pbr.get("metallicFactor", 1.0)),
            roughness=1.0 if diffuse else float(pbr.get("roughnessFactor", 1.0)),
            base_color_texture=images.texture(color["index"], "RGBA") if color else None,
            metallic_roughness_texture=images.texture(surface["index"], "RGB") if surface else None,
            normal_texture=images.texture(bumps["index"], "RGB") if bumps else None,
            normal_scale=float(bumps.get("scale", 1.0)) if bumps else 1.0,
            emissive=_emission(material, images, glow),
            emissive_texture=images.texture(glow["index"], "RGB") if glow else None,
            occlusion_texture=images.texture(open_share["index"], "RGB") if open_share else None,
            occlusion_strength=float(open_share.get("strength", 1.0)) if open_share else 1.0,
            alpha_cutoff=_cutoff(material),
            blended=material.get("alphaMode") == "BLEND",
            double_sided=bool(material.get("doubleSided", False)),
            toon=None if toon is None else _toon_shading(toon, shade, images),
        ),
        *mapping,
    )


def _toon_shading(toon: Json, texture: Json | None, images: _ImageDecoder) -> ToonShading:
    image = images.texture(texture["index"], "RGB") if texture else None
    return replace(mtoon.shading(toon), texture=image)


def _mapping(texture: Json) -> tuple[int, Array | None]:
    """Return the coordinate set of a texture and its transform.

    KHR_texture_transform: scale, then rotation, then offset. As v points down, a counter-clockwise
    rotation takes u towards −v; three.js and Khronos's sample viewer agree.
    """
    uv_set = int(texture.get("texCoord", 0))
    transform = texture.get("extensions", {}).get("KHR_texture_transform")
    if transform is None:
        return uv_set, None
    x, y = transform.get("scale", (1.0, 1.0))
    turn = transform.get("rotation", 0.0)
    cos, sin = math.cos(turn), math.sin(turn)
    u, v = transform.get("offset", (0.0, 0.0))
    matrix = np.array([[cos * x, sin * y, u], [-sin * x, cos * y, v]], float)
    return int(transform.get("texCoord", uv_set)), matrix


def _same(a: tuple[int, Array | None], b: tuple[int, Array | None]) -> bool:
    first, second = (np.eye(2, 3) if matrix is None else matrix for _, matrix in (a, b))
    return a[0] == b[0] and np.allclose(first, second, atol=1e-6)


def _emission(
    material: Json, images: _ImageDecoder, drawn: Json | None
) -> tuple[float, float, float]:
    """Return the emission; a texture of it that is not `drawn` counts with its mean colour."""
    factor = np.array(material.get("emissiveFactor", (0.0, 0.0, 0.0)), float)
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {})
    factor *= float(strength.get("emissiveStrength", 1.0))
    texture = material.get("emissiveTexture")
    if texture and factor.any() and drawn is None:
        image = images.texture(texture["index"], "RGB")
        if image is not None:
            factor *= (image.reshape(-1, 3) / 255.0).mean(axis=0) ** 2.2  # sRGB to linear
    red, green, blue = factor.tolist()
    return red, green, blue


BLENDED_CUTOFF = 0.49
"""Alpha that counts as solid where blending is not drawn. Half-transparent surfaces are common;
with a cutoff of one half, rounding would make holes in them."""


def _cutoff(material: Json) -> float | None:
    """Return the alpha below which nothing is drawn.

    Where blending is not drawn, there is a cutoff too: opaque lashes would be solid sheets.
    """
    mode = material.get("alphaMode", "OPAQUE")
    if mode == "OPAQUE":
        return None
    if mode not in ("MASK", "BLEND"):
        raise DamagedFileError(f"alphaMode is {mode!r:.20}")
    return float(material.get("alphaCutoff", 0.5)) if mode == "MASK" else BLENDED_CUTOFF


class MaterialWriter:
    """Adds materials to a document, and each of their images once."""

    def __init__(self, builder: GlbBuilder) -> None:
        self._builder = builder
        self._textures: dict[bytes, int] = {}

    def add(self, material: Material, name: str) -> int:
        """Append a material and return its number."""
        pbr: Json = {
            "baseColorFactor": list(material.base_color),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        item: Json = {"name": name, "pbrMetallicRoughness": pbr}
        if material.double_sided:
            item["doubleSided"] = True
        if material.base_color_texture is not None:
            pbr["baseColorTexture"] = self._texture(material.base_color_texture)
        if material.metallic_roughness_texture is not None:
            pbr["metallicRoughnessTexture"] = self._texture(material.metallic_roughness_texture)
        if material.normal_texture is not None:
            scale = {"scale": material.normal_scale}
            item["normalTexture"] = self._texture(material.normal_texture) | scale
        if material.toon is not None:
            image = material.toon.texture
            shade = None if image is None else self._texture(image)
            self._extend(item, mtoon.EXTENSION, mtoon.write(material.toon, shade))
        if any(material.emissive):
            self._set_emission(item, material.emissive)
        if material.emissive_texture is not None:
            item["emissiveTexture"] = self._texture(material.emissive_texture)
        if material.occlusion_texture is not None:
            share = {"strength": material.occlusion_strength}
            item["occlusionTexture"] = self._texture(material.occlusion_texture) | share
        if material.blended:
            item["alphaMode"] = "BLEND"
        elif material.alpha_cutoff is not None:
            item |= {"alphaMode": "MASK", "alphaCutoff": material.alpha_cutoff}
        return self._builder.add("materials", item)

    def _set_emission(self, item: Json, emission: tuple[float, float, float]) -> None:
        """Write the emission; components above one need an extension."""
        brightest = max(*emission, 1.0)
        item["emissiveFactor"] = [part / brightest for part in emission]
        if brightest > 1.0:
            name = "KHR_materials_emissive_strength"
            self._extend(item, name, {"emissiveStrength": brightest})

    def _extend(self, item: Json, name: str, content: Json) -> None:
        item.setdefault("extensions", {})[name] = content
        used = self._builder.document.setdefault("extensionsUsed", [])
        if name not in used:
            used.append(name)

    def _texture(self, image: Image) -> dict[str, int]:
        """Return a reference to the texture of an image."""
        import PIL.Image

        file = io.BytesIO()
        PIL.Image.fromarray(image).save(file, "PNG")
        data = file.getvalue()
        if data not in self._textures:
            item = {"bufferView": self._builder.view(data), "mimeType": "image/png"}
            source = self._builder.add("images", item)
            self._textures[data] = self._builder.add("textures", {"source": source})
        return {"index": self._textures[data]}
