"""Spring bones that a VRM states, on an arm in millimetres with a lock of hair."""

import numpy as np
import pytest

from cubeling.characters import Animator, Character, CharacterCommand, CharacterWarning, RootDelta
from cubeling.characters.control.layers.springs import SpringLayer
from cubeling.characters.skeleton import rotations
from tests.characters.formats.built_gltf import build_arm

HAIR = [
    {"name": "lock1", "translation": [0, 0, 100], "children": [5, 7]},
    {"name": "lock2", "translation": [0, 50, 0], "children": [6]},
    {"name": "lock3", "translation": [0, 30, 40]},
    {"name": "ribbon", "translation": [20, 0, 0]},
]


@pytest.fixture
def load(tmp_path):
    """Loads the arm with hair at its hand, and these extensions."""

    def loaded(**extensions):
        build = build_arm()
        build.document["nodes"][2]["children"] = [4]
        build.document["nodes"] += [dict(node) for node in HAIR]
        build.document["extensions"] = extensions
        (tmp_path / "arm.glb").write_bytes(build.bytes())
        return Character.load(tmp_path / "arm.glb")

    return loaded


def springs_1(**changes):
    joint = {"hitRadius": 0.02, "stiffness": 0.5, "gravityPower": 0.2, "dragForce": 0.3}
    return {
        "specVersion": "1.0",
        "colliders": [
            {"node": 1, "shape": {"sphere": {"offset": [0, 10, 0], "radius": 0.05}}},
            {"node": 2, "shape": {"capsule": {"offset": [0, 0, 0], "tail": [9, 0, 0]}}},
            {"node": -1, "shape": {"sphere": {}}},  # written by some exporters
        ],
        "colliderGroups": [{"name": "body", "colliders": [0, 1, 2, 9]}],
        "springs": [
            {
                "joints": [{"node": 4} | joint, {"node": 6, "stiffness": 9.0}],
                "colliderGroups": [0, 7],
                "center": 1,
            }
        ],
    } | changes


SPRINGS_0 = {
    "colliderGroups": [
        {"node": 1, "colliders": [{"offset": {"x": 1, "y": 2, "z": 3}, "radius": 0.1}]},
        {"node": -1, "colliders": [{"radius": 0.1}]},
    ],
    "boneGroups": [
        {
            "comment": "",
            "stiffiness": 2.0,
            "gravityPower": 0.5,
            "gravityDir": {"x": 0.6, "y": -0.8, "z": 0.0},
            "dragForce": 0.7,
            "center": -1,
            "hitRadius": 0.03,
            "bones": [4, -1],
            "colliderGroups": [0, 1],
        },
        {"bones": [5], "stiffiness": 9.0},
    ],
}


def test_chains_of_vrm_1_swing_as_they_state(load):
    character = load(VRMC_springBone=springs_1())
    (bone,) = character.springs  # the last of a chain is the end of the bone before it
    assert bone.joint == "lock1"
    assert bone.tail == pytest.approx((0.0, 80.0, 40.0))  # lock3, past lock2
    assert (bone.stiffness, bone.drag, bone.radius) == (0.5, 0.3, 0.02)
    assert bone.gravity == pytest.approx((0.0, -0.2, 0.0))
    assert bone.center == "upper"
    ball, capsule = bone.colliders
    assert (ball.joint, ball.start, ball.end, ball.radius) == (
        "upper",
        (0, 10, 0),
        (0, 10, 0),
        0.05,
    )
    assert (capsule.joint, capsule.end, capsule.radius) == ("lower", (9, 0, 0), 0.0)


def test_groups_of_vrm_0_swing_with_all_below_them(load):
    character = load(VRM={"secondaryAnimation": SPRINGS_0})
    bones = {bone.joint: bone for bone in character.springs}
    assert set(bones) == {"lock1", "lock2", "lock3", "ribbon"}
    first = bones["lock1"]
    assert first.tail == pytest.approx((0.0, 50.0, 0.0))  # its first child
    assert (first.stiffness, first.drag, first.radius) == (2.0, 0.7, 0.03)
    assert first.gravity == pytest.approx((-0.3, -0.4, 0.0))  # Unity's x is to the right
    assert first.center is None
    assert [each.start for each in first.colliders] == [(1, 2, -3)]  # and its z is turned round
    assert bones["lock2"].stiffness == 2.0  # the first group counts
    # 7 cm on as it lies from its parent.
    assert bones["lock3"].tail == pytest.approx((0.0, 0.07 * 0.6, 0.07 * 0.8))


def test_hair_of_a_vrm_hangs_from_the_first_frame_on(load):
    character = load(VRMC_springBone=springs_1())
    animator = Animator(character, place=RootDelta(), layers=(SpringLayer,))
    rest = character.skeleton.rest.rotations
    joint, turns = character.skeleton.index("lock1"), []
    for frame in range(60):
        shown = animator.update(CharacterCommand(frame / 30)).pose.rotations
        turn = rotations.multiply(rotations.conjugate(rest[joint]), shown[joint])
        turns.append(np.linalg.norm(rotations.to_rotation_vector(turn)))
    assert min(turns) > 0.1
    assert max(turns) - min(turns) < 0.01


def test_a_file_without_a_vrm_has_no_spring_bones(load):
    assert load().springs == ()


@pytest.mark.parametrize(
    ("springs", "reason"),
    [
        (
            springs_1(springs=[{"joints": [{"node": 99}]}]),
            r"node is 99, but the file has 8 nodes",
        ),
        (springs_1(springs=[{"joints": [{"node": 4, "gravityDir": 1}]}]), "not 3 numbers"),
        (springs_1(colliders=[{"node": 1}]), "lacks 'shape'"),
    ],
)
def test_invalid_spring_bones_are_left_out_with_a_warning(load, springs, reason):
    with pytest.warns(CharacterWarning, match=reason):
        load(VRMC_springBone=springs)


def test_one_bad_collider_or_spring_costs_that_part_alone(load):
    springs = springs_1()
    ball = springs["colliders"][0]
    springs["colliders"].insert(0, {"node": 1, "shape": {"sphere": {"radius": "wide"}}})
    springs["colliderGroups"] = [{"colliders": [0, 1]}]
    springs["springs"].insert(0, {"joints": [{"node": 99}, {"node": 5}]})
    springs["springs"][1]["colliderGroups"] = [0]
    with pytest.warns(CharacterWarning) as caught:
        (bone,) = load(VRMC_springBone=springs).springs
    assert len(caught) == 2
    assert bone.joint == "lock1"
    assert [each.radius for each in bone.colliders] == [ball["shape"]["sphere"]["radius"]]
    balls = [{"radius": "x"}, {"radius": 0.1}]
    groups = {
        "colliderGroups": [{"node": 1, "colliders": balls}],
        "boneGroups": [7, {"bones": [4], "colliderGroups": [0]}],
    }
    with pytest.warns(CharacterWarning, match="left it out"):
        first = load(VRM={"secondaryAnimation": groups}).springs[0]
    assert (first.joint, [each.radius for each in first.colliders]) == ("lock1", [0.1])


def test_a_file_may_require_what_is_read_of_vrm(tmp_path):
    build = build_arm()
    build.document["extensionsRequired"] = [
        "VRMC_vrm",
        "VRMC_springBone",
        "VRMC_node_constraint",
        "VRMC_materials_mtoon",
    ]
    (tmp_path / "arm.glb").write_bytes(build.bytes())
    assert Character.load(tmp_path / "arm.glb").springs == ()
