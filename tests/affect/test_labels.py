"""Words for feelings: sets complete, places in the plane, and every robot says the right one."""

import itertools
import math

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import LABEL_SETS, Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.labels import WORD_TABLE, label_set
from cubeling.affect.words import WORD_LABELS, WORD_PLACES, closest_word

THREE_WORDS = ("neutral", "happy", "angry")

WORDS_OF_MOOD = {
    "neutral": "neutral sad surprised calm sleepy bored alert depressed relaxed distress pity "
    "disappointment shame remorse resentment surprise",
    "happy": "happy excited content pleased joy happy-for gratitude gratification admiration pride "
    "love hope satisfaction relief gloating",
    "angry": "angry afraid disgusted distressed displeased anger reproach hate fear fear-confirmed "
    "disgust",
}
"""What a child would expect of a robot that knows three moods."""


def test_a_robot_with_three_moods_shows_the_sensible_one_for_every_word():
    expected = {word: mood for mood, words in WORDS_OF_MOOD.items() for word in words.split()}
    assert expected.keys() == {row.word for row in WORD_TABLE}
    for word, mood in expected.items():
        for robot in itertools.permutations(THREE_WORDS):
            assert closest_word(robot, Emotion(0, 0, word)) == mood, word


@pytest.mark.parametrize(
    ("words", "label", "closest"),
    [
        (("neutral", "happy", "sad", "angry"), "distress", "sad"),
        (("neutral", "happy", "sad", "angry"), "depressed", "sad"),
        (("neutral", "happy", "afraid", "angry"), "fear", "afraid"),
        (("neutral", "happy", "afraid", "angry"), "hate", "angry"),
        (("calm", "excited"), "happy", "excited"),
        (("sad", "angry"), "happy", "angry"),  # the nearest place, where no word is as good
        (("sit", "zero"), "happy", None),
        ((), "happy", None),
    ],
)
def test_a_robot_with_other_moods_shows_the_closest(words, label, closest):
    assert closest_word(words, Emotion(0, 0, label)) == closest


@given(st.floats(-1, 1), st.floats(-1, 1), st.sampled_from([None, "snarky"]))
def test_without_a_known_label_the_emotion_decides(valence, arousal, label):
    word = closest_word(THREE_WORDS, Emotion(valence, arousal, label))
    assert word == min(
        THREE_WORDS, key=lambda each: math.dist(WORD_PLACES[each], (valence, arousal))
    )


def test_the_24_emotions_have_the_faces_of_table_5_2():
    faces = {
        "happy": "happy-for gloating joy pride admiration love hope satisfaction relief "
        "gratification gratitude",
        "sad": "resentment pity distress shame remorse disappointment",
        "angry": "anger reproach hate",
        "surprised": "surprise",
        "afraid": "fear fear-confirmed",
        "disgusted": "disgust",
        "neutral": "neutral",
    }
    expected = {word: face for face, words in faces.items() for word in words.split()}
    assert {row.word: row.face for row in WORD_TABLE if row.set == "occ"} == expected


def test_the_sets_have_the_sizes_that_they_are_known_for():
    sizes = {name: len(labels.places) for name, labels in LABEL_SETS.items()}
    assert sizes == {"thesis": 3, "circumplex": 8 + 1, "ekman": 6 + 1, "occ": 24 + 1}


def test_every_place_is_in_the_plane_and_no_set_says_a_word_twice():
    for row in WORD_TABLE:
        Emotion(row.valence, row.arousal)
    for name in {row.set for row in WORD_TABLE}:
        words = [row.word for row in WORD_TABLE if row.set == name]
        assert len(words) == len(set(words))
    for word in WORD_PLACES:
        assert len({row.face for row in WORD_TABLE if row.word == word}) == 1, word
    assert WORD_PLACES.keys() == WORD_LABELS.keys()


@pytest.mark.parametrize("name", LABEL_SETS)
def test_neutral_is_in_every_set_at_the_origin(name):
    assert LABEL_SETS[name].places["neutral"] == (0, 0)


def test_the_circumplex_is_a_circle_of_eight_equal_steps():
    around = [place for word, place in LABEL_SETS["circumplex"].places.items() if word != "neutral"]
    angles = [round(math.degrees(math.atan2(a, v))) % 360 for v, a in around]
    assert angles == [0, 45, 90, 135, 180, 225, 270, 315]
    assert {round(math.hypot(*place), 3) for place in around} == {0.8}


@pytest.mark.parametrize("name", ["circumplex", "ekman"])
def test_no_two_places_of_a_set_are_nearer_than_any_hysteresis_can_part(name):
    for one, other in itertools.combinations(LABEL_SETS[name].places.values(), 2):
        assert math.dist(one, other) > 2 * 0.15


def test_a_set_that_does_not_exist_is_refused_with_those_that_do():
    with pytest.raises(AffectError, match="no label set 'plutchik': choose one of thesis, circum"):
        label_set("plutchik")
