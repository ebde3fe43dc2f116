"""Whatever a file holds, it loads, or is refused by a CharacterError of one line."""

import base64
import copy
import io
import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from PIL import Image

from cubeling.characters import Character, CharacterError
from cubeling.characters.body.constraints import ConstrainedJoints
from cubeling.characters.body.springs import SpringBody
from cubeling.characters.skeleton import rotations
from tests.characters.formats.built_gltf import build_arm, glb
from tests.examples import examples

pytestmark = pytest.mark.filterwarnings("ignore::cubeling.characters.errors.CharacterWarning")


@cache
def specimen():
    """A small file with one of nearly everything: its document and its bytes."""
    build = build_arm()
    build.animate("LINEAR", [0.0, 0.5, 1.0], rotations.about("x", [0.0, 0.5, 1.0]))
    animation = build.document["animations"][0]
    lift = {
        "input": animation["samplers"][0]["input"],
        "output": build.floats(np.linspace(0, 1, 9), "SCALAR"),
        "interpolation": "CUBICSPLINE",
    }
    animation["samplers"].append(lift)
    animation["channels"].append({"sampler": 1, "target": {"node": 3, "path": "weights"}})
    picture = io.BytesIO()
    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)).save(picture, "PNG")
    view = build.view(picture.getvalue())
    build.document["images"] = [{"bufferView": view, "mimeType": "image/png"}]
    build.document["textures"] = [{"source": 0}]
    place = {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1.0, "scale": [2, 2]}}
    texture = {"index": 0, "texCoord": 0, "extensions": place}
    build.document["materials"] = [
        {
            "pbrMetallicRoughness": {"baseColorTexture": texture, "metallicFactor": 0.5},
            "normalTexture": texture | {"scale": 0.5},
            "emissiveFactor": [1, 1, 1],
            "emissiveTexture": {"index": 0},
            "alphaMode": "MASK",
            "extensions": {
                "VRMC_materials_mtoon": {
                    "shadeColorFactor": [0.5, 0, 0],
                    "shadeMultiplyTexture": texture,
                    "shadingToonyFactor": 0.5,
                }
            },
        }
    ]
    sparse = {
        "count": 1,
        "indices": {"bufferView": build.view(b"\2\0"), "componentType": 5123},
        "values": {"bufferView": build.view(np.ones(3, np.float32).tobytes())},
    }
    build.document["accessors"].append(
        {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse}
    )
    primitive = build.document["meshes"][0]["primitives"][0]
    primitive["targets"] = [{"POSITION": len(build.document["accessors"]) - 1}]
    primitive["indices"] = build.add(np.array([0, 1, 2], np.uint16), "SCALAR", 5123)
    primitive["attributes"]["TEXCOORD_0"] = build.floats(np.eye(3, 2), "VEC2")
    primitive["attributes"]["COLOR_0"] = build.floats(np.ones((3, 4)), "VEC4")
    primitive["material"] = 0
    binds = [{"node": 3, "index": 0, "weight": 1.0}]
    build.document["extensions"] = {
        "VRMC_vrm": {
            "specVersion": "1.0",
            "humanoid": {"humanBones": {"hips": {"node": 1}}},
            "expressions": {"preset": {"aa": {"morphTargetBinds": binds}}},
            "lookAt": {
                "type": "expression",
                "offsetFromHeadBone": [0, 0.1, 0],
                "rangeMapVerticalUp": {"inputMaxValue": 30, "outputScale": 1},
            },
        },
        "VRMC_springBone": {
            "colliders": [{"node": 1, "shape": {"sphere": {"offset": [0, 0, 9], "radius": 0.1}}}],
            "colliderGroups": [{"colliders": [0]}],
            "springs": [
                {
                    "joints": [{"node": 1, "stiffness": 2, "gravityPower": 0.1}, {"node": 2}],
                    "colliderGroups": [0],
                    "center": 0,
                }
            ],
        },
    }
    constraint = {"constraint": {"roll": {"source": 1, "rollAxis": "X", "weight": 0.5}}}
    build.document["nodes"][2]["extensions"] = {"VRMC_node_constraint": constraint}
    maps = {name: {"greatest": 1.0, "output": 0.5} for name in ("inner", "outer", "down", "up")}
    extras = {"morphs": ["mesh0.0"], "cubelingFollowers": {"look_at": maps | {"by": "bone"}}}
    build.document["scenes"] = [{"nodes": [0, 3], "extras": extras}]
    build.document["buffers"] = [{"byteLength": len(build.blob)}]
    return build.document, build.blob


def survives(data, suffix=".glb"):
    """Load what may be damaged; anything but a refusal in one line is a fault."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"odd{suffix}"
        path.write_bytes(data)
        reason = ""
        try:
            character = Character.load(path)
        except CharacterError as error:
            reason = str(error)
    if reason:
        assert reason.startswith(str(path))
        assert "\n" not in reason
        return
    constrained = ConstrainedJoints(character.skeleton, character.constraints)
    body = SpringBody(character.skeleton, character.springs) if character.springs else None
    for clip in character.clips.values():
        pose = constrained.apply(clip.sample(clip.duration / 2))
        if body is not None:
            pose = body.update(pose, np.eye(4), 0.0)
        assert np.isfinite(pose.globals(character.skeleton)).all()


def test_the_unchanged_file_loads():
    document, blob = specimen()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "specimen.vrm"
        path.write_bytes(glb(document, blob))
        character = Character.load(path)
    assert character.morphs == ("aa",)
    assert character.meshes[0].material.normal_texture is not None
    assert character.meshes[0].material.toon is not None
    assert character.springs
    assert character.constraints
    assert character.look_at is not None


def places(value, path=()):
    """Every place in a JSON document, as the keys that lead there."""
    if path:
        yield path
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in inner:
        if isinstance(each, dict | list):
            yield from places(each, (*path, key))
        else:
            yield (*path, key)


ODD_VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 12),
    st.sampled_from([2**31, 2**63, -(2**40), 10**400, 1e308, 0.5, -1.5]),
    st.sampled_from(
        [
            "",
            "VEC3",
            "CUBICSPLINE",
            "data:,",
            "data:;base64,+",
            "/dev/zero",
            "http://a/b",
            "\n",
            "../../etc",
            "\0",
        ]
    ),
    st.sampled_from([5120, 5121, 5123, 5125, 5126]),
    st.just([]),
    st.just({}),
    st.lists(st.integers(-1, 5), max_size=4),
)


@given(st.data())
@settings(max_examples=examples(100))
def test_any_changed_json_member_loads_or_is_refused(data):
    document, blob = copy.deepcopy(specimen())
    for _ in range(data.draw(st.integers(1, 3))):
        *way, last = data.draw(st.sampled_from(list(places(document))))
        holder = document
        for key in way:
            holder = holder[key]
        what = data.draw(st.sampled_from(["drop", "copy", "replace", "replace"]))
        if what == "drop":
            del holder[last]
        elif what == "copy":
            other = data.draw(st.sampled_from(list(places(document))))
            found = document
            for key in other:
                found = found[key]
            holder[last] = copy.deepcopy(found)
        else:
            holder[last] = data.draw(ODD_VALUES)
    if not data.draw(st.booleans()):
        survives(glb(document, blob))
    elif isinstance(document.get("buffers"), list) and document["buffers"]:
        uri = "data:;base64," + base64.b64encode(blob).decode()
        document["buffers"][0] = {
            "byteLength": len(blob),
            "uri": data.draw(st.just(uri) | ODD_VALUES),
        }
        survives(json.dumps(document).encode(), ".gltf")


@given(st.data())
@settings(max_examples=examples(100))
def test_any_changed_bytes_load_or_are_refused(data):
    document, blob = specimen()
    whole = bytearray(glb(document, blob))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(whole) - 1))
        odd = data.draw(st.binary(min_size=1, max_size=8) | st.just(b"\xff\xff\xff\xff"))
        end = start + data.draw(st.sampled_from([0, len(odd), len(odd), len(odd)]))
        whole[start:end] = odd
    survives(bytes(whole), data.draw(st.sampled_from([".glb", ".gltf", ".vrm"])))


@given(st.binary(max_size=200))
@settings(max_examples=examples(30))
def test_random_data_are_refused(noise):
    survives(noise)
    survives(b"glTF\2\0\0\0" + noise)
