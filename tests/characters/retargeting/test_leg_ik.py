"""Legs to a place: where a foot or a knee could snap, they move steadily."""

import numpy as np
import pytest

from cubeling.characters import Character, Pose
from cubeling.characters.retargeting.feet.leg_ik import place_ankle
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations

FRAMES = 120


@pytest.fixture(scope="module")
def rig():
    human = Character.load("human")
    return Rig(human.skeleton, human.anatomy)


def bent(rig, knee, yaw):
    """Poses whose left knee is bent and turned to the outside by (frames,) [rad]."""
    rest = rig.skeleton.rest
    turns = np.tile(rest.rotations, (FRAMES, 1, 1))
    leg = rig.legs[0]
    hinge = rotations.multiply(rotations.about("y", yaw), rotations.about("x", knee))
    turns[:, leg.lower] = rotations.multiply(turns[:, leg.lower], hinge)
    return Pose(np.tile(rest.translations, (FRAMES, 1, 1)), turns)


def places(rig, pose):
    """Where the left knee and foot are, (frames, 3) each [m]."""
    leg = rig.legs[0]
    at = pose.globals(rig.skeleton)[:, [leg.lower, leg.foot]][..., :3, 3]
    return at[:, 0], at[:, 1]


def greatest_step(path):
    return np.linalg.norm(np.diff(path, axis=0), axis=-1).max()


def test_a_foot_that_comes_close_to_the_hip_does_not_jump(rig):
    pose = bent(rig, np.full(FRAMES, 1.2), np.zeros(FRAMES))
    hip = rig.rest_positions[rig.legs[0].upper]
    targets = hip + np.linspace([0.05, -0.1, 0.5], [0.05, -0.1, -0.5], FRAMES)
    knee, foot = places(rig, place_ankle(pose, rig, rig.legs[0], targets))
    assert greatest_step(foot) < 5 * greatest_step(targets)
    assert greatest_step(knee) < 10 * greatest_step(targets)


def test_a_bent_knee_that_turns_to_the_outside_and_back_does_not_snap(rig):
    yaw = 1.8 * np.sin(np.linspace(0, 2 * np.pi, FRAMES))
    pose = bent(rig, np.full(FRAMES, 1.2), yaw)
    _, foot = places(rig, pose)
    before, _ = places(rig, pose)
    knee, _ = places(rig, place_ankle(pose, rig, rig.legs[0], foot))
    assert greatest_step(knee) < greatest_step(foot)
    assert np.abs(knee - before).max() < 0.1
