"""Motions written as .bvh are read back as they were."""

from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, load_motion
from cubeling.characters.formats.mocap.bvh_writing import save_bvh


@pytest.mark.parametrize(
    ("name", "clip"), [("human", "Run"), ("human", "wave"), ("vleo", "kiss_legs")]
)
def test_a_written_motion_comes_back(tmp_path: Path, name: str, clip: str) -> None:
    character = Character.load(name)
    skeleton, motion = character.skeleton, character.clips[clip]
    save_bvh(motion, skeleton, character.anatomy, tmp_path / "it.bvh")
    found = load_motion(tmp_path / "it.bvh", scale=1.0)
    assert len(found.clip) == len(motion)
    assert found.clip.rate == pytest.approx(motion.rate, rel=1e-6)
    placed = found.clip.poses.globals(found.skeleton)
    known = [joint for joint in found.skeleton.names if joint in skeleton.names]
    assert "Hips" in known or "hips" in known
    ours = [found.skeleton.names.index(joint) for joint in known]
    theirs = [skeleton.names.index(joint) for joint in known]
    truth = motion.poses.globals(skeleton)
    assert np.abs(placed[:, ours, :3, 3] - truth[:, theirs, :3, 3]).max() < 1e-5


def test_a_body_without_hips_is_refused(tmp_path: Path) -> None:
    human = Character.load("human")
    bare = type(human.anatomy)("other", {})
    with pytest.raises(CharacterError, match="begins at the hips"):
        save_bvh(human.clips["nod"], human.skeleton, bare, tmp_path / "it.bvh")
