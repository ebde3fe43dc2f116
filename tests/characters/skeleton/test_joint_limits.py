"""Limits of joints, and the natural ones of the bundled characters."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Character
from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.joint_limits import EDGE_RAD, AngleLimits
from cubeling.characters.skeleton.natural_limits import natural_limits

BUNDLED = ("human", "robot", "vleo")


@given(st.integers(0, 10_000))
def test_angles_make_the_rotations_that_they_were_made_of(seed: int) -> None:
    random = np.random.default_rng(seed)
    low = random.uniform(-1.4, 0.0, (4, 3))
    before, after = rotations.normalize(random.normal(size=(2, 4, 4)))
    limits = AngleLimits(low, low + random.uniform(0.1, 1.4, (4, 3)), before, after)
    angles = random.uniform(limits.low, limits.high)
    local = limits.rotations(angles)
    assert np.allclose(limits.angles(local), angles, atol=1e-9)
    assert limits.excess(local).max() <= EDGE_RAD
    assert np.array_equal(limits.clamp(local), local)
    wild = rotations.normalize(random.normal(size=(20, 4, 4)))
    assert limits.excess(limits.clamp(wild)).max() <= EDGE_RAD
    assert limits.widen(0.1).excess(limits.rotations(limits.high + 0.05)).max() <= EDGE_RAD


def test_limits_that_are_none_are_refused() -> None:
    with pytest.raises(CharacterError, match="joint 1 turns from"):
        AngleLimits.of_angles(np.array([[0.0] * 3, [1.0, 0, 0]]), np.full((2, 3), 0.5))
    with pytest.raises(CharacterError, match="not of one size"):
        AngleLimits.of_angles(np.zeros((2, 3)), np.zeros((3, 3)))


def test_a_middle_axis_beyond_90_degrees_is_refused() -> None:
    """Such a limit would never be met: the middle angle of a rotation is within ±90°."""
    low, high = np.full((3, 3), -0.5), np.full((3, 3), 0.5)
    high[2, 1] = np.radians(100.0)
    with pytest.raises(CharacterError, match=r"joint 2 turns from -28\.6 to 100\.0° about its mid"):
        AngleLimits.of_angles(low, high)
    high[2, 1], high[2, 0] = np.radians(90.0), np.radians(170.0)
    assert AngleLimits.of_angles(low, high).widen(0.2).high[2, 1] == np.pi / 2
    assert AngleLimits.none(1).excess(rotations.about("y", [2.0])).max() == 0.0


@pytest.mark.parametrize("name", BUNDLED)
def test_bundled_clips_stay_within_natural_limits(name: str) -> None:
    character = Character.load(name)
    limits = natural_limits(character.skeleton, character.anatomy)
    for clip in character.clips.values():
        assert np.degrees(limits.excess(clip.poses.rotations[::3]).max()) < 1.0, clip.name


@pytest.mark.parametrize("name", BUNDLED)
def test_sides_are_limited_alike(name: str) -> None:
    character = Character.load(name)
    limits, joints = natural_limits(character.skeleton, character.anatomy), character.anatomy.joints
    for part, left in joints.items():
        right = joints.get(part.replace("left", "right"))
        if part.startswith("left") and right is not None:
            widths = (limits.high - limits.low)[[left, right]]
            assert np.allclose(widths[0], widths[1], atol=1e-6), part


def bent(character: Character, part: str, axis: list[float], degrees: float) -> float:
    """Return the excess [deg] of a part that is turned from rest about an axis of the character."""
    skeleton, joint = character.skeleton, character.anatomy.joints[part]
    rest = skeleton.rest.globals(skeleton)
    frame = rotations.from_matrix(rest[joint, :3, :3])
    inner = rotations.multiply(rotations.about(np.array(axis), np.radians(degrees)), frame)
    turn = rotations.multiply(rotations.conjugate(frame), inner)
    local = skeleton.rest.rotations.copy()
    local[joint] = rotations.multiply(local[joint], turn)
    limits = natural_limits(skeleton, character.anatomy)
    return float(np.degrees(limits.excess(local)[joint]))


def test_knees_and_hips_of_people_bend_one_way() -> None:
    human = Character.load("human")
    for side in ("left", "right"):
        assert bent(human, f"{side}LowerLeg", [1.0, 0.0, 0.0], 100.0) < 1e-3  # heel backward
        assert bent(human, f"{side}LowerLeg", [1.0, 0.0, 0.0], -60.0) > 30.0
        assert bent(human, f"{side}UpperLeg", [1.0, 0.0, 0.0], -100.0) < 1e-3  # knee forward
        assert bent(human, f"{side}UpperLeg", [1.0, 0.0, 0.0], 90.0) > 30.0


def test_elbows_of_people_bend_one_way() -> None:
    human = Character.load("human")
    skeleton, joints = human.skeleton, human.anatomy.joints
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    for side in ("left", "right"):
        arm, elbow = joints[f"{side}UpperArm"], joints[f"{side}LowerArm"]
        axis = np.cross(places[elbow] - places[arm], [0.0, 0.0, 1.0])
        assert bent(human, f"{side}LowerArm", axis.tolist(), 110.0) < 1e-3  # hand forward
        assert bent(human, f"{side}LowerArm", axis.tolist(), -70.0) > 30.0


def test_joints_of_no_known_part_turn_freely() -> None:
    human = Character.load("human")
    limits = natural_limits(human.skeleton, human.anatomy)
    eye = human.anatomy.joints["leftEye"]
    wild = rotations.normalize(np.random.default_rng(1).normal(size=(50, len(limits), 4)))
    assert limits.excess(wild)[:, eye].max() <= EDGE_RAD
