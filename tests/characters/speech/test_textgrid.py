"""TextGrids in both text forms, and the speech in them."""

import itertools

import numpy as np
import parselmouth
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.phones import fill_pauses
from cubeling.characters.speech.speech import Phone, Speech, Word
from cubeling.characters.speech.textgrid import (
    Interval,
    TextGrid,
    Tier,
    read_textgrid,
    textgrid_of,
    with_textgrid,
    write_textgrid,
)

labels = st.text(st.characters(exclude_categories=("Cs", "Cc", "Zl", "Zp")), max_size=8)


@st.composite
def grids(draw):
    """Return a TextGrid of any labels and times."""
    tiers = []
    for points in draw(st.lists(st.booleans(), max_size=3)):
        cuts = np.cumsum([0.0, *draw(st.lists(st.floats(0.01, 2), min_size=1, max_size=5))])
        rows = [
            Interval(float(a), float(a if points else b), draw(labels))
            for a, b in itertools.pairwise(cuts)
        ]
        tiers.append(Tier(draw(labels), tuple(rows), points))
    return TextGrid(12.0, tuple(tiers))


@given(grids(), st.booleans())
def test_a_written_textgrid_is_read_as_it_was(tmp_path_factory, grid, short):
    path = tmp_path_factory.getbasetemp() / "any.TextGrid"
    write_textgrid(path, grid, short=short)
    read = read_textgrid(path)
    assert read.duration == grid.duration
    assert [(t.name, t.points) for t in read.tiers] == [(t.name, t.points) for t in grid.tiers]
    for ours, theirs in zip(read.tiers, grid.tiers, strict=True):
        assert [i.label for i in ours.intervals] == [i.label for i in theirs.intervals]
        assert [i.start for i in ours.intervals] == pytest.approx(
            [i.start for i in theirs.intervals], abs=1e-6
        )


@pytest.fixture
def speech():
    phones = fill_pauses([Phone("s", 0.1, 0.3), Phone("iː", 0.3, 0.5)], 1.0)
    words = (Word("sea", 0.1, 0.5, 5),)
    return Speech(np.zeros(16_000, np.float32), 16_000, 'the "sea"', "en", words, phones)


@pytest.mark.parametrize("short", [False, True])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be"])
def test_words_and_phones_come_back(tmp_path, speech, short, encoding):
    path = tmp_path / "sea.TextGrid"
    write_textgrid(path, textgrid_of(speech), short=short)
    text = path.read_text("utf-8")
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    path.write_bytes((mark + text).encode(encoding))
    bare = Speech(speech.samples, speech.rate, speech.text, speech.language)
    read = with_textgrid(bare, read_textgrid(path))
    assert read.words == speech.words
    assert read.phones == speech.phones


@pytest.mark.parametrize("short", [False, True])
def test_praat_reads_what_we_write(tmp_path, speech, short):
    path = tmp_path / "sea.TextGrid"
    write_textgrid(path, textgrid_of(speech), short=short)
    grid = parselmouth.read(str(path))
    said = parselmouth.praat.call(grid, "Get label of interval", 2, 3)
    assert parselmouth.praat.call(grid, "Get number of tiers") == 2
    assert said == "iː"


def test_arpabet_becomes_ipa_and_gaps_become_pauses(speech):
    rows = (Interval(0.1, 0.2, "HH"), Interval(0.2, 0.3, "OW1"), Interval(0.6, 0.7, "sp"))
    read = with_textgrid(speech, TextGrid(1.0, (Tier("Anna - phones", rows),)))
    assert [p.symbol for p in read.phones] == ["", "h", "oʊ", ""]
    assert read.phones[-1] == Phone("", 0.3, 1.0)


def test_a_textgrid_of_another_recording_is_refused(speech):
    grid = TextGrid(3.0, (Tier("words", (Interval(0.0, 3.0, "long"),)),))
    with pytest.raises(CharacterError, match=r"ends at 3\.00 s, the recording at 1\.00 s"):
        with_textgrid(speech, grid)


def test_a_textgrid_without_words_or_phones_is_refused(speech):
    with pytest.raises(CharacterError, match="it has: tones"):
        with_textgrid(speech, TextGrid(1.0, (Tier("tones", ()),)))


@given(st.binary(max_size=80))
def test_what_is_no_textgrid_is_one_line(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "none.TextGrid"
    path.write_bytes(b'"ooTextFile" "TextGrid" ' + data)
    with pytest.raises(CharacterError, match="no TextGrid"):
        read_textgrid(path)


phones = st.lists(
    st.builds(Phone, st.sampled_from(["", "a", "s"]), st.floats(-1, 3), st.floats(-1, 3)),
    max_size=8,
)


@given(phones, st.floats(0.1, 2))
def test_filled_phones_have_no_gaps_and_no_two_pauses(given_phones, duration):
    filled = fill_pauses(sorted(given_phones, key=lambda p: p.start), duration)
    assert filled[0].start == 0.0
    assert filled[-1].end == pytest.approx(duration, abs=1e-5)
    for a, b in itertools.pairwise(filled):
        assert a.end == b.start
        assert a.end > a.start
        assert a.symbol or b.symbol
