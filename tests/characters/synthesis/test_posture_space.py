import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.idle.posture_space import (
    PostureSpace,
    PostureVectors,
    Region,
    Weights,
    continuous_rotation_vectors,
)


@pytest.fixture(scope="module")
def human() -> Character:
    return Character.load("human")


@pytest.fixture(scope="module")
def walked(human: Character) -> np.ndarray:
    clip = human.clips["Walk"]
    return PostureVectors.of(human.skeleton, human.anatomy).vectors(clip.in_place)


@pytest.mark.parametrize("region", ["whole", "upper", "lower"])
def test_poses_come_back_from_their_vectors(human: Character, region: Region) -> None:
    kind = PostureVectors.of(human.skeleton, human.anatomy, region)
    poses = human.clips["Run"].in_place
    again = kind.poses(kind.vectors(poses))
    joints = list(kind.joints)
    same = np.abs((again.rotations * poses.rotations).sum(-1))[:, joints]
    assert same == pytest.approx(1.0, abs=1e-12)
    if kind.hips is not None:
        hips = again.translations[:, kind.hips]
        assert hips == pytest.approx(poses.translations[:, kind.hips], abs=1e-12)


def test_upper_and_lower_body_make_the_whole(human: Character) -> None:
    sizes = [
        PostureVectors.of(human.skeleton, human.anatomy, region).size
        for region in ("whole", "upper", "lower")
    ]
    assert sizes[0] == sizes[1] + sizes[2]


@given(st.lists(st.floats(-3.1, 3.1), min_size=3, max_size=3))
def test_a_rotation_comes_back_from_its_vector(vector: list[float]) -> None:
    wanted = np.array(vector)
    length = np.linalg.norm(wanted)
    if length > 3.1:
        wanted *= 3.1 / length
    turns = rotations.from_rotation_vector(wanted)[None, None]
    assert continuous_rotation_vectors(turns)[0, 0] == pytest.approx(wanted, abs=1e-9)


def test_vectors_are_continuous_beyond_half_a_turn() -> None:
    angles = np.linspace(0.0, 5.0, 200)
    turns = rotations.about([0.6, 0.0, 0.8], angles)[:, None]
    found = continuous_rotation_vectors(turns)[:, 0]
    assert np.linalg.norm(np.diff(found, axis=0), axis=1).max() < 0.03


@pytest.mark.parametrize("centred", [True, False])
def test_components_hold_all_of_the_vectors(walked: np.ndarray, centred: bool) -> None:
    space = PostureSpace.of(walked, centred=centred)
    size = len(space.variances)
    assert space.components.T @ space.components == pytest.approx(np.eye(size), abs=1e-10)
    assert space.restore(space.project(walked)) == pytest.approx(walked, abs=1e-9)
    covariance = np.cov(space.project(walked).T)
    assert covariance == pytest.approx(np.diag(space.variances), abs=1e-10)


def test_what_is_left_out_is_the_variance_of_the_components_left_out(walked: np.ndarray) -> None:
    space = PostureSpace.of(walked)
    for count in (1, 3, 8):
        errors = space.restore(space.project(walked, count)) - walked
        left_out = space.variances[count:].sum() * (len(walked) - 1) / len(walked)
        assert (errors**2).sum(1).mean() == pytest.approx(left_out, abs=1e-12)


@pytest.mark.parametrize("mode", ["eigen", "eigen_norm", "one"])
def test_distances_are_a_metric(walked: np.ndarray, mode: Weights) -> None:
    space = PostureSpace.of(walked)
    at = space.project(walked[::3])
    found = space.distances(at, at, mode)
    assert found == pytest.approx(found.T, abs=1e-9)
    assert np.diag(found) == pytest.approx(0.0, abs=1e-6)
    assert (found[:, :, None] <= found[:, None, :] + found.T[None] + 1e-6).all()


def test_without_weights_and_truncation_the_distance_is_that_of_the_vectors(
    walked: np.ndarray,
) -> None:
    space = PostureSpace.of(walked)
    at = space.project(walked[:5])
    plain = np.linalg.norm(walked[:5, None] - walked[None, :5], axis=-1)
    assert space.distances(at, at) == pytest.approx(plain, abs=1e-6)
