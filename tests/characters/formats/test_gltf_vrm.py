import json
import struct

import numpy as np
import pytest

from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    CharacterWarning,
    RootDelta,
)
from cubeling.characters.control.layers.gaze import GazeLayer
from cubeling.characters.model.character import skin
from tests.characters.formats.built_gltf import build_arm, glb

BONES = {"hips": "hips", "head": "head", "leftUpperArm": "LeftArm", "rightFoot": "RightFoot"}


@pytest.fixture(scope="module")
def human(tmp_path_factory):
    """The bundled human as a file: its JSON and its binary."""
    path = tmp_path_factory.mktemp("human") / "human.glb"
    character = Character.load("human")
    Character("human", character.skeleton, {}, character.meshes, character.morphs).save(path)
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def vrm(human, extension):
    """A VRM made of the human: `extension` gets its nodes by name and what carries its morphs."""
    document, blob = human
    nodes = {node["name"]: number for number, node in enumerate(document["nodes"])}
    targets = [m.get("extras", {}).get("targetNames", []) for m in document["meshes"]]
    mesh = next(number for number, names in enumerate(targets) if names)
    carrier = next(n for n, node in enumerate(document["nodes"]) if node.get("mesh") == mesh)
    name, content = extension(nodes, carrier, mesh, targets[mesh])
    return glb(document | {"extensionsUsed": [name], "extensions": {name: content}}, blob)


def vrm_1(nodes, carrier, mesh, targets):
    def binds(**weights):
        return {
            "morphTargetBinds": [
                {"node": carrier, "index": targets.index(name), "weight": weight}
                for name, weight in weights.items()
            ]
        }

    preset = {
        "blink": binds(blinkLeft=1.0, blinkRight=0.5),
        "happy": binds(happy=0.8),
        "neutral": {},
    }
    return "VRMC_vrm", {
        "specVersion": "1.0",
        "meta": {},
        "humanoid": {"humanBones": {bone: {"node": nodes[name]} for bone, name in BONES.items()}},
        "expressions": {"preset": preset, "custom": {"gasp": binds(oh=1.0, surprised=0.5)}},
    }


def vrm_0(nodes, carrier, mesh, targets):
    bones = BONES | {"leftThumbProximal": "LeftHandThumb1"}
    groups = [
        {
            "name": "Joy",
            "presetName": "joy",
            "binds": [{"mesh": mesh, "index": targets.index("happy"), "weight": 80}],
        },
        {
            "name": "Wink",
            "presetName": "unknown",
            "binds": [{"mesh": mesh, "index": targets.index("blinkLeft"), "weight": 100}],
        },
    ]
    return "VRM", {
        "humanoid": {"humanBones": [{"bone": b, "node": nodes[n]} for b, n in bones.items()]},
        "blendShapeMaster": {"blendShapeGroups": groups},
    }


def load(tmp_path, data, name="person.vrm"):
    (tmp_path / name).write_bytes(data)
    return Character.load(tmp_path / name)


def moved(character, weights):
    """How far each vertex is from where it is at rest, all meshes together."""
    rest = character.skeleton.rest.globals(character.skeleton)
    return np.concatenate(
        [skin(mesh, rest, weights) - skin(mesh, rest) for mesh in character.meshes]
    )


def test_vrm_states_the_body_parts(tmp_path, human):
    character = load(tmp_path, vrm(human, vrm_1))
    assert dict(character.semantics) == BONES
    arm = character.anatomy.joint("leftUpperArm")
    assert arm is not None
    assert character.skeleton.names[arm] == "LeftArm"


def test_expressions_are_weighted_sums_of_morph_targets(tmp_path, human):
    character, plain = load(tmp_path, vrm(human, vrm_1)), Character.load("human")
    assert character.morphs == ("blink", "happy", "gasp")  # neutral binds nothing
    pairs = [
        ({"blink": 1.0}, {"blinkLeft": 1.0, "blinkRight": 0.5}),
        ({"happy": 0.5}, {"happy": 0.4}),
        ({"gasp": 1.0}, {"oh": 1.0, "surprised": 0.5}),
    ]
    for expression, targets in pairs:
        displacements = moved(character, expression)
        assert np.abs(displacements).max() > 1e-3
        assert np.allclose(displacements, moved(plain, targets), atol=1e-6)


def test_an_old_vrm_has_its_body_parts_and_weighted_expressions(tmp_path, human):
    character, plain = load(tmp_path, vrm(human, vrm_0)), Character.load("human")
    assert character.morphs == ("happy", "Wink")
    assert character.semantics["leftThumbMetacarpal"] == "LeftHandThumb1"
    assert character.semantics["hips"] == "hips"
    assert np.allclose(character.bounds, plain.bounds, atol=1e-5)
    assert np.allclose(
        moved(character, {"happy": 1.0}),
        moved(plain, {"happy": 0.8}),
        atol=1e-6,
    )


def test_vrm_body_parts_and_expressions_survive_saving_as_glb(tmp_path, human):
    character = load(tmp_path, vrm(human, vrm_1))
    character.save(tmp_path / "person.glb")
    again = Character.load(tmp_path / "person.glb")
    assert dict(again.semantics) == BONES
    assert again.morphs == character.morphs


def test_bones_that_move_no_vertex_are_joints_too(tmp_path):
    build = build_arm()
    build.document["nodes"][2]["children"] = [4]
    build.document["nodes"].append({"name": "eye"})
    humanoid = {"humanBones": {"hips": {"node": 1}, "leftEye": {"node": 4}}}
    build.document["extensions"] = {"VRMC_vrm": {"specVersion": "1.0", "humanoid": humanoid}}
    assert load(tmp_path, build.bytes()).semantics["leftEye"] == "eye"


@pytest.mark.parametrize(
    ("extension", "reason"),
    [
        ({"specVersion": "2.0"}, r"VRMC_vrm: is version '2\.0'; export it as VRM 1\.0"),
    ],
)
def test_a_vrm_of_another_version_is_refused(tmp_path, extension, reason):
    build = build_arm()
    build.document["extensions"] = {"VRMC_vrm": extension}
    with pytest.raises(CharacterError, match=reason):
        load(tmp_path, build.bytes())


@pytest.mark.parametrize(
    ("extension", "reason"),
    [
        (
            {"specVersion": "1.0", "humanoid": {"humanBones": {"hips": {"node": 9}}}},
            r"humanBones\.hips\.node is 9, but the file has 4 nodes",
        ),
        (
            {
                "specVersion": "1.0",
                "expressions": {
                    "preset": {"aa": {"morphTargetBinds": [{"node": 3, "index": 5, "weight": 1}]}}
                },
            },
            "expression 'aa' binds morph target 5 of node 3, which has 0",
        ),
        (
            {"specVersion": "1.0", "expressions": {"preset": {"aa": 3}}},
            "aa is not an object; left it out",
        ),
        ({"specVersion": "1.0", "lookAt": {"type": 1}}, "lookAt.type is 1, not text"),
    ],
)
def test_an_invalid_part_of_a_vrm_is_left_out_with_a_warning(tmp_path, extension, reason):
    build = build_arm()
    build.document["extensions"] = {"VRMC_vrm": extension}
    with pytest.warns(CharacterWarning, match=reason):
        character = load(tmp_path, build.bytes())
    assert character.morphs == ()
    assert character.look_at is None


def test_one_bad_expression_costs_that_one_alone(tmp_path, human):
    def damaged(nodes, carrier, mesh, targets):
        name, content = vrm_1(nodes, carrier, mesh, targets)
        content["expressions"]["preset"]["happy"]["morphTargetBinds"][0]["index"] = 999
        content["expressions"]["custom"]["odd"] = {"morphTargetBinds": [{"node": 9999}]}
        return name, content

    with pytest.warns(CharacterWarning) as caught:
        character = load(tmp_path, vrm(human, damaged))
    assert {"999" in str(each.message) for each in caught} == {True}
    assert character.morphs == ("blink", "gasp")


@pytest.mark.parametrize("name", ["person.glb", "person.txt", "person.VRM", "person.vrm.bin"])
def test_a_vrm_is_known_by_its_content(tmp_path, human, name):
    assert dict(load(tmp_path, vrm(human, vrm_1), name).semantics) == BONES


def test_a_plain_gltf_that_is_called_vrm_loads_with_a_warning(tmp_path):
    with pytest.warns(CharacterWarning, match="contains no VRM"):
        assert load(tmp_path, build_arm().bytes()).name == "person"


@pytest.mark.parametrize("version", [1, 0])
def test_vrm_states_how_eyes_follow_a_point(tmp_path, version):
    if version:
        ranges = {"inputMaxValue": 45, "outputScale": 0.5}
        content = {
            "specVersion": "1.0",
            "lookAt": {
                "type": "expression",
                "offsetFromHeadBone": [0, 0.06, 0.01],
                "rangeMapHorizontalOuter": ranges,
            },
        }
    else:
        content = {
            "firstPerson": {
                "lookAtTypeName": "BlendShape",
                "firstPersonBoneOffset": {"x": 0, "y": 0.06, "z": -0.01},
                "lookAtHorizontalOuter": {"xRange": 45, "yRange": 0.5},
            }
        }
    build = build_arm()
    build.document["extensions"] = {"VRMC_vrm" if version else "VRM": content}
    look_at = load(tmp_path, build.bytes()).look_at
    assert look_at.by == "expression"
    assert look_at.eye_offset == (0, 0.06, 0.01)
    assert look_at.map_angles(np.radians(18), np.radians(9)) == pytest.approx((0.2, 0.1))


@pytest.mark.parametrize(
    ("extension", "content"),
    [
        ("VRMC_vrm", {"specVersion": "1.0", "lookAt": {"type": "bone"}}),
        ("VRM", {"firstPerson": {"lookAtTypeName": "Bone", "lookAtVerticalUp": {"xRange": 90}}}),
    ],
)
def test_joints_of_eyes_turn_by_10_of_90_degrees_unless_it_is_stated(tmp_path, extension, content):
    build = build_arm()
    build.document["extensions"] = {extension: content}
    look_at = load(tmp_path, build.bytes()).look_at
    turns = look_at.map_angles(np.radians(45), np.radians(180), "left")
    assert np.degrees(turns) == pytest.approx([5.0, 10.0])


def test_a_vrm_without_joints_for_its_eyes_looks_at_a_point_by_its_expressions(tmp_path, human):
    def looking(nodes, carrier, mesh, targets):
        name, content = vrm_1(nodes, carrier, mesh, targets)
        for way, target in {"lookLeft": "aa", "lookRight": "oh", "lookUp": "ih"}.items():
            bind = {"node": carrier, "index": targets.index(target), "weight": 1.0}
            content["expressions"]["preset"][way] = {"morphTargetBinds": [bind]}
        content["lookAt"] = {"type": "expression"}
        return name, content

    character = load(tmp_path, vrm(human, looking))
    animator = Animator(character, place=RootDelta(), layers=(GazeLayer,))
    left = np.array([0.2, 0.15, 1.0])
    for frame in range(30):
        pose = animator.update(CharacterCommand(frame / 30, gaze=left)).pose
    assert pose.morphs is not None
    weights = dict(zip(character.morphs, pose.morphs, strict=True))
    assert weights["lookLeft"] > 0.02
    assert weights["lookRight"] == 0.0
    eyes = [character.skeleton.index(name) for name in ("LeftEye", "RightEye")]
    assert np.array_equal(pose.rotations[eyes], character.skeleton.rest.rotations[eyes])


def test_a_vrm_that_says_nothing_of_its_eyes_looks_as_people_do(tmp_path):
    build = build_arm()
    build.document["extensions"] = {"VRM": {"firstPerson": {}}}
    assert load(tmp_path, build.bytes()).look_at is None
