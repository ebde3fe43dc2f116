"""The languages of the pages: what the session says in English, in a page's language.

Pictures and their cards are the same for all pages; these are in English.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from cubeling.toml_file import bundled

LANGUAGES = "en", "es"
"""Codes of the languages; the first is that of the program."""

PAGE_FOLDER = Path(__file__).parent / "page"
"""What the pages are made of."""

SENTENCE_END = re.compile(r"(?<=[.!?:]) ")


@dataclass(frozen=True)
class PageWords:
    """Some words for a page."""

    words: str
    """In a language, to be shown as they are."""

    language: str
    """Its code; "" where nobody knows, as for words of a scenario of the player's own."""


def language_of(accepted: str) -> str:
    """Return which language to use for a browser's header Accept-Language.

    >>> language_of("de-DE,de;q=0.9,es;q=0.8,en;q=0.7"), language_of("fr"), language_of("")
    ('es', 'en', 'en')
    """
    codes = (each.split(";")[0].strip().lower()[:2] for each in accepted.split(","))
    return next((code for code in codes if code in LANGUAGES), LANGUAGES[0])


class English(str):
    """Words in English in a message: each page gets them in its language, as `PageWords`."""


def in_language(text: str, language: str) -> PageWords:
    """Return what the session says in English, in a language; else as it is, of unknown language.

    >>> in_language("Playing follow", "es")
    PageWords(words='Jugamos a: Seguir', language='es')
    >>> in_language("So far! Move the cube a little", "es").words
    '¡Qué lejos! Mueve un poco el cubo'
    >>> in_language("What only somebody's own scenario says", "es").language
    ''
    """
    spanish = _whole(text) or _in_parts(text)
    if spanish is None:
        return PageWords(text, "")
    return PageWords(spanish if language == "es" else text, language)


def localized(content: object, language: str) -> object:
    """Return the content of a message for a page: whatever is `English` becomes `PageWords`."""
    if isinstance(content, English):
        return in_language(str(content), language)
    if isinstance(content, dict):
        return {key: localized(each, language) for key, each in content.items()}
    if isinstance(content, list):
        return [localized(each, language) for each in content]
    return content


def _in_parts(text: str) -> str | None:
    """Return sentences one by one, if each is known."""
    parts = [_whole(each) for each in SENTENCE_END.split(text)]
    return None if None in parts or len(parts) < 2 else " ".join(map(str, parts))


def _whole(text: str) -> str | None:
    exact, patterns = _spanish()
    if text in exact:
        return exact[text]
    for pattern, spanish in patterns:
        if found := pattern.fullmatch(text):
            return spanish.format(*(exact.get(each, each) for each in found.groups()))
    return None


@lru_cache(maxsize=1)
def _spanish() -> tuple[dict[str, str], list[tuple[re.Pattern[str], str]]]:
    """Return what is said in English and in Spanish, and the same with places for names."""
    said = bundled(PAGE_FOLDER / "spanish.toml")
    exact = {english: spanish for english, spanish in said.items() if "{}" not in english}
    patterns = [
        (re.compile("(.+?)".join(map(re.escape, english.split("{}"))), re.DOTALL), spanish)
        for english, spanish in said.items()
        if "{}" in english
    ]
    return exact, patterns
