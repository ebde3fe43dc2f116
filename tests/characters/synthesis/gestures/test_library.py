"""The .gestures file, and the bundled library."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.speech import Accent
from cubeling.characters.synthesis.archive import skeleton_identity
from cubeling.characters.synthesis.gestures.library import STEP_RAD, GestureLibrary, gesture_joints
from cubeling.characters.synthesis.gestures.planning import GesturePlanner
from tools.authoring.speakers import GESTURES


def test_a_library_comes_back_from_its_file(library, tmp_path):
    library.save(tmp_path / "a.gestures")
    again = GestureLibrary.load(tmp_path / "a.gestures")
    assert again.phrases == library.phrases
    assert again.skeleton_identity == library.skeleton_identity
    assert (again.joints, again.rate) == (library.joints, library.rate)
    for mine, read in zip(library.recordings, again.recordings, strict=True):
        assert mine.name == read.name
        assert np.abs(mine.turns - read.turns).max() < STEP_RAD
    assert np.abs(library.rest - again.rest).max() < STEP_RAD


@pytest.mark.parametrize("content", [b"", b"PK nothing", b"# motion capture"])
def test_other_files_are_refused_in_one_line(tmp_path, content):
    path = tmp_path / "b.gestures"
    path.write_bytes(content)
    with pytest.raises(CharacterError, match="not a gesture library") as caught:
        GestureLibrary.load(path)
    assert "\n" not in str(caught.value)
    with pytest.raises(CharacterError):
        GestureLibrary.load(tmp_path / "missing.gestures")


def test_the_bundled_library_is_of_the_bundled_human(human, library):
    assert library.skeleton_identity == skeleton_identity(human.skeleton)
    assert library.joints == gesture_joints(human.skeleton, human.anatomy)


def test_it_has_sixty_phrases_of_both_hands_and_of_either_and_all_strengths(library):
    assert len(library.phrases) >= 60
    hands = [phrase.hand for phrase in library.phrases]
    assert min(hands.count(hand) for hand in ("left", "right", "both")) >= 15
    weak, strong = np.quantile(library.strengths, (0.1, 0.9))
    assert strong - weak > 3.0
    assert sum(library.consecutive) >= 40  # chained without a rest between


def test_no_two_phrases_are_copies_of_each_other_or_mirror_images(library):
    lengths = [phrase.bounds[5] - phrase.bounds[0] for phrase in library.phrases]
    keys = {(round(s, 2), n) for s, n in zip(library.strengths.tolist(), lengths, strict=True)}
    assert len(keys) >= len(library.phrases) - 2


def test_units_begin_and_end_near_rest(library):
    for recording in library.recordings:
        for end in (recording.turns[0], recording.turns[-1]):
            half = np.arccos(np.clip(np.abs((end * library.rest).sum(-1)), 0.0, 1.0))
            assert np.degrees(2 * half).max() < 12.0


def test_databases_are_the_stronger_and_the_weaker_phrases(library):
    aggressive, neutral = library.database("aggressive"), library.database("neutral")
    assert aggressive.strengths.min() > np.quantile(library.strengths, 0.3)
    assert neutral.strengths.max() < np.quantile(library.strengths, 0.7)
    assert {*aggressive.phrases, *neutral.phrases} == {*library.phrases}
    assert library.database("full") is library
    with pytest.raises(CharacterError, match="there are aggressive, neutral, full"):
        library.database("loud")


@pytest.mark.full
@pytest.mark.parametrize("name", ["human", "vleo"])
def test_a_bundled_library_is_what_the_authoring_makes(name):
    character = Character.load(name)
    shipped, made = character.gestures, GESTURES[name](character)
    assert shipped is not None
    assert [each.bounds for each in shipped.phrases] == [each.bounds for each in made.phrases]
    assert shipped.strengths == pytest.approx(made.strengths, abs=1e-3)
    for one, other in zip(shipped.recordings, made.recordings, strict=True):
        assert np.abs(one.turns - other.turns).max() < 2 * STEP_RAD


def test_vleo_speaks_with_neck_head_and_tail_while_his_trunk_carries_standing_legs():
    vleo = Character.load("vleo")
    library = vleo.gestures
    assert library is not None
    moved = {vleo.skeleton.names[joint] for joint in library.joints}
    assert moved == {"neck1", "neck2", "neck3", "head", *(f"tail{n}" for n in range(1, 6))}
    plan = GesturePlanner(library).plan([Accent(1.0, 0.9), Accent(2.0, 0.7)], 3.0)
    assert len(plan.gestures) == 2


@pytest.mark.parametrize(
    "bounds", [(-1, 0, 1, 2, 3, 4), (0, 0, 5, 5, 6, 7), (0, 1, 2, 3, 4, 10**6)]
)
def test_a_phrase_that_is_not_in_its_recording_is_refused(library, tmp_path, bounds):
    wrong = replace(library.phrases[0], bounds=bounds)
    replace(library, phrases=(wrong,)).save(tmp_path / "c.gestures")
    with pytest.raises(CharacterError, match="not in its recording"):
        GestureLibrary.load(tmp_path / "c.gestures")


def test_only_the_upper_body_moves(human, library):
    moved = {human.skeleton.names[joint] for joint in np.flatnonzero(library.mask)}
    assert {"LeftHandIndex2", "RightForeArm", "spine1", "head"} <= moved
    assert not moved & {"root", "hips", "LeftUpLeg", "Backpack", "LeftEye"}
    poses = library.poses(library.recordings[0].turns)
    still = library.mask == 0
    rest = human.skeleton.rest.rotations[still]
    assert np.abs(poses.rotations[:, still] - rest).max() == 0.0
