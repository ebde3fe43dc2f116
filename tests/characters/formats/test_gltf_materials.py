import io
import struct
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from cubeling.characters import Character, CharacterWarning
from cubeling.characters.model.mesh import Material
from tests.characters.formats.built_gltf import build_arm

RNG = np.random.default_rng(3)


def pixels(channels):
    return RNG.integers(0, 256, (4, 6, channels), dtype=np.uint8)


def load(tmp_path, build, name="arm.glb"):
    (tmp_path / name).write_bytes(build.bytes())
    return Character.load(tmp_path / name).meshes[0]


def encoded(array, kind="PNG", **options):
    data = io.BytesIO()
    Image.fromarray(array).save(data, kind, **options)
    return data.getvalue()


def dressed(material, *pictures):
    """The arm in a material with these pictures."""
    build = build_arm()
    primitive = build.document["meshes"][0]["primitives"][0]
    primitive["material"] = 0
    primitive["attributes"]["TEXCOORD_0"] = build.floats([[0, 0], [1, 0], [0, 1]], "VEC2")
    primitive["attributes"]["TEXCOORD_1"] = build.floats([[9, 9], [9, 9], [9, 9]], "VEC2")
    build.document["materials"] = [material]
    build.document["images"] = [{"bufferView": build.view(each)} for each in pictures]
    build.document["textures"] = [{"source": number} for number in range(len(pictures))]
    return build


def test_textures_of_colour_roughness_and_normals_are_read(tmp_path):
    color, surface, bumps = pixels(4), pixels(3), pixels(3)
    material = {
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0},
            "metallicRoughnessTexture": {"index": 1},
        },
        "normalTexture": {"index": 2, "scale": 0.5},
        "alphaMode": "MASK",
        "alphaCutoff": 0.3,
    }
    mesh = load(tmp_path, dressed(material, encoded(color), encoded(surface), encoded(bumps)))
    assert np.array_equal(mesh.material.base_color_texture, color)
    assert np.array_equal(mesh.material.metallic_roughness_texture, surface)
    assert np.array_equal(mesh.material.normal_texture, bumps)
    assert (mesh.material.normal_scale, mesh.material.alpha_cutoff) == (0.5, 0.3)
    assert (mesh.material.metallic, mesh.material.roughness) == (1.0, 1.0)


@pytest.mark.parametrize("mode", ["L", "P", "1", "LA", "RGBA", "I;16"])
def test_images_of_any_mode_become_colours(tmp_path, mode):
    grey = np.array([[0, 255], [255, 0]], np.uint8)
    picture = Image.fromarray(grey)
    if mode == "I;16":
        picture = Image.fromarray(grey.astype(np.uint16) * 257)
    elif mode != "L":
        picture = picture.convert(mode)
    data = io.BytesIO()
    picture.save(data, "PNG")
    build = dressed({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, data.getvalue())
    texture = load(tmp_path, build).material.base_color_texture
    assert texture is not None
    assert np.array_equal(texture, np.dstack([grey, grey, grey, np.full((2, 2), 255)]))


def test_jpegs_and_image_files_are_read(tmp_path):
    flat = np.full((8, 8, 3), (200, 30, 60), np.uint8)
    build = dressed({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})
    build.document["images"] = [{"uri": "my%20skin.jpg"}]
    build.document["textures"] = [{"source": 0}]
    (tmp_path / "my skin.jpg").write_bytes(encoded(flat, "JPEG", quality=95))
    texture = load(tmp_path, build).material.base_color_texture
    assert texture is not None
    assert np.abs(texture[..., :3].astype(int) - flat).max() < 6


def test_webp_textures_are_read_in_place_of_their_fallback(tmp_path):
    color = pixels(4)
    color[..., 3] = 255  # lossless WebP keeps no colour where nothing is seen
    build = dressed({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, encoded(color))
    webp = build.view(encoded(color[::-1], "WEBP", lossless=True))
    build.document["images"].append({"bufferView": webp, "mimeType": "image/webp"})
    for fallback in ({"source": 0}, {}):
        build.document["textures"] = [
            fallback | {"extensions": {"EXT_texture_webp": {"source": 1}}}
        ]
        build.document["extensionsRequired"] = ["EXT_texture_webp"]
        texture = load(tmp_path, build).material.base_color_texture
        assert np.array_equal(texture, color[::-1])


KTX2 = b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(60)


@pytest.mark.parametrize("required", [False, True])
def test_a_character_is_drawn_without_its_ktx2_textures_with_a_warning(tmp_path, required):
    build = build_arm()
    build.document["images"] = [{"bufferView": build.view(KTX2), "mimeType": "image/ktx2"}]
    basis = {"extensions": {"KHR_texture_basisu": {"source": 0}}}
    build.document["textures"] = [basis, basis]
    build.document["materials"] = [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": n}}} for n in (0, 1)
    ]
    build.document["meshes"][0]["primitives"][0]["material"] = 0
    if required:
        build.document["extensionsRequired"] = ["KHR_texture_basisu"]
    (tmp_path / "arm.glb").write_bytes(build.bytes())
    with pytest.warns(CharacterWarning) as caught:
        character = Character.load(tmp_path / "arm.glb")
    assert character.meshes[0].material.base_color_texture is None
    lines = [str(each.message) for each in caught]
    assert len(lines) == 1 + required
    assert "cli ktxdecompress arm.glb unpacked.glb (it calls ktx of KTX-Software:" in lines[-1]


def test_a_ktx2_texture_beside_a_png_is_not_missed(tmp_path):
    color = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    build = dressed(color, encoded(pixels(4)))
    build.document["images"].append({"bufferView": build.view(KTX2)})
    build.document["textures"][0]["extensions"] = {"KHR_texture_basisu": {"source": 1}}
    assert load(tmp_path, build).material.base_color_texture is not None


def test_coordinates_are_moved_turned_and_scaled_with_their_texture(tmp_path):
    place = {"offset": [0.5, 0.25], "rotation": np.pi / 2, "scale": [2, 3]}
    texture = {"index": 0, "extensions": {"KHR_texture_transform": place}}
    build = dressed({"pbrMetallicRoughness": {"baseColorTexture": texture}}, encoded(pixels(3)))
    uvs = load(tmp_path, build).uvs
    # Counter-clockwise as seen, with v down: what went along u goes towards −v.
    assert uvs == pytest.approx(np.array([[0.5, 0.25], [0.5, -1.75], [3.5, 0.25]]), abs=1e-6)
    place["texCoord"] = 1
    place.update(rotation=0, scale=[1, 1])
    assert load(tmp_path, build).uvs == pytest.approx(np.tile([9.5, 9.25], (3, 1)))


def test_textures_with_other_coordinates_are_dropped_with_a_warning(tmp_path):
    material = {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "normalTexture": {"index": 1, "texCoord": 1},
    }
    build = dressed(material, encoded(pixels(3)), encoded(pixels(3)))
    with pytest.warns(CharacterWarning, match="material 0 has textures with different coordinates"):
        read = load(tmp_path, build).material
    assert read.base_color_texture is not None
    assert read.normal_texture is None


def test_emission_is_its_factor_times_its_texture(tmp_path):
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}}
    material = {"emissiveFactor": [1, 0.5, 0], "extensions": strength}
    assert load(tmp_path, dressed(material)).material.emissive == (4.0, 2.0, 0.0)
    spots = pixels(3)
    material["emissiveTexture"] = {"index": 0}
    read = load(tmp_path, dressed(material, encoded(spots))).material
    assert read.emissive == (4.0, 2.0, 0.0)
    assert np.array_equal(read.emissive_texture, spots)
    # With other coordinates than the colour, it counts with its mean.
    material["pbrMetallicRoughness"] = {"baseColorTexture": {"index": 0, "texCoord": 1}}
    dark = encoded(np.zeros((2, 2, 3), np.uint8))
    with pytest.warns(CharacterWarning, match="different coordinates"):
        read = load(tmp_path, dressed(material, dark)).material
    assert (read.emissive, read.emissive_texture) == ((0.0, 0.0, 0.0), None)


def test_occlusion_is_read_with_its_strength(tmp_path):
    shares = pixels(3)
    material = {"occlusionTexture": {"index": 0, "strength": 0.4}}
    read = load(tmp_path, dressed(material, encoded(shares))).material
    assert np.array_equal(read.occlusion_texture, shares)
    assert read.occlusion_strength == 0.4


def test_unlit_materials_are_rough_and_blended_ones_get_a_cutoff(tmp_path):
    material = {"extensions": {"KHR_materials_unlit": {}}, "alphaMode": "BLEND"}
    read = load(tmp_path, dressed(material)).material
    assert (read.metallic, read.roughness, read.blended) == (0.0, 1.0, True)
    assert read.alpha_cutoff < 0.5  # half-transparent surfaces are drawn


def test_normalised_integers_are_read(tmp_path):
    build = build_arm()
    attributes = build.document["meshes"][0]["primitives"][0]["attributes"]
    plain = load(tmp_path, build)
    corners = np.zeros((3, 4), np.int16)  # KHR_mesh_quantization, padded to four
    corners[:, :3] = [[0, 0, 0], [10, 0, 0], [0, 0, 600]]
    attributes["POSITION"] = build.add(corners, "VEC3", 5122)
    build.document["bufferViews"][-1]["byteStride"] = 8
    corners = np.array([[0, 0], [255, 0], [51, 255]], np.uint8)
    attributes["TEXCOORD_0"] = build.add(corners, "VEC2", 5121, normalized=True)
    build.document["extensionsRequired"] = ["KHR_mesh_quantization"]
    packed = load(tmp_path, build)
    assert np.allclose(packed.positions, plain.positions)
    assert packed.uvs == pytest.approx(np.array([[0, 0], [1, 0], [0.2, 1]]))


def test_a_material_survives_saving_and_loading(tmp_path, walker):
    material = Material(
        base_color=(0.5, 0.25, 1.0, 1.0),
        metallic=0.75,
        roughness=0.5,
        base_color_texture=pixels(4),
        metallic_roughness_texture=pixels(3),
        normal_texture=pixels(3),
        normal_scale=0.5,
        emissive=(3.0, 0.75, 0.0),
        emissive_texture=pixels(3)[::-1],
        occlusion_texture=pixels(3),
        occlusion_strength=0.5,
        alpha_cutoff=0.25,
        double_sided=True,
    )
    mesh = replace(walker.meshes[0], material=material, uvs=np.zeros((8, 2), np.float32))
    twice = replace(mesh, name="twin")
    Character("m", walker.skeleton, {}, (mesh, twice)).save(tmp_path / "m.glb")
    again = Character.load(tmp_path / "m.glb").meshes[0].material
    for field, value in vars(material).items():
        assert np.array_equal(getattr(again, field), value), field
    data = (tmp_path / "m.glb").read_bytes()
    assert data.count(b"\x89PNG") == 5  # each picture once, though two meshes wear it
    assert struct.unpack_from("<I", data, 8)[0] == len(data)
