"""What a speech does besides gestures: shifts, beats, arms, eyes, words on the face, blinks."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.affect import Emotion
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.speaking.aversions import Aversions
from cubeling.characters.control.speaking.beats import syllable_clock, syllable_swing
from cubeling.characters.control.speaking.shifts import AT_TOPIC, WITHIN_TOPIC_HZ, shift_times
from cubeling.characters.control.speaking.spoken import SpokenBody, SpokenMovement
from cubeling.characters.control.speech_profile import SpeechProfile
from cubeling.characters.face.blink import BlinkTimer
from cubeling.characters.face.word_emotion import emotion_at, emotions_of, face_of, told_emotion
from cubeling.characters.speech.prosody.phrases import Phrase, phrases_of
from cubeling.characters.speech.speech import (
    Accent,
    GestureSpan,
    Phone,
    Syllable,
    Utterance,
    Word,
)
from cubeling.characters.speech.tagged_text import TaggedText
from tests.examples import examples

HAPPY, ANGRY = Emotion(0.7, 0.6, "happy"), Emotion(-0.7, 0.6, "angry")


def said(text, seconds_a_word=0.4, gestures=()):
    """Return an utterance whose words follow each other evenly."""
    offsets, at = [], 0
    for word in text.split():
        at = text.index(word, at)
        offsets.append((word.strip(".,!?"), at))
        at += len(word)
    words = tuple(
        Word(word, n * seconds_a_word, (n + 0.9) * seconds_a_word, offset)
        for n, (word, offset) in enumerate(offsets)
    )
    end = seconds_a_word * len(words)
    syllables = tuple(
        Syllable(word.start + 0.1, 0.2 + 0.2 * (n % 4)) for n, word in enumerate(words)
    )
    accents = tuple(Accent(s.time, 0.6 + 0.1 * (n % 4)) for n, s in enumerate(syllables[1::3]))
    phones = (Phone("a", 0.0, end),)
    return Utterance(text, "en", end, words, phones, accents, tuple(gestures), syllables)


LONG = "One two three, four five six. " * 6


def test_phrases_end_at_punctuation_and_an_empty_line_opens_a_topic():
    text = TaggedText.read("Come in, please. <topic/>Now look.").text
    phrases = phrases_of(said(text))
    assert [each.text.strip() for each in phrases] == ["Come in,", "please.", "Now look."]
    assert [each.opens_topic for each in phrases] == [False, False, True]
    assert [each.ends_sentence for each in phrases] == [False, True, True]


def test_phrases_without_words_end_at_pauses():
    phones = (Phone("a", 0.0, 1.0), Phone("", 1.0, 1.4), Phone("a", 1.4, 2.0), Phone("", 2.0, 2.1))
    found = phrases_of(Utterance("", "", 2.1, (), phones))
    assert [(each.start, each.end) for each in found] == [(0.0, 1.0), (1.4, 2.0)]


def test_weight_shifts_mostly_at_topics_and_seldom_within_them():
    phrases = [
        Phrase(2.0 * n, 2.0 * n + 1.8, opens_topic=n % 10 == 0 and n > 0) for n in range(4000)
    ]
    times = np.array(shift_times(phrases, np.random.default_rng(1)))
    at_topic = np.isclose(np.mod(times + 0.25, 20.0), 0.0)
    assert at_topic.sum() / 399 == pytest.approx(AT_TOPIC, abs=0.06)
    assert (~at_topic).sum() / 8000.0 == pytest.approx(0.9 * WITHIN_TOPIC_HZ, rel=0.2)


@settings(max_examples=examples(30))
@given(st.integers(0, 10**6))
def test_a_body_comes_back_to_rest_without_jumps(seed):
    utterance = said(LONG)
    rows = SpokenMovement.of(utterance, phrases_of(utterance), (2.0, 4.0), seed).rows
    assert not rows[0].any()
    assert np.abs(rows[-1]).max() < 1e-9
    # Largest steps of a frame: pelvis [legs], turns of the trunk and the arms [degrees].
    steps = np.abs(np.diff(rows, axis=0)).max(axis=0)
    assert steps[3:6].max() < 0.006
    assert steps[6:26].max() < 3.0


def test_hands_keep_the_time_of_accents_and_linger_in_pauses():
    syllables = tuple(Syllable(t, 0.9) for t in (0.3, 0.5, 0.7, 2.1, 2.3, 2.5))
    utterance = Utterance("", "", 3.0, accents=(Accent(0.7, 1.0), Accent(2.3, 1.0)),
                          syllables=syllables)  # fmt: skip
    times = np.arange(-0.5, 3.5, 0.01)
    shown = times + syllable_clock(times, utterance)
    pace = np.gradient(shown, times)
    assert (np.diff(shown) >= 0.0).all()
    assert np.interp([0.0, 0.7, 2.3, 3.0], times, shown) == pytest.approx(
        [0.0, 0.7, 2.3, 3.0], abs=0.02
    )
    assert np.interp(2.1, times, pace) > 1.5 * np.interp(1.4, times, pace)
    swing = np.abs(np.gradient(syllable_swing(times, syllables), times))
    assert np.interp(1.4, times, swing) == 0.0
    assert all(swing[np.abs(times - each.time) < 0.03].max() > 1.0 for each in syllables)


@settings(max_examples=examples(50))
@given(st.integers(0, 10**6))
def test_eyes_are_away_before_the_first_word_and_back_before_the_end(seed):
    utterance = Utterance("", "", 20.0, phones=(Phone("a", 0.0, 20.0),))
    looks = Aversions(utterance, np.random.default_rng(seed))
    assert looks.at(-0.15) is not None
    assert looks.at(19.9) is None
    away = [looks.at(t) is not None for t in np.arange(-2.0, 20.0, 0.05)]
    assert 0.1 < np.mean(away) < 0.4


def test_a_live_voice_of_unknown_words_keeps_the_eyes_on_the_listener():
    looks = Aversions(Utterance("", "", 1.3), np.random.default_rng(0))
    assert all(looks.at(t) is None for t in np.arange(-2.0, 3.0, 0.1))


@pytest.mark.parametrize(
    ("sentence", "language", "word"),
    [
        ("You lied to me!", "en", "angry"),
        ("How could you do that to such a nice friend?", "en", "angry"),
        ("I am not happy.", "en", "sad"),
        ("Do not be afraid.", "en", None),
        ("The table is made of wood.", "en", None),
        ("Me mentiste.", "es", "angry"),
        ("Muchas gracias, amigo.", "es-419", "happy"),
        ("You lied to me!", "ca", None),
    ],
)
def test_words_tell_an_emotion(sentence, language, word):
    told = told_emotion(sentence, language)
    assert (told and told.word) == word


def test_who_is_happy_and_accuses_does_not_smile_meanwhile():
    utterance = said("Good morning to you. You lied to me! The door is open.")
    told = emotions_of(utterance, phrases_of(utterance))
    assert emotion_at(told, 0.2) is None
    accusing = face_of(HAPPY, emotion_at(told, 2.5))
    assert accusing is not None
    assert accusing.word == "angry"
    assert face_of(HAPPY, emotion_at(told, 5.5)) is HAPPY


def test_kind_words_make_nobody_smile_who_is_angry():
    assert face_of(ANGRY, HAPPY) is ANGRY
    assert face_of(None, HAPPY) is HAPPY


def test_a_tag_for_the_face_goes_before_its_words():
    utterance = said("You lied to me!", gestures=[GestureSpan("happy", 0.0, 1.0)])
    assert not emotions_of(utterance, phrases_of(utterance))


def test_without_liveliness_only_the_head_nods():
    speech = SpeechIntent(said(LONG), 0.0, SpeechProfile(liveliness=0.0))
    body = SpokenBody(speech, 0, own_shifts=True)
    body.advance(0.45)
    state = body.state(1 / 30, 1.0, 1.0)
    assert not body.arms.any()
    assert body.gesture_time == 0.45
    assert state.nod.any()
    assert (state.stance, state.aversion, state.emotion) == (None, None, None)


@pytest.mark.parametrize(("talking", "rate"), [(False, 17.0), (True, 26.0)])
def test_blinks_are_as_frequent_as_those_of_people(talking, rate):
    timer, closed, ends = BlinkTimer(3), [], []
    for frame in range(30 * 60 * 20):
        ends.append(talking and frame % 80 == 0)
        closed.append(timer.update(1 / 30, talking=talking, phrase_ends=ends[-1]) > 0.0)
    starts = np.flatnonzero(np.diff(np.array(closed, int)) == 1)
    assert len(starts) / 20 == pytest.approx(rate, rel=0.07)
    if talking:  # more come with the end of a phrase than by chance
        with_end = np.mean([any(ends[max(s - 2, 0) : s + 3]) for s in starts.tolist()])
        assert with_end > 0.3
