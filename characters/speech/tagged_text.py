"""Texts with gestures: tags begin and end a gesture, and the voice's words say when that is.

The markup is that of Egges, "Real-time animation of interactive virtual humans", 2006, section 5.3:

    <begin_gesture id="g1" anim="shake"/>Sorry, I have no idea.<end_gesture id="g1"/>

Both tags stand for themselves, so spans may nest or cross. `<topic/>` marks a change of topic, as
an empty line does.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.speech import GestureSpan, Word
from cubeling.files import FileKind
from cubeling.toml_file import printable

TEXT_FILE = FileKind(
    "text",
    (".txt",),
    CharacterError,
    100_000,
    "cubeling.characters.speech.tagged_text:TaggedText.load",
)
"""A text to be said; larger files are no speeches."""

MIN_SPAN_S = 0.4
"""Shortest time of a gesture [s]: one around a short word, or around none, is made longer."""

NEW_TOPIC = "\n\n"
"""What parts two topics of a text: an empty line."""

_TAG = re.compile(r"<\s*(begin|end)_gesture\b([^<>]*?)/?\s*>")
_TOPIC = re.compile(r"\s*<\s*topic\s*/\s*>\s*")
_ANY_TAG = re.compile(r"<[^<>]*>?")
_ATTRIBUTE = re.compile(r"""(\w+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")


@dataclass(frozen=True)
class TaggedSpan:
    """A gesture and the part of the text that it goes with."""

    name: str
    """Of a gesture, a clip or an expression."""

    start: int
    """Index of the first character of the text that it goes with."""

    end: int
    """Index after the last character."""


@dataclass(frozen=True)
class TaggedText:
    """A text and its gestures."""

    text: str
    """The text without tags, otherwise as it was written."""

    spans: tuple[TaggedSpan, ...]
    """The gestures, in the order in which they begin."""

    @staticmethod
    def load(path: Path) -> "TaggedText":
        """Read the text of a file; CharacterError if it cannot be read, and as `read`."""
        return TaggedText.read(TEXT_FILE.read_text(path))

    @staticmethod
    def read(marked: str) -> "TaggedText":
        """Read a text with tags.

        Raises
        ------
        CharacterError
            If a tag lacks an attribute, begins twice, ends what has not begun, or never ends.

        >>> marked = '<begin_gesture id="a" anim="wave"/>Hi<end_gesture id="a"/> you'
        >>> found = TaggedText.read(marked)
        >>> found.text, found.spans
        ('Hi you', (TaggedSpan(name='wave', start=0, end=2),))
        """
        parts: list[str] = []
        length = copied = 0
        begun: dict[str, tuple[str, int]] = {}
        spans: list[TaggedSpan] = []
        marked = _TOPIC.sub(NEW_TOPIC, marked)
        for tag in _TAG.finditer(marked):
            said = printable(tag[0])
            parts.append(marked[copied : tag.start()])
            length += tag.start() - copied
            copied = tag.end()
            values = {name: a or b for name, a, b in _ATTRIBUTE.findall(tag[2])}
            key = _value(values, "id", said)
            if tag[1] == "begin":
                if key in begun:
                    raise CharacterError(f"{said}: gesture {key!r} has begun; give another id")
                begun[key] = _value(values, "anim", said), length
            elif key in begun:
                name, start = begun.pop(key)
                spans.append(TaggedSpan(name, start, length))
            else:
                raise CharacterError(f"{said}: no gesture {key!r} has begun; begin it before")
        if begun:
            names = ", ".join(map(repr, begun))
            raise CharacterError(f"gesture {names} never ends; add <end_gesture id=…/>")
        text = "".join([*parts, marked[copied:]])
        return TaggedText(text, tuple(sorted(spans, key=lambda span: (span.start, span.end))))

    @staticmethod
    def read_or_plain(marked: str) -> "tuple[TaggedText, str]":
        """Read a text, without any tags if they do not fit together, and return why; "" if they do.

        >>> said, why = TaggedText.read_or_plain('<begin_gesture id="a" anim="wave"/>Hi')
        >>> said, why
        (TaggedText(text='Hi', spans=()), "gesture 'a' never ends; add <end_gesture id=…/>")
        """
        try:
            return TaggedText.read(marked), ""
        except CharacterError as error:
            return TaggedText(" ".join(_ANY_TAG.sub(" ", marked).split()), ()), str(error)

    def gesture_spans(self, words: Sequence[Word], duration: float) -> tuple[GestureSpan, ...]:
        """Return the gestures with the times of the words that they go with.

        A gesture begins with the first word that begins in its span, and ends with the last one; a
        span without a word is at the place of its begin. `duration` is that of the speech [s].
        """
        return tuple(self._gesture_span(span, words, duration) for span in self.spans)

    def _gesture_span(
        self, span: TaggedSpan, words: Sequence[Word], duration: float
    ) -> GestureSpan:
        inside = [w for w in words if w.offset < span.end and w.offset + len(w.text) > span.start]
        if inside:
            start, end = inside[0].start, inside[-1].end
        else:
            start = min((w.start for w in words if w.offset >= span.start), default=duration)
            end = start
        if end - start < MIN_SPAN_S:
            middle = (start + end) / 2
            start, end = middle - MIN_SPAN_S / 2, middle + MIN_SPAN_S / 2
        latest = max(duration - MIN_SPAN_S, 0.0)
        start = min(max(start, 0.0), latest)
        return GestureSpan(span.name, start, max(end, start + MIN_SPAN_S))


def _value(values: dict[str, str], name: str, tag: str) -> str:
    """Return an attribute of a tag."""
    if not values.get(name):
        raise CharacterError(f'{tag}: has no {name}; write {name}="…"')
    return values[name]
