"""Recordings whose words and phones are known: spoken by another speaker of eSpeak NG."""

import importlib.util
import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.alignment import align, align_with_sphinx
from cubeling.characters.speech.alignment.warping import warp
from cubeling.characters.speech.audio import resample
from cubeling.characters.speech.closures import with_closures
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word
from cubeling.characters.speech.voices import Manner
from cubeling.characters.speech.words import with_every_word
from tests.examples import some

TEXT = "He turned sharply, and faced Gregson across the table."


def word_errors(truth, made):
    assert [word.text for word in made.words] == [word.text for word in truth.words]
    pairs = zip(truth.words, made.words, strict=True)
    return np.array([abs(a.start - b.start) for a, b in pairs])


@pytest.mark.parametrize(
    ("text", "language", "speaker"),
    some(
        [
            ("Schöne Züge fahren langsam.", "de", "de+m1"),
            (TEXT, "en-us", "en-us+m5"),
            ("Bon dia, nens. Avui anirem a la platja.", "ca", "ca+f4"),
        ]
    ),
)
def test_another_speaker_is_aligned(spoken_voice, text, language, speaker):
    truth = with_every_word(spoken_voice.say(text, speaker, Manner(rate=0.85)))
    made = align(Speech(truth.samples, truth.rate), text, spoken_voice, language)
    assert np.median(word_errors(truth, made)) < 0.02
    assert made.phones[0].start == 0.0
    assert made.phones[-1].end == pytest.approx(made.duration)
    assert all(a.end == b.start for a, b in itertools.pairwise(made.phones))


def test_a_pause_that_the_voice_lacks_lies_between_words(spoken_voice):
    truth = spoken_voice.say(TEXT, "en-us+m5")
    cut = truth.words[4].start  # before "faced"
    at = round(cut * truth.rate)
    noise = np.random.default_rng(1).normal(0, 1e-4, truth.rate).astype(np.float32)
    samples = np.concatenate([noise, truth.samples[:at], noise, truth.samples[at:]])
    made = align(Speech(samples, truth.rate), TEXT, spoken_voice, "en-us")
    later = [w.start + (2.0 if w.start >= cut else 1.0) for w in truth.words]
    assert np.abs(np.subtract([w.start for w in made.words], later)).max() < 0.06
    pauses = [p for p in made.phones if p.symbol == SILENCE and p.end - p.start > 0.8]
    assert len(pauses) == 2


@pytest.mark.parametrize("rate", some([8000, 96_000]))
def test_other_sample_rates_are_aligned(spoken_voice, rate):
    truth = spoken_voice.say(TEXT, "en-us+m5")
    samples = resample(truth.samples, truth.rate, rate)
    made = align(Speech(samples, rate), TEXT, spoken_voice, "en-us")
    assert np.median(word_errors(truth, made)) < 0.03


@pytest.mark.parametrize(
    ("samples", "text", "said"),
    [
        (np.zeros(32_000), TEXT, "silent"),
        (np.zeros(10), TEXT, "silent"),
        (np.zeros(0), TEXT, "silent"),
        (np.full(10, 0.1), TEXT, "too short for a word"),
        (np.random.default_rng(1).normal(0, 0.1, 16_000), TEXT * 5, "do not belong together"),
        (np.random.default_rng(1).normal(0, 0.1, 320_000), "Hi", "do not belong together"),
        (np.random.default_rng(1).normal(0, 0.1, 16_000), "...", "nothing to say"),
    ],
)
def test_what_cannot_be_aligned_is_one_line(spoken_voice, samples, text, said):
    with pytest.raises(CharacterError, match=said):
        align(Speech(samples.astype(np.float32), 16_000), text, spoken_voice, "en-us")


def test_an_hour_is_refused_before_work_begins(spoken_voice):
    hour = Speech(np.zeros(3600 * 1000, np.float32), 1000)
    with pytest.raises(CharacterError, match="60 minutes long: cut it in parts of up to 20"):
        align(hour, TEXT, spoken_voice)


@pytest.mark.parametrize("kind", some(["noise", "emoji", "music", "another text"], 2))
def test_what_does_not_fit_gets_the_honest_best(spoken_voice, kind):
    random = np.random.default_rng(3)
    t = np.arange(48_000) / 16_000
    chords = sum(np.sin(2 * np.pi * f * t) for f in (220, 277, 330)) * (0.3 + 0.2 * np.sin(7 * t))
    samples = {"noise": random.normal(0, 0.1, 48_000), "music": 0.2 * chords}.get(kind)
    if samples is None:
        samples = spoken_voice.say("My brother wants a yellow bicycle.", "en-us").samples
    text = "She left 😀 early" if kind == "emoji" else TEXT
    made = align(Speech(samples.astype(np.float32), 16_000), text, spoken_voice, "en-us")
    assert made.words
    assert all(a.end <= b.start + 1e-9 for a, b in itertools.pairwise(made.words))


def test_a_stop_begins_when_the_mouth_closes():
    rate = 16_000
    t = np.arange(rate // 2) / rate
    voice = np.where((t < 0.2) | (t > 0.25), np.sin(2 * np.pi * 150 * t), 0.0)
    phones = (Phone("a", 0.0, 0.25), Phone("p", 0.25, 0.3), Phone("a", 0.3, 0.5))
    closed = with_closures(Speech(voice.astype(np.float32), rate, phones=phones))
    assert closed.phones[1].start == pytest.approx(0.2, abs=0.01)
    assert closed.phones[0].end == closed.phones[1].start
    assert closed.phones[2] == phones[2]


def test_words_that_the_voice_runs_together_have_their_own_times():
    phones = tuple(Phone(s, 0.1 * n, 0.1 * (n + 1)) for n, s in enumerate("təbiɡə"))
    merged = Speech(
        np.zeros(9600, np.float32),
        16_000,
        "to be go",
        words=(Word("to", 0.0, 0.4, 0), Word("go", 0.4, 0.6, 6)),
        phones=phones,
    )
    words = with_every_word(merged).words
    assert [(w.text, w.offset) for w in words] == [("to", 0), ("be", 3), ("go", 6)]
    assert [w.start for w in words] == pytest.approx([0.0, 0.2, 0.4])


@given(st.integers(0, 100), st.integers(2, 40))
def test_a_warped_path_never_falls_and_ends_at_the_end(seed, count):
    random = np.random.default_rng(seed)
    template = random.normal(0, 1, (count, 4)).astype(np.float32)
    features = template[np.sort(random.integers(0, count, count))]
    path = warp(features, template)
    steps = np.diff(path)
    assert path[0] in (0, 1)
    assert path[-1] == count - 1
    assert steps.min(initial=0) >= 0
    assert steps.max(initial=0) <= 2


def test_the_banded_path_of_a_long_sequence_is_that_of_the_whole(monkeypatch):
    random = np.random.default_rng(1)
    template = (np.cumsum(random.normal(0, 1, (1500, 6)), 0) / 5).astype(np.float32)
    at = np.interp(np.linspace(0, 1, 1500), [0, 0.4, 1], [0, 0.5, 1]) * 1499
    features = template[at.astype(int)]
    whole = warp(features, template)
    monkeypatch.setattr("cubeling.characters.speech.alignment.warping.MAX_CELLS", 250_000)
    monkeypatch.setattr("cubeling.characters.speech.alignment.warping.BAND", 100)
    banded = warp(features, template)
    assert np.mean(np.abs(banded - whole) <= 2) > 0.99


needs_sphinx = pytest.mark.skipif(
    importlib.util.find_spec("pocketsphinx") is None, reason="PocketSphinx is not installed"
)


@needs_sphinx
def test_pocketsphinx_aligns_words_that_it_does_not_know(spoken_voice):
    text = "He turned 7 sharply, and faced Gregsonn."
    truth = spoken_voice.say(text, "en-us+f2")
    made = align_with_sphinx(Speech(truth.samples, truth.rate), text, spoken_voice)
    assert np.median(word_errors(truth, made)) < 0.04
    assert {p.symbol for p in made.phones} >= {"", "ʃ", "f"}


@needs_sphinx
@pytest.mark.parametrize("text", ["", "😀"])
def test_pocketsphinx_without_words_is_one_line(spoken_voice, text):
    speech = replace(spoken_voice.say("Hello"), words=())
    with pytest.raises(CharacterError, match="no words"):
        align_with_sphinx(speech, text, spoken_voice)


@needs_sphinx
def test_pocketsphinx_refuses_what_is_not_said(spoken_voice):
    speech = Speech(np.zeros(4000, np.float32), 16_000)
    with pytest.raises(CharacterError, match="does not find"):
        align_with_sphinx(speech, TEXT, spoken_voice)
