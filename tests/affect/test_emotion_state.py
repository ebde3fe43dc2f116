"""A state of 24 emotions: responses, decay, bounds, words (specification S17)."""

import dataclasses
import itertools
import math

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion, Feelings, Personality, closest_word
from cubeling.affect.emotion_settings import EmotionSettings, MoodLayer
from cubeling.affect.errors import AffectError
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.occ import ALMA_MATRIX, OCC_FACES, OCC_PLACES, TWO_ROWS
from cubeling.affect.traits import Ocean

STEP_S = 0.5
words = st.sampled_from(sorted(OCC_PLACES))
amounts = st.dictionaries(words, st.floats(0, 1), max_size=4)
trait = st.floats(0, 1)
anyone = st.builds(Ocean, trait, trait, trait, trait, trait)
settings = st.builds(
    EmotionSettings,
    st.sampled_from([ALMA_MATRIX, TWO_ROWS]),
    st.sampled_from(["linear", "exponential"]),
    st.floats(0, 1),
    st.floats(0.05, 100),
    st.one_of(st.none(), st.builds(MoodLayer, trait, st.floats(0.05, 100), trait)),
)


def somebody(emotions: EmotionSettings | None = None, **fields: object) -> Personality:
    who = Personality("somebody", labels="occ", emotions=emotions or EmotionSettings())
    return dataclasses.replace(who, **fields)  # type: ignore[arg-type]


def steps(feelings: Feelings, count: int, start: float = 0.0) -> list[float]:
    """Return the joy after each of some steps of half a second without an influence."""
    joys = []
    for step in range(count):
        feelings.update("idle", 0.0, start + step * STEP_S)
        joys.append(feelings.intensities["joy"])
    return joys


@given(st.floats(0.05, 1), st.floats(0.02, 0.9))
def test_an_intensity_fades_by_a_line_to_exactly_zero(value, per_s):
    feelings = Feelings(somebody(EmotionSettings(decay_per_s=per_s)))
    feelings.influence("joy", value)
    count = math.ceil(value / (per_s * STEP_S))
    joys = steps(feelings, count + 2)
    for step, joy in enumerate(joys):
        assert joy == pytest.approx(max(value - step * STEP_S * per_s, 0.0), abs=1e-12)
    assert joys[count] == pytest.approx(0.0, abs=1e-12)
    assert joys[-1] == 0.0
    assert joys[count - 1] > 0.0


def test_by_the_other_law_half_is_left_after_a_half_life():
    feelings = Feelings(somebody(EmotionSettings(decay="exponential", half_life_s=3.0)))
    feelings.influence("joy", 0.8)
    assert steps(feelings, 13)[6::6] == pytest.approx([0.4, 0.2], abs=1e-12)


@given(settings, anyone, st.lists(st.tuples(amounts, st.floats(0, 1)), max_size=8))
def test_intensities_stay_within_their_bounds_and_the_place_on_the_disc(how, ocean, done):
    who = somebody(how, ocean=ocean, gains={"kiss": AffectImpulse(emotions={"love": 2.0})})
    feelings = Feelings(who)
    for step, (influences, strength) in enumerate(done):
        for word, value in influences.items():
            feelings.influence(word, value)
        emotion = feelings.update("kiss", strength, step * STEP_S)
        assert all(0.0 <= value <= 1.0 for value in feelings.intensities.values())
        assert math.hypot(emotion.valence, emotion.arousal) <= 1.0 + 1e-12


@given(amounts, amounts, st.sampled_from(["linear", "exponential"]))
def test_influences_add_up_while_nothing_is_at_its_bound(one, other, law):
    def after(*all_influences: dict[str, float]) -> list[float]:
        feelings = Feelings(somebody(EmotionSettings(decay=law)))
        feelings.update("idle", 0.0, 0.0)
        for influences in all_influences:
            for word, value in influences.items():
                feelings.influence(word, 0.4 * value)
        return list(feelings.intensities.values())

    sums = [a + b for a, b in zip(after(one), after(other), strict=True)]
    assert after(one, other) == pytest.approx(sums, abs=1e-12)


@given(anyone, anyone, words, st.sampled_from([ALMA_MATRIX, TWO_ROWS]))
def test_two_personalities_respond_in_the_ratio_of_their_rows(one, other, word, matrix):
    felt = []
    for ocean in (one, other):
        feelings = Feelings(somebody(EmotionSettings(matrix), ocean=ocean))
        feelings.influence(word, 0.5)
        felt.append(feelings.intensities[word])
    us = [matrix[word].response(ocean) for ocean in (one, other)]
    assert felt[0] * us[1] == pytest.approx(felt[1] * us[0], abs=1e-9)


def test_by_two_rows_the_example_of_the_thesis_feels_as_the_specification_computes():
    who = somebody(EmotionSettings(TWO_ROWS), ocean=Ocean(0.8, 0.1, 0.7, 0.5, 0.05))
    feelings = Feelings(who)
    for word in ("joy", "hate"):
        feelings.influence(word, 1.0)
    assert (feelings.intensities["joy"], feelings.intensities["hate"]) == (0.62, 0.175)


def test_who_has_no_personality_feels_nothing():
    feelings = Feelings(somebody(ocean=Ocean(0, 0, 0, 0, 0)))
    for word in OCC_PLACES:
        feelings.influence(word, 1.0)
    assert set(feelings.intensities.values()) == {0.0}


@given(st.lists(st.floats(0.001, 0.05), min_size=2, max_size=9), st.floats(-1, 1), settings)
def test_the_state_does_not_depend_on_how_time_is_cut(cuts, weight, how):
    how = dataclasses.replace(how, mood=None)  # a mood is felt from frame to frame
    times = [0.0, *itertools.accumulate(cuts)]
    who = somebody(how, gains={"kiss": AffectImpulse(emotions={"love": 0.7})})
    felt = []
    for cut in (times, [times[0], times[-1]]):
        feelings = Feelings(who)
        feelings.influence("love", 0.3)
        for time in cut:
            feelings.update("kiss", weight, time)
        felt.append(feelings.intensities["love"])
    assert felt[0] == pytest.approx(felt[1], abs=1e-12)


@pytest.mark.parametrize("word", OCC_PLACES)
def test_each_of_the_24_is_named_shown_and_told_to_a_robot(word):
    feelings = Feelings(somebody())
    feelings.influence(word, 0.8)
    emotion = feelings.update("idle", 0.0, 0.0)
    assert (emotion.word, emotion.intensity) == (word, 0.8)
    assert (emotion.valence, emotion.arousal) == pytest.approx(
        [0.8 * axis for axis in OCC_PLACES[word]]
    )
    faces = ("happy", "sad", "angry", "surprised", "afraid", "disgusted")
    assert closest_word(faces, emotion) == OCC_FACES[word]
    six = Feelings(somebody(labels="ekman"))
    six.influence(word, 0.8)
    assert six.update("idle", 0.0, 0.0).word == OCC_FACES[word]


def test_a_word_leaves_where_another_leads_by_the_hysteresis_and_all_end_neutral():
    feelings = Feelings(somebody(hysteresis=0.1))
    feelings.influence("shame", 0.5)
    assert feelings.update("idle", 0.0, 0.0).word == "shame"
    feelings.influence("relief", 0.55)
    assert feelings.update("idle", 0.0, 0.0).word == "shame"
    feelings.influence("relief", 0.1)
    assert feelings.update("idle", 0.0, 0.0).word == "relief"
    for step in range(90):
        emotion = feelings.update("idle", 0.0, step * STEP_S)
    assert emotion == Emotion(0.0, 0.0, "neutral")


def test_a_mood_outlasts_its_emotions_and_colours_the_next():
    def felt(mood: MoodLayer | None) -> tuple[Emotion, float]:
        feelings = Feelings(somebody(EmotionSettings(decay_per_s=0.2, mood=mood)))
        for _ in range(3):
            feelings.influence("joy", 0.5)
        for step in range(13):
            emotion = feelings.update("idle", 0.0, step * STEP_S)
        assert feelings.intensities["joy"] == 0.0
        feelings.influence("joy", 0.5)
        return emotion, feelings.intensities["joy"]

    plain, joy = felt(None)
    moody, stronger = felt(MoodLayer())
    assert (plain.valence, joy) == (0.0, 0.5)
    assert moody.valence > 0.1
    assert stronger > 1.1 * joy


def test_an_impulse_in_the_plane_raises_what_lies_in_its_direction():
    feelings = Feelings(somebody(events={"praised": AffectImpulse(0.2, 0.1)}))
    feelings.apply_event("praised")
    assert feelings.intensities["joy"] == pytest.approx(0.5)
    assert sum(feelings.intensities.values()) == pytest.approx(0.5)


def test_without_a_state_of_them_emotions_move_valence_and_arousal_and_are_read_from_there():
    feelings = Feelings("lively")
    feelings.influence("fear", 1.0)
    emotion = feelings.update("idle", 0.0, 0.0)
    assert (emotion.valence, emotion.arousal) == pytest.approx((0.12 - 0.64, 0.10 + 0.6))
    assert feelings.intensities["fear"] > 0.7
    assert feelings.intensities["joy"] == 0.0


def test_an_unknown_emotion_or_value_is_refused_and_changes_nothing():
    for name in ("lively", "heartfelt"):
        feelings = Feelings(name)
        before = feelings.intensities
        with pytest.raises(AffectError, match="'envy' is not one of the 24 emotions"):
            feelings.influence("envy", 0.5)
        for value in (-0.1, 1.1, math.nan):
            with pytest.raises(AffectError, match="influence on 'joy' must be from 0 to 1"):
                feelings.influence("joy", value)
        assert feelings.intensities == before
