"""Phones: classes of the International Phonetic Alphabet, and ARPAbet."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from cubeling.characters.speech.speech import SILENCE, Phone

SoundClass = Literal["silence", "vowel", "glide", "nasal", "stop", "fricative", "affricate"]
"""How a phone is made; glides are approximants, laterals, taps and trills."""

SYLLABIC = "\N{COMBINING VERTICAL LINE BELOW}"
"""Marks a consonant that is the nucleus of a syllable, such as in "bottle"."""

_LETTERS: dict[SoundClass, str] = {
    "vowel": "aɑɒɐæeɛəɘɜɞɤɪiɨɯoɔuʊʉʌyʏøœɶɚɝᵻ",
    "glide": "wjɥɰɹɻrɾɽʀlɫɭʎʟʋ",
    "nasal": "mɱnɳɲŋɴ",
    "stop": "pbtdʈɖcɟkɡgqɢʔɓɗɠʛ",
    "fricative": "fvθðszʃʒʂʐɕʑçʝxɣχʁħʕhɦɸβɬɮʍ",
}
_CLASSES = {letter: kind for kind, letters in _LETTERS.items() for letter in letters}

_ARPABET = """
AA:ɑ AE:æ AH:ʌ AO:ɔ AW:aʊ AX:ə AXR:ɚ AY:aɪ B:b CH:tʃ D:d DH:ð DX:ɾ EH:ɛ ER:ɜ EY:eɪ F:f G:ɡ HH:h
IH:ɪ IX:ɪ IY:i JH:dʒ K:k L:l EL:l̩ M:m EM:m̩ N:n EN:n̩ NG:ŋ OW:oʊ OY:ɔɪ P:p R:ɹ S:s SH:ʃ T:t TH:θ
UH:ʊ UW:u V:v W:w Y:j Z:z ZH:ʒ
"""

IPA_OF_ARPABET = dict(pair.split(":") for pair in _ARPABET.split())
"""The IPA symbol of each phone of ARPAbet, the alphabet of American pronunciation dictionaries."""


_DICTIONARY_LACKS = ("AX", "AXR", "DX", "EL", "EM", "EN", "IX")
_NEAREST = "ɐ:AH ə:AH ɚ:ER ᵻ:IH ɾ:D ɒ:AA a:AA e:EH o:OW g:G r:R ɫ:L x:K ç:K y:UW ø:ER"

ARPABET_OF_IPA = {
    **{ipa: name for name, ipa in IPA_OF_ARPABET.items() if name not in _DICTIONARY_LACKS},
    **dict(pair.split(":") for pair in _NEAREST.split()),
}
"""The 39 phones of the CMU dictionary by IPA symbols, and what comes nearest to other ones."""


def ipa_of_arpabet(symbol: str) -> str:
    """Return a phone of ARPAbet in IPA; an unknown one as it is, without capitals.

    >>> ipa_of_arpabet("ow1"), ipa_of_arpabet("PT")
    ('oʊ', 'pt')
    """
    return IPA_OF_ARPABET.get(symbol.upper().rstrip("012"), symbol.lower())


def arpabet_of_ipa(symbol: str) -> list[str]:
    """Return a phone of IPA in ARPAbet, piece by piece, the longest first.

    >>> arpabet_of_ipa("aɪə"), arpabet_of_ipa("ŋ"), arpabet_of_ipa("?")
    (['AY', 'AH'], ['NG'], [])
    """
    pieces, at = [], 0
    while at < len(symbol):
        for length in (2, 1):
            piece = ARPABET_OF_IPA.get(symbol[at : at + length])
            if piece is not None:
                pieces.append(piece)
                at += length - 1
                break
        at += 1
    return pieces


def is_arpabet(symbols: Sequence[str]) -> bool:
    """Return whether phones are in ARPAbet rather than IPA, as far as they tell.

    >>> is_arpabet(["hh", "ax", "l", "ow"]), is_arpabet(["h", "ə", "l", "o"])
    (True, False)
    """
    known = [s for s in symbols if s.upper().rstrip("012") in IPA_OF_ARPABET]
    telling = any(len(s) > 1 for s in known) and all(s.isascii() for s in symbols)
    return telling and len(known) >= 0.8 * len(symbols)


def sound_class(symbol: str) -> SoundClass:
    """Return how a phone is made, by the first letter that says so.

    An unknown symbol is a vowel: the mouth opens, whatever it is.

    >>> [sound_class(each) for each in ("", "aɪ", "tʃ", "ŋ", "ˈx", "?")]
    ['silence', 'vowel', 'affricate', 'nasal', 'fricative', 'vowel']
    """
    if symbol == SILENCE:
        return "silence"
    if SYLLABIC in symbol:
        return "vowel"
    kinds = [_CLASSES[letter] for letter in symbol if letter in _CLASSES]
    if kinds[:2] == ["stop", "fricative"]:
        return "affricate"
    return kinds[0] if kinds else "vowel"


def is_vowel(symbol: str) -> bool:
    """Return whether a phone can be the nucleus of a syllable."""
    return sound_class(symbol) == "vowel"


def fill_pauses(phones: Sequence[Phone], duration: float) -> tuple[Phone, ...]:
    """Return phones with pauses in between, without gaps, overlaps or empty phones.

    >>> [(p.symbol, p.start) for p in fill_pauses([Phone("m", 0.1, 0.2), Phone("", 0.2, 0.3)], 1.0)]
    [('', 0.0), ('m', 0.1), ('', 0.2)]
    """
    filled: list[Phone] = []
    at = 0.0
    for phone in [*phones, Phone(SILENCE, duration, duration)]:
        start, end = min(max(phone.start, at), duration), min(phone.end, duration)
        pieces = [Phone(SILENCE, at, start)] if start > at + 1e-6 else []
        begin = start if pieces else at
        pieces += [replace(phone, start=begin, end=end)] if end > start else []
        for piece in pieces:
            if filled and piece.symbol == SILENCE == filled[-1].symbol:
                filled[-1] = Phone(SILENCE, filled[-1].start, piece.end)
            else:
                filled.append(piece)
            at = piece.end
    return tuple(filled)
