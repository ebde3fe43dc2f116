import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Clip, Pose, Skeleton
from cubeling.characters.locomotion.clip_bank import ClipBank
from cubeling.characters.motion.blend import mix
from cubeling.characters.skeleton.rotations import about


@pytest.fixture(scope="module")
def vleo() -> Character:
    return Character.load("vleo")


def test_one_clip_alone_shows_its_poses(vleo: Character) -> None:
    clips = list(vleo.clips.values())
    bank = ClipBank.of(vleo.skeleton, clips, np.float64)
    rng = np.random.default_rng(3)
    for _ in range(20):
        number, time = int(rng.integers(len(clips))), float(rng.uniform(-2.0, 9.0))
        shown, alone = bank.blend([(number, time, 1.0)])[0], clips[number].sample(time)
        assert np.abs((shown.rotations * alone.rotations).sum(-1)) == pytest.approx(1.0, abs=1e-9)
        np.testing.assert_allclose(shown.translations, alone.translations, atol=1e-6)
        assert shown.scales is not None
        assert alone.scales is not None
        np.testing.assert_allclose(shown.scales, alone.scales, atol=1e-6)


@pytest.mark.parametrize("name", ["vleo", "human"])
def test_it_mixes_as_poses_are_mixed(name: str) -> None:
    character = Character.load(name)
    clips = list(character.clips.values())
    extra = [np.arange(float(len(clip)))[:, None] for clip in clips]
    bank = ClipBank.of(character.skeleton, clips, np.float64, extra)
    rng = np.random.default_rng(4)
    for _ in range(12):
        numbers, times = rng.integers(0, len(clips), 3).tolist(), rng.uniform(0.0, 5.0, 3).tolist()
        weights = rng.dirichlet(np.ones(3)).tolist()
        shown, numbered = bank.blend(list(zip(numbers, times, weights, strict=True)))
        alone = mix([clips[n].sample(t) for n, t in zip(numbers, times, strict=True)], weights)
        near = np.abs((shown.rotations * alone.rotations).sum(-1))
        assert 2 * np.arccos(np.clip(near, 0, 1)).max() < np.radians(0.5)
        np.testing.assert_allclose(shown.translations, alone.translations, atol=1e-6)
        frames = [
            (t * clips[n].rate) % (len(clips[n]) - 1)
            if clips[n].loop
            else min(t * clips[n].rate, len(clips[n]) - 1.0)
            for n, t in zip(numbers, times, strict=True)
        ]
        assert numbered == pytest.approx([np.dot(frames, weights)])


def test_joints_that_turn_by_a_full_circle_are_mixed_the_shorter_way() -> None:
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    skeleton = Skeleton(("spinner",), (-1,), rest)
    angles = np.linspace(0.0, 2 * np.pi, 9)
    clip = Clip("spin", 8.0, Pose(np.zeros((9, 1, 3)), about("y", angles)[:, None]))
    bank = ClipBank.of(skeleton, [clip], np.float64)
    assert bank.sign_ambiguous.tolist() == [0]
    shown, _ = bank.blend([(0, 0.5, 0.5), (0, 0.75, 0.5)])
    assert abs(float(shown.rotations[0] @ about("y", np.radians(225.0)))) == pytest.approx(1.0)


def test_clips_of_another_skeleton_are_refused(vleo: Character):
    other = Clip("other", 30.0, vleo.clips["idle"].poses)
    fewer = Pose(other.poses.translations[:, 1:], other.poses.rotations[:, 1:])
    with pytest.raises(CharacterError, match=f"{len(vleo.skeleton)} joints"):
        ClipBank.of(vleo.skeleton, [Clip("fewer", 30.0, fewer)])
