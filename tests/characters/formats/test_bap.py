"""MPEG-4 body animation parameters: what a motion is in integers, and back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Character, CharacterError, Clip, Pose, load_motion
from cubeling.characters.formats.mocap.bap import (
    UNIT_RAD,
    BapTrack,
    read_baps,
    track_of,
    write_baps,
)
from cubeling.characters.formats.mocap.hanim import (
    BAP_COUNT,
    ROOT,
    hanim_anatomy,
    hanim_skeleton,
    parameters,
)
from cubeling.characters.retargeting.bap import baps_of, save_bap
from cubeling.characters.retargeting.retarget import retarget
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from tests.examples import examples

BODY = ("hips", "head", *(f"{s}{part}" for s in ("left", "right")
        for part in ("UpperArm", "LowerArm", "Hand", "LowerLeg", "Foot")))  # fmt: skip


def posed(**turns: Array) -> Clip:
    """Return a clip of one frame of the H-ANIM body, at rest but for some joints."""
    skeleton = hanim_skeleton()
    rotated = skeleton.rest.rotations.copy()
    for joint, turn in turns.items():
        rotated[skeleton.index(joint)] = turn
    return Clip("posed", 25.0, Pose(skeleton.rest.translations[None], rotated[None]), loop=False)


def number(joint: str, axis: str) -> int:
    return parameters().index((joint, axis))


def test_parameters_have_the_numbers_of_the_standard() -> None:
    found = parameters()
    assert len(found) == 186
    expected = {1: ("sacroiliac", "x"), 4: ("l_hip", "x"), 24: ("l_sternoclavicular", "z"),
                33: ("r_shoulder", "x"), 48: ("skullbase", "z"), 122: ("vl5", "x"),
                171: ("l_thumb1", "x"), 181: (ROOT, "Y"), 186: (ROOT, "x")}  # fmt: skip
    assert {each: found[each - 1] for each in expected} == expected


def test_every_part_of_a_person_is_in_the_body() -> None:
    assert hanim_anatomy().kind == "humanoid"
    assert hanim_anatomy().missing == ()


@settings(max_examples=examples(40), deadline=None)
@given(st.lists(st.floats(-1.5, 1.5), min_size=6, max_size=6))
def test_an_angle_comes_back_within_half_a_unit(angles: list[float]) -> None:
    joints = ("l_shoulder", "vt6")
    turns = rotations.from_euler("zyx", np.reshape(angles, (2, 3)))
    clip = posed(**dict(zip(joints, turns, strict=True)))
    values = track_of(clip).values[0]
    for joint, exact in zip(joints, np.reshape(angles, (2, 3)), strict=True):
        read = [values[number(joint, axis)] * UNIT_RAD for axis in "zyx"]
        assert np.abs(read - exact).max() <= UNIT_RAD / 2 + 1e-9


def test_a_forearm_that_is_raised_ahead_flexes_the_elbow_alone() -> None:
    values = track_of(posed(l_elbow=rotations.about("x", -1.2))).values[0]
    assert values[number("l_elbow", "x")] == -120_000
    assert np.count_nonzero(values) == 1


@settings(max_examples=examples(40), deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_hinges_leave_hands_and_feet_where_they_are(seed: int) -> None:
    draw = np.random.default_rng(seed)
    joints = [f"{s}_{j}" for s in "lr" for j in ("sternoclavicular", "shoulder", "elbow", "wrist",
                                                 "hip", "knee", "ankle")]  # fmt: skip
    vectors = draw.uniform(-1.2, 1.2, (len(joints), 3))
    clip = posed(**dict(zip(joints, rotations.from_rotation_vector(vectors), strict=True)))
    skeleton = hanim_skeleton()
    before = clip.poses.globals(skeleton)[0]
    after = track_of(clip).motion("again").poses.globals(skeleton)[0]
    ends = [skeleton.index(f"{s}_{j}") for s in "lr" for j in ("wrist", "subtalar", "elbow")]
    assert np.abs(before[ends, :3, 3] - after[ends, :3, 3]).max() < 1e-4
    turned = [skeleton.index(f"{s}_{j}") for s in "lr" for j in ("wrist", "subtalar")]
    assert np.abs(before[turned, :3, :3] - after[turned, :3, :3]).max() < 1e-4


def test_a_straight_arm_keeps_the_plane_of_its_elbow() -> None:
    skeleton = hanim_skeleton()
    bend = np.array([0.5, 0.1, 0.0, 0.0, 0.1, 0.5])
    hinge = rotations.multiply(rotations.about("y", 0.7), rotations.about("x", -bend))
    turns = np.tile(skeleton.rest.rotations, (len(bend), 1, 1))
    turns[:, skeleton.index("l_elbow")] = hinge
    places = np.tile(skeleton.rest.translations, (len(bend), 1, 1))
    values = track_of(Clip("bend", 25.0, Pose(places, turns), loop=False)).values
    assert (values[:, number("l_shoulder", "y")] == 70_000).all()


@pytest.mark.parametrize("name", ["wave", "Run"])
def test_a_characters_motion_survives_the_file(name: str, tmp_path: Path) -> None:
    body = Character.load("human")
    clip = body.clips[name]
    file = tmp_path / "motion.bap"
    save_bap(clip, body.skeleton, body.anatomy, file)
    read = load_motion(file)
    assert read.clip.rate == clip.rate
    own = retarget(
        read.clip, read.skeleton, hanim_anatomy(), body.skeleton, body.anatomy, hold_feet=False
    )
    joints = [joint for part in BODY if (joint := body.anatomy.joint(part)) is not None]
    places = [c.poses.globals(body.skeleton)[:, joints, :3, 3] for c in (clip, own)]
    assert np.abs(places[0] - places[1]).max() < 0.005 * body.height


def test_a_file_holds_what_was_written(tmp_path: Path) -> None:
    draw = np.random.default_rng(3)
    values = draw.integers(-(10**6), 10**6, (4, BAP_COUNT)) * draw.integers(0, 2, (4, BAP_COUNT))
    write_baps(tmp_path / "a b.bap", BapTrack(25.0, values))
    read = read_baps(tmp_path / "a b.bap")
    assert read.rate == 25.0
    assert (read.values == values).all()


FLAGS = " ".join(["1"] + ["0"] * (BAP_COUNT - 1))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: not a version"),
        ("2.1 x 0 1\n", "line 1: not a version"),
        ("2.1 x 25 2\n" + FLAGS + "\n0 5\n", "1 of 2 frames"),
        ("2.1 x 25 1\n1 0 1\n0 5\n", "line 2: not 296 flags"),
        ("2.1 x 25 1\n" + FLAGS + "\n0\n", "line 3: not one value"),
        ("2.1 x 25 1\n" + FLAGS + "\n0 many\n", "line 3: expected a number"),
        ("2.1 x 25 1\n" + FLAGS + "\n0 nan\n", "line 3: 'nan' is out of range"),
    ],
)
def test_a_damaged_file_is_refused_with_its_line(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.bap"
    file.write_text(text)
    with pytest.raises(CharacterError, match=message):
        load_motion(file)


def test_an_animal_has_no_body_parameters() -> None:
    body = Character.load("human")
    animal = replace(body.anatomy, kind="quadruped")
    with pytest.raises(CharacterError, match="are for people"):
        baps_of(body.clips["wave"], body.skeleton, animal)
