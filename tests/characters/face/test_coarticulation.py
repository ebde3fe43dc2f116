"""Coarticulation: the published curves and shares, contacts, emphasis, and no jumps."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.face.visemes.coarticulation import (
    Coarticulation,
    MouthTrack,
    dominance,
    level_weights,
)
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES, viseme_sets
from cubeling.characters.speech.speech import SILENCE, Accent, Phone, Utterance
from tests.examples import examples

PUBLISHED = Coarticulation("sapi", sharpness=1.0, contacts=False)


def spoken(*phones: tuple[str, float], accents: tuple[Accent, ...] = ()) -> Utterance:
    """Return an utterance of phones with their lengths [s]."""
    ends = np.cumsum([length for _, length in phones]).tolist()
    starts = [0.0, *ends[:-1]]
    made = (Phone(p, a, b) for (p, _), a, b in zip(phones, starts, ends, strict=True))
    return Utterance("", "en", ends[-1], phones=tuple(made), accents=accents)


@pytest.mark.parametrize(
    ("alpha", "value"), [(1, 0.4226), (2, 0.3002), (3, 0.1982), (5, 0.0787), (10, 0.0067)]
)
def test_dominance_has_the_printed_values(alpha, value):
    assert dominance(0.25, alpha) == pytest.approx(value, abs=5e-5)
    assert dominance(0.75, alpha) == pytest.approx(value, abs=5e-5)
    assert [dominance(x, alpha) for x in (0.0, 0.5, 1.0)] == pytest.approx([0, 1, 0], abs=1e-12)


def test_without_steepness_dominance_is_a_triangle():
    assert [dominance(x, 0.0) for x in (0.0, 0.25, 0.5, 0.75)] == [0.0, 0.5, 1.0, 0.5]


def test_dominance_alone_gives_a_p_57_percent_of_the_mouth():
    track = MouthTrack(spoken(("ɑ", 0.1), ("p", 0.08), ("ɑ", 0.1)), PUBLISHED)
    active, shares = track.shares(0.14)
    assert shares[2 - active.start] == pytest.approx(0.5702, abs=5e-5)


phones = st.lists(
    st.tuples(st.sampled_from("pbmfvtsnkwɑiuəɹ" + SILENCE), st.floats(0.03, 0.4)),
    min_size=1,
    max_size=12,
)


@pytest.mark.parametrize("name", viseme_sets())
@settings(max_examples=examples(25), deadline=None)
@given(phones=phones, emphasis=st.floats(-1, 1), strength=st.floats(0, 1))
def test_shares_sum_to_one_and_never_jump(name, phones, emphasis, strength):
    said = spoken(*phones, accents=(Accent(0.2, strength),))
    track = MouthTrack(said, Coarticulation(name))
    times = np.arange(-0.5, said.duration + 0.5, 1 / 240)
    shapes = np.array([track.at(time, emphasis) for time in times.tolist()])
    assert shapes.sum(axis=(1, 2)) == pytest.approx(1.0)
    assert shapes.min() >= 0
    assert np.abs(np.diff(shapes, axis=0)).max() < 0.45  # a contact forms in 15 ms at the fastest


@pytest.mark.parametrize("name", viseme_sets())
@pytest.mark.parametrize("rate", [3.0, 5.0, 8.0])
@pytest.mark.parametrize(
    ("phone", "shape"), [("p", "PP"), ("b", "PP"), ("m", "PP"), ("f", "FF"), ("v", "FF")]
)
def test_contacts_are_complete_in_a_frame_of_each_and_the_vowel_opens(name, rate, phone, shape):
    length = 1 / rate
    said = spoken(*[("ɑ", length), (phone, length)] * 4, ("ɑ", length))
    track = MouthTrack(said, Coarticulation(name))
    frames = np.arange(0, said.duration, 1 / 30)
    share = np.array([track.at(time).sum(axis=0)[MOUTH_SHAPES.index(shape)] for time in frames])
    for number in range(1, 9, 2):
        within = (frames >= number * length) & (frames < (number + 1) * length)
        assert share[within].max() == pytest.approx(1.0)
    for number in range(0, 9, 2):
        within = (frames >= number * length) & (frames < (number + 1) * length)
        assert share[within].min() < 0.35


def test_lips_begin_to_close_before_the_sound():
    track = MouthTrack(spoken(("ɑ", 0.2), ("m", 0.1), ("ɑ", 0.2)))
    closed = [
        track.at(time).sum(axis=0)[MOUTH_SHAPES.index("PP")] for time in (0.13, 0.17, 0.195, 0.25)
    ]
    assert closed[0] < 0.1
    assert closed[0] < closed[1] < closed[2] < closed[3] == pytest.approx(1.0)


def test_lips_round_before_a_rounded_vowel():
    track = MouthTrack(spoken(("i", 0.15), ("s", 0.1), ("t", 0.08), ("u", 0.15)))
    rounded = [
        track.at(time).sum(axis=0)[MOUTH_SHAPES.index("U")] for time in (0.05, 0.24, 0.31, 0.4)
    ]
    assert rounded[0] < 0.02 < rounded[1] < rounded[2] < rounded[3]


def test_levels_are_low_neutral_and_high_at_the_printed_strengths():
    assert [level_weights(s) for s in (0.0, 0.5, 1.0)] == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    assert level_weights(0.5 - 1e-9) == pytest.approx(level_weights(0.5 + 1e-9), abs=1e-8)


def test_emphasis_counts_for_accented_vowels_alone():
    said = spoken(("ɑ", 0.2), ("t", 0.1), ("ɑ", 0.2), accents=(Accent(0.1, 0.6),))
    track = MouthTrack(said, Coarticulation(sharpness=8.0))
    aa = MOUTH_SHAPES.index("aa")
    high = [track.at(0.1, emphasis)[2, aa] for emphasis in (-1.0, 0.0, 0.2, 1.0)]
    assert all(a < b for a, b in pairwise(high))
    assert track.at(0.4, 1.0)[1, aa] == pytest.approx(track.at(0.4, 1.0)[:, aa].sum(), abs=1e-3)


def test_a_symbol_without_a_letter_belongs_to_the_phone_before_it():
    plain = MouthTrack(spoken(("ɑ", 0.3), ("p", 0.1)))
    marked = MouthTrack(spoken(("ɑ", 0.2), ("(en)", 0.1), ("p", 0.1)))
    assert marked.at(0.15) == pytest.approx(plain.at(0.15))
