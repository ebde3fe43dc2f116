import pytest

from cubeling.characters.skeleton.anatomy import Anatomy
from tests.characters.skeleton.bodies import PERSON, named_body
from tests.characters.skeleton.test_naming import PEOPLE

PARTS = ("Proximal", "Intermediate", "Distal")
FINGERS = {"Index": 0.03, "Middle": 0.01, "Ring": -0.01, "Little": -0.03}
HAND = PERSON | {
    f"{finger}{part}": (f"{finger}{PARTS[number - 1]}" if number else "Hand", place)
    for finger, z in FINGERS.items()
    for number, part in enumerate(PARTS)
    for place in [(0.8 + 0.03 * number, 1.45, z)]
}
HAND |= {
    "ThumbProximal": ("Hand", (0.73, 1.45, 0.03)),
    "ThumbDistal": ("ThumbProximal", (0.76, 1.45, 0.05)),
}
# In the order of HAND.
HANDS = {
    "Mixamo": " ".join(
        f"mixamorig:{{}}Hand{finger}{number}"
        for finger in ("Index", "Middle", "Ring", "Pinky")
        for number in "123"
    )
    + " mixamorig:{}HandThumb1 mixamorig:{}HandThumb2",
    "Unreal": " ".join(
        f"{finger}_0{number}_{{}}"
        for finger in ("index", "middle", "ring", "pinky")
        for number in "123"
    )
    + " thumb_01_{} thumb_02_{}",
    "Biped": " ".join(
        f"Bip01_{{}}_Finger{finger}{number}" for finger in "1234" for number in ("", "1", "2")
    )
    + " Bip01_{}_Finger0 Bip01_{}_Finger01 Bip01_{}_Finger0Nub<Bip01_{}_Finger01",
    "CAT": " ".join(f"CATRig{{}}ArmDigit{finger}{number}" for finger in "2345" for number in "123")
    + " CATRig{}ArmDigit11 CATRig{}ArmDigit12",
    "no names at all": " ".join(f"c{{}}{number}" for number in range(14)),
}


def body(style):
    own = PEOPLE[style].split()[: 2 + len(PERSON)]
    return named_body(" ".join([*own, HANDS[style]]), HAND)


@pytest.mark.parametrize("style", HANDS)
def test_the_fingers_of_every_convention_are_recognised(style):
    skeleton, truth = body(style)
    anatomy = Anatomy.guess(skeleton)
    assert {part: skeleton.names[joint] for part, joint in anatomy.joints.items()} == truth


def test_a_metacarpal_is_not_the_first_joint_of_a_finger():
    skeleton, truth = body("Unreal")
    own = PEOPLE["Unreal"].split()[: 2 + len(PERSON)]
    style = " ".join([*own, HANDS["Unreal"], "index_metacarpal_{}>index_01_{}"])
    skeleton, truth = named_body(style, HAND)
    joints = Anatomy.guess(skeleton).joints
    assert skeleton.names[joints["leftIndexProximal"]] == truth["leftIndexProximal"]


def test_weapons_and_sleeves_are_no_fingers():
    own = PEOPLE["KayKit"].split()[: 2 + len(PERSON)]
    helpers = "slot.{}<wrist.{} sleeve1.{}<wrist.{} sleeve2.{}<sleeve1.{}"
    skeleton, truth = named_body(" ".join([*own, helpers]), PERSON)
    joints = Anatomy.guess(skeleton).joints
    assert {part: skeleton.names[joint] for part, joint in joints.items()} == truth
