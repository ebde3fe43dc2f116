"""Viseme sets: every sound of every language has a class, and the printed tables are kept."""

import pytest
from hypothesis import given, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.face.visemes.ipa import letters_of, parts_of
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES, viseme_set, viseme_sets

# What eSpeak NG 1.52 prints for texts with all sounds of each language, by the shape that a person
# who reads lips would name; where two are as good, both.
RECORDED = {
    "PP": "b p m bʰ pʰ",
    "FF": "f v ʋ",
    "TH": "θ ð",
    "DD": "d t dˤ t̪ ɖ ɖʰ ʈʰ dʰ tʲ dʲ ɾ r",
    "kk": "k ɡ ŋ x ɣ q χ ʁ h ħ ʕ ʔ ɴ",
    "CH": "tʃ dʒ ʃ ʒ ɕ ʑ ʂ",
    "SS": "s z s̪ s.",
    "nn": "n l ɲ ʎ ɳ ɭ",
    "RR": "ɹ ɜː",
    "aa": "a ɑː ɑ ɐ ʌ æ ɑ̃ ä aː",
    "E": "ɛ e ə eː ɛː ɛ̃ e̞",
    "I": "i iː ɪ j ɨ ç ʝ ɯᵝ i.",
    "O": "ɔ ɔː o oː ɒ ø œ øː ɔ̃ o̞ œ̃ ɵ",
    "U": "u uː w ʊ y yː ʉ",
}
JOINED = {
    "aɪ": "aa I", "aʊ": "aa U", "eɪ": "E I", "ɔɪ": "O I", "eə": "E E", "ts": "DD SS",
    "pf": "PP FF", "dz": "DD SS", "əl": "E nn", "aɪə": "aa I E", "ju": "I U", "yɛ": "U E",
    "onɡ": "O nn kk", "tɕ": "DD CH", "sx": "SS kk", "tʃʲ": "CH",
}  # fmt: skip


@pytest.mark.parametrize("shape", RECORDED)
def test_recorded_phones_have_the_shape_that_they_show(shape):
    found = viseme_set("oculus")
    for symbol in RECORDED[shape].split():
        assert [each.viseme.name for each in found.of(symbol)] == [shape], symbol


@pytest.mark.parametrize("symbol", JOINED)
def test_diphthongs_and_affricates_are_said_in_parts_unless_the_set_knows_them(symbol):
    found = viseme_set("oculus").of(symbol)
    assert " ".join(each.viseme.name for each in found) == JOINED[symbol]
    assert sum(each.share for each in found) == pytest.approx(1.0)


@pytest.mark.parametrize("name", viseme_sets())
@given(symbol=st.text(max_size=6))
def test_no_symbol_whatever_is_refused(name, symbol):
    for each in viseme_set(name).of(symbol):
        assert each.viseme in viseme_set(name).visemes
    assert sum(share for _, share in parts_of(symbol)) == pytest.approx(
        int(letters_of(symbol) != ())
    )


@pytest.mark.parametrize("name", viseme_sets())
def test_every_phone_of_a_table_is_in_one_class_and_every_shape_is_whole(name):
    visemes = viseme_set(name).visemes
    phones = [phone for viseme in visemes for phone in viseme.phones]
    assert len(phones) == len(set(phones))
    for viseme in visemes:
        assert set(viseme.shape) <= set(MOUTH_SHAPES)
        assert 0.5 < sum(viseme.shape.values()) <= 1.0
        for phone in viseme.phones:
            assert [each.viseme for each in viseme_set(name).of(phone)] == [viseme]


def test_the_sets_have_their_printed_sizes_and_parameters():
    assert [len(each.visemes) for each in viseme_sets().values()] == [15, 15, 15, 22]
    sapi = {each.name: each for each in viseme_set("sapi").visemes}
    assert (sapi["21"].spread, sapi["21"].weight, sapi["21"].alpha) == (3.0, 1.5, 3.0)
    assert (sapi["02"].spread, sapi["16"].weight, sapi["00"].spread) == (5.0, 1.2, 2.0)


def test_the_corrected_table_keeps_rounded_and_spread_vowels_apart():
    printed, corrected = viseme_set("thesis"), viseme_set("thesis-corrected")
    assert printed.of("ɔ")[0].viseme == printed.of("i")[0].viseme
    assert corrected.of("ɔ")[0].viseme != corrected.of("i")[0].viseme
    assert corrected.of("aʊ")[0].viseme == corrected.of("oʊ")[0].viseme


def test_lips_only_come_near_each_other_in_spanish_b_between_vowels():
    assert viseme_set("oculus").of("b")[0].contact
    assert not viseme_set("oculus").of("β")[0].contact


def test_an_unknown_set_is_refused():
    with pytest.raises(CharacterError, match="no set of visemes is called 'klingon'"):
        viseme_set("klingon")
