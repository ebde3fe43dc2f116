import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import CharacterError, Pose, Skeleton
from cubeling.characters.skeleton import rotations


def random_tree(seed, joints, batch=()):
    rng = np.random.default_rng(seed)
    parents = tuple(int(rng.integers(-1, joint)) if joint else -1 for joint in range(joints))
    turns = rotations.normalize(rng.normal(size=(*batch, joints, 4)))
    pose = Pose(
        rng.normal(size=(*batch, joints, 3)), turns, rng.uniform(0.5, 2, (*batch, joints, 3))
    )
    first = (0,) * len(batch)
    rest = Pose(pose.translations[first], turns[first])
    return Skeleton(tuple(f"j{i}" for i in range(joints)), parents, rest), pose


@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_globals_equal_a_walk_down_the_tree(seed, joints):
    skeleton, pose = random_tree(seed, joints)
    locals_ = pose.locals()
    expected: list[np.ndarray] = []
    for joint, parent in enumerate(skeleton.parents):
        above = np.eye(4) if parent < 0 else expected[parent]
        expected.append(above @ locals_[joint])
    assert np.allclose(pose.globals(skeleton), expected, atol=1e-9, rtol=1e-6)


@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_rotations_in_the_characters_frame_are_those_of_globals_and_go_back(seed, joints):
    skeleton, pose = random_tree(seed, joints, (3,))
    unscaled = Pose(pose.translations, pose.rotations)
    turned = unscaled.turned_in_character(skeleton)
    expected = unscaled.globals(skeleton)[..., :3, :3]
    assert np.allclose(rotations.to_matrix(turned.rotations), expected)
    assert np.allclose(turned.turned_in_parents(skeleton).rotations, pose.rotations)


def test_globals_take_any_leading_axes():
    skeleton, pose = random_tree(3, 12, (5, 2))
    together = pose.globals(skeleton)
    assert together.shape == (5, 2, 12, 4, 4)
    alone = pose[4][1].globals(skeleton)
    assert np.allclose(together[4, 1], alone)


def test_a_hierarchy_of_twelve_levels_takes_four_products():
    joints = 13
    rest = Pose(np.zeros((joints, 3)), np.tile(rotations.IDENTITY, (joints, 1)))
    chain = Skeleton(tuple(map(str, range(joints))), tuple(range(-1, joints - 1)), rest)
    assert len(chain.doubled_ancestors) == 4


def test_a_child_before_its_parent_is_refused_by_name():
    rest = Pose(np.zeros((2, 3)), np.tile(rotations.IDENTITY, (2, 1)))
    with pytest.raises(CharacterError, match="'hand' comes before its parent"):
        Skeleton(("hand", "arm"), (1, -1), rest)


def test_an_unknown_joint_is_named(skeleton):
    assert skeleton.index("head") == 2
    with pytest.raises(CharacterError, match="no joint 'tail'"):
        skeleton.index("tail")
