"""The 24 emotions on faces and in the plane."""

import math
from collections import Counter

import pytest
from hypothesis import given, strategies as st

from cubeling.affect.errors import AffectError
from cubeling.affect.occ import OCC_FACES, face_intensities, shown_emotion
from cubeling.affect.words import WORD_PLACES
from cubeling.characters.face.affect_display import expression_weights
from cubeling.characters.face.expressions import EXPRESSIONS

intensities = st.dictionaries(st.sampled_from(sorted(OCC_FACES)), st.floats(0, 1))


def test_every_emotion_has_one_face_as_in_the_table():
    counts = Counter(OCC_FACES.values())
    assert counts == {
        "happy": 11, "sad": 6, "angry": 3, "surprised": 1, "afraid": 2, "disgusted": 1
    }  # fmt: skip


@pytest.mark.parametrize("word", OCC_FACES)
def test_a_pure_emotion_is_at_its_own_place_with_its_own_face(word):
    shown = shown_emotion({word: 1.0})
    assert (shown.valence, shown.arousal) == pytest.approx(WORD_PLACES[word])
    assert shown.word == OCC_FACES[word]
    assert max(expression_weights(shown)[: len(EXPRESSIONS)]) > 0.15


@given(intensities)
def test_the_body_stays_on_the_disc_and_faces_within_one(felt):
    shown = shown_emotion(felt)
    assert math.hypot(shown.valence, shown.arousal) <= 1 + 1e-9
    faces = face_intensities(felt)
    assert len(faces) == 6
    for word, intensity in felt.items():
        assert faces[OCC_FACES[word]] >= intensity
    assert max(faces.values()) == max(felt.values(), default=0.0)


def test_fear_and_disgust_look_different_from_anger():
    shown = {
        word: expression_weights(shown_emotion({word: 1.0}))
        for word in ("anger", "fear", "disgust")
    }
    assert math.dist(shown["anger"], shown["fear"]) > 0.4
    assert math.dist(shown["anger"], shown["disgust"]) > 0.3
    assert math.dist(shown["fear"], shown["disgust"]) > 0.3


def test_nothing_felt_is_neutral_and_a_stranger_is_refused():
    assert shown_emotion({}).word == "neutral"
    with pytest.raises(AffectError, match="'envy' is not one of the 24"):
        face_intensities({"envy": 1.0})
