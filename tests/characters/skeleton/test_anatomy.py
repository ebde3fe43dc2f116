from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from characters import Character, CharacterError, Pose, Skeleton
from characters.skeleton import rotations
from characters.skeleton.anatomy import BODY_PARTS, Anatomy
from characters.skeleton.joint_names import read_name

DATA = Path(__file__).parents[4] / "shared" / "data" / "gltf"

# Parents and rest places of a person, left side only; {} is where a side goes.
BODY = {
    "hips": ("", (0, 1, 0)),
    "spine": ("hips", (0, 1.1, 0)),
    "chest": ("spine", (0, 1.3, 0)),
    "neck": ("chest", (0, 1.5, 0)),
    "head": ("neck", (0, 1.6, 0)),
    "Shoulder": ("chest", (0.05, 1.45, 0)),
    "UpperArm": ("Shoulder", (0.2, 1.45, 0)),
    "LowerArm": ("UpperArm", (0.45, 1.45, 0)),
    "Hand": ("LowerArm", (0.7, 1.45, 0)),
    "UpperLeg": ("hips", (0.1, 0.95, 0)),
    "LowerLeg": ("UpperLeg", (0.1, 0.5, 0)),
    "Foot": ("LowerLeg", (0.1, 0.1, 0)),
    "Toes": ("Foot", (0.1, 0.03, 0.1)),
}
# One style a line: left and right, then the names in the order of BODY; "-" where it has none.
STYLES = {
    "Mixamo": "Left Right mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Neck "
    "mixamorig:Head mixamorig:{}Shoulder mixamorig:{}Arm mixamorig:{}ForeArm mixamorig:{}Hand "
    "mixamorig:{}UpLeg mixamorig:{}Leg mixamorig:{}Foot mixamorig:{}ToeBase",
    "Unity": "Left Right Hips Spine Chest Neck Head {}Shoulder {}UpperArm {}LowerArm {}Hand "
    "{}UpperLeg {}LowerLeg {}Foot {}Toes",
    "VRoid": "L R J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_Neck J_Bip_C_Head "
    "J_Bip_{}_Shoulder J_Bip_{}_UpperArm J_Bip_{}_LowerArm J_Bip_{}_Hand J_Bip_{}_UpperLeg "
    "J_Bip_{}_LowerLeg J_Bip_{}_Foot J_Bip_{}_ToeBase",
    "Rigify": "L R spine spine.001 spine.002 spine.004 spine.006 shoulder.{} upper_arm.{} "
    "forearm.{} hand.{} thigh.{} shin.{} foot.{} toe.{}",
    "Rigify, deforming": "L R DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.004 DEF-spine.006 "
    "DEF-shoulder.{} DEF-upper_arm.{} DEF-forearm.{} DEF-hand.{} DEF-thigh.{} DEF-shin.{} "
    "DEF-foot.{} DEF-toe.{}",
    "CMU": "l r root lowerback thorax lowerneck head {}clavicle {}humerus {}radius {}hand {}femur "
    "{}tibia {}foot {}toes",
    "cgspeed": "Left Right Hips LowerBack Chest Neck Head {}Collar {}Shoulder {}Elbow {}Wrist "
    "{}Hip {}Knee {}Ankle {}Toe",
    "H-Anim": "l r HumanoidRoot vl5 vt6 vc7 skullbase {}_sternoclavicular {}_shoulder {}_elbow "
    "{}_wrist {}_hip {}_knee {}_ankle {}_metatarsal",
    "H-Anim, plain": "l r humanoid_root vl5 vt6 vc4 skull - {}_shoulder {}_elbow {}_wrist {}_hip "
    "{}_knee {}_ankle -",
    "Quaternius": "L R Hips Abdomen Torso Neck Head Shoulder.{} UpperArm.{} LowerArm.{} Palm.{} "
    "UpperLeg.{} LowerLeg.{} Foot.{} -",
    "Biped": "L R Bip01_Pelvis Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head Bip01_{}_Clavicle "
    "Bip01_{}_UpperArm Bip01_{}_Forearm Bip01_{}_Hand Bip01_{}_Thigh Bip01_{}_Calf Bip01_{}_Foot "
    "Bip01_{}_Toe0",
    "Unreal": "l r pelvis spine_01 spine_02 neck_01 head clavicle_{} upperarm_{} lowerarm_{} "
    "hand_{} thigh_{} calf_{} foot_{} ball_{}",
    "Daz": "l r hip abdomenLower chestLower neckLower head {}Collar {}ShldrBend {}ForearmBend "
    "{}Hand {}ThighBend {}Shin {}Foot {}Toe",
    "MakeHuman": "L R root spine02 spine01 neck01 head clavicle.{} upperarm01.{} lowerarm01.{} "
    "wrist.{} upperleg01.{} lowerleg01.{} foot.{} toe1-1.{}",
    "Khronos": "L R torso_joint_1 torso_joint_2 torso_joint_3 neck_joint_1 neck_joint_2 - "
    "arm_joint_{}_1 arm_joint_{}_2 arm_joint_{}_3 leg_joint_{}_1 leg_joint_{}_2 leg_joint_{}_3 "
    "leg_joint_{}_5",
    "no names at all": "1 2 n0 n3 n4 n5 n6 a{}0 a{}1 a{}2 a{}3 b{}0 b{}1 b{}2 b{}3",
}


def body(style):
    """A person named in a style, and the joint names by part that are right."""
    left, right, *names = STYLES[style].split()
    named = dict(zip(BODY, names, strict=True))
    joints = {}
    truth = {}

    def parent_of(part):
        above = BODY[part][0]
        return parent_of(above) if above and named[above] == "-" else above

    for part, name in named.items():
        for side, word, sign in (("left", left, 1), ("right", right, -1)):
            if name == "-":
                continue
            above = parent_of(part)
            x, y, z = BODY[part][1]
            full = name.format(word)
            parent = named[above].format(word) if above else ""
            joints[full] = (parent, (sign * x, y, z))
            truth[side + part if part[0].isupper() else part] = full
    return skeleton_of(joints), truth


def skeleton_of(joints):
    names = tuple(joints)
    parents = tuple(names.index(parent) if parent else -1 for parent, _ in joints.values())
    world = np.array([place for _, place in joints.values()], float)
    local = world - np.where(np.array(parents)[:, None] >= 0, world[list(parents)], 0.0)
    return Skeleton(names, parents, Pose(local, np.tile(rotations.IDENTITY, (len(names), 1))))


@pytest.mark.parametrize("style", STYLES)
def test_every_naming_convention_is_recognised(style):
    skeleton, truth = body(style)
    anatomy = Anatomy.guess(skeleton)
    found = {part: skeleton.names[joint] for part, joint in anatomy.joints.items()}
    assert found == truth
    assert anatomy.kind == "humanoid"
    assert anatomy.missing == ()


@pytest.mark.parametrize("name", ["human", "vleo"])
def test_the_bundled_characters_have_all_parts(name):
    anatomy = Character.load(name).anatomy
    assert anatomy.kind == ("humanoid" if name == "human" else "quadruped")
    assert anatomy.missing == ()
    assert len(anatomy.feet) == (2 if name == "human" else 4)


@pytest.mark.parametrize(
    ("file", "kind", "some"),
    [
        ("CesiumMan", "humanoid", {"leftHand": "Skeleton_arm_joint_L__2_"}),
        ("RiggedFigure", "humanoid", {"rightLowerLeg": "leg_joint_R_2"}),
        ("RobotExpressive", "humanoid", {"hips": "Body", "leftFoot": "FootL", "head": "Head_1"}),
        ("BrainStem", "humanoid", {"leftUpperLeg": "node4", "head": "node20"}),
        ("Fox", "quadruped", {"leftFrontFoot": "b_LeftHand_011", "tail3": "b_Tail03_014"}),
        ("dino_apatosaurus", "quadruped", {"leftFoot": "BackFoot.L", "tail5": "Tail5"}),
        ("dino_t-rex", "quadruped", {"rightFrontFoot": "FrontFoot.R", "hips": "Body"}),
    ],
)
def test_third_party_models_are_recognised(file, kind, some):
    path = DATA / f"{file}.glb"
    if not path.exists():
        pytest.skip("no shared data")
    character = Character.load(path)
    assert character.anatomy.kind == kind
    names = character.skeleton.names
    assert {part: names[character.anatomy.joints[part]] for part in some} == some


def test_declared_parts_have_priority_over_guesses():
    skeleton, _ = body("Mixamo")
    anatomy = Anatomy.guess(skeleton, {"chest": "mixamorig:Spine", "leftToes": ""})
    assert anatomy.joint("chest") == skeleton.index("mixamorig:Spine")
    assert anatomy.joint("leftToes") is None
    assert anatomy.joint("spine") is None  # one joint is one part


def test_an_unknown_joint_is_refused_with_a_suggestion():
    skeleton, _ = body("Unity")
    with pytest.raises(CharacterError, match=r"leftFoot = 'LeftFoo'.*mean 'LeftFoot'"):
        Anatomy.guess(skeleton, {"leftFoot": "LeftFoo"})
    with pytest.raises(CharacterError, match=r"named 'LeftFoot' \(do you mean 'leftFoot'"):
        Anatomy.guess(skeleton, {"LeftFoot": "LeftFoot"})


def test_missing_parts_are_listed():
    skeleton, _ = body("Unity")
    keep = [j for j, name in enumerate(skeleton.names) if "LeftHand" not in name]
    joints = {skeleton.names[j]: (skeleton.names[skeleton.parents[j]] if j else "") for j in keep}
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    part = {name: (up, places[skeleton.index(name)]) for name, up in joints.items()}
    anatomy = Anatomy.guess(skeleton_of(part))
    assert anatomy.missing == ("leftHand",)


def test_a_lamp_is_neither_humanoid_nor_quadruped():
    lamp = skeleton_of({"base": ("", (0, 0, 0)), "stick": ("base", (0, 1, 0))})
    anatomy = Anatomy.guess(lamp)
    assert anatomy.kind == "other"
    assert anatomy.missing == ()


@given(st.text(max_size=20))
def test_any_name_can_be_read(name):
    read_name(name)


@settings(max_examples=25)
@given(st.data())
def test_any_tree_gets_an_anatomy_of_known_parts_and_distinct_joints(data):
    count = data.draw(st.integers(1, 12))
    words = st.sampled_from(["leg", "Arm.L", "rfoot", "Head", "b", "Spine", "FrontLeg.R", "Hips"])
    names = tuple(f"{data.draw(words)}_{number}" for number in range(count))
    parents = tuple(data.draw(st.integers(-1, number - 1)) for number in range(count))
    seed = np.random.default_rng(data.draw(st.integers(0, 1000)))
    rest = Pose(seed.normal(size=(count, 3)), np.tile(rotations.IDENTITY, (count, 1)))
    anatomy = Anatomy.guess(Skeleton(names, parents, rest))
    assert set(anatomy.joints) <= set(BODY_PARTS)
    assert len(set(anatomy.joints.values())) == len(anatomy.joints)
