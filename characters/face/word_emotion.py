"""What the words of a speech tell of feeling, for the face that says them.

The rule, with the words in `word_emotions.toml`: a sentence has the emotion of which most of its
words tell. A word after "not" or "never" (the negations of its language, at most two words before)
tells the opposite: of something pleasant, sadness; of something unpleasant, nothing. Phrases count
as three words, as nobody says "how could you" by chance.
"""

import re
from collections import Counter
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from cubeling.affect import Emotion
from cubeling.affect.words import WORD_PLACES
from cubeling.characters.face.affect_display import FACE_RECIPES
from cubeling.characters.face.expressions import EXPRESSIONS
from cubeling.characters.speech.prosody.phrases import Phrase
from cubeling.characters.speech.speech import Utterance
from cubeling.toml_file import bundled

PHRASE_WEIGHT = 3
"""How many words a phrase of several counts as."""

NEGATION_REACH = 2
"""So many words after it a negation turns what a word tells."""

LEAD_S = 0.35
"""A face shows what a sentence tells so long before its first word [s]."""

LINGER_S = 1.5
"""And keeps it so long after the last one: a smile that is back at once was not meant [s]."""

TOLD_SHARE = 0.85
"""Share of the emotion of a word that its mention tells."""

MAX_UNPLEASANT_VALENCE = -0.1
"""Valence below which somebody feels badly."""

_WORDS = re.compile(r"[^\W\d_]+(?:['’][^\W\d_]+)*")

SpokenEmotions = tuple[tuple[float, float, Emotion], ...]
"""Emotions with the times from which and to which words tell of them [s], in order."""


def emotions_of(utterance: Utterance, phrases: Sequence[Phrase]) -> SpokenEmotions:
    """Return what the sentences of a speech tell of feeling; tags for the face go first."""
    found: list[tuple[float, float, Emotion]] = []
    sentence: list[Phrase] = []
    asked = [span for span in utterance.gestures if span.name in {*EXPRESSIONS, *FACE_RECIPES}]
    for number, phrase in enumerate(phrases):
        sentence.append(phrase)
        if not (phrase.ends_sentence or number == len(phrases) - 1):
            continue
        start, end = sentence[0].start, phrase.end
        told = told_emotion("".join(each.text for each in sentence), utterance.language)
        sentence = []
        if told is not None and not any(s.start < end and start < s.end for s in asked):
            found.append((start - LEAD_S, end + LINGER_S, told))
    return tuple(found)


def emotion_at(emotions: SpokenEmotions, time: float) -> Emotion | None:
    """Return what words tell at a time [s]; of two, the later one."""
    return next((told for start, end, told in reversed(emotions) if start <= time < end), None)


def told_emotion(sentence: str, language: str) -> Emotion | None:
    """Return the emotion of which a sentence tells; None for none.

    >>> told_emotion("You lied to me!", "en").word, told_emotion("I am not happy.", "en").word
    ('angry', 'sad')
    """
    tables = _tables()
    words_of = tables.get(language.partition("-")[0])
    if words_of is None:
        return None
    emotions, phrases, negations = words_of
    said = [each.lower().replace("’", "'") for each in _WORDS.findall(sentence)]
    counts: Counter[str] = Counter()
    text = f" {' '.join(said)} "
    for phrase, emotion in phrases.items():
        counts[emotion] += PHRASE_WEIGHT * text.count(f" {phrase} ")
    for number, word in enumerate(said):
        told = emotions.get(word)
        if told is None:
            continue
        if negations.isdisjoint(said[max(number - NEGATION_REACH, 0) : number]):
            counts[told] += 1
        elif WORD_PLACES[told][0] > 0.0:
            counts["sad"] += 1
    counts = +counts
    if not counts:
        return None
    most = max(counts, key=lambda each: counts[each])
    valence, arousal = WORD_PLACES[most]
    return Emotion(TOLD_SHARE * valence, TOLD_SHARE * arousal, most)


def face_of(felt: Emotion | None, told: Emotion | None) -> Emotion | None:
    """Return what a face shows of who feels one thing and tells another.

    What is unpleasant to tell leaves no smile. What is pleasant to tell makes nobody smile who
    feels badly.
    """
    if told is None or (felt is not None and felt.valence < MAX_UNPLEASANT_VALENCE):
        return felt
    if felt is None or told.valence < 0.0 or felt.word == "neutral":
        return told
    return max(felt, told, key=lambda each: each.valence)


@cache
def _tables() -> dict[str, tuple[dict[str, str], dict[str, str], frozenset[str]]]:
    """Return words, phrases and negations of each language."""
    data = bundled(Path(__file__).with_name("word_emotions.toml"))
    tables = {}
    for language, table in data.items():
        emotions = {
            each: emotion
            for emotion, words in table.items()
            if emotion != "negations"
            for each in words
        }
        phrases = {each: word for each, word in emotions.items() if " " in each}
        single = {each: word for each, word in emotions.items() if " " not in each}
        tables[language] = single, phrases, frozenset(table["negations"])
    return tables
