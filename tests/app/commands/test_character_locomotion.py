"""`cubeling character locomotion`: what it makes, tells and refuses."""

from dataclasses import replace

import pytest

from cubeling.characters import Character
from cubeling.characters.locomotion.gaits import WALK_CLIPS
from tests.characters.retargeting.conftest import straight_only as straight_only


@pytest.mark.slow(reason="clips are made and written")
def test_one_command_makes_a_character_that_walks(cubeling, tmp_path):
    target = tmp_path / "mine.glb"
    code, out, _ = cubeling(
        "character", "locomotion", "human", "--walk", "human#Walk", "-o", target
    )
    assert not code
    assert "1.35 m/s" in out
    assert "WalkLeftShort" in out
    assert set(WALK_CLIPS.values()) <= set(Character.load(target).clips)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["human"], "give at least one recording with --walk"),
        (["human", "--walk", "human#Walk", "-o", "mine.fbx"], "not as 'mine.fbx'"),
        (["human", "--walk", "human#Stroll"], "which clip? write human#CLIP"),
        (["human", "--walk", "nowhere.bvh"], "nowhere.bvh"),
        (["vleo", "--walk", "human#Walk"], "use a motion of the same kind"),
        (["human", "--walk", "human#idle"], "goes nowhere"),
    ],
)
def test_invalid_arguments_are_refused_in_one_line(cubeling, arguments, told):
    code, _, err = cubeling("character", "locomotion", *arguments)
    assert code == 2
    assert told in err
    assert err.count("\n") == 1


def test_inputs_are_not_overwritten(cubeling, tmp_path):
    mine = tmp_path / "mine.glb"
    Character.load("human").save(mine)
    before = mine.read_bytes()
    for arguments in ([mine, "--walk", "human#Walk"], ["human", "--walk", f"{mine}#Walk"]):
        code, _, err = cubeling(
            "character", "locomotion", *arguments, "-o", "mine.glb", "--overwrite"
        )
        assert code == 2
        assert "overwrite one of its inputs" in err
    assert mine.read_bytes() == before


def test_a_run_slower_than_the_walk_is_reported(cubeling, straight_only):
    code, out, _ = cubeling(
        "character", "locomotion", "human", "--walk", "human#Run", "--run", "human#Walk"
    )
    assert code == 0
    assert "slower than it walks" in out


def test_visible_faults_are_told(cubeling, straight_only, tmp_path):
    human = Character.load("human")
    walk = human.clips["Walk"]
    longer = walk.poses.translations.copy()
    longer[:, human.anatomy.joints["leftLowerArm"]] *= 1.4
    grown = replace(walk, poses=replace(walk.poses, translations=longer))
    replace(human, clips={"Walk": grown}).save(tmp_path / "grown.glb")
    code, out, _ = cubeling(
        "character", "locomotion", "grown.glb", "--walk", "grown.glb#Walk", "-o", "mine.glb"
    )
    assert code == 0
    assert "! grown.glb#Walk: its bones change length by 40%" in out
