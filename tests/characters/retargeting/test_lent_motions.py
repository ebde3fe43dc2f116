"""Characters without clips, who play the motions of a bundled one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Animator, Character, RootDelta, with_lent_motions
from cubeling.characters.ik.legs import find_legs
from cubeling.characters.model.character import skin
from cubeling.characters.model.standing import idle_clip
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.attached_limbs import (
    with_attached_limbs,
    with_toe_ends,
    with_whole_limbs,
)
from cubeling.characters.retargeting.hanging_arms import ArmClearance, share_inside
from cubeling.characters.retargeting.lent_motions import LentClips
from cubeling.characters.retargeting.measures import foot_gap
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from tests.characters.commands import command
from tests.characters.formats.built_gltf import SAMPLES

GIANTS = [path for path in SAMPLES if path.stem == "dino_t-rex"]
"""A creature of others whose feet are a third of its height."""


@pytest.fixture(scope="module")
def human():
    """The bundled human as a file without clips would be: no clips, no files beside it."""
    own = Character.load("human")
    return replace(own, name="person", clips={}, standing=None, gestures=None)


@pytest.fixture(scope="module")
def person(human):
    return with_lent_motions(human)


def hands_below_shoulders(character, pose):
    """How much lower the higher hand is than its shoulder, in parts of the arm."""
    placed = pose.globals(character.skeleton)[:, :3, 3]
    joint = character.anatomy.joints
    arms = [placed[joint[f"{s}UpperArm"]] - placed[joint[f"{s}Hand"]] for s in ("left", "right")]
    return min(float(arm[1] / np.linalg.norm(arm)) for arm in arms)


@pytest.mark.slow(reason="it retargets the clips of a walker")
def test_a_person_without_clips_stands_with_hanging_arms_from_the_first_frame_and_walks(person):
    animator = Animator(person, place=RootDelta())
    assert animator.walks
    assert {"wave", "nod"} <= {*animator.actions}
    first = animator.update(command(0.0)).pose
    assert hands_below_shoulders(person, first) > 0.8
    assert share_inside(Rig(person.skeleton, person.anatomy, person.meshes), first) < 0.02
    there = np.array([0.0, 0.3])
    for frame in range(1, 60):
        posed = animator.update(command(frame / 30, "move", 2.0, there))
    assert posed.state in ("walk", "run")
    assert posed.table_from_character[2, 3] > 0.05


def test_one_whose_only_clip_walks_borrows_the_rest_and_keeps_its_own():
    own = Character.load("human")
    stride = replace(own.clips["Walk"], name="animation0")
    walker = replace(own, standing=None, plan=None, gestures=None, clips={"animation0": stride})
    lent = with_lent_motions(walker)
    assert {"animation0", "idle", "Walk", "wave"} <= {*lent.clips}
    assert lent.clips["animation0"].poses is stride.poses
    assert idle_clip(lent.clips) == "idle"
    assert lent.gestures is not None
    standing = replace(walker, clips={"survey": replace(own.clips["idle"], name="survey")})
    assert with_lent_motions(standing) is standing  # it stands by itself


@pytest.mark.skipif(not GIANTS, reason="the creatures of others are not here")
def test_the_feet_of_a_curve_end_as_they_begin_also_with_large_feet():
    giant = with_lent_motions(replace(Character.load(GIANTS[0]), clips={}))
    ends = giant.clips["WalkRightShort"].in_place[np.array([0, -1])].globals(giant.skeleton)
    feet = list(giant.anatomy.feet)
    np.testing.assert_allclose(ends[0, feet], ends[1, feet], atol=1e-6)


def test_clips_are_retargeted_when_they_are_asked_for_and_once(human):
    clips = with_lent_motions(human).clips
    assert isinstance(clips, LentClips)
    assert "Walk" in clips
    assert clips._made == {}
    assert clips["nod"] is clips["nod"]
    assert [*clips._made] == ["nod"]


def test_its_hands_beat_what_it_says_as_the_lender_s_do(human, person):
    own = Character.load("human").gestures
    assert person.gestures is not None
    assert own is not None
    lent, theirs = person.gestures.recordings[0].turns, own.recordings[0].turns
    assert person.gestures.phrases == own.phrases
    apart = rotations.multiply(rotations.conjugate(lent), theirs)
    assert np.linalg.norm(rotations.to_rotation_vector(apart), axis=-1).max() < math.radians(1.0)


@pytest.mark.parametrize("name", ["human", "robot", "vleo"])
def test_a_character_with_motions_of_its_own_keeps_them(name):
    character = Character.load(name)
    assert character.lender is None
    assert with_lent_motions(character) is character


def test_an_animal_gets_those_of_an_animal(human):
    vleo = replace(Character.load("vleo"), clips={}, standing=None, gestures=None)
    lent = with_lent_motions(vleo)
    assert vleo.lender == "vleo"
    assert {"idle", "nod"} <= {*lent.clips}
    assert human.lender == "human"


def test_a_clip_of_one_frame_is_no_motion(human):
    wave = Character.load("human").clips["wave"]
    posed = replace(human, clips={"T-Pose": replace(wave, poses=wave.poses[:1])})
    assert posed.lender == "human"
    assert replace(human, clips={"wave": wave}).lender is None


def test_a_giant_stands_on_the_same_feet(human, person):
    size = np.diag([10.0, 10.0, 10.0, 1.0])
    rest = human.skeleton.rest
    giant = replace(
        human,
        skeleton=replace(human.skeleton, rest=replace(rest, translations=10.0 * rest.translations)),
        meshes=tuple(
            replace(
                mesh,
                positions=10.0 * mesh.positions,
                inverse_bind=size @ mesh.inverse_bind @ np.linalg.inv(size),
                morphs=(),
            )
            for mesh in human.meshes
        ),
    )
    own, large = (each.clips["nod"].poses for each in (person, with_lent_motions(giant)))
    np.testing.assert_allclose(large.translations, 10.0 * own.translations, atol=0.01)


def test_arms_are_held_away_from_wide_hips_by_as_much_as_these_need(human):
    idle = Character.load("human").clips["idle"].poses[:1]
    narrow = ArmClearance.of(Rig(human.skeleton, human.anatomy, human.meshes), idle[0])
    wide_meshes = tuple(replace(mesh, positions=_wider(human, mesh, 0.14)) for mesh in human.meshes)
    rig = Rig(human.skeleton, human.anatomy, wide_meshes)
    wide = ArmClearance.of(rig, idle[0])
    assert min(wide.angles.values()) > max(narrow.angles.values(), default=0.0)
    assert share_inside(rig, idle[0]) > 0.05
    assert share_inside(rig, wide.hold(idle)[0]) < 0.03


def _wider(human, mesh, more):
    """The vertices of a mesh with those of hips and thighs farther from the middle [m]."""
    parts = ("hips", "leftUpperLeg", "rightUpperLeg", "spine")
    joints = [human.anatomy.joints[part] for part in parts]
    strongest = np.take_along_axis(mesh.joints, np.argmax(mesh.weights, axis=1)[:, None], axis=1)[
        :, 0
    ]
    moved = mesh.positions.copy()
    own = np.isin(strongest, joints)
    moved[own, 0] += (more * np.sign(moved[own, 0])).astype(moved.dtype)
    return moved


def test_a_foot_that_a_rig_has_elsewhere_is_led_by_its_shin(human):
    torn = _with_foot_at_root(human)
    rig = Rig(torn.skeleton, torn.anatomy)
    assert not rig.legs[0].attached
    whole = with_attached_limbs(torn)
    rest, before = (
        [skin(mesh, each.skeleton.rest.globals(each.skeleton)) for mesh in each.meshes]
        for each in (whole, torn)
    )
    np.testing.assert_allclose(np.concatenate(rest), np.concatenate(before), atol=1e-6)
    lent = with_lent_motions(torn)
    assert foot_gap(lent.clips["jump"].poses, Rig(lent.skeleton, lent.anatomy)) < 0.01


def test_legs_of_its_own_clips_reach_a_foot_that_a_rig_has_elsewhere(human):
    torn = _with_foot_at_root(human)
    rest = torn.skeleton.rest
    count, hips = 20, torn.anatomy.joints["hips"]
    translations = np.tile(rest.translations, (count, 1, 1))
    # Hips that sink and sway take the thighs with them; the left foot stays at the root.
    translations[:, hips, 1] -= 0.08 * np.linspace(0.0, 1.0, count)
    translations[:, hips, 0] += 0.04 * np.linspace(0.0, 1.0, count)
    clip = Clip(
        "sway", 30.0, Pose(translations, np.tile(rest.rotations, (count, 1, 1))), loop=False
    )
    own = replace(torn, clips={"sway": clip})
    whole = with_whole_limbs(own)
    poses, rig = whole.clips["sway"].poses, Rig(whole.skeleton, whole.anatomy)
    assert foot_gap(clip.poses, Rig(own.skeleton, own.anatomy)) > 0.08
    assert foot_gap(poses, rig) < 0.001
    stood, stands = (
        each.clips["sway"].poses.globals(each.skeleton)[:, each.anatomy.joints["leftFoot"]]
        for each in (own, whole)
    )
    np.testing.assert_allclose(stands, stood, atol=2e-3)
    swayed = poses.translations.copy()
    swayed[:, whole.anatomy.joints["leftUpperLeg"]] += 0.05  # what any layer may do
    assert foot_gap(replace(poses, translations=swayed), rig) < 0.001
    assert with_whole_limbs(replace(human, clips={"sway": clip})).clips["sway"] is clip


def test_toes_that_carry_the_shin_are_not_led_by_the_foot_that_it_leads(human):
    swapped = {"leftToes": "LeftLeg", "leftLowerLeg": "LeftFoot", "leftFoot": "LeftToe"}
    body = human.with_stated_anatomy
    torn = _with_foot_at_root(replace(body, semantics={**body.semantics, **swapped}))
    whole = with_attached_limbs(torn)
    joint, parents = whole.anatomy.joints, whole.skeleton.parents
    assert parents[joint["leftFoot"]] == joint["leftLowerLeg"]
    assert parents[joint["leftLowerLeg"]] == joint["leftToes"]
    rest, before = (each.skeleton.rest.globals(each.skeleton) for each in (whole, torn))
    for mesh, own in zip(whole.meshes, torn.meshes, strict=True):
        np.testing.assert_allclose(skin(mesh, rest), skin(own, before), atol=1e-6)


def _with_foot_at_root(human):
    """The human, whose left foot is a child of its root."""
    skeleton, foot = human.skeleton, human.anatomy.joints["leftFoot"]
    placed = skeleton.rest.globals(skeleton)[foot]
    translations, turns = skeleton.rest.translations.copy(), skeleton.rest.rotations.copy()
    translations[foot], turns[foot] = placed[:3, 3], rotations.from_matrix(placed[:3, :3])
    parents = list(skeleton.parents)
    parents[foot] = 0
    rest = replace(skeleton.rest, translations=translations, rotations=turns)
    body = replace(
        human.with_stated_anatomy, skeleton=Skeleton(skeleton.names, tuple(parents), rest)
    )
    return body


def test_feet_without_toes_get_some_so_that_they_are_held_in_place(human):
    toes = {human.anatomy.joints[f"{side}Toes"] for side in ("left", "right")}
    names = tuple(
        f"plate{joint}" if joint in toes else name
        for joint, name in enumerate(human.skeleton.names)
    )
    stated = dict.fromkeys(("leftToes", "rightToes"), "")
    joints = {
        part: names[joint] for part, joint in human.anatomy.joints.items() if part not in stated
    }
    flat = replace(
        human, skeleton=replace(human.skeleton, names=names), semantics={**joints, **stated}
    )
    feet = with_toe_ends(flat)
    assert find_legs(flat.skeleton) is None
    assert find_legs(feet.skeleton) is not None
    assert "leftToes" in feet.skeleton.names
    own = [skin(mesh, flat.skeleton.rest.globals(flat.skeleton)) for mesh in flat.meshes]
    new = [skin(mesh, feet.skeleton.rest.globals(feet.skeleton)) for mesh in feet.meshes]
    np.testing.assert_array_equal(np.concatenate(new), np.concatenate(own))
