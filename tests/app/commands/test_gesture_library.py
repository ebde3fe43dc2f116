"""`cubeling gesture learn` and `library`."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from cubeling.characters import Character, Clip
from cubeling.characters.synthesis.gestures.library import GestureLibrary


@pytest.fixture(scope="module")
def talk() -> Character:
    """The explorer with three clips: two units of gestures, and one that stands still."""
    human = Character.load("human")
    library = human.gestures
    assert library is not None
    clips = {}
    for name, number in (("one", 9), ("two", 17)):
        turns = library.recordings[number].turns
        rests = [np.repeat(turns[[end]], 30, axis=0) for end in (0, -1)]
        poses = library.poses(np.concatenate([rests[0], turns, rests[1]]))
        clips[name] = Clip(name, library.rate, poses, loop=False)
    still = library.poses(np.repeat(library.rest[None], 90, axis=0))
    clips["still"] = Clip("still", library.rate, still, loop=False)
    return Character("talk", human.skeleton, clips, human.meshes, morphs=human.morphs)


@pytest.fixture
def talking(talk, tmp_path) -> Path:
    path: Path = tmp_path / "talk.glb"
    talk.save(path)
    return path


def test_learns_the_gestures_of_recordings(cubeling, talking, tmp_path):
    code, out, _ = cubeling(
        "gesture", "learn", f"{talking}#one", f"{talking}#two", "-o", "a.gestures"
    )
    assert code == 0
    assert "6 gesture phrases" in out
    library = GestureLibrary.load(tmp_path / "a.gestures")
    assert len(library.phrases) == 6
    assert library.skeleton_identity == GestureLibrary.load(bundled()).skeleton_identity


def test_marks_are_written_compared_and_learned_from(cubeling, talking, tmp_path):
    both = f"{talking}#one", f"{talking}#still"
    code, out, _ = cubeling("gesture", "marks", *both, "-o", "m.csv")
    assert code == 0
    assert "no gesture; no hand leaves its place of rest" in " ".join(out.split())
    code, out, _ = cubeling("gesture", "marks", both[0], "--against", "m.csv")
    assert code == 0
    assert "missed: 0.0%" in out
    assert "apex within 0.1 s: 100.0%" in out
    code, _, _ = cubeling("gesture", "learn", both[0], "--marks", "m.csv", "-o", "m.gestures")
    assert code == 0
    assert len(GestureLibrary.load(tmp_path / "m.gestures").phrases) == 3


def test_recordings_without_gestures_are_refused_in_one_line(cubeling, talking, tmp_path):
    code, _, err = cubeling("gesture", "learn", f"{talking}#still", "-o", "b.gestures")
    assert code == 2
    assert "no gesture found" in err
    assert err.count("\n") == 1
    assert not (tmp_path / "b.gestures").exists()


def test_shows_the_bundled_library_with_its_graph(cubeling):
    code, out, _ = cubeling("gesture", "library")
    assert code == 0
    assert "72 gesture phrases" in out
    assert "connected" in out


def test_draws_strokes_and_apices(cubeling, talking, tmp_path):
    cubeling("gesture", "learn", f"{talking}#one", "-o", "c.gestures")
    code, _, _ = cubeling("gesture", "library", "c.gestures", "-o", "c.png")
    assert code == 0
    picture = cv2.imread(str(tmp_path / "c.png"))
    assert picture is not None
    assert picture.shape[1] > 700
    assert int(picture.min()) < 128


@pytest.mark.parametrize("name", ["nobody.gestures", "human.glb"])
def test_what_is_no_library_is_refused_in_one_line(cubeling, name):
    code, _, err = cubeling("gesture", "library", name)
    assert code == 2
    assert err.count("\n") == 1


def test_the_group_of_old_versions_names_that_of_today(cubeling):
    code, _, err = cubeling("gestures", "show", "human")
    assert code == 2
    assert err.startswith("cubeling: 'gestures' is now cubeling gesture")
    assert err.count("\n") == 1


def bundled() -> Path:
    return Path(__file__).parents[3] / "characters" / "assets" / "human.gestures"
