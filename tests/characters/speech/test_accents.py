"""Pitch accents that are known by construction, and how strong they are."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.speech.prosody.accents import AccentSettings, accents_of, detect_accents
from cubeling.characters.speech.prosody.analysis import utterance_of
from cubeling.characters.speech.prosody.contours import Prosody, measure_prosody
from cubeling.characters.speech.prosody.strength import (
    AccentMeasures,
    ev,
    ev2,
    matthews,
    measure_accents,
    psi,
)
from cubeling.characters.speech.speech import Phone, Speech
from cubeling.characters.speech.tagged_text import TaggedText
from tests.examples import examples

SYLLABLES = (0.3, 0.52, 0.75, 1.0, 1.22, 1.5, 1.75)
ACCENTED = (0.52, 1.0, 1.75)


@pytest.fixture(scope="module")
def sentence(buzz):
    peaks = [(t, 0, 6) if t in ACCENTED else (t, -9, 0) for t in SYLLABLES]
    return buzz(2.0, peaks)


def test_accents_are_found_in_one_long_voiced_region(sentence):
    found = detect_accents(sentence, 16_000)
    assert [a.time for a in found] == pytest.approx(ACCENTED, abs=0.03)
    assert max(a.strength for a in found) == 1.0


def test_only_vowels_are_accented_where_phones_are_known(sentence):
    phones = [Phone("m", 0.0, 0.9), Phone("a", 0.9, 1.1), Phone("m", 1.1, 2.0)]
    found = detect_accents(sentence, 16_000, phones=phones)
    assert [a.time for a in found] == pytest.approx([1.0], abs=0.03)


def test_the_last_syllable_before_a_pause_is_strengthened(sentence):
    prosody = measure_prosody(sentence, 16_000)
    plain = accents_of(prosody, settings=AccentSettings(pause_bonus=0.0))
    raised = accents_of(prosody, settings=AccentSettings(pause_bonus=0.3))
    assert raised[-1].strength / raised[0].strength > plain[-1].strength / plain[0].strength


def random_prosody(seed: int) -> Prosody:
    """Return the prosody of a made-up speech."""
    random = np.random.default_rng(seed)
    times = np.linspace(0.005, 5.995, 600)
    smooth = np.convolve(random.normal(0, 1, 620), np.hanning(21), "same")[10:-10]
    f0 = 150 * 2 ** (np.convolve(random.normal(0, 1, 620), np.hanning(31), "same")[10:-10] / 12)
    f0[smooth < -2] = 0.0
    changes = np.flatnonzero(np.diff(np.concatenate([[False], f0 > 0, [False]]).astype(int)))
    voiced = np.asarray(0.01 * changes.reshape(-1, 2), float)
    return Prosody(times, f0, 4 * smooth - 20, voiced, np.zeros((0, 2)), 6.0)


def test_a_voice_that_goes_away_from_the_microphone_keeps_its_accents():
    prosody = random_prosody(7)
    near = accents_of(prosody)
    away = replace(prosody, intensity=prosody.intensity - 4.0 * prosody.times)  # 24 dB in all
    far = accents_of(away)
    same = {round(a.time, 1) for a in near} & {round(a.time, 1) for a in far}
    assert len(same) >= 0.8 * max(len(near), len(far))


@settings(max_examples=examples(60))
@given(
    st.integers(0, 1000),
    st.lists(st.floats(0, 1), min_size=2, max_size=2).map(sorted),
    st.lists(st.floats(0.01, 1), min_size=2, max_size=2).map(sorted),
)
def test_stricter_settings_find_a_part_of_what_looser_ones_find(seed, thresholds, distances):
    prosody = random_prosody(seed)
    loose = accents_of(prosody, settings=AccentSettings(thresholds[0], distances[0]))
    assert loose
    assert max(a.strength for a in loose) == 1.0
    for threshold, distance in ((thresholds[1], distances[0]), (thresholds[0], distances[1])):
        strict = accents_of(prosody, settings=AccentSettings(threshold, distance))
        assert {a.time for a in strict} <= {a.time for a in loose}
        assert np.all(np.diff([a.time for a in strict]) >= distance)


@pytest.mark.parametrize("count", [0, 1, 500, 16_000])
@pytest.mark.parametrize("loudness", [0.0, 0.1])
def test_silence_and_noise_of_any_length_give_an_answer(count, loudness):
    noise = np.random.default_rng(2).normal(0, loudness, count).astype(np.float32)
    assert len(detect_accents(noise, 16_000)) <= 2


def test_an_utterance_has_accents_and_the_gestures_of_its_text(sentence):
    speech = Speech(sentence, 16_000, "no no", "en")
    tagged = TaggedText.read("no no")
    utterance = utterance_of(speech, tagged)
    assert len(utterance.accents) == len(ACCENTED)
    assert utterance.duration == pytest.approx(2.0)
    assert utterance.gestures == ()


measured = st.builds(
    lambda rows: AccentMeasures(*np.array(rows).T),
    st.lists(
        st.tuples(st.floats(0.02, 0.4), st.floats(0, 0.1), st.floats(0, 12), st.floats(70, 110)),
        min_size=3,
        max_size=30,
    ),
)


@given(measured)
def test_strengths_lie_between_0_and_1(measures):
    for score in (psi, ev, ev2):
        assert np.all((score(measures) >= 0) & (score(measures) <= 1))


@given(measured, st.sampled_from(["duration", "energy", "mean_pitch"]))
def test_psi_grows_with_each_factor(measures, factor):
    arrays = {name: np.append(own, [own[0], own[0]]) for name, own in vars(measures).items()}
    arrays[factor][-2:] = arrays[factor].min(), arrays[factor].max()
    lower, higher = psi(AccentMeasures(**arrays))[-2:]
    assert lower <= higher


def test_loud_flat_accents_rank_higher_by_psi_than_by_ev2():
    # The first is long, loud, high and flat; the others rise more and more.
    measures = AccentMeasures(
        np.array([0.3, 0.1, 0.15, 0.2, 0.25]),
        np.array([0.05, 0.01, 0.02, 0.03, 0.04]),
        np.array([0.0, 2.0, 3.0, 4.0, 5.0]),
        np.array([100.0, 85.0, 86.0, 87.0, 88.0]),
    )
    assert ev2(measures)[0] == 0.0
    assert np.sum(psi(measures) > psi(measures)[0]) < np.sum(ev2(measures) > ev2(measures)[0])


def test_a_falling_accent_has_no_pitch_range():
    times = np.linspace(0.005, 0.395, 40)
    rise = 100 * 2 ** (np.linspace(0, 6, 20) / 12)
    f0 = np.concatenate([rise, rise[::-1]])
    prosody = Prosody(times, f0, np.full(40, -20.0), np.array([[0.0, 0.4]]), np.zeros((0, 2)), 0.4)
    measures = measure_accents(prosody, [(0.0, 0.2), (0.2, 0.4)])
    assert measures.pitch_range == pytest.approx([6.0, 0.0], abs=0.01)
    assert measures.energy == pytest.approx([0.01, 0.01])


def test_labelled_accents_are_told_apart_best_by_psi():
    random = np.random.default_rng(4)
    strong = random.random(600) < 0.5
    flat = random.random(600) < 0.25
    noise = random.normal(0, 1, (4, 600))
    measures = AccentMeasures(
        np.exp(np.log(0.09) + 0.25 * strong + 0.25 * noise[0]),
        np.exp(np.log(0.01) + 0.7 * strong + 0.5 * noise[1]),
        (2.0 + 3.0 * (strong & ~flat) - 1.0 * (strong & flat) + noise[2]).clip(0),
        85.0 + 1.0 * (strong & ~flat) + 5.0 * (strong & flat) + 1.5 * noise[3],
    )
    scores = [
        max(matthews(strong, s > cut) for cut in np.quantile(s, np.linspace(0.05, 0.95, 50)))
        for s in (psi(measures), ev2(measures), ev(measures))
    ]
    assert scores[0] > scores[1] > scores[2]
