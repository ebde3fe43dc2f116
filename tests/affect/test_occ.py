"""The 24 emotions on faces and in the plane (specification S18)."""

import math
from collections import Counter

import pytest
from hypothesis import given, strategies as st

from cubeling.affect.errors import AffectError
from cubeling.affect.occ import (
    ALMA_MATRIX,
    DOMINANCE,
    OCC_FACES,
    OCC_PLACES,
    TWO_ROWS,
    activation_evaluation,
    face_intensities,
)
from cubeling.affect.traits import Ocean
from cubeling.affect.words import WORD_PLACES

intensities = st.dictionaries(st.sampled_from(sorted(OCC_FACES)), st.floats(0, 1))


def test_every_emotion_has_one_face_one_place_and_one_row():
    counts = Counter(OCC_FACES.values())
    assert counts == {
        "happy": 11, "sad": 6, "angry": 3, "surprised": 1, "afraid": 2, "disgusted": 1
    }  # fmt: skip
    for table in (OCC_PLACES, DOMINANCE, ALMA_MATRIX, TWO_ROWS):
        assert table.keys() == OCC_FACES.keys()


@pytest.mark.parametrize("word", OCC_FACES)
def test_a_pure_emotion_is_at_its_own_place(word):
    shown = activation_evaluation({word: 1.0})
    assert (shown.valence, shown.arousal) == pytest.approx(WORD_PLACES[word])
    assert face_intensities({word: 0.7}) == {
        **dict.fromkeys(OCC_FACES.values(), 0.0),
        OCC_FACES[word]: 0.7,
    }


@given(intensities)
def test_the_body_stays_on_the_disc_and_faces_within_one(felt):
    shown = activation_evaluation(felt)
    assert math.hypot(shown.valence, shown.arousal) <= 1 + 1e-9
    faces = face_intensities(felt)
    assert len(faces) == 6
    for word, intensity in felt.items():
        assert faces[OCC_FACES[word]] >= intensity
    assert max(faces.values()) == max(felt.values(), default=0.0)


def test_a_stranger_is_refused():
    with pytest.raises(AffectError, match="'envy' is not one of the 24"):
        face_intensities({"envy": 1.0})


@pytest.mark.parametrize("word", OCC_FACES)
def test_by_alma_who_has_every_trait_by_half_responds_by_half(word):
    assert ALMA_MATRIX[word].response(Ocean()) == pytest.approx(0.5)
    assert ALMA_MATRIX[word].response(Ocean(0, 0, 0, 0, 0)) == 0.0


def test_by_alma_people_feel_what_lies_where_their_temperament_does():
    kind, nervous = Ocean(0, 0, 1, 1, 0), Ocean(0.5, 0.5, 0.2, 0.5, 1)
    joy, distress, fear, pride = (ALMA_MATRIX[w] for w in ("joy", "distress", "fear", "pride"))
    assert joy.response(kind) > 2 * distress.response(kind)
    assert fear.response(nervous) > 2 * fear.response(kind)
    assert pride.response(kind) > 1.2 * pride.response(nervous)
    differences = {word: math.dist(ALMA_MATRIX[word], TWO_ROWS[word]) for word in OCC_FACES}
    assert min(differences.values()) > 0.05
