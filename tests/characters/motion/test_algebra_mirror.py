from functools import cache
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Blend, Character, CharacterError, Mirror, Mirrored, Pose, Skeleton
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.motion.phase import PhasedMotion, with_phase
from cubeling.characters.skeleton import rotations

DATA = Path(__file__).parents[4] / "shared" / "data" / "gltf"
FLIP = np.array([-1.0, 1.0, 1.0])


@cache
def load(name: str) -> Character:
    if "." not in name:
        return Character.load(name)
    if not (DATA / name).exists():
        pytest.skip("no data")
    return Character.load(DATA / name)


def places(pose: Pose, skeleton: Skeleton):
    return pose.globals(skeleton)[..., :3, 3]


@pytest.mark.parametrize(
    "name", ["human", "vleo", "CesiumMan.glb", "RobotExpressive.glb", "dino_t-rex.glb"]
)
def test_mirroring_reflects_every_position_and_is_its_own_inverse(name):
    character = load(name)
    skeleton = character.skeleton
    mirror = Mirror.of(skeleton, character.morphs)
    size = np.ptp(places(skeleton.rest, skeleton), axis=0).max()
    for clip in list(character.clips.values())[:3]:
        poses = clip.poses[slice(0, None, 7)]
        mirrored = mirror.pose(poses)
        there = places(poses, skeleton) * FLIP
        # Scales of 32-bit files that differ along their axes in the last digit are not exact.
        slack = (1e-9 if poses.scales is None else 1e-6) * size
        assert np.abs(places(mirrored, skeleton)[:, mirror.partners] - there).max() < slack
        again = mirror.pose(mirrored)
        assert np.abs(places(again, skeleton) - places(poses, skeleton)).max() < slack
        turns = rotations.align(again.rotations, poses.rotations)
        assert np.abs(turns - poses.rotations).max() < 1e-9


@pytest.mark.parametrize("name", ["dino_apatosaurus.glb", "RobotExpressive.glb", "Fox.glb"])
def test_a_skin_is_mirrored_about_the_pose_it_was_bound_in(name):
    character = load(name)
    mirror = mirror_of(character)
    pose = next(iter(character.clips.values())).sample(0.3)
    twice = mirror.pose(mirror.pose(pose)).globals(character.skeleton)
    once = pose.globals(character.skeleton)
    assert np.abs(twice - once).max() < 1e-5 * np.abs(once).max()
    partners = mirror.partners
    names = character.skeleton.names
    assert all(partners[partners[i]] == i for i in range(len(names)))
    for joint, other in enumerate(partners):
        if "Left" in names[joint]:
            assert "Right" in names[other]


def test_the_left_footfall_of_a_mirrored_walk_is_the_right_footfall_of_the_walk():
    human = load("human")
    skeleton, walk = human.skeleton, human.clips["Walk"]
    mirror = Mirror.of(skeleton)
    original, mirrored = with_phase(walk, skeleton), with_phase(mirror.clip(walk), skeleton)
    assert mirrored.marks[0] == pytest.approx(original.marks[1], abs=1e-6)
    # A motion of phases knows so by itself.
    by_phase = Mirrored(original, mirror)
    assert np.allclose(
        by_phase.at(0.0).rotations, mirror.pose(original.at(0.5)).rotations, atol=1e-12
    )
    found = mirrored.at(0.3).rotations
    assert np.abs(rotations.align(by_phase.at(0.3).rotations, found) - found).max() < 1e-2
    twice = Mirrored(by_phase, mirror)
    assert np.allclose(twice.at(0.3).rotations, original.at(0.3).rotations)


def test_a_mirrored_turn_goes_the_other_way_and_blends_to_a_straight_one():
    human = load("human")
    mirror = Mirror.of(human.skeleton)
    left = with_phase(human.clips["WalkLeftWide"], human.skeleton)
    right = Mirrored(left, mirror)
    a, b = left.between(0.0, 1.0), right.between(0.0, 1.0)
    assert (b.x, b.z, b.yaw) == pytest.approx((-a.x, a.z, -a.yaw), abs=0.02)
    straight = Blend((left, right), (0.5, 0.5)).between(0.0, 1.0)
    assert straight.yaw == pytest.approx(0.0, abs=1e-6)
    assert abs(straight.x) < 0.03 * straight.z


def test_a_motion_without_steps_is_mirrored_in_time():
    vleo = load("vleo")
    clip = PhasedMotion(vleo.clips["kiss_head"])
    mirror = Mirror.of(vleo.skeleton)
    pose = Mirrored(clip, mirror).at(0.25)
    assert np.allclose(pose.rotations, mirror.pose(clip.at(0.25)).rotations)


def test_morphs_of_the_two_sides_are_exchanged(skeleton):
    mirror = Mirror.of(skeleton, ("happy", "blinkLeft", "blinkRight"))
    rest, looks = skeleton.rest, np.array([0.1, 0.2, 0.3])
    mirrored = mirror.pose(Pose(rest.translations, rest.rotations, None, looks)).morphs
    assert mirrored is not None
    assert mirrored.tolist() == [0.1, 0.3, 0.2]


def test_a_body_that_looks_aside_or_lacks_a_hand_is_refused():
    turned = np.array([[0, 0, 0], [0, 0, 1.0], [0, 0, -1.0]])
    identity = np.tile(rotations.IDENTITY, (3, 1))
    aside = Skeleton(("root", "LeftFoot", "RightFoot"), (-1, 0, 0), Pose(turned, identity))
    with pytest.raises(CharacterError, match="not symmetric"):
        Mirror.of(aside, pairs={"LeftFoot": "RightFoot"})
    reach = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [1, 0, 0]], float)
    lame = Skeleton(
        ("root", "LeftArm", "RightArm", "LeftHand"),
        (-1, 0, 0, 1),
        Pose(reach, np.tile(rotations.IDENTITY, (4, 1))),
    )
    with pytest.raises(CharacterError, match="'LeftHand' has no partner"):
        Mirror.of(lame)
