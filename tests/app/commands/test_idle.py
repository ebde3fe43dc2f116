"""`cubeling idle`, and characters that stand as a person does."""

import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import cast

import cv2
import numpy as np
import pytest

from cubeling.affect import region_of
from cubeling.characters import Animator, Character, CharacterCommand, Clip, Pose
from cubeling.characters.control.controllers.idle import standing_as
from cubeling.characters.retargeting.feet.leg_ik import place_ankle
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.synthesis.idle.pauses import PauseLaw
from cubeling.characters.synthesis.idle.recordings import read_standing
from cubeling.characters.synthesis.idle.standing import StandingPerson
from cubeling.characters.synthesis.idle.storage import load_person, save_person

RATE = 25.0


@pytest.fixture(scope="module")
def swaying() -> Clip:
    """A person who shifts her balance every three seconds: her hips go from side to side."""
    human = Character.load("human")
    times = np.arange(0.0, 30.0, 1 / RATE)
    rest, hips = human.skeleton.rest, human.anatomy.joints["hips"]
    moved = np.repeat(rest.translations[None], len(times), axis=0)
    moved[:, hips, 0] += 0.06 * np.tanh(4.0 * np.sin(2 * np.pi * times / 6.0))
    turns = np.repeat(rest.rotations[None], len(times), axis=0)
    return Clip("swaying", RATE, Pose(moved, turns), root_motion=True)


@pytest.fixture(scope="module")
def saved_anna(swaying: Clip, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of that person."""
    human = Character.load("human")
    rig = Rig(human.skeleton, human.anatomy)
    poses = replace(swaying.poses, translations=swaying.poses.translations.copy())
    poses.translations[:, human.anatomy.joints["hips"], 1] -= 0.02  # bent knees let her sway
    for leg in rig.legs:  # her feet stay where they are
        ankle = np.broadcast_to(rig.rest_positions[leg.foot], (len(swaying), 3))
        poses = place_ankle(poses, rig, leg, ankle)
    clip = Clip("anna", RATE, poses, root_motion=True)
    recording = read_standing(clip, human.skeleton, human.anatomy)
    path = tmp_path_factory.mktemp("anna") / "anna.idle"
    save_person((human.skeleton, human.anatomy, (recording,)), path)
    return path


@pytest.fixture
def anna(saved_anna: Path, tmp_path: Path) -> Path:
    """A copy of it, for one test."""
    return Path(shutil.copy(saved_anna, tmp_path))


def test_a_person_comes_back_from_her_file(anna: Path) -> None:
    skeleton, _, (recording,) = load_person(anna)
    assert len(skeleton) == len(Character.load("human").skeleton)
    assert (recording.name, recording.rate, len(recording.vectors)) == ("anna", RATE, 750)
    assert {rest.balance for rest in recording.rests} == {"left", "right"}


def test_the_emotions_at_both_ends_come_back_from_her_file(anna: Path, tmp_path: Path) -> None:
    skeleton, anatomy, (recording,) = load_person(anna)
    turning = replace(recording, feeling=region_of("sad"), before=region_of("happy"))
    save_person((skeleton, anatomy, (turning, recording)), tmp_path / "turning.idle")
    one, other = load_person(tmp_path / "turning.idle")[2]
    assert (one.before, one.feeling) == (turning.before, turning.feeling)
    assert (other.before, other.feeling) == (None, None)


def test_shows_rests_pauses_and_shifts(cubeling, anna) -> None:
    code, out, _ = cubeling("idle", "show", str(anna))
    assert code == 0
    assert "Recorded for 30.0 s" in out
    assert "then right" in out
    assert "100%" in out  # after the left foot comes the right one


def test_a_mood_shows_what_suits_it(cubeling) -> None:
    def rests(*mood: str) -> int:
        code, out, _ = cubeling("idle", "show", "human", *mood)
        assert code == 0
        assert ("Rests, happy" in out) == bool(mood)
        return int(re.findall(r"^ *left +(\d+)", out, re.MULTILINE)[0])

    assert 0 < rests("--mood", "happy") < rests()


def test_somebody_without_moods_stands_as_always(cubeling, anna) -> None:
    assert "not recorded in moods" in cubeling("idle", "show", str(anna), "--mood", "happy")[1]


@pytest.mark.slow(reason="portraits are drawn into a plot")
def test_plots_her_postures_shifts_and_variations(cubeling, anna, tmp_path) -> None:
    code, out, _ = cubeling("idle", "show", "anna.idle", "-o", "a.png", "--mood", "happy")
    assert code == 0
    assert "Plotted: a.png" in out
    picture = cv2.imread(str(tmp_path / "a.png"))
    assert picture is not None
    assert picture.shape[1] > 1500
    colours = picture.reshape(-1, 3) @ np.array([1 << 16, 1 << 8, 1])
    assert len(np.unique(colours)) > 2000  # portraits, not only lines


def test_shows_how_a_bundled_character_stands(cubeling) -> None:
    code, out, _ = cubeling("idle", "show", "vleo")
    assert code == 0
    assert "with 44 balance shifts" in out


@pytest.mark.slow(reason="a character stands for a minute")
def test_a_character_stands_as_the_person(anna: Path) -> None:
    human = Character.load("human")
    lively = Animator(standing_as(human, anna), scale=1.0)
    still = Animator(replace(human, standing=None), scale=1.0)
    hips = human.anatomy.joints["hips"]
    for animator, least, most in ((lively, 0.5, 1.0), (still, 0.0, 0.2)):
        aside = np.array([
            animator.update(CharacterCommand(t)).pose.translations[hips, 0]
            for t in np.arange(0.0, 30.0, 1 / 6)
        ])  # fmt: skip
        assert least <= np.mean(np.abs(aside) > 0.045) <= most


def test_a_character_that_stands_as_the_person_keeps_the_pauses_of_its_file(anna: Path) -> None:
    human = Character.load("human")
    assert human.pauses is None
    for law in (None, PauseLaw(beta=0.5)):
        make = standing_as(replace(human, pauses=law), anna).standing
        assert make is not None
        assert cast(StandingPerson, make(0)).idle.pauses == (law or PauseLaw())


@pytest.mark.full
def test_a_smaller_character_stands_so_too(anna: Path) -> None:
    human = Character.load("human")
    rest = human.skeleton.rest
    smaller = replace(rest, translations=0.8 * rest.translations)
    child = replace(human, skeleton=replace(human.skeleton, rest=smaller))
    hips = human.anatomy.joints["hips"]
    motions = [standing_as(each, anna).standing for each in (human, child)]
    ways = [
        np.ptp([motion.sample(t).translations[hips, 0] for t in np.arange(0.0, 12.0, 0.2)])
        for motion in (make(0) for make in motions if make is not None)
    ]
    assert ways[1] / ways[0] == pytest.approx(0.8, abs=0.08)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("show", "no.idle"), "no.idle': No such file"),
        (("show", "human", "-o", "a.gif"), "written as .svg"),
        (("show", "human", "--mood", "blue"), "no emotion is called 'blue'"),
        (("learn", "blue=x.bvh"), "no emotion is called 'blue'"),
        (("learn", "nobody.bvh"), "nobody.bvh"),
        (("learn", "human#Walk"), "both feet stand in only"),
        (("learn", "human#Walk", "-o", "walk.txt"), "written as .idle"),
        (("learn", "human#Walk", "--character", "vleo"), "quadruped"),
    ],
)
def test_refuses_in_one_line(cubeling, arguments, message) -> None:
    code, _, error = cubeling("idle", *arguments)
    assert code == 2
    assert message in error
    assert error.count("\n") == 1


def test_a_file_that_is_damaged_is_refused(cubeling, anna, tmp_path) -> None:
    with np.load(anna) as archive:
        arrays = dict(archive)
    arrays["rests_0"] = np.array([[0, 10**6, 0]])
    (tmp_path / "bad.idle").write_bytes(b"")
    np.savez(tmp_path / "bad.npz", **arrays)
    (tmp_path / "bad.npz").rename(tmp_path / "bad.idle")
    code, _, error = cubeling("idle", "show", "bad.idle")
    assert code == 2
    assert "its rests are not in its frames" in error


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("follow", "--controller", "matching"), "stands by its own motions: leave out --idle"),
        (("companion",), "anna.idle: "),
    ],
)
def test_idle_motion_that_cannot_be_played_is_refused(cubeling, anna, options, message) -> None:
    code, _, error = cubeling(
        "play",
        *options,
        "--idle",
        str(anna),
        "--source",
        f"synthetic:{options[0]}",
        "--no-pictures",
    )
    assert code == 2
    assert message in error
