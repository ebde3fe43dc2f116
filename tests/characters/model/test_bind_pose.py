"""Bodies rest in the turns that their skins were bound in, and keep their size."""

from dataclasses import replace

import numpy as np

from characters import Character
from characters.model.bind_pose import with_bind_pose
from characters.skeleton import rotations


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
