"""Stress marks of a voice, and accents that go by them."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.speech.phones import is_vowel
from cubeling.characters.speech.prosody.accents import detect_accents
from cubeling.characters.speech.prosody.analysis import utterance_of
from cubeling.characters.speech.prosody.stress import stressed_like, with_stress
from cubeling.characters.speech.speech import Phone, Speech, Word
from cubeling.characters.speech.voices import espeak
from cubeling.characters.speech.voices.espeak import espeak_installed

needs_espeak = pytest.mark.skipif(not espeak_installed(), reason="eSpeak NG is not installed")


def phones_of(symbols):
    return tuple(Phone(symbol, 0.1 * n, 0.1 * n + 0.1) for n, symbol in enumerate(symbols))


@pytest.mark.parametrize(
    ("symbols", "transcription", "stressed"),
    [
        (["m", "e", "ɣ", "u", "s", "t", "a"], "me ɣˈusta", [3]),
        (["m", "e", "ɣ", "u", "s", "t", "a"], "me ˈɣusta", [3]),  # the mark before the syllable
        (["p", "iː", "", "d", "ɪ"], "pˈiː\nd_ɪ ", [1]),
        (["a", "x", "o"], "a bˈo", [2]),  # the voice and its transcription differ
    ],
)
def test_the_vowel_after_a_mark_is_stressed_and_the_others_are_not(
    symbols, transcription, stressed
):
    found = with_stress(phones_of(symbols), transcription)
    assert [n for n, phone in enumerate(found) if phone.stressed] == stressed
    vowels = [n for n, symbol in enumerate(symbols) if symbol and is_vowel(symbol)]
    assert [n for n, phone in enumerate(found) if phone.stressed is not None] == vowels


@given(st.lists(st.sampled_from(["a", "t", "", "tʃ", "iː"])), st.text("aˈtʃiː _\n", max_size=30))
def test_any_transcription_leaves_symbols_and_times(symbols, transcription):
    before = phones_of(symbols)
    after = with_stress(before, transcription)
    assert [(p.symbol, p.start, p.end) for p in after] == [
        (p.symbol, p.start, p.end) for p in before
    ]


def test_a_clitic_has_no_accent_though_it_is_as_loud(buzz):
    sound = buzz(1.6, [(0.3, 0, 4), (0.8, 0, 4), (1.3, 0, 4)])
    bounds = (0.15, 0.45), (0.65, 0.95), (1.15, 1.45)
    vowels = [
        Phone("a", *each, stressed=stressed)
        for each, stressed in zip(bounds, (True, False, True), strict=True)
    ]
    found = detect_accents(sound, 16_000, phones=vowels)
    assert [accent.time for accent in found] == pytest.approx([0.3, 1.3], abs=0.1)


def test_words_are_stressed_as_a_voice_stresses_them():
    said = Speech(
        np.zeros(1, np.float32), 1, "to gusta", "", (Word("to", 0, 0.2), Word("gusta", 0.2, 0.7)),
        with_stress(phones_of(["t", "o", "g", "u", "s", "t", "a"]), "to gˈusta"),
    )  # fmt: skip
    own = Speech(np.zeros(20, np.float32), 10, "gusta", "", (Word("Gusta", 1.0, 2.0),))
    vowels = [p for p in stressed_like(own, said).phones if p.stressed is not None]
    assert [(p.symbol, p.stressed) for p in vowels] == [("u", True), ("a", False)]
    assert vowels[0].start == pytest.approx(1.2)
    labelled = Speech(np.zeros(20, np.float32), 10, "gusta", "", own.words, (
        Phone("g", 1.0, 1.1), Phone("ʊ", 1.1, 1.5), Phone("s", 1.5, 1.6), Phone("ə", 1.6, 2.0),
    ))  # fmt: skip
    assert [p.stressed for p in stressed_like(labelled, said).phones] == [None, True, None, False]


@needs_espeak
@pytest.mark.slow(reason="a voice speaks three texts")
@pytest.mark.parametrize(
    ("language", "text", "wrong"),
    [
        ("es", "Me gusta mucho, y no te lo digo más.", {"te", "lo", "y"}),
        ("ca", "M'agrada molt la platja amb els nens.", {"la", "els"}),
        ("en", "I thought of the umbrella and of the piano.", {"of", "the", "and"}),
    ],
)
def test_accents_of_a_voice_are_on_its_stressed_vowels(language, text, wrong):
    with espeak() as voice:
        speech = voice.say(text, language)
    accents = utterance_of(speech).accents
    assert len(accents) >= 2
    for accent in accents:
        (phone,) = [p for p in speech.phones if p.start <= accent.time < p.end]
        neighbours = [p for p in speech.phones if abs(p.start - accent.time) < 0.15]
        assert phone.stressed or any(p.stressed for p in neighbours)
        words = {w.text for w in speech.words if w.start <= accent.time < w.end}
        assert not words & wrong
