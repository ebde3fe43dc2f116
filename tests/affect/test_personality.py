"""Personalities from TOML: the bundled ones are whole, and what is wrong is said in one line."""

import dataclasses
import math

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion, Personality
from cubeling.affect.errors import AffectError
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.personality_file import bundled_names, bundled_text
from cubeling.affect.traits import Ocean

trait = st.floats(0, 1)
anyone = st.builds(Ocean, trait, trait, trait, trait, trait)


def test_the_bundled_personalities():
    assert bundled_names() == ("thesis", "calm", "grumpy", "heartfelt", "lively", "shy")
    for name in bundled_names():
        who = Personality.load(name)
        assert who.name == name
        assert who.description
        assert {"kiss", "shout"} <= who.gains.keys()


def test_one_of_your_own_is_read_from_a_file(tmp_path):
    path = tmp_path / "moody.toml"
    path.write_text(bundled_text("lively").replace('name = "lively"\n', ""), encoding="utf-8")
    assert Personality.load(str(path)) == dataclasses.replace(
        Personality.load("lively"), name="moody"
    )


def test_what_a_file_leaves_out_is_the_default():
    assert Personality.parse("", "who.toml") == Personality("who")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("half = 3", "who.toml: half means nothing here; there are name"),
        (
            "gains.kiss.speed = 3",
            "who.toml: gains.kiss.speed means nothing here; there are valence, ar",
        ),
        ("ocean.height = 0.5", "who.toml: ocean.height means nothing here; there are openness"),
        ("movement.valence = 0.5", "movement.valence means nothing here; there are arousal"),
        ("temperament.valence = 1.5", "temperament.valence must be a number from -1 to 1, not 1.5"),
        ("temperament.valence = nan", "temperament.valence must be a number from -1 to 1, not nan"),
        ("half_life_s.valence = 0", "half_life_s.valence must be from 0.05 to inf, not 0"),
        ("half_life_s.arousal = -inf", "half_life_s.arousal must be from 0.05"),
        ("gains.kiss.valence = 99", "gains.kiss.valence must be from -10 to 10, not 99"),
        ("gains.kiss = 0.1", "gains.kiss must be a table of valence, arousal, joy, "),
        ("events.shaken.arousal = 3", "events.shaken.arousal must be from -2 to 2, not 3"),
        ("movement.arousal = 9", "movement.arousal must be from -2 to 2, not 9"),
        ("hysteresis = 0.5", "hysteresis must be from 0 to 0.25, not 0.5"),
        ("dwell_s = -1", "dwell_s must be from 0 to 60, not -1"),
        ("dwell_s = true", "dwell_s must be a number, not True"),
        ('dwell_s = "1"', "dwell_s must be a number, not '1'"),
        ("ocean.neuroticism = 2", "ocean.neuroticism must be a number from 0 to 1, not 2"),
        ("ocean = 3", "ocean must be a table of openness, "),
        ("labels = 3", "labels must be a text, not 3"),
        ('labels = "plutchik"', "there is no label set 'plutchik': choose one of thesis"),
        ("gains.kiss.joy = -1", "gains.kiss.joy must be from 0 to 10, not -1"),
        ("emotions.half = 3", "emotions.half means nothing here; there are matrix, decay, "),
        ("emotions.rows.envy = [0, 0, 0, 0, 1]", "emotions.rows: 'envy' is not one of the 24 emo"),
        ("emotions.rows.joy = [0, 0, 1]", "emotions.rows.joy must be a list of 5 numbers, not"),
        ('emotions.matrix = "occ"', "emotions.matrix must be one of alma, thesis, not 'occ'"),
        ("emotions.mood.share = 2", "emotions.mood.share must be a number from 0 to 1, not 2"),
        ('arousal = "some"', "arousal must be 'own' or 'magnitude', not 'some'"),
        ("[gains", "who.toml: "),
    ],
)
def test_what_is_wrong_is_said_in_one_line_with_file_key_and_range(text, says):
    with pytest.raises(AffectError) as refusal:
        Personality.parse(text, "who.toml")
    assert says in str(refusal.value)
    assert str(refusal.value).startswith("who.toml: ")
    assert "\n" not in str(refusal.value)


def test_a_name_or_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(AffectError, match="no personality 'rude': choose one of thesis, calm"):
        Personality.load("rude")
    with pytest.raises(AffectError, match=r"cannot read .*rude.toml': No such"):
        Personality.load(str(tmp_path / "rude.toml"))
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(AffectError, match="not UTF-8"):
        Personality.load(str(tmp_path / "bytes.toml"))


def test_the_thesis_example_responds_as_the_specification_computes():
    example = Ocean(0.8, 0.1, 0.7, 0.5, 0.05)
    assert example.responses == (0.62, 0.175)


@given(anyone, st.floats(0.01, 2), st.floats(0.01, 2))
def test_the_response_of_two_personalities_is_in_the_ratio_of_their_traits(ocean, up, down):
    gains = {"kiss": AffectImpulse(valence=up), "shout": AffectImpulse(valence=-down)}
    plain = Personality("w", gains=gains)
    who = dataclasses.replace(plain, ocean=ocean)
    good, bad = ocean.responses
    assert who.gain("kiss").valence == pytest.approx(up * good)
    assert who.gain("shout").valence == pytest.approx(-down * bad)
    assert plain.gain("kiss").valence == up
    assert 0 <= good <= 1
    assert 0 <= bad <= 1


def test_who_has_no_personality_does_not_respond():
    who = Personality("w", gains={"kiss": AffectImpulse(1.0, 1.0)}, ocean=Ocean(0, 0, 0, 0, 0))
    assert who.gain("kiss") == AffectImpulse(0.0, 0.0)


@given(anyone)
def test_traits_give_a_temperament_within_neutral(ocean):
    home = ocean.temperament
    assert abs(home.valence) <= 0.33 + 1e-3
    assert math.hypot(home.valence, home.arousal) < 0.5


def test_agreeable_people_are_at_home_where_it_is_pleasant_and_nervous_ones_where_it_is_stirred():
    plain, kind = Ocean().temperament, Ocean(agreeableness=0.9).temperament
    nervous = Ocean(neuroticism=0.9).temperament
    assert plain == Emotion(0, 0)
    assert kind.valence > 0.1
    assert nervous.valence < 0 < nervous.arousal


def test_traits_set_the_temperament_only_where_the_file_does_not():
    traits = "ocean = { agreeableness = 1.0 }\n"
    assert Personality.parse(traits, "w").temperament == Ocean(agreeableness=1.0).temperament
    stated = Personality.parse(traits + "temperament.valence = -0.1", "w")
    assert stated.temperament == Emotion(-0.1, 0.0)
