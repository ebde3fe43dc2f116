"""Eyes that look about by morphs, or as far as a file says."""

import math

import numpy as np
import pytest

from cubeling.characters.body.gaze import Gaze
from cubeling.characters.model.look_at import LookAt, RangeMap
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Pose, Skeleton

NAMES = ("hips", "spine", "chest", "neck", "head", "LeftEye", "RightEye")
PLACES = [
    [0, 1, 0],
    [0, 0.1, 0],
    [0, 0.2, 0],
    [0, 0.2, 0],
    [0, 0.1, 0],
    [0.03, 0, 0.08],
    [-0.03, 0, 0.08],
]
VRM = ("aa", "lookUp", "lookDown", "lookLeft", "lookRight")
ARKIT = tuple(
    f"eyeLook{way}{side}" for side in ("Left", "Right") for way in ("In", "Out", "Up", "Down")
)


def bust(eyes):
    """A body down to the hips that faces +z, with or without joints for its eyes."""
    joints = 7 if eyes else 5
    turns = np.tile(rotations.IDENTITY, (joints, 1))
    rest = Pose(np.array(PLACES[:joints], float), turns)
    skeleton = Skeleton(NAMES[:joints], (-1, 0, 1, 2, 3, 4, 4)[:joints], rest)
    semantics = {name: name for name in NAMES[:5]}
    if eyes:
        semantics |= {"leftEye": "LeftEye", "rightEye": "RightEye"}
    return skeleton, Anatomy.guess(skeleton, semantics)


def settled(gaze, skeleton, target, head_share=0.0):
    """The pose after looking at a point for a second; `head_share` 0 holds the head still."""
    for _ in range(60):
        pose = gaze.update(
            skeleton.rest, None if target is None else np.array(target), 1 / 60, head_share
        )
    return pose


def toward(yaw, pitch):
    """A point 2 m away from the middle of the eyes, at a yaw to the left and a pitch up [°]."""
    yaw, pitch = math.radians(yaw), math.radians(pitch)
    way = [math.sin(yaw) * math.cos(pitch), math.sin(pitch), math.cos(yaw) * math.cos(pitch)]
    return np.array([0.0, 1.6, 0.0]) + 2.0 * np.array(way)


@pytest.mark.parametrize(
    ("yaw", "pitch", "moved"),
    [(10, 0, "lookLeft"), (-10, 0, "lookRight"), (0, 8, "lookUp"), (0, -8, "lookDown")],
)
def test_a_face_without_joints_for_its_eyes_looks_by_morphs(yaw, pitch, moved):
    skeleton, anatomy = bust(eyes=False)
    weights = settled(Gaze(skeleton, anatomy, VRM), skeleton, toward(yaw, pitch)).morphs
    found = dict(zip(VRM, weights, strict=True))
    assert 0.4 < found.pop(moved) <= 1.0
    assert all(abs(weight) < 1e-6 for weight in found.values())
    assert not settled(Gaze(skeleton, anatomy, VRM), skeleton, None).morphs.any()


def test_morphs_of_each_eye_look_the_same_way():
    skeleton, anatomy = bust(eyes=False)
    weights = settled(Gaze(skeleton, anatomy, ARKIT), skeleton, toward(10, 5)).morphs
    found = dict(zip(ARKIT, weights.round(6), strict=True))
    assert {name for name, weight in found.items() if weight} == {
        "eyeLookOutLeft",
        "eyeLookInRight",
        "eyeLookUpLeft",
        "eyeLookUpRight",
    }
    assert found["eyeLookOutLeft"] == found["eyeLookInRight"] > 0.4


def test_joints_of_eyes_come_before_morphs():
    skeleton, anatomy = bust(eyes=True)
    pose = settled(Gaze(skeleton, anatomy, VRM), skeleton, toward(10, 0))
    assert pose.morphs is None
    assert not np.allclose(pose.rotations[5], rotations.IDENTITY)


def look_at(by, output=1.0, offset=None):
    inner, outer, down, up = (
        RangeMap(math.radians(degrees), output) for degrees in (30, 40, 20, 10)
    )
    return LookAt(by, inner, outer, down, up, offset)


@pytest.mark.parametrize(
    ("yaw", "pitch", "moved", "expected"),
    [
        (12, 0, "lookLeft", 12 / 40),  # the outer map is that of both sides
        (-12, 0, "lookRight", 12 / 40),
        (0, 5, "lookUp", 0.5),
        (0, -5, "lookDown", 0.25),
        (0, 12, "lookUp", 1.0),
    ],
)
def test_morphs_follow_the_maps_that_a_file_states(yaw, pitch, moved, expected):
    skeleton, anatomy = bust(eyes=True)
    gaze = Gaze(skeleton, anatomy, VRM, look_at("expression"))
    pose = settled(gaze, skeleton, toward(yaw, pitch) + [0, 0, 0.08])
    found = dict(zip(VRM, pose.morphs, strict=True))
    assert found.pop(moved) == pytest.approx(expected, abs=1e-3)
    assert all(abs(weight) < 1e-6 for weight in found.values())
    assert np.allclose(pose.rotations[5:], rotations.IDENTITY)


def test_joints_of_eyes_follow_the_maps_that_a_file_states():
    skeleton, anatomy = bust(eyes=True)
    gaze = Gaze(skeleton, anatomy, (), look_at("bone", math.radians(8)))
    # So far away that both eyes look the same way.
    pose = settled(gaze, skeleton, 500 * (toward(12, 0) - [0, 1.6, 0]) + [0, 1.6, 0])
    yaws = np.degrees([rotations.heading(turn) for turn in pose.rotations[5:]])
    assert yaws == pytest.approx([8 * 12 / 40, 8 * 12 / 30], abs=0.01)
    pose = settled(gaze, skeleton, 500 * (toward(0, -15) - [0, 1.6, 0]) + [0, 1.6, 0])
    pitches = np.degrees([rotations.to_rotation_vector(turn)[0] for turn in pose.rotations[5:]])
    assert pitches == pytest.approx([6.0, 6.0], abs=0.01)


def test_a_file_may_say_where_the_eyes_are():
    skeleton, anatomy = bust(eyes=False)
    level = toward(0, 0) + [0, 0.1, 0]
    low = settled(Gaze(skeleton, anatomy, VRM), skeleton, level).morphs
    placed = look_at("expression", offset=(0.0, 0.1, 0.0))
    same = settled(Gaze(skeleton, anatomy, VRM, placed), skeleton, level).morphs
    assert low[VRM.index("lookUp")] > 0.1
    assert np.allclose(same, 0.0, atol=1e-6)
