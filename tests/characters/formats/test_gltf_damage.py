"""Bad files: refused in one line that names file and place, or repaired with a warning."""

import io
import struct
import zlib
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from cubeling.characters import Character, CharacterError, CharacterWarning
from cubeling.characters.formats.gltf.document import DamagedFileError
from cubeling.characters.formats.gltf.file import ReadBudget, open_gltf
from cubeling.characters.skeleton import rotations
from tests.characters.formats.built_gltf import build_arm, glb


@pytest.fixture
def arm():
    return build_arm()


def load(tmp_path, build):
    (tmp_path / "arm.glb").write_bytes(build.bytes())
    return Character.load(tmp_path / "arm.glb")


def refused(tmp_path, build, reason):
    with pytest.raises(CharacterError, match=reason) as caught:
        load(tmp_path, build)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(str(tmp_path / "arm.glb"))


def attributes(build):
    return build.document["meshes"][0]["primitives"][0]["attributes"]


# Joints


def test_a_cycle_of_nodes_is_refused(tmp_path, arm):
    arm.document["nodes"][0]["name"] = "hips"
    arm.document["nodes"][2]["children"] = [0]
    refused(tmp_path, arm, "node 'hips' is its own ancestor")


def test_a_node_of_two_parents_is_refused(tmp_path, arm):
    arm.document["nodes"][0]["children"] = [1, 2]
    refused(tmp_path, arm, "node 'lower' has two parents")


def test_an_absent_joint_is_named(tmp_path, arm):
    arm.document["skins"][0]["joints"] = [1, 7]
    refused(tmp_path, arm, r"skins\[0\]\.joints\[1\] is 7, but the file has 4 nodes")


def test_a_vertex_on_an_absent_joint_is_refused(tmp_path, arm):
    rows = np.array([[0, 0, 0, 0], [5, 0, 0, 0], [1, 0, 0, 0]], np.uint8)
    attributes(arm)["JOINTS_0"] = arm.add(rows, "VEC4", 5121)
    refused(tmp_path, arm, "mesh 0: a vertex has joint 5 of a skin of 2")


def test_joints_of_equal_names_get_numbers(tmp_path, arm):
    arm.document["nodes"][2]["name"] = "upper"
    assert load(tmp_path, arm).skeleton.names == ("node0", "upper", "upper.2")


def test_a_mirrored_skeleton_keeps_its_winding_order(tmp_path, arm):
    plain = load(tmp_path, arm).meshes[0]
    arm.document["nodes"][0]["scale"] = [-1e-3, 1e-3, 1e-3]
    mirrored = load(tmp_path, arm).meshes[0]
    assert np.allclose(mirrored.positions, plain.positions * [-1, 1, 1], atol=1e-6)
    assert np.array_equal(mirrored.triangles, plain.triangles[:, ::-1])


def test_too_many_joints_are_refused(tmp_path, arm):
    nodes = arm.document["nodes"]
    start = len(nodes)
    nodes[2]["children"] = list(range(start, start + 5000))
    nodes += [{} for _ in range(5000)]
    arm.document["skins"][0] = {"joints": [1, 2, *range(start, start + 5000)]}
    refused(tmp_path, arm, "has 5003 joints, more than 4096")


def test_more_parts_and_clips_than_any_character_has_are_refused(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    arm.document["animations"] *= 5000
    refused(tmp_path, arm, "has 5000 animations, more than 4096")
    arm.document["meshes"][0]["primitives"] *= 5000
    refused(tmp_path, arm, "has 5000 primitives, more than 4096")


# Rotations


def test_a_rotation_of_another_length_is_normalised_with_a_warning(tmp_path, arm):
    arm.document["nodes"][1]["rotation"] = [0, 0, 0, 2]
    with pytest.warns(CharacterWarning, match="node 'upper' has a rotation of length 2"):
        character = load(tmp_path, arm)
    assert character.skeleton.rest.rotations[1].tolist() == [0, 0, 0, 1]
    arm.document["nodes"][1].pop("rotation")
    arm.animate("LINEAR", [0.0, 1.0], [[0, 0, 0, 1], [0, 0, 3, 0]])
    with pytest.warns(CharacterWarning, match="animation 'a' has a rotation of length 3"):
        character = load(tmp_path, arm)
    assert np.allclose(np.linalg.norm(character.clips["a"].poses.rotations, axis=2), 1)


def test_a_rotation_of_no_length_is_refused(tmp_path, arm):
    arm.document["nodes"][1]["rotation"] = [0, 0, 0, 0]
    refused(tmp_path, arm, "node 'upper': rotation .* has no length")


# Clips


def test_a_clip_with_one_key_is_static(tmp_path, arm):
    arm.animate("LINEAR", [0.7], rotations.about("x", [0.5]))
    clip = load(tmp_path, arm).clips["a"]
    assert (len(clip), clip.duration) == (1, 0.0)
    assert np.allclose(clip.sample(3.0).rotations[2], rotations.about("x", 0.5), atol=1e-6)
    assert clip.travel(0.0, 5.0).x == 0


def test_keys_that_do_not_ascend_are_refused(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0, 0.5], rotations.about("x", [0.0, 1.0, 0.5]))
    refused(
        tmp_path,
        arm,
        "animation 'a': channel 0: accessor 4 has no key times, or they do not ascend",
    )


def test_keys_without_values_are_refused(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0, 2.0], rotations.about("x", [0.0, 1.0]))
    refused(tmp_path, arm, "animation 'a': channel 0: has 2 values instead of 3")


def test_samplers_that_do_not_exist_are_refused(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    arm.document["animations"][0]["channels"][0]["sampler"] = 3
    refused(tmp_path, arm, "animation 'a': channel 0: sampler 3 does not exist")
    arm.animate("BEZIER", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    refused(tmp_path, arm, "animation 'a': channel 0: has interpolation 'BEZIER'")


def test_a_clip_longer_than_an_hour_is_refused(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1e6], rotations.about("x", [0.0, 1.0]))
    refused(tmp_path, arm, "animation 'a': lasts 1000000 s")


def test_clips_of_equal_names_get_numbers(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    arm.document["animations"] *= 2
    assert list(load(tmp_path, arm).clips) == ["a", "a.2"]


# Weights


def test_weights_that_do_not_sum_to_one_are_scaled(tmp_path, arm):
    rows = np.array([[1, 0, 0, 0], [1, 0, 0, 0], [0.5, 1.5, 0, 0]], np.float32)
    attributes(arm)["WEIGHTS_0"] = arm.floats(rows, "VEC4")
    with pytest.warns(
        CharacterWarning, match=r"arm\.glb: mesh 0 has .* at 1 of 3 vertices \(2 at vertex 2"
    ):
        mesh = load(tmp_path, arm).meshes[0]
    assert np.allclose(np.sort(mesh.weights[2]), [0, 0, 0.25, 0.75])


def test_a_negative_weight_is_refused(tmp_path, arm):
    rows = np.array([[1, 0, 0, 0], [1, 0, 0, 0], [2, -1, 0, 0]], np.float32)
    attributes(arm)["WEIGHTS_0"] = arm.floats(rows, "VEC4")
    refused(tmp_path, arm, "mesh 0: has a skin weight of -1")


def test_a_wrong_number_of_weights_is_refused(tmp_path, arm):
    attributes(arm)["WEIGHTS_0"] = arm.floats(np.eye(2, 4), "VEC4")
    refused(tmp_path, arm, "mesh 0: has 3 joints and 2 weights for 3 vertices")


# Arrays


@pytest.mark.parametrize("odd", [np.nan, np.inf])
def test_values_that_are_not_finite_are_named(tmp_path, arm, odd):
    attributes(arm)["POSITION"] = arm.floats([[0, 0, 0], [0, odd, 0], [1, 0, 0]], "VEC3")
    refused(tmp_path, arm, r"mesh 0: accessor 4 holds \[ *0\. +(nan|inf) +0\. *\] in row 1")


def test_an_invalid_number_in_the_json_is_named(tmp_path, arm):
    arm.document["nodes"][1]["translation"] = [0, float("nan"), 0]
    refused(tmp_path, arm, "its JSON contains NaN")
    arm.document["nodes"][1]["translation"] = [0, 10**400, 0]
    refused(tmp_path, arm, r"nodes\[1\]\.translation is .*, not 3 numbers")


@pytest.mark.parametrize(
    ("key", "value", "reason"),
    [
        ("count", 10**12, "mesh 0: accessor 0: a count of 1000000000000 claims more"),
        ("count", 4, "mesh 0: accessor 0: needs 48 bytes in steps of 12, buffer view 0 has 36"),
        ("byteOffset", 4, "mesh 0: accessor 0: needs 40 bytes"),
        ("componentType", 5124, "mesh 0: accessor 0: component type 5124 does not exist"),
        ("type", "VEC2", "mesh 0: accessor 0: is VEC2, 3 components are needed"),
        ("bufferView", 99, r"accessors\[0\]\.bufferView is 99, but the file has 4 bufferViews"),
    ],
)
def test_an_invalid_accessor_is_named(tmp_path, arm, key, value, reason):
    arm.document["accessors"][0][key] = value
    refused(tmp_path, arm, reason)


def test_a_buffer_view_beyond_its_buffer_is_named(tmp_path, arm):
    arm.document["bufferViews"][0]["byteOffset"] = len(arm.blob)
    refused(tmp_path, arm, f"buffer view 0 ends at byte {len(arm.blob) + 36} of a buffer of")


def test_a_truncated_buffer_is_named(tmp_path, arm):
    arm.document["buffers"] = [{"byteLength": len(arm.blob)}]
    (tmp_path / "arm.glb").write_bytes(glb(arm.document, arm.blob[:-8]))
    with pytest.raises(CharacterError, match=r"buffer 0: has \d+ bytes, not \d+"):
        Character.load(tmp_path / "arm.glb")


@pytest.mark.parametrize("uri", ["/dev/zero", "http://x.org/a.bin", "file:///etc/passwd"])
def test_uris_outside_the_folder_are_refused(tmp_path, arm, uri):
    arm.document["buffers"] = [{"byteLength": 9, "uri": uri}]
    (tmp_path / "arm.glb").write_bytes(glb(arm.document))
    with pytest.raises(
        CharacterError, match=r"buffer 0: needs .*, which is not in the same folder"
    ):
        Character.load(tmp_path / "arm.glb")


def test_joint_indices_that_are_not_integers_are_refused(tmp_path, arm):
    attributes(arm)["JOINTS_0"] = arm.floats(np.zeros((3, 4)), "VEC4")
    refused(tmp_path, arm, "mesh 0: accessor 4 has float32 components where indices")


def test_a_sparse_row_beyond_the_array_is_refused(tmp_path, arm):
    arm.document["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": arm.view(b"\x09\x00"), "componentType": 5123},
        "values": {"bufferView": arm.view(bytes(12))},
    }
    refused(tmp_path, arm, "mesh 0: accessor 0: replaces a row beyond its 3")


def test_a_large_accessor_without_data_is_refused(tmp_path, arm):
    arm.document["accessors"].append({"componentType": 5126, "count": 10**7, "type": "VEC3"})
    attributes(arm)["POSITION"] = 4
    refused(tmp_path, arm, "mesh 0: accessor 4: has a count of 10000000, and no data")


def test_repeated_reads_are_limited_by_the_budget(tmp_path, arm):
    (tmp_path / "arm.glb").write_bytes(arm.bytes())
    file = replace(open_gltf(tmp_path / "arm.glb"), budget=ReadBudget(numbers=20))
    for _ in range(2):
        file.floats(0, 3)
    with pytest.raises(DamagedFileError, match="accessor 0: a count of 3 claims more numbers"):
        file.floats(0, 3)


def test_a_file_without_triangles_is_refused(tmp_path, arm):
    primitive = arm.document["meshes"][0]["primitives"][0]
    primitive["indices"] = arm.add(np.zeros(2, np.uint16), "SCALAR", 5123)
    refused(tmp_path, arm, "its skeleton moves no mesh")
    primitive["indices"] = arm.add(np.array([0, 1, 9], np.uint16), "SCALAR", 5123)
    refused(tmp_path, arm, "mesh 0: a triangle has vertex 9 of 3")


def test_json_nested_without_end_is_refused(tmp_path):
    (tmp_path / "deep.gltf").write_bytes(b'{"asset":' * 100_000)
    with pytest.raises(CharacterError, match="not a glTF file"):
        Character.load(tmp_path / "deep.gltf")


# Pictures


def picture(size=(4, 4), kind="PNG"):
    data = io.BytesIO()
    Image.new("RGB", size, (250, 10, 20)).save(data, kind)
    return data.getvalue()


def bomb(width, height):
    """A PNG of a few bytes that claims to be large."""
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(bytes(1000))), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


def with_pictures(build, *data):
    build.document["images"] = [{"bufferView": build.view(each), "name": "skin"} for each in data]
    build.document["textures"] = [{"source": number} for number in range(len(data))]
    build.document["materials"] = [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": number}}}
        for number in range(len(data))
    ]
    return build


@pytest.mark.parametrize("size", [(100_000, 100), (60_000, 60_000), (9000, 4)])
def test_an_oversized_image_is_refused_by_its_header(tmp_path, arm, size):
    refused(tmp_path, with_pictures(arm, bomb(*size)), "material 0: image 'skin' .*8192")


def test_images_share_a_pixel_budget(tmp_path, arm):
    build = with_pictures(arm, *[bomb(8000, 8000 + n) for n in range(2)])
    refused(tmp_path, build, "material 0: image 'skin' .*")
    build = with_pictures(build_arm(), bomb(8192, 8192))
    refused(tmp_path, build, "image 'skin' makes more than 64 million pixels")


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_a_truncated_image_is_named(tmp_path, arm, kind):
    whole = picture((64, 64), kind)
    refused(tmp_path, with_pictures(arm, whole[: len(whole) * 2 // 3]), "image 'skin' is damaged")


def test_an_unknown_image_format_is_named(tmp_path, arm):
    refused(tmp_path, with_pictures(arm, b"GIF89a"), "image 'skin' is neither PNG, JPEG nor WebP")
