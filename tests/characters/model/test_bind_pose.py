"""Bodies rest in the turns that their skins were bound in, and keep their size."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy


def bone_lengths(skeleton):
    at = skeleton.rest.globals(skeleton)[:, :3, 3]
    return np.linalg.norm(at[2:] - at[list(skeleton.parents[2:])], axis=-1)


def test_a_body_keeps_its_bones_whatever_bones_its_skins_were_bound_to():
    human = Character.load("human")
    skeleton = human.skeleton
    bound = skeleton.rest.globals(skeleton)
    arms = [skeleton.index(name) for name in ("LeftHand", "RightHand")]
    other_bones = bound.copy()
    other_bones[arms, :3, 3] += 2.4 * (bound[arms, :3, 3] - bound[arms - np.ones(2, int), :3, 3])
    z_up_in_cm, elsewhere = np.eye(4), np.eye(4)
    z_up_in_cm[:3, :3] = 100 * np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    elsewhere[:3, 3] = 5.0, 1.0, -2.0
    meshes = tuple(
        replace(mesh, inverse_bind=np.linalg.inv((z_up_in_cm if number else elsewhere) @ bones))
        for number, (mesh, bones) in enumerate(
            zip(human.meshes, [bound, *[other_bones] * (len(human.meshes) - 1)], strict=True)
        )
    )
    stride = human.clips["Run"].in_place[5]
    body = replace(human, skeleton=replace(skeleton, rest=stride), meshes=meshes)
    found = with_bind_pose(body)
    assert np.allclose(bone_lengths(found), bone_lengths(body.skeleton), rtol=1e-6)
    differences = rotations.multiply(
        found.rest.rotations, rotations.conjugate(skeleton.rest.rotations)
    )
    skinned = sorted({int(j) for mesh in human.meshes for j in np.unique(mesh.joints)})
    angles = np.linalg.norm(rotations.to_rotation_vector(differences[skinned]), axis=-1)
    assert np.degrees(angles).max() < 0.1
    lowest = found.rest.globals(found)[skinned, 1, 3].min()
    assert abs(lowest - stride.globals(skeleton)[skinned, 1, 3].min()) < 1e-6


def test_a_file_that_rests_in_mid_stride_stands_as_it_was_bound(tmp_path):
    human = Character.load("human")
    stride = human.clips["Walk"].in_place[5]
    striding = replace(
        human, skeleton=replace(human.skeleton, rest=stride), clips={}, standing=None
    )
    striding.save(tmp_path / "striding.glb")
    loaded = Character.load(tmp_path / "striding.glb")
    upright = with_bind_pose(loaded)
    places = [pose.rest.globals(pose)[1:, :3, 3] for pose in (upright, human.skeleton)]
    shift = (places[0] - places[1]).mean(0)
    assert np.allclose(places[0] - shift, places[1], atol=0.005)
    mesh, theirs = loaded.meshes[0], human.meshes[0]
    assert np.ptp(mesh.positions, axis=0) == pytest.approx(
        np.ptp(theirs.positions, axis=0), rel=1e-3
    )


def test_a_body_with_a_skin_on_one_arm_stands_on_its_feet():
    human = Character.load("human")
    skeleton, joints = human.skeleton, human.anatomy.joints
    arm = [joints[part] for part in ("leftUpperArm", "leftLowerArm", "leftHand")]
    bones = np.zeros((3, 4), np.uint16)
    bones[:, 0] = arm
    sleeve = replace(
        human.meshes[0],
        positions=skeleton.rest.globals(skeleton)[arm, :3, 3].astype(np.float32),
        normals=np.tile(np.array([0, 1, 0], np.float32), (3, 1)),
        triangles=np.array([[0, 1, 2]], np.uint32),
        joints=bones,
        weights=np.eye(1, 4, dtype=np.float32).repeat(3, axis=0),
        inverse_bind=np.asarray(np.linalg.inv(skeleton.rest.globals(skeleton)), np.float64),
        colors=None,
        uvs=None,
        morphs=(),
    )
    raised = skeleton.rest.rotations.copy()
    raised[arm[0]] = rotations.multiply(rotations.about("z", 0.6), raised[arm[0]])
    rest = replace(skeleton.rest, rotations=raised)
    body = replace(human, skeleton=replace(skeleton, rest=rest), meshes=(sleeve,), clips={})
    found = with_bind_pose(body)
    at = found.rest.globals(found)[:, :3, 3]
    assert np.allclose(at, skeleton.rest.globals(skeleton)[:, :3, 3], atol=1e-6)


def test_body_parts_are_guessed_as_the_skin_was_bound():
    human = Character.load("human")
    skeleton = human.skeleton
    names = ("root", *(f"bone_{number}" for number in range(1, len(skeleton))))
    folded = skeleton.rest.rotations.copy()
    for side in ("left", "right"):
        for part, angle in (("UpperLeg", -2.9), ("UpperArm", -0.9)):
            folded[human.anatomy.joints[side + part]] = rotations.about("x", angle)
    rest = replace(skeleton.rest, rotations=folded, translations=skeleton.rest.translations.copy())
    lowest = [pose.globals(skeleton)[1:, 1, 3].min() for pose in (rest, skeleton.rest)]
    rest.translations[human.anatomy.joints["hips"], 1] += lowest[1] - lowest[0]
    body = replace(
        human,
        skeleton=replace(skeleton, names=names, rest=rest),
        clips={},
        semantics={},
        springs=(),
    )
    standing = Anatomy.guess(replace(skeleton, names=names))
    assert Anatomy.guess(body.skeleton) != standing
    assert body.anatomy == standing
    assert body.with_stated_anatomy.anatomy == body.anatomy
