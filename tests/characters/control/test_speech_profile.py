"""Profiles of BodySpeech: their values, and their files."""

import pytest
from hypothesis import given, strategies as st

from cubeling.characters.control.speech_profile import DATABASES, RANGES, SpeechProfile
from cubeling.characters.errors import CharacterError
from cubeling.characters.face.visemes.sets import viseme_sets

PROFILES = st.builds(
    SpeechProfile,
    database=st.sampled_from(DATABASES),
    visemes=st.sampled_from(list(viseme_sets())),
    **{name: st.floats(low, high) for name, (low, high) in RANGES.items()},
)


@given(PROFILES)
def test_a_profile_comes_back_from_its_file(tmp_path_factory, profile):
    path = tmp_path_factory.mktemp("profiles") / "my.toml"
    profile.save(path)
    assert SpeechProfile.load(str(path)) == profile


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("database = 'loud'", "must be one of aggressive, neutral, full, not 'loud'"),
        ("visemes = 'none'", "visemes must be one of oculus"),
        ("gesture_emphasis = 2", "gesture_emphasis must be from -1 to 1, not 2"),
        ("face_emphasis = 'much'", "must be a number, not 'much'"),
        ("accent_threshold = true", "must be a number, not True"),
        ("volume = 3", "volume means nothing here; there are database, "),
        ("database", "my.toml"),
    ],
)
def test_what_is_no_profile_is_one_line(tmp_path, text, problem):
    path = tmp_path / "my.toml"
    path.write_text(text)
    with pytest.raises(CharacterError, match=problem) as error:
        SpeechProfile.load(str(path))
    assert "\n" not in str(error.value)


def test_what_a_file_leaves_out_is_usual(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text("database = 'aggressive'\n")
    assert SpeechProfile.load(str(path)) == SpeechProfile(database="aggressive")
