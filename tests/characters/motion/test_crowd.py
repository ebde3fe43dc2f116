import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Character, CharacterError, Clip, Pose, Skeleton
from cubeling.characters.motion.batch.bank import ClipBank
from cubeling.characters.motion.batch.crowd import crowd_globals
from cubeling.characters.motion.blend import mix
from cubeling.characters.skeleton.rotations import about, normalize
from tests.examples import examples


@pytest.fixture(scope="module")
def vleo() -> Character:
    return Character.load("vleo")


def test_a_crowd_with_one_clip_each_shows_the_poses_of_the_clips(vleo):
    clips = list(vleo.clips.values())
    bank = ClipBank.of(vleo.skeleton, clips, np.float64)
    rng = np.random.default_rng(3)
    numbers, times = rng.integers(0, len(clips), (20, 1)), rng.uniform(-2.0, 9.0, (20, 1))
    poses = bank.sample(numbers, times, np.ones((20, 1)))
    for crowd, number, time in zip(range(20), numbers[:, 0], times[:, 0], strict=True):
        alone = clips[number].sample(float(time))
        one = poses[crowd]
        assert np.abs((one.rotations * alone.rotations).sum(-1)) == pytest.approx(1.0, abs=1e-9)
        np.testing.assert_allclose(one.translations, alone.translations, atol=1e-6)
        assert one.scales is not None
        assert alone.scales is not None
        np.testing.assert_allclose(one.scales, alone.scales, atol=1e-6)


def test_a_crowd_mixes_as_one_character_does(vleo):
    clips = list(vleo.clips.values())
    bank = ClipBank.of(vleo.skeleton, clips)
    rng = np.random.default_rng(4)
    numbers, times = rng.integers(0, len(clips), (12, 3)), rng.uniform(0.0, 5.0, (12, 3))
    weights = rng.dirichlet(np.ones(3), 12)
    poses = bank.sample(numbers, times, weights)
    for crowd in range(12):
        contributions = [
            clips[n].sample(float(t)) for n, t in zip(numbers[crowd], times[crowd], strict=True)
        ]
        alone = mix(contributions, weights[crowd])
        near = np.abs((poses[crowd].rotations * alone.rotations).sum(-1))
        assert 2 * np.arccos(np.clip(near, 0, 1)).max() < np.radians(0.5)


@settings(max_examples=examples(25), deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_matrices_of_any_skeleton_are_those_of_its_poses(seed):
    rng = np.random.default_rng(seed)
    joints, count = int(rng.integers(1, 12)), int(rng.integers(1, 5))
    parents = tuple(int(rng.integers(-1, joint)) if joint else -1 for joint in range(joints))
    poses = Pose(
        rng.normal(size=(count, joints, 3)),
        normalize(rng.normal(size=(count, joints, 4))),
        rng.uniform(0.5, 2.0, (count, joints, 3)) if seed % 2 else None,
    )
    skeleton = Skeleton(tuple(map(str, range(joints))), parents, poses[0])
    clips = [Clip(str(n), 1.0, poses[np.array([n])], loop=False) for n in range(count)]
    bank = ClipBank.of(skeleton, clips, np.float64)
    one_each = np.arange(count)[:, None], np.zeros((count, 1)), np.ones((count, 1))
    expected = poses.globals(skeleton)[:, :, :3]
    np.testing.assert_allclose(crowd_globals(bank, *one_each), expected, atol=1e-9)


@pytest.mark.parametrize("name", Character.bundled_names())
def test_crowd_matrices_are_those_of_the_sampled_poses(name):
    character = Character.load(name)
    clips = list(character.clips.values())
    bank = ClipBank.of(character.skeleton, clips, np.float64)
    rng = np.random.default_rng(2)
    played = rng.integers(0, len(clips), (9, 2)), rng.uniform(-1.0, 5.0, (9, 2))
    weights = rng.dirichlet(np.ones(2), 9)
    poses = bank.sample(*played, weights)
    each = np.stack([poses[n].globals(character.skeleton)[:, :3] for n in range(9)])
    np.testing.assert_allclose(crowd_globals(bank, *played, weights), each, atol=1e-9)


def test_joints_that_turn_by_a_full_circle_are_mixed_the_shorter_way():
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    skeleton = Skeleton(("spinner",), (-1,), rest)
    angles = np.linspace(0.0, 2 * np.pi, 9)
    clip = Clip("spin", 8.0, Pose(np.zeros((9, 1, 3)), about("y", angles)[:, None]))
    bank = ClipBank.of(skeleton, [clip], np.float64)
    assert bank.sign_ambiguous.tolist() == [0]
    poses = bank.sample([[0, 0]], [[0.5, 0.75]], [[0.5, 0.5]])
    turned = about("y", np.radians(225.0))
    assert abs(float(poses.rotations[0, 0] @ turned)) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["vleo", "human"])
def test_one_character_is_blended_as_a_crowd_is(name):
    character = Character.load(name)
    clips = list(character.clips.values())
    extra = [np.arange(float(len(clip)))[:, None] for clip in clips]
    bank = ClipBank.of(character.skeleton, clips, np.float64, extra)
    rng = np.random.default_rng(6)
    numbers, times = rng.integers(0, len(clips), 3), rng.uniform(-1.0, 5.0, 3)
    weights = rng.dirichlet(np.ones(3))
    rows = bank.mixed_rows([numbers], [times], [weights])
    crowd = bank.pose(rows)[0]
    alone, other = bank.blend(list(zip(numbers.tolist(), times.tolist(), weights, strict=True)))
    np.testing.assert_allclose(alone.rotations, crowd.rotations, atol=1e-12)
    np.testing.assert_allclose(alone.translations, crowd.translations, atol=1e-12)
    for mine, theirs in ((alone.scales, crowd.scales), (alone.morphs, crowd.morphs)):
        assert (mine is None) == (theirs is None)
        assert mine is None or np.allclose(mine, theirs, atol=1e-12)  # type: ignore[arg-type]
    assert other == pytest.approx(rows[0, -1:])


def test_clips_of_another_skeleton_are_refused(vleo):
    other = Clip("other", 30.0, vleo.clips["idle"].poses)
    fewer = Pose(other.poses.translations[:, 1:], other.poses.rotations[:, 1:])
    with pytest.raises(CharacterError, match=f"{len(vleo.skeleton)} joints"):
        ClipBank.of(vleo.skeleton, [Clip("fewer", 30.0, fewer)])
