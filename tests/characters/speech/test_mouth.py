"""The mouth follows the sound alone: vowels by their formants, hisses, pauses, and how soon."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.speech.mouth import MouthTracker, phones_from_sound
from tests.examples import examples

FORMANTS = {"a": (750, 1200, 2500), "i": (280, 2300, 2900), "u": (330, 750, 2300)}
BLOCK_S = 0.01


def vowel(symbol, seconds, rate, pitch=130.0):
    """Return harmonics with the formants of a vowel, each 12 dB below the one before."""
    t = np.arange(round(seconds * rate)) / rate
    sound = np.zeros(len(t))
    for k in range(1, int(min(4000, rate / 2) / pitch)):
        gains = [
            4.0**-n * np.exp(-(((k * pitch - f) / 120) ** 2))
            for n, f in enumerate(FORMANTS[symbol])
        ]
        sound += (max(gains) + 1e-3) * np.sin(2 * np.pi * k * pitch * t)
    return (0.3 * sound / np.abs(sound).max()).astype(np.float32)


def hiss(seconds, rate):
    noise = np.random.default_rng(1).normal(0, 0.05, round(seconds * rate))
    return np.diff(noise, prepend=0.0, n=2).astype(np.float32)


@pytest.mark.parametrize("rate", [8000, 16_000, 48_000])
def test_vowels_and_pauses_are_heard(rate):
    pause = np.zeros(round(0.2 * rate), np.float32)
    parts = [pause, *(part for v in "aiu" for part in (vowel(v, 0.3, rate), pause))]
    phones = phones_from_sound(np.concatenate(parts), rate)
    assert [p.symbol for p in phones] == ["", "a", "", "i", "", "u", ""]
    assert [p.start for p in phones[1::2]] == pytest.approx([0.2, 0.7, 1.2], abs=0.03)


def test_a_hiss_is_heard():
    sound = np.concatenate([vowel("a", 0.3, 16_000), hiss(0.3, 16_000)])
    assert [p.symbol for p in phones_from_sound(sound, 16_000)] == ["a", "s"]


@pytest.mark.parametrize("rate", [8000, 16_000, 48_000])
def test_the_mouth_is_less_than_60_ms_behind(rate):
    quiet = np.zeros(rate // 2, np.float32)
    sound = np.concatenate([quiet, vowel("a", 0.5, rate), quiet])
    tracker, block = MouthTracker(rate), round(BLOCK_S * rate)
    opened = np.array(
        [tracker.update(sound[at : at + block]).open for at in range(0, len(sound), block)]
    )
    heard = BLOCK_S * (1 + np.arange(len(opened)))  # when each block has come in whole
    assert 0.5 < heard[opened > 0.5][0] <= 0.5 + 0.06
    assert 1.0 < heard[opened > 0.5][-1] <= 1.0 + 0.06
    assert opened[-1] < 0.01


@settings(max_examples=examples(20))
@given(st.integers(0, 100))
def test_blocks_of_any_length_give_the_same_mouth(seed):
    random = np.random.default_rng(seed)
    sound = np.concatenate([vowel("a", 0.2, 16_000), hiss(0.1, 16_000)])
    cuts = np.sort(random.integers(0, len(sound), 9))
    whole, pieces = MouthTracker(16_000), MouthTracker(16_000)
    for part in np.split(sound, cuts):
        last = pieces.update(part)
    at_once = whole.update(sound)
    for name, value in vars(at_once).items():
        assert getattr(last, name) == pytest.approx(value, abs=1e-6)
    assert sum(vars(last).values()) <= 1.0 + 1e-9


@pytest.mark.parametrize("value", [0.0, np.nan, 1e-5])
def test_silence_keeps_the_mouth_closed(value):
    weights = MouthTracker(16_000).update(np.full(8000, value, np.float32))
    assert sum(vars(weights).values()) == 0.0


@pytest.mark.parametrize("count", [0, 1, 100])
def test_a_very_short_sound_is_a_pause(count):
    phones = phones_from_sound(np.zeros(count, np.float32), 16_000)
    assert [p.symbol for p in phones] == ([""] if count else [])
