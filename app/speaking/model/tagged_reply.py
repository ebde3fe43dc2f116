"""What a language model writes, made into what a character can say."""

import re
from collections.abc import Collection

from cubeling.app.speaking.model.protocol import ModelError
from cubeling.characters.behaviour import MAX_LINE_CHARS
from cubeling.characters.speech import TaggedText

_THOUGHT = re.compile(r"<think>.*?(</think>|$)", re.DOTALL)
_TAG = re.compile(r"<[^<>]*>?")
_KNOWN = re.compile(r"<\s*(?:begin_gesture|end_gesture|topic)\b")
_BEGIN = re.compile(
    r"""<\s*begin_gesture\b(?=[^<>]*\bid\s*=\s*["']([^"']*))[^<>]*\banim\s*=\s*["']([^"']*)"""
)
_END = re.compile(r"""<\s*end_gesture\b[^<>]*\bid\s*=\s*["']([^"']*)""")
_MARKDOWN = re.compile(r"[*_`#~{}|]+")
_SENTENCE_END = re.compile(r"[.!?…](?=\s)")


def tagged_reply(written: str, gestures: Collection[str]) -> tuple[str, str]:
    """Return what is said of a reply, with its tags, and a note of what was left out.

    Thoughts, signs of Markdown, tags that nobody knows and gestures that are none of `gestures` are
    left out. A reply that is too long ends after a sentence.

    Raises
    ------
    ModelError
        It has no words.

    >>> tagged_reply("*Roar!* I am <b>big</b>.", ())
    ('Roar! I am big.', 'tags left out: <b>, </b>')
    """
    written = "".join(c if c.isprintable() else " " for c in _THOUGHT.sub(" ", written))
    dropped: list[str] = []
    unknown: set[str] = set()

    def keep(tag: "re.Match[str]") -> str:
        begin, end = _BEGIN.match(tag[0]), _END.match(tag[0])
        known = _KNOWN.match(tag[0]) is not None
        if begin is not None and begin[2] not in gestures:
            unknown.add(begin[1])
            known = False
        elif end is not None and end[1] in unknown:
            return ""
        if not known:
            dropped.append(tag[0])
        return tag[0] if known else ""

    parts, at = [], 0
    for tag in _TAG.finditer(written):
        parts += [_MARKDOWN.sub("", written[at : tag.start()]), keep(tag)]
        at = tag.end()
    text = " ".join("".join([*parts, _MARKDOWN.sub("", written[at:])]).split())
    notes = [f"tags left out: {', '.join(dropped)[:80]}"] if dropped else []
    said, wrong = TaggedText.read_or_plain(text)
    plain = said.text
    if wrong:
        text = plain
        notes.append("its tags do not fit together: all of them left out")
    if not any(c.isalnum() for c in plain):
        raise ModelError("the model's reply has no words")
    if len(plain) > MAX_LINE_CHARS:
        text = _cut(" ".join(plain.split()))
        notes.append(f"a reply of {len(plain)} characters, cut")
    return text, "; ".join(notes)


def _cut(text: str) -> str:
    """Return the beginning of a text: whole sentences if it has one, else whole words."""
    begin = text[:MAX_LINE_CHARS]
    ends = [found.end() for found in _SENTENCE_END.finditer(begin)]
    return begin[: ends[-1]] if ends else f"{begin[:-1].rpartition(' ')[0] or begin[:-1]}…"
