"""Files compressed by Draco are unpacked; other compressions name the tool that unpacks them."""

import DracoPy
import numpy as np
import pytest

from cubeling.characters import Character, CharacterError
from tests.characters.formats.built_gltf import build_arm, glb

POSITIONS = np.array([[0, 0, 0], [10, 0, 0], [0, 0, 600], [10, 0, 600]], float)
TRIANGLES = np.array([[0, 1, 2], [1, 3, 2]], np.uint32)
JOINTS = np.array([[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0]], np.uint8)
WEIGHTS = np.array([[255, 0, 0, 0]] * 4, np.uint8)
UVS = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], float)


def compressed():
    """The arm with a sleeve of two triangles, compressed; its accessors have no data."""
    build = build_arm()
    data = DracoPy.encode(
        POSITIONS,
        TRIANGLES,
        quantization_bits=20,
        preserve_order=True,
        tex_coord=UVS,
        generic_attributes={1: JOINTS, 2: WEIGHTS},
    )
    ids = {each["attribute_type"]: each["unique_id"] for each in DracoPy.decode(data).attributes}
    accessors = build.document["accessors"]

    def claimed(kind, component, count=4, **extra):
        accessors.append({"componentType": component, "count": count, "type": kind} | extra)
        return len(accessors) - 1

    attributes = {
        "POSITION": claimed("VEC3", 5126),
        "TEXCOORD_0": claimed("VEC2", 5126),
        "JOINTS_0": claimed("VEC4", 5121),
        "WEIGHTS_0": claimed("VEC4", 5121, normalized=True),
    }
    packed = {"POSITION": ids[0], "TEXCOORD_0": ids[3], "JOINTS_0": 1, "WEIGHTS_0": 2}
    extension = {"bufferView": build.view(data), "attributes": packed}
    build.document["meshes"][0]["primitives"] = [
        {
            "attributes": attributes,
            "indices": claimed("SCALAR", 5125, 6),
            "extensions": {"KHR_draco_mesh_compression": extension},
        }
    ]
    for key in ("extensionsUsed", "extensionsRequired"):
        build.document[key] = ["KHR_draco_mesh_compression"]
    return build, data


def load(folder, data):
    (folder / "arm.glb").write_bytes(data)
    return Character.load(folder / "arm.glb")


def test_a_compressed_mesh_is_unpacked(tmp_path):
    build, _ = compressed()
    arm = load(tmp_path, build.bytes())
    (mesh,) = arm.meshes
    assert np.allclose(mesh.positions, POSITIONS[:, [0, 2, 1]] * [1e-3, 1e-3, -1e-3], atol=1e-6)
    assert mesh.triangles.tolist() == TRIANGLES.tolist()
    moved_by = [arm.skeleton.names[joint] for joint in mesh.joints[:, 0]]
    assert moved_by == ["upper", "upper", "lower", "lower"]
    assert mesh.uvs == pytest.approx(UVS, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            lambda build, data: build.document["accessors"][-1].update(count=9),
            "has 2 triangles of 4 vertices, its accessors have 3 of 4",
        ),
        (lambda build, data: build.document["accessors"][-2].update(type="VEC3"), "says 4 VEC3"),
        (
            lambda build, data: build.document["meshes"][0]["primitives"][0]["extensions"][
                "KHR_draco_mesh_compression"
            ]["attributes"].update(COLOR_0=3),
            "its compressed part has no 'COLOR_0'",
        ),
        (
            lambda build, data: setattr(build, "blob", build.blob.replace(data[:60], bytes(60))),
            "is not compressed by Draco 2.2",
        ),
        (  # it says that it has 2^32 − 1 triangles
            lambda build, data: setattr(
                build, "blob", build.blob.replace(data[:12], data[:11] + b"\xff\xff\xff\xff\x0f")
            ),
            "has 4294967295 triangles",
        ),
        (
            lambda build, data: setattr(
                build, "blob", build.blob.replace(data[60:], bytes(len(data) - 60))
            ),
            "Draco cannot unpack it",
        ),
    ],
)
def test_a_damaged_compressed_mesh_is_refused_in_one_line(tmp_path, change, told):
    build, data = compressed()
    change(build, data)
    with pytest.raises(CharacterError, match=told) as error:
        load(tmp_path, build.bytes())
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("extension", "advice"),
    [
        ("EXT_meshopt_compression", "npx @gltf-transform/cli copy arm.glb unpacked.glb"),
        ("XYZ_new", "export it without"),
    ],
)
def test_other_compressions_name_what_unpacks_them(tmp_path, extension, advice):
    required = glb({"asset": {"version": "2.0"}, "extensionsRequired": [extension]})
    with pytest.raises(CharacterError, match=f"requires the extension {extension}; .*{advice}"):
        load(tmp_path, required)


def test_a_file_with_meshopt_and_ktx2_names_the_command_that_undoes_both(tmp_path):
    both = ["EXT_meshopt_compression", "KHR_texture_basisu"]
    required = glb({"asset": {"version": "2.0"}, "extensionsRequired": both})
    with pytest.raises(CharacterError, match=r"meshopt.*cli ktxdecompress arm\.glb"):
        load(tmp_path, required)
