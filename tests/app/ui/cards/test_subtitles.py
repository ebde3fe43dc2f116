"""Subtitles: what is being said, in parts that can be read."""

import numpy as np

from cubeling.app.ui.canvas import text_mask, text_width, wrap_text
from cubeling.app.ui.cards.subtitles import MAX_LETTERS, SIZE, parts, subtitle
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.speech.speech import Utterance, Word

TEXT = (
    "This is the first sentence of a long speech, which nobody could read at one time. "
    "Here is another one! And then there is a third one, which is long enough to need two parts."
)


def utterance(text: str) -> Utterance:
    """Return an utterance with a word each half second."""
    words, offset = [], 0
    for number, word in enumerate(text.split()):
        offset = text.index(word, offset)
        words.append(Word(word.strip(".,!"), number / 2, number / 2 + 0.5, offset))
        offset += len(word)
    return Utterance(text, "en", len(words) / 2, tuple(words))


def test_the_parts_are_the_text_and_none_is_too_long():
    found = parts(utterance(TEXT))
    assert " ".join(words for _, words in found) == TEXT
    assert all(len(words) <= MAX_LETTERS + 1 for _, words in found)
    assert [start for start, _ in found] == sorted(start for start, _ in found)


def test_a_part_is_shown_from_its_first_word_on_and_the_last_one_stays():
    speech = SpeechIntent(utterance(TEXT), 10.0)
    (_, first), (start, second), *_ = parts(speech.utterance)
    assert subtitle(speech, 10.0) == first
    assert subtitle(speech, 10.0 + start + 0.01) == second
    assert subtitle(speech, 1000.0) == parts(speech.utterance)[-1][1]
    assert subtitle(None, 10.0) == ""


def test_a_speech_without_words_shows_its_text():
    assert subtitle(SpeechIntent(Utterance("Hello", "en", 1.0), 0.0), 0.5) == "Hello"


def test_lines_are_as_wide_as_there_is_room():
    lines = wrap_text(TEXT, 300.0, SIZE)
    assert " ".join(lines) == TEXT
    assert all(text_width(line, SIZE) <= 300.0 for line in lines)


def test_letters_with_accents_have_glyphs_and_scripts_without_are_not_shown():
    missing = text_mask("你", 60)[0]  # the same font, which lacks it
    for letter in "ñáéíóúü¡¿çàèßøłдΩ":
        mask = text_mask(letter, 60)[0]
        assert mask.shape != missing.shape or not np.array_equal(mask, missing), letter
    assert subtitle(SpeechIntent(Utterance("¡Mañana!", "es", 1.0), 0.0), 0.5) == "¡Mañana!"
    assert subtitle(SpeechIntent(Utterance("你好", "cmn", 1.0), 0.0), 0.5) == ""
