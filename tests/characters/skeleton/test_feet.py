import numpy as np
import pytest

from cubeling.characters import Pose, Skeleton
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.feet import find_feet, foot_joints_by_side
from tests.characters.skeleton.bodies import DOG, PERSON, named_body
from tests.characters.skeleton.test_naming import ANIMALS, PEOPLE


@pytest.mark.parametrize(
    "names",
    [
        ("LeftFoot", "RightFoot", "Spine"),
        ("foot_l", "foot_r", "ball"),
        ("Foot.L", "Foot.R", "Metal_bar"),
        ("b_LeftFoot01_017", "b_RightFoot01_021", "tail"),
        ("ToeL", "ToeR", "toeless"),
    ],
)
def test_feet_are_found_by_common_joint_names(names):
    rest = Pose(np.zeros((3, 3)), np.tile(rotations.IDENTITY, (3, 1)))
    assert foot_joints_by_side(Skeleton(names, (-1, -1, -1), rest)) == ([0], [1])


@pytest.mark.parametrize("style", PEOPLE)
def test_a_person_stands_on_two_feet_whatever_their_names(style):
    skeleton, truth = named_body(PEOPLE[style], PERSON)
    feet = find_feet(skeleton)
    assert {skeleton.names[foot[0]] for foot in feet} == {truth["leftFoot"], truth["rightFoot"]}


@pytest.mark.parametrize("style", ANIMALS)
def test_an_animal_stands_on_four_feet_whatever_their_names(style):
    skeleton, truth = named_body(ANIMALS[style], DOG)
    ankles = {skeleton.names[foot[0]] for foot in find_feet(skeleton)}
    assert ankles == {truth[part] for part in truth if part.endswith("Foot")}
    left, right = foot_joints_by_side(skeleton)
    names = [skeleton.names[left[0]], skeleton.names[right[0]]]
    assert names == [truth["leftFoot"], truth["rightFoot"]]


def test_a_body_without_legs_stands_where_joints_are_named_feet():
    skeleton, _ = named_body("L R Body - - - - - - - - - - - - Foot.{}<Body@Foot", PERSON)
    assert [[skeleton.names[j] for j in foot] for foot in find_feet(skeleton)] == [
        ["Foot.L"],
        ["Foot.R"],
    ]
