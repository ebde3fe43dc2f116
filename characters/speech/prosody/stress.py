"""Which vowels of a text are stressed, by the marks of a voice that says it."""

from collections.abc import Sequence
from dataclasses import replace
from difflib import SequenceMatcher

from cubeling.characters.speech.phones import fill_pauses, is_vowel
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word

PRIMARY = "\N{MODIFIER LETTER VERTICAL LINE}"
"""The mark before a stressed vowel or syllable in the International Phonetic Alphabet."""

NO_PHONES = "ˌ|_-.,‿ \n\t"
"""Other signs of a transcription that are no phones, secondary stress among them."""

MOST_COMPARED = 4000
"""Characters up to which a transcription that differs from the phones is compared with them."""


def with_stress(phones: Sequence[Phone], transcription: str) -> tuple[Phone, ...]:
    """Return phones that know whether they are stressed, from a transcription of the same words.

    Clitics have no mark in it. Without one mark that is found, nothing is known.

    >>> phones = [Phone(symbol, 0.0, 0.0) for symbol in "ɣusta"]
    >>> "".join(phone.symbol for phone in with_stress(phones, "ɣˈusta") if phone.stressed)
    'u'
    """
    letters, marked = _letters(transcription)
    owners = [number for number, phone in enumerate(phones) for _ in phone.symbol]
    spoken = "".join(phone.symbol for phone in phones)
    pairs = [(0, 0, len(spoken))]
    if spoken != letters:
        if max(len(spoken), len(letters)) > MOST_COMPARED:
            return tuple(phones)
        matcher = SequenceMatcher(None, letters, spoken, autojunk=False)
        pairs = [(block.a, block.b, block.size) for block in matcher.get_matching_blocks()]
    found = {owners[b + n] for a, b, size in pairs for n in range(size) if a + n in marked}
    stressed = {_vowel_from(phones, number) for number in found}
    if not stressed:
        return tuple(phones)
    return tuple(
        replace(phone, stressed=number in stressed)
        if phone.symbol != SILENCE and is_vowel(phone.symbol)
        else phone
        for number, phone in enumerate(phones)
    )


def _letters(transcription: str) -> tuple[str, set[int]]:
    """Return the characters of the phones, and which of them follow a mark."""
    letters: list[str] = []
    marked: set[int] = set()
    for letter in transcription:
        if letter == PRIMARY:
            marked.add(len(letters))
        elif letter not in NO_PHONES:
            letters.append(letter)
    return "".join(letters), marked


def _vowel_from(phones: Sequence[Phone], number: int) -> int:
    """Return the first vowel from a phone on: some voices mark where the syllable begins."""
    while number + 1 < len(phones) and not is_vowel(phones[number].symbol):
        number += 1
    return number


def stressed_like(speech: Speech, said: Speech) -> Speech:
    """Return a speech whose words are stressed as in what a voice said of the same text.

    Phones that are not known, but words, are those of the voice, as fast as the word was.
    """
    phones = list(speech.phones)
    own_words, said_words = ([word.text.lower() for word in s.words] for s in (speech, said))
    matcher = SequenceMatcher(None, own_words, said_words, autojunk=False)
    for a, b, size in matcher.get_matching_blocks():
        for word, model in zip(speech.words[a : a + size], said.words[b : b + size], strict=True):
            spoken = _inside(said.phones, model)
            if speech.phones:
                _mark(phones, word, spoken)
            else:
                speed = (word.end - word.start) / max(model.end - model.start, 1e-6)
                phones += [
                    replace(
                        phone,
                        start=word.start + speed * (phone.start - model.start),
                        end=word.start + speed * (phone.end - model.start),
                    )
                    for phone in spoken
                ]
    if not speech.phones:
        phones = list(fill_pauses(phones, speech.duration)) if phones else []
    return replace(speech, phones=tuple(phones))


def _inside(phones: Sequence[Phone], word: Word) -> list[Phone]:
    return [p for p in phones if p.symbol != SILENCE and word.start <= p.start + 1e-6 < word.end]


def _mark(phones: list[Phone], word: Word, spoken: Sequence[Phone]) -> None:
    """Mark the vowels of a word among phones as those of a voice; there may be fewer or more."""
    model = [phone.stressed is True for phone in spoken if is_vowel(phone.symbol)]
    own = [
        index
        for index, phone in enumerate(phones)
        if is_vowel(phone.symbol) and word.start <= phone.start + 1e-6 < word.end
    ]
    scale = (len(own) - 1) / max(len(model) - 1, 1)
    stressed = {round(number * scale) for number, marked in enumerate(model) if marked}
    for number, index in enumerate(own):
        phones[index] = replace(phones[index], stressed=number in stressed)
