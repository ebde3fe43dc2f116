from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Character, CharacterError, Pose, Skeleton
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import BODY_PARTS, Anatomy
from cubeling.characters.skeleton.body_parts.joint_names import read_names
from tests.characters.skeleton.bodies import DOG, PERSON, named_body, skeleton_of
from tests.characters.skeleton.test_naming import ANIMALS, PEOPLE
from tests.examples import examples, some

DATA = Path(__file__).parents[4] / "shared" / "data" / "gltf"


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
        ("dino_t-rex", "humanoid", {"rightHand": "FrontFoot.R", "hips": "Body"}),
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


UNITY = PEOPLE["Unity, VRM"]
SHIN_ENDS = "L R Hips Spine Chest Neck Head - Arm.{} Forearm.{} Hand.{} Thigh.{} Shin.{} - - "


@pytest.mark.parametrize(
    ("style", "hips"),
    [
        (f"{UNITY} Root>Hips@", "Hips"),
        (f"{UNITY} Hips_root>Hips@", "Hips"),
        (UNITY.replace("Hips", "Bone.003") + " Hips>Bone.003@", "Bone.003"),
        (f"{UNITY} Root>Hips@ Head_target<Root", "Hips"),
        (f"{UNITY} Root>Hips@ Head.001<Root", "Hips"),
        (f"{UNITY} Root>Hips@ {{}}UpperLeg_IK<Root@UpperLeg", "Hips"),
        (PEOPLE["MMD"], "センター"),
    ],
)
def test_hips_are_not_a_root_on_the_ground(style, hips):
    skeleton, truth = named_body(style, PERSON)
    anatomy = Anatomy.guess(skeleton)
    assert skeleton.names[anatomy.joints["hips"]] == hips
    assert skeleton.names[anatomy.joints["head"]] == truth["head"]


@pytest.mark.parametrize("end", ["Shin.{}_end", "Shin.{}.001_end", "Nub.{}", "EndSite.{}"])
def test_a_leg_that_ends_at_the_shin_stands_on_the_end_of_its_bone(end):
    skeleton, _ = named_body(f"{SHIN_ENDS} {end}<Shin.{{}}@Foot", PERSON)
    anatomy = Anatomy.guess(skeleton)
    assert skeleton.names[anatomy.joints["leftFoot"]] == end.format("L")
    assert anatomy.missing == ()


@pytest.mark.parametrize(
    "foot", ["Foot.{}", "IK_Foot.{}", "ankle_ctrl.{}", "LegIK.{}", "Leg.target.{}", "foot_{}_bind"]
)
def test_a_foot_of_inverse_kinematics_hangs_under_the_root(foot):
    helpers = f"Root>Hips@ Pole.{{}}<Root@Pole {foot}<Root@Foot Toe.{{}}<{foot}@Toes"
    skeleton, _ = named_body(f"{SHIN_ENDS} - {helpers}", PERSON | {"Pole": ("", (0.1, 0.5, 0.5))})
    anatomy = Anatomy.guess(skeleton)
    assert skeleton.names[anatomy.joints["rightFoot"]] == foot.format("R")
    assert skeleton.names[anatomy.joints["leftToes"]] == "Toe.L"
    assert anatomy.missing == ()


def test_unnamed_legs_may_end_at_the_shin_and_unnamed_ears_are_no_arms():
    ears = PERSON | {f"Ear{k}": ("", (0.1, 1.7 + 0.1 * k, 0)) for k in range(3)}
    helpers = "- - - c{}0<n6@Ear0 c{}1<c{}0@Ear1 c{}2<c{}1@Ear2"
    style = f"1 2 n0 n3 n4 n5 n6 - a{{}}1 a{{}}2 a{{}}3 b{{}}0 b{{}}1 - - {helpers}"
    skeleton, truth = named_body(style, ears)
    anatomy = Anatomy.guess(skeleton)
    assert {part: skeleton.names[joint] for part, joint in anatomy.joints.items()} == truth
    assert anatomy.missing == ("leftFoot", "rightFoot")


def test_a_body_may_stand_beside_the_origin():
    helpers = "Root>Hips@ Foot.{}<Root@Foot Foot.{}.001<Foot.{}"
    skeleton, _ = named_body(f"{SHIN_ENDS} {helpers}", PERSON)
    beside = (
        skeleton.rest.translations + np.where(np.array(skeleton.parents) < 0, 1.0, 0.0)[:, None]
    )
    moved = replace(skeleton, rest=replace(skeleton.rest, translations=beside))
    assert Anatomy.guess(moved) == Anatomy.guess(skeleton)
    assert Anatomy.guess(moved).missing == ()


@pytest.mark.parametrize(
    "legs", ["Thigh.{} Shin.{} Tarsus.{} Toe.{}", "leg1.{} leg2.{} leg3.{} leg4.{}"]
)
def test_a_bird_walks_on_two_legs_and_its_wings_are_no_arms(legs):
    bird = {part: DOG[part] for part in ("hips", "spine", "neck", "head")} | {
        part: DOG[part] for part in ("UpperLeg", "LowerLeg", "Foot", "Toes")
    }
    bird |= {
        f"Wing{k}": (f"Wing{k - 1}" if k else "spine", (0.1 + 0.2 * k, 0.6, 0)) for k in range(4)
    }
    wings = " ".join(f"wing{k}.{{}}" for k in range(4))
    skeleton, truth = named_body(f"L R body spine neck head {legs} {wings}", bird)
    anatomy = Anatomy.guess(skeleton)
    found = {part: skeleton.names[joint] for part, joint in anatomy.joints.items()}
    assert found == {part: name for part, name in truth.items() if "Wing" not in part}
    assert anatomy.kind == "humanoid"
    assert len(anatomy.feet) == 2


def test_front_legs_that_do_not_reach_the_ground_are_arms():
    short = {part: (up, (x, y / 3 + 0.4, z)) for part, (up, (x, y, z)) in DOG.items()}
    rex = {part: short[part] if "Front" in part else DOG[part] for part in DOG}
    skeleton, truth = named_body(ANIMALS["hind and front"], rex)
    anatomy = Anatomy.guess(skeleton)
    assert anatomy.kind == "humanoid"
    assert anatomy.missing == ()
    assert skeleton.names[anatomy.joints["leftHand"]] == truth["leftFrontFoot"]
    assert skeleton.names[anatomy.joints["leftUpperArm"]] == truth["leftFrontUpperLeg"]
    assert "leftFrontToes" not in anatomy.joints


# As in two much used sets of animals, whose paws have no leg above them.
PAWS_APART = {
    "Body Torso Neck1 Head Tail1 Tail2 BackUpperLeg.{} BackLowerLeg.{} - - FrontShoulder.{} "
    "FrontUpperLeg.{} FrontLowerLeg.{} - - Back>Tail1 BackLeg.{}>BackUpperLeg.{} "
    "BackShoulder.{}>BackLeg.{} Neck2>Head IKBackLeg.{}<@Foot FFB.{}<IKBackLeg.{}@Toes "
    "IKFrontLeg.{}<@FrontFoot FF.{}<IKFrontLeg.{}@FrontToes PoleTargetBack.{}<@LowerLeg "
    "PoleTarget.{}<@FrontLowerLeg Ear1.{}<Head": ("IKBackLeg", "IKFrontLeg"),
    "Body Shoulders Neck Head Tail1 Tail2 BackUpLeg.{} BackLowLeg.{} - - FrontLeg.{} FrontUpLeg.{} "
    "FrontLowLeg.{} - - root>Body@ BackLeg.{}>BackUpLeg.{} BackLowLeg.{}_end<BackLowLeg.{}@Foot "
    "FrontLowLeg.{}_end<FrontLowLeg.{}@FrontFoot BackFoot.{}<root@Foot FrontFoot.{}<root@FrontFoot "
    "FrontFoot.{}_end<FrontFoot.{} Hips<Body Torso<Hips": ("BackFoot", "FrontFoot"),
    "Hip Spine Neck Head Tail1 Tail2 Leg1.{} Leg2.{} - - - UpperArm.{} ForeArm.{} - - root>Hip@ "
    "Foot.{}<root@Foot Hand.{}<root@FrontFoot": ("Foot", "Hand"),
}


@pytest.mark.parametrize("style", PAWS_APART)
def test_an_animal_may_stand_on_feet_of_inverse_kinematics(style):
    skeleton, truth = named_body(f"L R {style}", DOG)
    anatomy = Anatomy.guess(skeleton)
    assert anatomy.kind == "quadruped"
    assert anatomy.missing == ()
    assert [skeleton.names[joint] for joint in anatomy.feet] == [
        f"{foot}.{side}" for foot in PAWS_APART[style] for side in "LR"
    ]
    for part in ("hips", "head", "leftUpperLeg", "rightFrontLowerLeg"):
        assert skeleton.names[anatomy.joints[part]] == truth[part]


def along(axis):
    """Every bone along one axis, as the zero poses of some recordings are."""

    def zero_pose(skeleton):
        offsets = np.zeros((len(skeleton), 3))
        offsets[:, axis] = np.linalg.norm(skeleton.rest.translations, axis=-1)
        return replace(skeleton, rest=replace(skeleton.rest, translations=offsets))

    return zero_pose


def turned(axis, angle):
    """Turned about the origin, as models that face or stand elsewhere are."""

    def rest_pose(skeleton):
        offsets, turns = skeleton.rest.translations.copy(), skeleton.rest.rotations.copy()
        roots = np.array(skeleton.parents) < 0
        offsets[roots] = rotations.rotate(rotations.about(axis, angle), offsets[roots])
        turns[roots] = rotations.about(axis, angle)
        return replace(skeleton, rest=Pose(offsets, turns))

    return rest_pose


@pytest.mark.parametrize(
    ("pose", "kinds"),
    some(
        [
            (along(0), [PEOPLE]),
            (turned("y", np.pi / 2), [PEOPLE, ANIMALS]),
            *((along(axis), [PEOPLE]) for axis in (1, 2)),
            (turned("x", np.pi / 2), [PEOPLE]),
            *((turned("y", quarters * np.pi / 2), [PEOPLE, ANIMALS]) for quarters in (2, 3)),
        ],
        2,
    ),
)
def test_names_are_read_in_any_pose(pose, kinds):
    silent = ("no names at all", "German", "French", "Rigify wolf")  # places tell some parts
    for kind in kinds:
        for style in kind:
            if style not in silent:
                skeleton, truth = named_body(kind[style], PERSON if kind is PEOPLE else DOG)
                found = Anatomy.guess(pose(skeleton)).joints
                assert {part: skeleton.names[found[part]] for part in truth} == truth, style


@pytest.mark.parametrize("facing", [-1.0, 1.0])
def test_legs_that_only_their_place_tells_apart_are_told_by_the_head(facing):
    skeleton, truth = named_body(ANIMALS["legs that only their place tells apart"], DOG)
    rest = replace(skeleton.rest, translations=skeleton.rest.translations * [1, 1, facing])
    anatomy = Anatomy.guess(replace(skeleton, rest=rest))
    assert skeleton.names[anatomy.joints["leftFrontFoot"]] == truth["leftFrontFoot"]


def test_declared_parts_have_priority_over_guesses():
    skeleton, _ = named_body(PEOPLE["Mixamo"], PERSON)
    anatomy = Anatomy.guess(skeleton, {"chest": "mixamorig:Spine", "leftToes": ""})
    assert anatomy.joint("chest") == skeleton.index("mixamorig:Spine")
    assert anatomy.joint("leftToes") is None
    assert anatomy.joint("spine") is None  # one joint is one part


def test_an_unknown_joint_is_refused_with_a_suggestion():
    skeleton, _ = named_body(PEOPLE["Unity, VRM"], PERSON)
    with pytest.raises(CharacterError, match=r"leftFoot = 'LeftFoo'.*mean 'LeftFoot'"):
        Anatomy.guess(skeleton, {"leftFoot": "LeftFoo"})
    with pytest.raises(CharacterError, match=r"named 'LeftFoot' \(do you mean 'leftFoot'"):
        Anatomy.guess(skeleton, {"LeftFoot": "LeftFoot"})


def test_missing_parts_are_listed():
    skeleton, _ = named_body(PEOPLE["Unity, VRM"], PERSON)
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
    read_names([name])


@settings(max_examples=examples(25))
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
