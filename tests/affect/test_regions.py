"""Regions of the plane of valence and arousal."""

import math

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import NEUTRAL, AffectError, Emotion
from cubeling.affect.regions import SECTOR_WORDS, RegionBox, Sector, on_disc, region_of
from cubeling.affect.words import WORD_PLACES

AXIS = st.floats(-1.0, 1.0)


@given(AXIS, AXIS)
def test_every_emotion_is_neutral_or_in_a_sector(valence: float, arousal: float) -> None:
    emotion = Emotion(valence, arousal)
    regions = [region_of(word) for word in ("neutral", *SECTOR_WORDS)]
    inside = [region.contains(emotion) for region in regions]
    assert any(inside)
    assert sum(inside[1:]) <= 2  # two on the border of two sectors


def test_words_are_in_their_own_regions() -> None:
    for word, place in WORD_PLACES.items():
        assert region_of(word).contains(Emotion(*place), 1e-9)
    assert region_of("neutral").contains(NEUTRAL)
    with pytest.raises(AffectError, match="no emotion is called 'hungry'"):
        region_of("hungry")


def test_a_margin_makes_regions_larger() -> None:
    box, sector = RegionBox((0.2, 0.4), (0.0, 0.5)), Sector(0.0, math.pi / 4, 0.25)
    for region, outside in ((box, Emotion(0.15, 0.1)), (sector, Emotion(0.6, 0.27))):
        assert not region.contains(outside)
        assert region.contains(outside, 0.1)


@given(st.floats(-50, 50), st.floats(-50, 50))
def test_the_disc_holds_every_emotion(valence: float, arousal: float) -> None:
    emotion = on_disc(valence, arousal)
    assert math.hypot(emotion.valence, emotion.arousal) <= 1.0 + 1e-12
    if math.hypot(valence, arousal) <= 1.0:
        assert (emotion.valence, emotion.arousal) == (valence, arousal)
