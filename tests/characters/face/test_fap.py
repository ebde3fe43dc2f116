"""MPEG-4 facial animation parameters: limits, files, and the way back."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.face.fap import FAP_COUNT, FaceParameters, FapTrack, read_faps, write_faps
from cubeling.characters.model.character import Character
from tests.examples import examples

PARTS = [
    *("jawOpen", "mouthFunnel", "mouthPucker", "mouthSmileLeft", "mouthSmileRight", "tongueOut"),
    *("mouthUpperUpLeft", "mouthUpperUpRight", "mouthLowerDownLeft", "mouthLowerDownRight"),
    *("eyeBlinkLeft", "eyeBlinkRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight"),
    *("browDownLeft", "browDownRight"),
]


@settings(max_examples=examples(15), deadline=None)
@given(st.lists(st.floats(0, 1), min_size=len(PARTS), max_size=len(PARTS)))
def test_parts_of_a_face_come_back_if_no_parameter_is_at_its_limit(weights):
    face = FaceParameters(PARTS)
    values = face.to_faps(0.4 * np.array([weights]))
    assert face.from_faps(values)[0] == pytest.approx(0.4 * np.array(weights), abs=0.02)


@given(st.lists(st.floats(-3, 3), min_size=len(PARTS), max_size=len(PARTS)))
def test_limits_of_the_standard_are_kept(weights):
    values = FaceParameters(PARTS).to_faps(np.array(weights))
    assert values.shape == (FAP_COUNT,)
    assert 0 <= values[2] <= 1080  # open_jaw
    assert np.abs(values[[3, 5, 6, 11, 12]]).max() <= 600
    assert np.abs(values).max() <= 1860
    assert not values[:2].any()


@pytest.mark.parametrize("name", ["human", "vleo"])
def test_what_a_bundled_face_says_comes_back(name):
    morphs = Character.load(name).morphs
    face, weights = FaceParameters(morphs), np.zeros((3, len(morphs)))
    for row, (morph, weight) in zip(
        weights, (("viseme_aa", 0.8), ("viseme_PP", 1.0), ("browInnerUp", 0.5)), strict=True
    ):
        row[morphs.index(morph)] = weight
    values = face.to_faps(weights)
    assert np.abs(face.to_faps(face.from_faps(values)) - values).max() <= 2
    assert values[0, 2] > 300  # the jaw of aa


def test_a_file_comes_back(tmp_path):
    values = np.random.default_rng(0).integers(-500, 500, (20, FAP_COUNT))
    values[:, :2] = 0
    values[3] = 0
    write_faps(tmp_path / "a face.fap", FapTrack(25.0, values))
    found = read_faps(tmp_path / "a face.fap")
    assert found.rate == 25.0
    assert np.array_equal(found.values, values)


GOOD = "2.1 face 25 1\n" + " ".join(["1"] + ["0"] * 67) + "\n0 5\n"


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "no .fap file"),
        ("hello", "no .fap file"),
        ("2.1 face -3 1\n", "no .fap file"),
        ("2.1 face 25 2\n" + GOOD.partition("\n")[2], "cut off"),
        (GOOD.replace("0 0 0", "0 7 0", 1), "line 2: no frame of 68"),
        (GOOD.replace("0 5", "0"), "line 2: no frame of 68"),
        (GOOD.replace("0 5", "0 inf"), "line 2: no frame of 68"),
        ("2.1 face 25 999999999\n", "cut off"),
    ],
)
def test_what_is_no_such_file_is_refused_in_one_line(tmp_path, text, problem):
    path = tmp_path / "bad.fap"
    path.write_text(text, "utf-8")
    with pytest.raises(CharacterError, match=problem) as refused:
        read_faps(path)
    assert "\n" not in str(refused.value)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(CharacterError, match="cannot read"):
        read_faps(tmp_path / "none.fap")
