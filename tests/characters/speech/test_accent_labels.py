"""Labels of people are read, and agreement with them is what it says."""

import pytest

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.prosody.accent_labels import LabelAgreement, read_accent_labels
from cubeling.characters.speech.speech import Accent, Word
from cubeling.characters.speech.textgrid import Interval, TextGrid, Tier, write_textgrid

WORDS = tuple(Word(text, 0.5 * n, 0.5 * n + 0.4) for n, text in enumerate("abcdefgh"))


def labels_at(*times):
    return [Interval(time, time, "") for time in times]


def accents_at(*times):
    return [Accent(time, 1.0) for time in times]


def test_what_agrees_scores_one_and_what_is_elsewhere_nothing():
    same = LabelAgreement.of(labels_at(0.2, 1.2), accents_at(0.25, 1.15), WORDS)
    assert (same.precision, same.recall, same.f1, same.words) == (1.0, 1.0, 1.0, 1.0)
    other = LabelAgreement.of(labels_at(0.2, 1.2), accents_at(2.2, 3.2), WORDS)
    assert (other.precision, other.recall, other.f1) == (0.0, 0.0, 0.0)
    assert other.words is not None
    assert other.words < 0.0
    assert LabelAgreement.of(labels_at(0.2), accents_at(0.2)).words is None


def test_each_accent_and_each_label_counts_once():
    found = LabelAgreement.of(labels_at(0.2), accents_at(0.15, 0.25))
    assert (found.precision, found.recall) == (0.5, 1.0)
    found = LabelAgreement.of(labels_at(0.2, 0.25), accents_at(0.2))
    assert (found.precision, found.recall) == (1.0, 0.5)


@pytest.mark.parametrize(
    "text",
    [
        "0.5\n1.5\n",
        "time\n1.5\n0.5\n",
        "word,start,end\na,0.5,0.5\nb,1.5,1.5\n",
        "0.5,H*\n1,L-\n1.5,H*\n",
    ],
)
def test_tables_of_times_are_read(tmp_path, text):
    path = tmp_path / "times.csv"
    path.write_text(text)
    assert [each.start for each in read_accent_labels(path)] == [0.5, 1.5]


def test_pitch_accents_of_a_tier_of_tones_are_read(tmp_path):
    path = tmp_path / "talk.TextGrid"
    words = tuple(Interval(w.start, w.end, w.text) for w in WORDS)
    tones = tuple(
        Interval(*each) for each in ((0.5, 0.5, "L+H*"), (1.0, 1.0, "L-L%"), (1.5, 1.5, "!H*"))
    )
    grid = TextGrid(4.0, (Tier("words", words), Tier("Tones", tones, points=True)))
    write_textgrid(path, grid)
    assert [each.start for each in read_accent_labels(path)] == [0.5, 1.5]
    write_textgrid(path, TextGrid(4.0, (Tier("words", words),)))
    with pytest.raises(CharacterError, match="no tier of accents"):
        read_accent_labels(path)


@pytest.mark.parametrize("text", ["", "time\n", "time\nsoon\n", "nan\n", "-1\n", "a,b\n"])
def test_a_table_without_times_is_refused_in_one_line(tmp_path, text):
    path = tmp_path / "times.csv"
    path.write_text(text)
    with pytest.raises(CharacterError, match=r"no accents|no time in seconds") as caught:
        read_accent_labels(path)
    assert "\n" not in str(caught.value)


def test_a_table_with_an_endless_field_is_refused(tmp_path):
    path = tmp_path / "times.csv"
    path.write_text("time\n" + 200_000 * "1")
    with pytest.raises(CharacterError, match="not a CSV file"):
        read_accent_labels(path)
