from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Pose, Skeleton
from cubeling.characters.formats import load_motion
from cubeling.characters.retargeting import retarget
from cubeling.characters.retargeting.feet.footskate import find_foot_contacts
from cubeling.characters.retargeting.feet.leg_ik import place_ankle
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy

SHARED = Path(__file__).parents[4] / "shared" / "data"
LIMBS = [
    (side + a, side + b)
    for side in ("left", "right")
    for a, b in (
        ("UpperArm", "LowerArm"),
        ("LowerArm", "Hand"),
        ("UpperLeg", "LowerLeg"),
        ("LowerLeg", "Foot"),
    )
]


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def places(clip, skeleton):
    return clip.poses.globals(skeleton)[..., :3, 3]


def parts(clip, skeleton, anatomy):
    """Where the parts of the body are, (frames, parts, 3)."""
    return places(clip, skeleton)[:, list(anatomy.joints.values())]


def directions(clip, skeleton, anatomy):
    """Unit vectors of all limbs, (frames, limbs, 3)."""
    at = places(clip, skeleton)
    starts, ends = ([anatomy.joints[pair[i]] for pair in LIMBS] for i in (0, 1))
    bones = at[:, ends] - at[:, starts]
    return bones / np.linalg.norm(bones, axis=-1, keepdims=True)


def reframed(skeleton, seed):
    """The same places at rest, with joints whose axes point anywhere; the root keeps its own."""
    turns = np.random.default_rng(seed).normal(size=(len(skeleton), 4))
    turns = rotations.normalize(turns)
    turns[0] = rotations.IDENTITY
    at = skeleton.rest.globals(skeleton)[:, :3, 3]
    parents = np.array(skeleton.parents)
    back = rotations.conjugate(turns[parents])
    back[parents < 0] = rotations.IDENTITY
    above = np.where(parents[:, None] < 0, 0.0, at[parents])
    rest = Pose(rotations.rotate(back, at - above), rotations.multiply(back, turns))
    return Skeleton(skeleton.names, skeleton.parents, rest)


def scaled(skeleton, factor):
    rest = skeleton.rest
    return replace(skeleton, rest=replace(rest, translations=rest.translations * factor))


def reposed(skeleton, anatomy, turns):
    """The same skeleton with some parts turned at rest, in the character's axes."""
    own = skeleton.rest.rotations.copy()
    for part, turn in turns.items():
        own[anatomy.joints[part]] = rotations.multiply(turn, own[anatomy.joints[part]])
    return replace(skeleton, rest=replace(skeleton.rest, rotations=own))


@pytest.mark.parametrize("name", ["Walk", "WalkLeftShort", "Run", "idle"])
def test_retargeting_to_the_same_skeleton_changes_nothing(human, name):
    clip, skeleton, anatomy = human.clips[name], human.skeleton, human.anatomy
    same = retarget(clip, skeleton, anatomy, skeleton, anatomy, hold_feet=False)
    assert np.allclose(parts(same, skeleton, anatomy), parts(clip, skeleton, anatomy), atol=1e-6)
    assert same.root_motion
    assert np.allclose(same.track, clip.track, atol=1e-6)


def test_retargeting_to_a_larger_copy_scales_everything(human):
    clip, skeleton, anatomy = human.clips["Walk"], human.skeleton, human.anatomy
    large = retarget(clip, skeleton, anatomy, scaled(skeleton, 2.5), anatomy, hold_feet=False)
    grown = parts(large, scaled(skeleton, 2.5), anatomy)
    assert np.allclose(grown, 2.5 * parts(clip, skeleton, anatomy), atol=1e-6)


def test_the_axes_of_joints_do_not_matter(human):
    clip, skeleton, anatomy = human.clips["Run"], human.skeleton, human.anatomy
    other = reframed(skeleton, 3)
    there = retarget(clip, skeleton, anatomy, other, anatomy, hold_feet=False)
    back = retarget(there, other, anatomy, skeleton, anatomy, hold_feet=False)
    right = parts(clip, skeleton, anatomy)
    assert np.allclose(parts(there, other, anatomy), right, atol=1e-6)
    assert np.allclose(parts(back, skeleton, anatomy), right, atol=1e-6)


@pytest.mark.parametrize("hold", [False, True])
def test_it_does_not_matter_how_the_arms_are_held_at_rest(human, hold):
    clip, skeleton, anatomy = human.clips["Walk"], human.skeleton, human.anatomy
    arms = {"leftUpperArm": rotations.about("z", 0.9), "rightUpperArm": rotations.about("z", -0.9)}
    spread = reposed(skeleton, anatomy, arms)
    there = retarget(clip, skeleton, anatomy, spread, anatomy, hold_feet=hold)
    apart = directions(there, spread, anatomy) - directions(clip, skeleton, anatomy)
    arm = [number for number, (start, _) in enumerate(LIMBS) if "Arm" in start]
    assert np.abs(apart[:, arm]).max() < 1e-6


def test_forearms_without_hands_go_on_like_the_upper_arms(human):
    clip, skeleton = human.clips["Walk"], human.skeleton
    handless = {
        p: j for p, j in human.anatomy.joints.items() if "Hand" not in p and "Prox" not in p
    }
    anatomy = replace(human.anatomy, joints=handless)
    bare = skeleton, replace(anatomy, joints=handless)
    arms = {"leftUpperArm": rotations.about("z", 0.9), "rightUpperArm": rotations.about("z", -0.9)}
    spread = reposed(skeleton, anatomy, arms)
    hands = [human.anatomy.joints[f"{side}Hand"] for side in ("left", "right")]
    elbows = [anatomy.joints[f"{side}LowerArm"] for side in ("left", "right")]
    forearms = []
    for body in (skeleton, spread):
        at = places(retarget(clip, *bare, body, anatomy, hold_feet=False), body)
        forearms.append(at[:, hands] - at[:, elbows])
    assert forearms[1] == pytest.approx(forearms[0], abs=0.002)


@pytest.mark.parametrize("name", ["Run", "cheer"])
def test_it_does_not_matter_where_the_joint_is_that_carries_the_hips(human, name):
    clip, skeleton, anatomy = human.clips[name], human.skeleton, human.anatomy
    hips = anatomy.joints["hips"]
    offsets = skeleton.rest.translations.copy()
    below = np.array(skeleton.parents) == hips
    offsets[below] += offsets[hips] - [0.0, 0.0, 0.1]
    offsets[hips] = [0.0, 0.0, 0.1]
    grounded = replace(skeleton, rest=replace(skeleton.rest, translations=offsets))
    at = [
        places(retarget(clip, skeleton, anatomy, body, anatomy, hold_feet=False), body)
        for body in (skeleton, grounded)
    ]
    others = [joint for part, joint in anatomy.joints.items() if part != "hips"]
    assert np.allclose(at[1][:, others], at[0][:, others], atol=1e-6)


def test_a_body_that_lies_on_its_back_in_the_file_stands_up(human):
    clip, skeleton, anatomy = human.clips["Walk"], human.skeleton, human.anatomy
    lying = rotations.about("x", -np.pi / 2)
    bones = skeleton.rest
    translations, turns = bones.translations.copy(), bones.rotations.copy()
    translations[0] = rotations.rotate(lying, translations[0])
    turns[0] = rotations.multiply(lying, turns[0])
    names = ("Z_UP", *skeleton.names[1:])  # a root that stands is one that is turned
    other = Skeleton(names, skeleton.parents, Pose(translations, turns))
    there = retarget(clip, skeleton, anatomy, other, Anatomy.guess(other), hold_feet=False)
    upright = rotations.rotate(rotations.conjugate(lying), parts(there, other, anatomy))
    assert np.allclose(upright, parts(clip, skeleton, anatomy), atol=1e-6)


def test_a_longer_spine_shares_the_bend(human):
    skeleton = human.skeleton
    trunk = [skeleton.index(name) for name in ("hips", "spine1", "spine2", "chest")]
    short = Anatomy.guess(skeleton)
    bend = rotations.about("x", 0.6)
    turns = np.tile(skeleton.rest.rotations, (2, 1, 1))
    turns[1, trunk[-1]] = rotations.multiply(turns[1, trunk[-1]], bend)
    clip = replace(
        human.clips["idle"],
        poses=Pose(np.tile(skeleton.rest.translations, (2, 1, 1)), turns),
        loop=False,
    )
    longer = with_more_spine(skeleton)
    there = retarget(clip, skeleton, short, longer, Anatomy.guess(longer), hold_feet=False)
    heads = [
        c.poses.globals(s)[1, s.index("head"), :3, :3]
        for c, s in ((clip, skeleton), (there, longer))
    ]
    assert np.allclose(heads[0], heads[1], atol=1e-6)
    extra = there.poses.rotations[1, longer.index("spine25")]
    assert 0.05 < np.linalg.norm(rotations.to_rotation_vector(extra)) < 0.6


def with_more_spine(skeleton):
    """A skeleton with one more joint, half-way from spine2 to the chest."""
    chest = skeleton.index("chest")
    names = [*skeleton.names[:chest], "spine25", *skeleton.names[chest:]]
    parents = [*skeleton.parents[:chest], skeleton.parents[chest]]
    parents += [parent + (parent >= chest) for parent in skeleton.parents[chest:]]
    parents[chest + 1] = chest
    translations = np.insert(skeleton.rest.translations, chest, 0.0, axis=0)
    translations[chest] = translations[chest + 1] = skeleton.rest.translations[chest] / 2
    turns = np.insert(skeleton.rest.rotations, chest, rotations.IDENTITY, axis=0)
    return Skeleton(tuple(names), tuple(parents), Pose(translations, turns))


def test_retargeting_a_person_to_a_quadruped_is_refused(human):
    vleo = Character.load("vleo")
    with pytest.raises(CharacterError, match=r"'Walk': .*humanoid and the character is a quadr"):
        retarget(human.clips["Walk"], human.skeleton, human.anatomy, vleo.skeleton, vleo.anatomy)


def test_a_body_without_legs_is_refused_in_one_line(human):
    lamp = Skeleton(("base",), (-1,), Pose(np.zeros((1, 3)), rotations.IDENTITY[None]))
    with pytest.raises(CharacterError, match="the source is neither"):
        retarget(human.clips["Walk"], lamp, Anatomy.guess(lamp), human.skeleton, human.anatomy)


def recorded(name):
    path = SHARED / "cmu-mocap" / f"{name}.amc"
    if not path.exists():
        pytest.skip("no shared data")
    performance = load_motion(path)
    return performance.clip, performance.skeleton, Anatomy.guess(performance.skeleton)


def slide(clip, skeleton, joint, contacts):
    """Mean speed of a joint over the ground while it stands [m/s]."""
    at = places(clip, skeleton)[:, joint][:, [0, 2]]
    speed = np.linalg.norm(np.diff(at, axis=0), axis=-1) * clip.rate
    return speed[contacts[1:] & contacts[:-1]].mean()


def test_a_recorded_walk_stands_on_the_ground_without_sliding(human):
    clip, source, anatomy = recorded("16/16_15")
    skeleton = human.skeleton
    walk = retarget(clip, source, anatomy, skeleton, human.anatomy)
    assert walk.root_motion
    at = places(walk, skeleton)
    toes = [human.anatomy.joints[side + "Toes"] for side in ("left", "right")]
    rest = skeleton.rest.globals(skeleton)[toes, 1, 3]
    assert (at[:, toes, 1] > rest - 1e-3).all()
    performer = Rig(source, anatomy)
    contacts = find_foot_contacts(clip, performer, performer.legs)
    for foot, joint in enumerate(toes):
        assert contacts.ball[:, foot].mean() > 0.3
        assert slide(walk, skeleton, joint, contacts.ball[:, foot]) < 0.01


def test_a_recorded_walk_keeps_the_directions_of_limbs(human):
    clip, source, anatomy = recorded("16/16_15")
    walk = retarget(clip, source, anatomy, human.skeleton, human.anatomy, hold_feet=False)
    mine = directions(walk, human.skeleton, human.anatomy)
    assert np.abs(mine - directions(clip, source, anatomy)).max() < 1e-6


def test_an_overstretched_leg_bends_in_its_mean_direction(human):
    rig = Rig(human.skeleton, human.anatomy)
    leg = rig.legs[0]
    rest = human.skeleton.rest
    angles = np.radians(np.linspace(40.0, -20.0, 61))  # the knee goes beyond straight
    turns = np.tile(rest.rotations, (len(angles), 1, 1))
    turns[:, leg.lower] = rotations.multiply(
        rest.rotations[leg.lower], rotations.about("x", angles)
    )
    pose = Pose(np.tile(rest.translations, (len(angles), 1, 1)), turns)
    globals_ = pose.globals(human.skeleton)
    hip, at = globals_[:, leg.upper, :3, 3], globals_[:, leg.foot, :3, 3]
    target = at + 0.06 * (hip - at)  # nearer to the hip, so that the knee has to bend
    bent = place_ankle(pose, rig, leg, target)
    world = bent.globals(human.skeleton)[:, :, :3, 3]
    assert np.abs(world[:, leg.foot] - target).max() < 1e-9
    ahead = world[:, leg.lower, 2] - (world[:, leg.upper, 2] + world[:, leg.foot, 2]) / 2
    assert ahead.min() > 0.05
    assert np.abs(np.diff(world[:, leg.lower], axis=0)).max() < 0.03


def test_a_leg_does_not_spin_when_its_target_passes_the_hip(human):
    rig = Rig(human.skeleton, human.anatomy)
    leg = rig.legs[0]
    still = human.clips["idle"].sample(0.0)
    pose = Pose(np.tile(still.translations, (41, 1, 1)), np.tile(still.rotations, (41, 1, 1)))
    globals_ = pose.globals(human.skeleton)
    hip, at = globals_[:, leg.upper, :3, 3], globals_[:, leg.foot, :3, 3]
    past = np.array([0.01, 0.0, 0.2]) * np.linspace(-1.0, 1.0, 41)[:, None]
    bent = place_ankle(pose, rig, leg, hip + past + [0.01, 0.0, 0.0])
    turned = np.abs(np.einsum("fji,fji->fj", bent.rotations[1:], bent.rotations[:-1]))
    assert 2 * np.arccos(np.minimum(turned.min(), 1.0)) < np.radians(25)
    assert np.linalg.norm(bent.globals(human.skeleton)[:, leg.foot, :3, 3] - hip, axis=1).min() > (
        0.3 * np.linalg.norm(at - hip, axis=1).min()
    )


def test_a_walk_is_retargeted_between_quadrupeds():
    if not (SHARED / "gltf" / "Fox.glb").exists():
        pytest.skip("no shared data")
    fox = Character.load(SHARED / "gltf" / "Fox.glb")
    dinosaur = Character.load(SHARED / "gltf" / "dino_apatosaurus.glb")
    walk = retarget(
        fox.clips["Walk"], fox.skeleton, fox.anatomy, dinosaur.skeleton, dinosaur.anatomy
    )
    feet = places(walk, dinosaur.skeleton)[:, list(dinosaur.anatomy.feet)]
    rest = dinosaur.skeleton.rest.globals(dinosaur.skeleton)[list(dinosaur.anatomy.feet), 1, 3]
    assert (feet[..., 1] > rest - 1e-2).all()
    assert (np.ptp(feet[..., 2], axis=0) > 0.1 * dinosaur.height).all()


def test_a_recording_whose_hips_count_from_their_rest_stands_on_the_ground(human):
    """Blender and studios that drop the place of the hips write such files."""
    walk = human.clips["Walk"]
    hips = human.anatomy.joints["hips"]
    skeleton = human.skeleton
    sunk = walk.poses.translations.copy()
    sunk[:, hips] -= skeleton.rest.translations[hips]
    low = replace(walk, poses=replace(walk.poses, translations=sunk))
    arguments = (skeleton, human.anatomy, skeleton, human.anatomy)
    at, right = (places(retarget(clip, *arguments), skeleton) for clip in (low, walk))
    feet = [human.anatomy.joints[side + "Foot"] for side in ("left", "right")]
    assert at[:, feet, 1] == pytest.approx(right[:, feet, 1], abs=0.02)


def test_a_rest_above_the_ground_of_the_motion_lowers_no_hips(human):
    """So rest files whose first frame is a stride, or that count hips from elsewhere."""
    skeleton, walk, hips = human.skeleton, human.clips["Walk"], human.anatomy.joints["hips"]
    lifted = skeleton.rest.translations.copy()
    lifted[hips, 1] += 0.04 * human.height
    above = replace(skeleton, rest=replace(skeleton.rest, translations=lifted))
    made = retarget(walk, above, human.anatomy, skeleton, human.anatomy)
    heights = places(made, skeleton)[:, hips, 1] - places(walk, skeleton)[:, hips, 1]
    assert np.abs(heights).max() < 1e-3 * human.height  # 22e-3 by the height of the rest
