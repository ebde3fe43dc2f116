"""Characters face +z, however their files do."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.facing import common_from_skeleton
from tests.examples import some


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def under_a_turned_node(character, yaw, name):
    """The character below one more joint with another heading, as exporters write it."""
    turn = rotations.about("y", yaw)

    def below(pose):
        first = np.zeros((*pose.translations.shape[:-2], 1, 3))
        turned = np.broadcast_to(turn, (*first.shape[:-1], 4))
        return replace(
            pose,
            translations=np.concatenate([first, pose.translations], -2),
            rotations=np.concatenate([turned, pose.rotations], -2),
        )

    skeleton = character.skeleton
    meshes = tuple(
        replace(
            mesh,
            joints=mesh.joints + 1,
            inverse_bind=np.concatenate([np.eye(4)[None], mesh.inverse_bind]),
        )
        for mesh in character.meshes
    )
    clip = character.clips["Walk"]
    return replace(
        character,
        skeleton=replace(
            skeleton,
            names=(name, *(f"{each}_" if each == "root" else each for each in skeleton.names)),
            parents=(-1, *(parent + 1 for parent in skeleton.parents)),
            rest=below(skeleton.rest),
        ),
        clips={"Walk": replace(clip, poses=below(clip.poses), root_motion=False)},
        meshes=meshes,
        semantics={},
    )


TURNED = [("scene", np.pi), ("root", np.pi / 2)]
TURNED += [(name, np.pi * turn) for name in ("scene", "root") for turn in (1.0, 0.5, -0.5)]


@pytest.mark.parametrize(("name", "yaw"), some(dict.fromkeys(TURNED), 2))
def test_a_character_that_faces_elsewhere_is_turned_once_when_it_is_loaded(
    human, tmp_path, yaw, name
):
    under_a_turned_node(human, yaw, name).save(tmp_path / "turned.glb")
    loaded = Character.load(tmp_path / "turned.glb")
    for clip, frame in (("Walk", 7), ("Walk", 20)):
        found = loaded.clips[clip].poses[frame].globals(loaded.skeleton)[1:]
        expected = human.clips[clip].poses[frame].globals(human.skeleton)
        assert np.allclose(found, expected, atol=1e-4)
    assert loaded.bounds == pytest.approx(human.bounds, abs=1e-4)
    loaded.save(tmp_path / "again.glb")
    again = Character.load(tmp_path / "again.glb")
    assert np.allclose(again.skeleton.rest.rotations, loaded.skeleton.rest.rotations, atol=1e-6)


def test_feet_tell_what_is_ahead_if_the_sides_are_named_the_wrong_way_round(human):
    skeleton = human.skeleton
    others = {"left": "right", "right": "left"}
    swapped = {
        part.replace(side, others[side], 1): skeleton.names[joint]
        for part, joint in human.anatomy.joints.items()
        if (side := next((each for each in others if part.startswith(each)), ""))
    }
    anatomy = Anatomy.guess(skeleton, swapped)
    assert np.allclose(common_from_skeleton(skeleton, anatomy), rotations.IDENTITY)
