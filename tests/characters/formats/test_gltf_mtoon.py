"""MToon's shade colour, as VRM 1.0 and VRM 0.x state it."""

import io

import numpy as np
import pytest
from PIL import Image

from cubeling.characters import Character, CharacterWarning
from cubeling.characters.model.mesh import ToonShading
from tests.characters.formats.built_gltf import build_arm

BASE = {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}


@pytest.fixture
def load(tmp_path):
    """Loads the arm with a material that has these extensions, in a file with those."""

    def loaded(material, **extensions):
        build = build_arm()
        primitive = build.document["meshes"][0]["primitives"][0]
        primitive["material"] = 0
        primitive["attributes"]["TEXCOORD_0"] = build.floats([[0, 0], [1, 0], [0, 1]], "VEC2")
        for color in ((200, 100, 50), (90, 30, 60)):
            file = io.BytesIO()
            Image.new("RGB", (2, 2), color).save(file, "PNG")
            view = build.view(file.getvalue())
            build.document.setdefault("images", []).append({"bufferView": view})
        build.document["textures"] = [{"source": 0}, {"source": 1}]
        pbr = {"baseColorTexture": BASE, "metallicFactor": 0.5}
        build.document["materials"] = [{"pbrMetallicRoughness": pbr, "extensions": material}]
        build.document["extensions"] = extensions
        (tmp_path / "arm.glb").write_bytes(build.bytes())
        return Character.load(tmp_path / "arm.glb")

    return loaded


def surface(character):
    (mesh,) = character.meshes
    return mesh.material


TOON = {
    "specVersion": "1.0",
    "shadeColorFactor": [0.5, 0.25, 0.125],
    "shadeMultiplyTexture": BASE | {"index": 1},
    "shadingShiftFactor": -0.2,
    "shadingToonyFactor": 0.6,
    "giEqualizationFactor": 0.3,
}


def test_vrm_1_states_the_shade(load):
    material = surface(load({"VRMC_materials_mtoon": TOON, "KHR_materials_unlit": {}}))
    toon = material.toon
    assert (toon.color, toon.shift, toon.toony) == ((0.5, 0.25, 0.125), -0.2, 0.6)
    assert toon.evenness == 0.3
    assert toon.texture[0, 0].tolist() == [90, 30, 60]
    assert material.base_color_texture[0, 0].tolist() == [200, 100, 50, 255]
    assert material.metallic == 0.0


def test_what_vrm_1_leaves_out_has_the_values_of_the_specification(load):
    toon = surface(load({"VRMC_materials_mtoon": {"specVersion": "1.0"}})).toon
    assert toon == ToonShading((0.0, 0.0, 0.0), None, 0.0, 0.9, 0.9)


def old(shader="VRM/MToon", **numbers):
    return {
        "materialProperties": [
            {
                "shader": shader,
                "floatProperties": numbers,
                "vectorProperties": {"_ShadeColor": [1.0, 0.5, 0.0, 1.0], "_Color": [1, 1, 1, 1]},
                "textureProperties": {"_MainTex": 0, "_ShadeTexture": 1},
            }
        ]
    }


def lit(toon, cosine):
    """How far light at a cosine to the normal makes a surface light, by VRM 1.0."""
    return np.clip((cosine + toon.shift + 1 - toon.toony) / (2 - 2 * toon.toony), 0, 1)


@pytest.mark.parametrize(("shift", "toony"), [(0.0, 0.9), (0.5, 0.5), (-0.5, 0.2)])
def test_vrm_0_means_the_same_shade_in_numbers_of_its_own(load, shift, toony):
    toon = surface(
        load({"KHR_materials_unlit": {}}, VRM=old(_ShadeShift=shift, _ShadeToony=toony))
    ).toon
    assert toon.color == pytest.approx((1.0, 0.5**2.2, 0.0))
    assert toon.texture[0, 0].tolist() == [90, 30, 60]
    # Its shader went from the shift to 1, or less far the more toony it was.
    end = shift + (1.0 - shift) * (1.0 - toony)
    for share in (0.25, 0.5, 0.75):
        assert lit(toon, shift + share * (end - shift)) == pytest.approx(share, abs=0.01)


def test_other_shaders_of_vrm_0_are_not_toon(load):
    assert surface(load({}, VRM=old("VRM/UnlitTexture"))).toon is None
    assert surface(load({}, VRM={})).toon is None
    assert surface(load({})).toon is None


def test_the_shade_survives_saving(load, tmp_path):
    character = load({"VRMC_materials_mtoon": TOON})
    character.save(tmp_path / "saved.glb")
    before, after = surface(character).toon, surface(Character.load(tmp_path / "saved.glb")).toon
    assert np.array_equal(before.texture, after.texture)
    for name in ("color", "shift", "toony", "evenness"):
        assert getattr(before, name) == getattr(after, name)


@pytest.mark.filterwarnings("ignore:.*textures with different coordinates")
def test_a_shade_texture_that_lies_otherwise_is_left_out(load):
    stated = TOON | {"shadeMultiplyTexture": {"index": 1}}
    assert surface(load({"VRMC_materials_mtoon": stated})).toon.texture is None


def test_an_invalid_shade_is_left_out_with_a_warning(load):
    with pytest.warns(CharacterWarning, match=r"shadeColorFactor is .* not 3 numbers"):
        character = load({"VRMC_materials_mtoon": {"shadeColorFactor": [1]}})
    assert surface(character).toon is None
