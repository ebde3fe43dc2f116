"""Constraints of joints: against the formulas of VRMC_node_constraint 1.0."""

import numpy as np
import pytest

from cubeling.characters import CharacterError
from cubeling.characters.body.constraints import ConstrainedJoints
from cubeling.characters.model.constraints import JointConstraint
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton

X = (1.0, 0.0, 0.0)
PARENTS = (-1, 0, 1, 2, 1, 1)
"""A root, an upper and a lower arm, a hand, a twist bone and a sleeve."""


@pytest.fixture
def arm():
    random = np.random.default_rng(5)
    turns = rotations.normalize(random.normal(size=(6, 4)))
    rest = Pose(random.normal(size=(6, 3)), turns)
    return Skeleton(tuple("abcdef"), PARENTS, rest)


@pytest.fixture
def pose(arm):
    turns = rotations.normalize(
        arm.rest.rotations + 0.6 * np.random.default_rng(8).normal(size=(6, 4))
    )
    twisted = rotations.from_rotation_vector([0.9, 0.4, -0.3])  # in the frame of the twist bone
    own = matrices(arm.rest.rotations[4])
    turn = own @ matrices(twisted) @ own.T @ matrices(arm.rest.rotations[2])
    turns[2] = rotations.from_matrix(turn)
    return Pose(arm.rest.translations, turns)


def matrices(quaternions):
    return rotations.to_matrix(quaternions)


def test_a_roll_takes_the_turn_about_the_axis_only(arm, pose):
    roll = JointConstraint("roll", "e", "c", X)
    found = matrices(ConstrainedJoints(arm, [roll]).apply(pose).rotations[4])
    rest, source, now = (
        matrices(q) for q in (arm.rest.rotations[4], arm.rest.rotations[2], pose.rotations[2])
    )
    inside = rest.T @ now @ source.T @ rest  # the turn of the source in the frame of the joint
    turned = rest.T @ found
    assert np.allclose(turned @ X, X)  # it is about the axis
    assert np.trace(turned) < 2.8  # by more than 25°
    # What is left of the source's turn moves the axis by the shortest way, without a roll.
    swing = inside @ turned.T
    assert np.allclose(swing @ X, inside @ X)
    across = np.cross(X, inside @ X)
    assert np.allclose(swing @ across, across)


def test_a_rotation_copies_the_turn_in_the_frame_of_the_joint(arm, pose):
    found = ConstrainedJoints(arm, [JointConstraint("rotation", "e", "c")]).apply(pose).rotations[4]
    rest, source, now = (
        matrices(q) for q in (arm.rest.rotations[4], arm.rest.rotations[2], pose.rotations[2])
    )
    assert np.allclose(matrices(found), rest @ source.T @ now)


def test_an_aim_points_its_axis_to_the_source_by_the_smallest_turn(arm, pose):
    axis = np.array([0.0, -1.0, 0.0])
    constrained = ConstrainedJoints(arm, [JointConstraint("aim", "f", "d", tuple(axis))])
    placed = constrained.apply(pose).globals(arm)
    way = placed[3, :3, 3] - placed[5, :3, 3]
    assert np.allclose(placed[5, :3, :3] @ axis, way / np.linalg.norm(way))
    at_rest = placed[1, :3, :3] @ matrices(arm.rest.rotations[5])
    turn = placed[5, :3, :3] @ at_rest.T
    across = np.cross(at_rest @ axis, way)
    assert np.allclose(turn @ across, across)


@pytest.mark.parametrize("kind", ["roll", "aim", "rotation"])
def test_the_weight_leads_from_the_rest_pose_to_the_whole_turn(arm, pose, kind):
    def turned(weight):
        joints = ConstrainedJoints(arm, [JointConstraint(kind, "e", "c", X, weight)])
        return joints.apply(pose).rotations[4]

    rest, half, whole = turned(0.0), turned(0.5), turned(1.0)
    assert np.allclose(matrices(rest), matrices(arm.rest.rotations[4]))
    assert not np.allclose(matrices(rest), matrices(whole), atol=0.1)
    assert np.allclose(matrices(half), matrices(rotations.slerp(rest, whole, 0.5)))


def test_constraints_that_need_others_come_after_them(arm, pose):
    first, second = JointConstraint("rotation", "e", "c"), JointConstraint("rotation", "f", "e")
    ordered = ConstrainedJoints(arm, [first, second]).apply(pose)
    swapped = ConstrainedJoints(arm, [second, first]).apply(pose)
    assert np.array_equal(ordered.rotations, swapped.rotations)
    once = ConstrainedJoints(arm, [second]).apply(ConstrainedJoints(arm, [first]).apply(pose))
    assert np.array_equal(ordered.rotations, once.rotations)


def test_joints_that_follow_each_other_are_refused(arm):
    with pytest.raises(CharacterError, match="constraints of e, f follow each other; remove one"):
        ConstrainedJoints(
            arm, [JointConstraint("rotation", "e", "f"), JointConstraint("roll", "f", "e", X)]
        )


def test_an_aim_at_the_joint_itself_leaves_it_at_rest(arm, pose):
    together = Pose(
        np.where(np.arange(6)[:, None] == 5, pose.translations[4], pose.translations),
        pose.rotations,
    )
    found = (
        ConstrainedJoints(arm, [JointConstraint("aim", "e", "f", X)]).apply(together).rotations[4]
    )
    assert np.allclose(matrices(found), matrices(arm.rest.rotations[4]))
