from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import CharacterError, Pose, RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.body import default_body_plan
from cubeling.characters.synthesis.distances import (
    DISTANCES,
    JointAngles,
    PointClouds,
    distance_matrix,
)
from cubeling.characters.synthesis.distances.points import windows
from cubeling.characters.synthesis.graphs.parts import part_distance, threshold_shares
from cubeling.characters.synthesis.joint_weights import fit_weights, nonnegative_weights
from cubeling.characters.synthesis.library import MotionLibrary


@pytest.mark.parametrize("name", DISTANCES)
def test_is_symmetric_not_negative_and_zero_between_a_frame_and_itself(
    name: str, library: MotionLibrary
) -> None:
    distance = DISTANCES[name](library)
    values = distance_matrix(distance)
    assert np.array_equal(values, values.T)
    assert (np.diag(values) == 0.0).all()
    assert (values >= 0.0).all()
    frames = np.arange(len(library))
    assert np.abs(distance.pairs(frames, frames)).max() < 1e-12


@pytest.mark.parametrize("name", DISTANCES)
def test_blocks_agree_with_pairs_to_single_precision(name: str, library: MotionLibrary) -> None:
    distance = DISTANCES[name](library)
    rng = np.random.default_rng(1)
    a, b = rng.integers(len(library), size=(2, 60))
    block = distance.block(a, b)
    rows, columns = np.meshgrid(a, b, indexing="ij")
    exact = distance.pairs(rows.ravel(), columns.ravel()).reshape(60, 60)
    # Of unsquared angles, float32 keeps the root of its precision only.
    assert np.abs(block - exact).max() < (2e-2 if name == "ahn-wohn" else 1e-4)


@pytest.mark.parametrize("name", DISTANCES)
def test_does_not_depend_on_place_heading_or_quaternion_sign(
    name: str, human, library: MotionLibrary
) -> None:
    clips = [human.clips["Walk"], human.clips["Run"]]
    rng = np.random.default_rng(2)
    moved = []
    for clip in clips:
        poses, yaw = clip.poses, rotations.about("y", rng.uniform(-3, 3))
        translations, turns = poses.translations.copy(), poses.rotations.copy()
        shifted = rotations.rotate(yaw, translations[:, 0])
        translations[:, 0] = shifted + [rng.normal(), 0.0, rng.normal()]
        turns[:, 0] = rotations.multiply(yaw, turns[:, 0])
        turns *= rng.choice([-1.0, 1.0], size=(*turns.shape[:2], 1))
        moved.append(replace(clip, poses=Pose(translations, turns)))
    here, there = (
        distance_matrix(DISTANCES[name](MotionLibrary.of(each, human.skeleton, human.anatomy)))
        for each in (clips, moved)
    )
    assert np.allclose(here, there, atol=2e-2 if name == "ahn-wohn" else 2e-4)


def test_an_angle_counts_half_and_squared(library: MotionLibrary) -> None:
    knee = library.anatomy.joints["leftLowerLeg"]
    turns = library.poses.rotations.copy()
    turns[1] = turns[0]
    turns[1, knee] = rotations.multiply(turns[0, knee], rotations.about("x", 0.4))
    bent = replace(library, poses=Pose(library.poses.translations, turns))
    distance = JointAngles(bent, {knee: 3.0}, height=0.0)
    assert distance.pairs(np.array([0]), np.array([1]))[0] == pytest.approx(3.0 * 0.2**2)


def test_velocities_tell_frames_apart_that_poses_do_not(human) -> None:
    walk = human.clips["Walk"]
    clip = replace(walk, loop=False)
    back = replace(walk, name="back", loop=False, poses=walk.poses[::-1])
    library = MotionLibrary.of([clip, back], human.skeleton, human.anatomy)
    weights = default_body_plan().joint_weights(library.anatomy)
    frames = np.arange(10, 40)
    mirrored = len(library) - 1 - frames
    still, moving = (JointAngles(library, weights, velocity) for velocity in (0.0, 0.05))
    assert still.pairs(frames, mirrored).max() < 1e-6
    assert moving.pairs(frames, mirrored).min() > 0.05


def test_parts_of_every_profile_sum_to_the_whole_body(library: MotionLibrary) -> None:
    plan = default_body_plan()
    weights = plan.joint_weights(library.anatomy)
    assert sum(weights.values()) == pytest.approx(8.2)
    whole = distance_matrix(JointAngles(library, weights))
    assert list(plan.profiles) == ["SMG", "SP2", "SP3a", "SP3b", "SP4a", "SP4b", "SP5"]
    for profile in plan.profiles:
        parts = plan.split(profile, library.skeleton, library.anatomy)
        joints = sorted(joint for part in parts for joint in part.joints)
        assert joints == list(range(len(library.skeleton)))
        assert [part.prior for part in parts] == [True] + [False] * (len(parts) - 1)
        total = sum(distance_matrix(part_distance(library, part)) for part in parts)
        assert np.allclose(total, whole, atol=1e-4)
        assert sum(threshold_shares(parts)) == pytest.approx(1.0)


def test_shares_of_the_threshold_are_those_of_the_thesis(library: MotionLibrary) -> None:
    parts = default_body_plan().split("SP4b", library.skeleton, library.anatomy)
    shares = [round(0.105 * share, 4) for share in threshold_shares(parts)]
    assert shares == [0.0691, 0.0102, 0.0128, 0.0128]


def test_weights_that_made_the_distances_are_found_again() -> None:
    rng = np.random.default_rng(3)
    angles, truth = rng.random((500, 5)), np.array([2.0, 0.5, 0.0, 1.0, 0.1])
    found = nonnegative_weights(angles, angles @ truth, np.ones(5), pull=0.0)
    assert np.allclose(found, truth, atol=1e-6)
    pulled = nonnegative_weights(angles, angles @ truth, np.ones(5), pull=1e6)
    assert np.ptp(pulled) < 1e-3


def test_fitted_weights_agree_with_what_is_seen(library: MotionLibrary) -> None:
    found = fit_weights(library)
    assert sum(found.weights.values()) == pytest.approx(8.2)
    assert min(found.weights.values()) >= 0.0
    assert 0.5 < found.default_agreement < found.agreement + 0.02 < 1.02
    with pytest.raises(CharacterError, match="give at least three"):
        fit_weights(library.only((0, 1)))


def test_alignment_of_point_clouds_is_the_best_one(library: MotionLibrary) -> None:
    distance = PointClouds(library)
    points = windows(library, list(range(len(library.skeleton))))
    a, b = 5, len(library) - 60

    def error(place: RootDelta) -> float:
        x, y, z = points[b].T
        ahead, across = np.cos(place.yaw), np.sin(place.yaw)
        moved = [ahead * x + across * z + place.x, y, ahead * z - across * x + place.z]
        return float(np.square(points[a] - np.stack(moved, axis=-1)).sum(1).mean())

    best = distance.alignment(a, b)
    least = error(best)
    assert least == pytest.approx(distance.pairs(np.array([a]), np.array([b]))[0])
    for x, z, yaw in 0.01 * np.vstack([np.eye(3), -np.eye(3)]):
        assert error(RootDelta(best.x + x, best.z + z, best.yaw + yaw)) > least
