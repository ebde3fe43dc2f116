"""MToon, the toon shading of VRM: VRMC_materials_mtoon of VRM 1.0, "materialProperties" of VRM 0.x.

Its shade colour is read, with its texture and where it begins; outlines, rim light and moving
textures are not.
"""

from cubeling.characters.formats.gltf.document import Json
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.model.mesh import ToonShading

EXTENSION = "VRMC_materials_mtoon"


def extension_of(file: GltfFile, number: int, material: Json) -> Json | None:
    """Return a material's extension, for VRM 0.x too; None for other materials."""
    stated: Json | None = material.get("extensions", {}).get(EXTENSION)
    if stated is not None:
        return stated
    all_properties = file.document.get("extensions", {}).get("VRM", {}).get("materialProperties")
    if not all_properties or number >= len(all_properties):
        return None
    properties = all_properties[number]
    if properties is None or properties.get("shader") != "VRM/MToon":
        return None
    return _convert(properties, material, len(file.all("textures")))


def shading(stated: Json) -> ToonShading:
    """Return what the extension says, without its texture."""
    red, green, blue = (float(part) for part in stated.get("shadeColorFactor", (0.0, 0.0, 0.0)))
    return ToonShading(
        color=(red, green, blue),
        shift=float(stated.get("shadingShiftFactor", 0.0)),
        toony=min(max(float(stated.get("shadingToonyFactor", 0.9)), 0.0), 1.0),
        evenness=min(max(float(stated.get("giEqualizationFactor", 0.9)), 0.0), 1.0),
    )


def write(toon: ToonShading, texture: Json | None) -> Json:
    """Return the extension for a reference to its texture."""
    stated: Json = {
        "specVersion": "1.0",
        "shadeColorFactor": list(toon.color),
        "shadingShiftFactor": toon.shift,
        "shadingToonyFactor": toon.toony,
        "giEqualizationFactor": toon.evenness,
    }
    return stated if texture is None else stated | {"shadeMultiplyTexture": texture}


def _convert(properties: Json, material: Json, textures: int) -> Json:
    """Return the properties of VRM 0.x as the extension of VRM 1.0.

    The formulas are those by which UniVRM and three-vrm convert them; colours were sRGB.
    """
    numbers = properties.get("floatProperties", {})
    shift = float(numbers.get("_ShadeShift", 0.0))
    toony = float(numbers.get("_ShadeToony", 0.9))
    toony += (1.0 - toony) * (0.5 + 0.5 * shift)
    color = properties.get("vectorProperties", {}).get("_ShadeColor", (0.97, 0.81, 0.86, 1.0))
    stated: Json = {
        "shadeColorFactor": [max(float(part), 0.0) ** 2.2 for part in (*color, 0.0, 0.0, 0.0)[:3]],
        "shadingShiftFactor": -shift - (1.0 - toony),
        "shadingToonyFactor": toony,
        "giEqualizationFactor": 1.0 - float(numbers.get("_IndirectLightIntensity", 0.1)),
    }
    index = properties.get("textureProperties", {}).get("_ShadeTexture", -1)
    if 0 <= index < textures:
        # It lies on the surface as the base colour does.
        base = material.get("pbrMetallicRoughness", {}).get("baseColorTexture", {})
        stated["shadeMultiplyTexture"] = base | {"index": index}
    return stated
