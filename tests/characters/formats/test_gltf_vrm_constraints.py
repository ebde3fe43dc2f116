"""Constraints that a VRM states, on an arm with a twist bone."""

import math

import numpy as np
import pytest

from cubeling.characters import Animator, Character, CharacterCommand, CharacterWarning, RootDelta
from cubeling.characters.control.layers import layers_of
from cubeling.characters.control.layers.constraints import ConstraintLayer
from cubeling.characters.skeleton import rotations
from tests.characters.formats.built_gltf import build_arm


@pytest.fixture
def load(tmp_path):
    """Loads the arm with a twist bone, node 4, that has this constraint."""

    def loaded(**constraint):
        build = build_arm()
        build.document["nodes"][1]["children"] = [2, 4]
        extension = {"specVersion": "1.0", "constraint": constraint}
        build.document["nodes"].append(
            {"name": "twist", "extensions": {"VRMC_node_constraint": extension}}
        )
        build.animate("LINEAR", [0.0, 1.0], rotations.about("z", [0.8, 0.8]))
        (tmp_path / "arm.glb").write_bytes(build.bytes())
        return Character.load(tmp_path / "arm.glb")

    return loaded


def test_twist_bones_turn_with_the_arm(load):
    character = load(roll={"source": 2, "rollAxis": "Z", "weight": 0.5})
    animator = Animator(character, place=RootDelta(), layers=(ConstraintLayer,))
    pose = animator.update(CharacterCommand(0.0)).pose
    twist = pose.rotations[character.skeleton.index("twist")]
    lower = pose.rotations[character.skeleton.index("lower")]
    angle = 2 * math.atan2(lower[2], lower[3])
    assert np.allclose(twist, rotations.about("z", angle / 2))


def test_only_characters_with_constraints_have_the_layer(load):
    assert ConstraintLayer not in layers_of(Character.load("vleo"))
    assert layers_of(load(rotation={"source": 2}))[-1] is ConstraintLayer


@pytest.mark.parametrize(
    ("constraint", "reason"),
    [
        ({"roll": {"source": 2, "rollAxis": "W"}}, "constraint of node 'twist' .*'W' is no axis"),
        (
            {"aim": {"source": 9, "aimAxis": "PositiveX"}},
            "source is 9, but the file has 5 nodes",
        ),
        ({}, "is neither roll, aim nor rotation"),
        ({"rotation": {"source": 4}}, "constraints of twist follow each other; remove one"),
    ],
)
def test_an_invalid_constraint_is_left_out_with_a_warning(load, constraint, reason):
    with pytest.warns(CharacterWarning, match=reason):
        assert load(**constraint).constraints == ()
