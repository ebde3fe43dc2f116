"""Contacts found in clips against what their authors put there, and against real recordings."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Character, Clip, Pose
from cubeling.characters.formats.loading import load_motion
from cubeling.characters.motion.contacts import find_contacts, spans
from cubeling.characters.motion.ground import find_ground, joint_trajectories
from cubeling.characters.skeleton.feet import find_feet
from tests.examples import examples, some
from tools.authoring.human.limbs import FOOT
from tools.authoring.human.motion import GAITS
from tools.authoring.modelling.gait import GroundArc, foot_motion

DATA = Path(__file__).parents[4] / "shared" / "data"


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def truth(gait):
    """When the authored feet are down, (frames, 2)."""
    arc = GroundArc(gait.speed, float(np.radians(gait.yaw_rate)))
    phase = np.arange(gait.frames + 1) / gait.frames
    return np.stack([foot_motion(arc, gait.steps, FOOT, s, phase).down for s in (1, -1)], axis=1)


@pytest.fixture(scope="module", params=sorted(GAITS))
def authored(request, human):
    clip = human.clips[request.param.replace("Turn", "Left")]
    return clip, truth(GAITS[request.param])


def off(found, down):
    """How many frames are wrong, of each foot."""
    return (found != down)[:-1].sum(axis=0)


def test_contacts_of_the_authored_gaits_are_found_within_two_frames(human, authored):
    clip, down = authored
    assert (off(find_contacts(clip, human.skeleton, find_feet(human.skeleton)), down) <= 3).all()


@pytest.mark.parametrize("rooted", [True, False])
def test_contacts_are_found_in_clips_in_place_also_in_curves(human, authored, rooted):
    clip, down = authored
    still = Clip(clip.name, clip.rate, clip.in_place, loop=True, root_motion=rooted)
    found = find_contacts(still, human.skeleton, find_feet(human.skeleton))
    assert (off(found, down) <= 0.1 * clip.rate).all()  # 0.1 s


def test_the_treadmill_of_a_walk_in_place_runs_as_fast_as_the_walk(human, authored):
    clip, _ = authored
    still = Clip(clip.name, clip.rate, clip.in_place, loop=True)
    feet = np.array([joint for foot in find_feet(human.skeleton) for joint in foot])
    ground = find_ground(still, joint_trajectories(still, human.skeleton), feet)
    gait = GAITS[clip.name.replace("Left", "Turn")]
    assert ground.velocity[1] == pytest.approx(-gait.speed, rel=0.15)
    assert np.degrees(ground.yaw_rate) == pytest.approx(-gait.yaw_rate, rel=0.15, abs=3)


@settings(max_examples=examples(15))
@given(
    shift=st.integers(1, GAITS["Walk"].frames - 1), size=st.floats(0.05, 40), lift=st.floats(-1, 1)
)
def test_contacts_do_not_depend_on_size_start_or_floor_height(human, shift, size, lift):
    clip = human.clips["Walk"]
    count = len(clip) - 1
    frames = np.append((np.arange(count) + shift) % count, shift)
    poses, rest = clip.in_place[frames], human.skeleton.rest
    translations = poses.translations.copy()
    translations[:, 1, 1] += lift
    moved = Clip("moved", clip.rate, Pose(translations * size, poses.rotations))
    skeleton = type(human.skeleton)(
        human.skeleton.names,
        human.skeleton.parents,
        Pose(rest.translations * size, rest.rotations),
    )
    down = truth(GAITS["Walk"])[frames]
    assert (off(find_contacts(moved, skeleton, find_feet(skeleton)), down) <= 5).all()


def test_feet_that_jump_leave_the_ground_at_once_and_touch_it_when_they_land(human):
    clip, feet = human.clips["jump"], find_feet(human.skeleton)
    found = find_contacts(clip, human.skeleton, feet)
    heights = clip.poses.globals(human.skeleton)[:, [foot[-1] for foot in feet], 1, 3]
    above = heights > heights[0] + 0.002
    assert above.any()
    assert ((found == above).sum(axis=0) <= 0.03 * clip.rate).all()  # 0.03 s


def test_both_feet_have_contact_while_standing(human):
    assert find_contacts(human.clips["idle"], human.skeleton, find_feet(human.skeleton)).all()


def test_short_contacts_and_gaps_are_dropped(gait, skeleton):
    clip = gait("walk", 1.3, 0.0, 1.0)
    translations = clip.poses.translations.copy()
    translations[10, 3, 1] += 0.2  # a standing foot is off its place for one frame
    translations[50, 3, 1] -= 0.1  # a swinging foot dips for one
    rough = Clip("rough", clip.rate, Pose(translations, clip.poses.rotations), True, True)
    found = find_contacts(rough, skeleton, ((3,), (4,)))
    assert [len(spans(found[:, foot], loop=True)) for foot in (0, 1)] == [1, 1]
    assert found[10, 0]


@given(st.lists(st.booleans(), min_size=2, max_size=30), st.booleans())
def test_spans_cover_the_contacts_and_nothing_else(flags, loop):
    down = np.array([*flags, flags[0]] if loop else flags)
    count = len(down) - 1 if loop else len(down)
    covered = np.zeros(count, bool)
    for first, length in spans(down, loop):
        covered[np.arange(first, first + length) % count] = True
    assert np.array_equal(covered, down[:count])


@pytest.mark.parametrize(
    ("name", "clip", "steps"),
    some(
        [
            ("Fox.glb", "Walk", [1, 1, 1, 1]),
            ("dino_t-rex.glb", "Armature|TRex_Walk", [1, 1]),
            ("RobotExpressive.glb", "Walking", [1, 1]),
            ("RobotExpressive.glb", "Running", [1, 1]),
            ("dino_apatosaurus.glb", "Armature|Apatosaurus_Run", [1, 1, 1, 1]),
        ],
        2,
    ),
)
def test_each_foot_lands_once_a_cycle_in_third_party_clips(name, clip, steps):
    path = DATA / "gltf" / name
    if not path.exists():
        pytest.skip("no shared data")
    character = Character.load(path)
    feet = find_feet(character.skeleton)
    found = find_contacts(character.clips[clip], character.skeleton, feet)
    assert [len(spans(found[:, foot], True)) for foot in range(len(feet))] == steps
    assert (found.mean(0) > 0.1).all()
    assert (found.mean(0) < 0.75).all()


@pytest.mark.parametrize(
    ("name", "share"), [("16_15", (0.55, 0.7)), ("16_21", (0.5, 0.65)), ("16_35", (0.25, 0.5))]
)
def test_the_contact_share_of_recorded_people_is_plausible(name, share):
    path = DATA / "cmu-mocap" / "16" / f"{name}.amc"  # a slow and a long walk, and a jog
    if not path.exists():
        pytest.skip("no shared data")
    person = load_motion(path)
    feet = find_feet(person.skeleton)
    found = find_contacts(person.clip, person.skeleton, feet)
    assert len(feet) == 2
    assert share[0] < found.mean() < share[1]
    toes = np.array([foot[1] for foot in feet])
    tracks = joint_trajectories(person.clip, person.skeleton)
    speeds = np.linalg.norm(tracks.velocities[:, toes], axis=-1)
    assert np.median(speeds[found]) < 0.1 * np.median(speeds[~found])
