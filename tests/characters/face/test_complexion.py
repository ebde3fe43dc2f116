"""Blood comes to the face in seconds, and leaves it slowly."""

import math

import numpy as np
import pytest

from cubeling.affect import NEUTRAL, Emotion
from cubeling.characters.face.complexion import (
    FALL_S,
    HAEMOGLOBIN_DENSITY,
    RISE_S,
    Complexion,
    added_density,
    blood_of,
)

ANGRY, AFRAID = Emotion(-0.75, 0.7, "angry"), Emotion(-0.6, 0.8, "afraid")


def blood_after(*spells, rate_hz=30.0):
    """Return the blood after spells of (emotion, seconds)."""
    complexion, now = Complexion(), 0.0
    complexion.update(now, None)
    for emotion, seconds in spells:
        for _ in range(round(seconds * rate_hz)):
            now += 1.0 / rate_hz
            complexion.update(now, emotion)
    return complexion.blood


@pytest.mark.parametrize(("emotion", "full"), [(ANGRY, 1.0), (AFRAID, -1.0)])
def test_it_rises_and_falls_by_its_time_constants(emotion, full):
    risen = blood_after((emotion, RISE_S))
    assert risen == pytest.approx(full * (1.0 - math.exp(-1.0)), rel=1e-6)
    fallen = blood_after((emotion, 20.0), (NEUTRAL, FALL_S))
    assert fallen == pytest.approx(full * math.exp(-1.0), rel=1e-3)


def test_it_does_not_depend_on_the_frame_rate():
    slow, fast = (blood_after((ANGRY, 1.0), (None, 2.0), rate_hz=rate) for rate in (10.0, 60.0))
    assert slow == pytest.approx(fast)


def test_fear_after_anger_turns_red_to_pale_without_a_jump():
    course = [blood_after((ANGRY, 10.0), (AFRAID, 0.2 * step)) for step in range(60)]
    assert course[0] > 0.9
    assert course[-1] < -0.8
    assert max(-np.diff(course)) < 0.2
    assert all(np.diff(course) < 0.0)


def test_stronger_emotions_bring_more_blood():
    flushes = [blood_of(Emotion(-0.2 - 0.1 * k, 0.1 * k, "angry")) for k in range(8)]
    assert flushes == sorted(flushes)
    assert flushes[0] < flushes[-1]


@pytest.mark.parametrize("word", ["happy", "excited", "angry", "shame", "love", "joy"])
def test_these_flush(word):
    assert blood_of(Emotion(0.0, 0.8, word)) > 0.0


@pytest.mark.parametrize("word", ["afraid", "fear", "sad", "depressed", "distress"])
def test_these_pale(word):
    assert blood_of(Emotion(-0.5, 0.0, word)) < 0.0


def test_an_emotion_without_a_word_has_that_of_its_place():
    assert blood_of(Emotion(-0.75, 0.4)) > 0.0
    assert blood_of(Emotion(-0.4, 0.8)) < 0.0
    assert blood_of(Emotion(0.0, 0.0)) == 0.0


def test_rest_is_rest_exactly():
    assert blood_after((NEUTRAL, 1.0)) == 0.0
    assert blood_after((ANGRY, 3.0), (NEUTRAL, 60.0)) == 0.0


def test_time_that_runs_backwards_counts_as_none():
    complexion = Complexion()
    complexion.update(5.0, ANGRY)
    assert complexion.update(4.0, ANGRY) == 0.0


def test_blood_takes_green_and_blue_away_most_and_pallor_gives_them_back():
    red, green, blue = added_density(1.0)
    assert (red, green, blue) == HAEMOGLOBIN_DENSITY
    assert green > blue > 4.0 * red
    assert all(
        0.0 > less > -more
        for less, more in zip(added_density(-1.0), HAEMOGLOBIN_DENSITY, strict=True)
    )
