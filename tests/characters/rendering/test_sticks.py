"""Stick figures: a body that any skeleton can have, which bends where its joints do."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character, Pose, Skeleton
from cubeling.characters.model.character import skin
from cubeling.characters.model.stick_figures import LEFT_RGB, RIGHT_RGB, stick_figure


@pytest.fixture(scope="module")
def human():
    skeleton = Character.load("human").skeleton
    return stick_figure("human", skeleton)


def volume(mesh):
    a, b, c = (mesh.positions[mesh.triangles[:, corner]].astype(float) for corner in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def test_it_is_as_tall_as_its_skeleton_and_closed_and_seen_from_outside(human):
    joints = human.skeleton.rest.globals(human.skeleton)[:, 1, 3]
    assert human.height == pytest.approx(joints.max(), rel=0.12)
    mesh = human.meshes[0]
    assert volume(mesh) > 0.0
    edges = np.concatenate([np.roll(mesh.triangles, turn, axis=1)[:, :2] for turn in range(3)])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-5)


def test_left_is_blue_and_right_is_red(human):
    mesh = human.meshes[0]
    assert mesh.colors is not None
    for color, sign in ((LEFT_RGB, 1), (RIGHT_RGB, -1)):
        painted = np.isclose(mesh.colors[:, :3], color).all(axis=1)
        assert painted.sum() > 100
        assert np.median(sign * mesh.positions[painted, 0]) > 0.05


def test_it_bends_where_its_joints_do(human):
    skeleton = human.skeleton
    elbow = human.anatomy.joint("leftLowerArm")
    turns = skeleton.rest.rotations.copy()
    turns[elbow] = [0.0, np.sin(0.6), 0.0, np.cos(0.6)]
    bent = replace(skeleton.rest, rotations=turns)
    mesh = human.meshes[0]
    moved = skin(mesh, bent.globals(skeleton)) - skin(mesh, skeleton.rest.globals(skeleton))
    below = np.linalg.norm(moved, axis=1) > 1e-3
    assert 0.02 < below.mean() < 0.4
    assert (mesh.positions[below, 0] > 0.0).all()


@pytest.mark.parametrize("lengths", [(), (0.0,), (1.0, 0.0, 1.0)])
def test_any_skeleton_has_a_body(lengths, ctx):
    count = len(lengths) + 1
    places = np.zeros((count, 3))
    places[1:, 1] = lengths
    rest = Pose(places, np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
    names = tuple(f"joint{number}" for number in range(count))
    mesh = stick_figure("rod", Skeleton(names, tuple(range(-1, count - 1)), rest)).meshes[0]
    assert len(mesh.triangles) > 0
    assert np.isfinite(mesh.positions).all()
    assert np.isfinite(mesh.normals).all()
