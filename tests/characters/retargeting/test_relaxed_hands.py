"""Hands hang relaxed where a motion has no fingers."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character, Clip, Pose
from cubeling.characters.retargeting.retarget import retarget
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from tests.characters.skeleton.bodies import PERSON, named_body
from tests.characters.skeleton.test_fingers import FINGERS, HAND, HANDS, PARTS
from tests.characters.skeleton.test_naming import PEOPLE

FLAT = f"{PEOPLE['Unity, VRM']} " + " ".join(f"{{}}{part}" for part in list(HAND)[len(PERSON) :])


@pytest.fixture(scope="module")
def flat():
    """A person with flat hands, palms down, in a T-pose."""
    skeleton, _ = named_body(FLAT, HAND)
    return skeleton, Anatomy.guess(skeleton)


@pytest.fixture(scope="module")
def fingerless():
    """A motion of a person whose hands have no fingers, in the same T-pose."""
    skeleton, _ = named_body(PEOPLE["Unity, VRM"], PERSON)
    return still(skeleton), skeleton, Anatomy.guess(skeleton)


def still(skeleton):
    return Clip("Still", 30.0, Pose.of_frames([skeleton.rest] * 3), loop=False)


def bones(clip, body, side, finger):
    """Unit vectors along the bones of a finger, without the last, in the first frame."""
    skeleton, anatomy = body
    parts = [f"{side}{finger}{part}" for part in PARTS]
    joints = [anatomy.joints[part] for part in parts if part in anatomy.joints]
    places = clip.poses.globals(skeleton)[0, joints, :3, 3]
    along = np.diff(places, axis=0)
    return along / np.linalg.norm(along, axis=-1, keepdims=True)


def bends_deg(clip, body, side, finger):
    """Turn of each joint of a finger relative to the joint above [deg]."""
    _, anatomy = body
    joints = [anatomy.joints[f"{side}{finger}{part}"] for part in PARTS]
    turns = rotations.to_rotation_vector(clip.poses.rotations[0, joints])
    return np.degrees(np.linalg.norm(turns, axis=-1))


def test_flat_fingers_curl_to_the_palm_without_data(flat, fingerless):
    clip = retarget(*fingerless, *flat, hold_feet=False)
    for side in ("left", "right"):
        for finger in FINGERS:
            first, second = bones(clip, flat, side, finger)
            assert 0 > first[1] > second[1]  # palms are down
            assert abs(first[2]) < 1e-6  # and fingers stay side by side
            assert np.all(bends_deg(clip, flat, side, finger) > 14)
            assert np.all(bends_deg(clip, flat, side, finger) < 36)


def test_the_index_bends_least_and_the_little_finger_most(flat, fingerless):
    clip = retarget(*fingerless, *flat, hold_feet=False)
    sums = [bends_deg(clip, flat, "left", finger).sum() for finger in FINGERS]
    assert sums == sorted(sums)
    assert sums[-1] > sums[0] + 20


def test_both_hands_mirror_each_other(flat, fingerless):
    skeleton, anatomy = flat
    places = retarget(*fingerless, *flat, hold_feet=False).poses.globals(skeleton)[0, :, :3, 3]
    for part, joint in anatomy.joints.items():
        if part.startswith("left"):
            partner = places[anatomy.joints["right" + part[4:]]]
            assert places[joint] == pytest.approx(partner * [-1, 1, 1], abs=1e-6)


def test_the_thumb_turns_to_the_palm(flat, fingerless):
    skeleton, anatomy = flat
    places = retarget(*fingerless, *flat, hold_feet=False).poses.globals(skeleton)[0, :, :3, 3]
    thumb = [anatomy.joints[f"leftThumb{part}"] for part in ("Proximal", "Distal")]
    assert -0.02 < places[thumb[1], 1] - places[thumb[0], 1] < -0.003


def test_the_fingers_of_the_motion_win(flat):
    skeleton, anatomy = flat
    joints = [anatomy.joints["leftIndexProximal"]]
    poses = still(skeleton).poses
    turns = poses.rotations.copy()
    turns[:, joints] = rotations.about("z", -np.linspace(0.1, 0.4, 3))[:, None]
    clip = Clip("Point", 30.0, replace(poses, rotations=turns), loop=False)
    same = retarget(clip, *flat, *flat, hold_feet=False)
    assert same.poses.rotations == pytest.approx(turns, abs=1e-9)


def test_fingers_that_a_motion_has_but_never_moves_are_relaxed(flat, fingerless):
    mixamo = PEOPLE["Mixamo"].split()[: 2 + len(PERSON)]
    skeleton, _ = named_body(" ".join([*mixamo, HANDS["Mixamo"]]), HAND)
    clip = retarget(still(skeleton), skeleton, Anatomy.guess(skeleton), *flat, hold_feet=False)
    relaxed = retarget(*fingerless, *flat, hold_feet=False)
    assert clip.poses.rotations == pytest.approx(relaxed.poses.rotations, abs=1e-9)


def test_the_own_motions_of_a_body_keep_its_flat_hands(flat):
    clip = retarget(still(flat[0]), *flat, *flat, hold_feet=False)
    assert clip.poses.rotations == pytest.approx(still(flat[0]).poses.rotations, abs=1e-9)


def test_a_hand_that_is_a_fist_at_rest_stays_one(flat, fingerless):
    skeleton, anatomy = flat
    turns = skeleton.rest.rotations.copy()
    for side, sign in (("left", -1.0), ("right", 1.0)):
        for finger in FINGERS:
            for part in PARTS:
                joint = anatomy.joints[f"{side}{finger}{part}"]
                turns[joint] = rotations.about("z", sign * 1.2)
    fists = replace(skeleton, rest=replace(skeleton.rest, rotations=turns))
    moved, source, source_anatomy = fingerless
    clip = retarget(moved, source, source_anatomy, fists, anatomy, hold_feet=False)
    fingers = [anatomy.joints[f"left{f}{part}"] for f in FINGERS for part in PARTS]
    alike = np.abs((clip.poses.rotations[0, fingers] * turns[fingers]).sum(-1))
    assert alike == pytest.approx(1.0, abs=1e-9)


def test_the_bundled_human_relaxes_its_hands_in_a_walk_without_fingers():
    human = Character.load("human")
    skeleton, anatomy = human.skeleton, human.anatomy
    bare = {p: j for p, j in anatomy.joints.items() if not p.endswith(PARTS)}
    source = replace(anatomy, joints=bare)
    renamed = replace(skeleton, names=tuple(f"{n}_{k}" for k, n in enumerate(skeleton.names)))
    clip = retarget(human.clips["Walk"], renamed, source, skeleton, anatomy, hold_feet=False)
    own = [anatomy.joints[p] for p in anatomy.joints if p.startswith("leftLittle")]
    bent = rotations.multiply(
        rotations.conjugate(skeleton.rest.rotations[own]), clip.poses.rotations[0, own]
    )
    angles = np.degrees(np.linalg.norm(rotations.to_rotation_vector(bent), axis=-1))
    assert np.all((angles > 10) & (angles < 40))
