"""The conditions and actions that a script may name: one table of each.

A program adds its own: see `Vocabulary.extended`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from cubeling.affect import OCC_FACES
from cubeling.characters.dialogue.patterns import Heard, WordPattern, fill, patterns_of
from cubeling.characters.dialogue.script import ANY_LANGUAGE, Localized
from cubeling.characters.dialogue.spelling import WordSet
from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.tagged_text import TaggedText
from cubeling.characters.xml_elements import XmlElement

Slots = dict[str, str]
"""What is remembered of a text, by slot."""

MAX_LINE_CHARS = 300
"""Longest text that is said at once: about twenty seconds."""

GESTURE_TAGS = ("begin_gesture", "end_gesture", "topic")
"""The tags of a text that is said; see `TaggedText`."""


@dataclass(frozen=True)
class DialogueMoment:
    """What a condition is asked of: one unit at one time."""

    heard: Heard | None
    """What was said and nobody has answered; None for nothing."""

    language: str
    """The language in which it was said."""

    spelled: tuple[str, ...]
    """Its words as the script spells them."""

    feelings: Mapping[str, float]
    """Intensities of the 24 emotions, 0…1; those that are missing are 0."""

    profile: Mapping[str, str]
    """What is remembered, by slot."""

    quiet_s: float
    """How long nobody has said anything [s]."""

    passed_over: bool
    """Whether another unit has answered since this one came to its state."""

    world: Any = None
    """What the conditions of the program are asked of."""


@dataclass
class TurnDraft:
    """What is done in one turn, as far as it is known; actions add to it."""

    language: str
    """The language that is spoken."""

    profile: dict[str, str]
    """What is remembered, by slot."""

    choose: Callable[[Localized[str], int], str]
    """Returns one of the texts of an action, by its line, with its slots filled."""

    line: int = 0
    """Line of the action that is performed."""

    texts: list[str] = field(default_factory=list)
    """What is said, with tags."""

    influences: list[tuple[str, float]] = field(default_factory=list)
    """Emotions that it causes, with their strength, 0…1."""

    acts: list[tuple[str, str]] = field(default_factory=list)
    """What else is done: an action of the program, and what the script says there."""


@dataclass(frozen=True)
class ConditionKind:
    """A kind of condition."""

    meaning: str
    """When it holds, for the table of all."""

    read: Callable[[XmlElement], Any]
    """Returns its argument; raises CharacterError for one of no use."""

    holds: Callable[[DialogueMoment, Any], Slots | None]
    """Returns what is to be remembered if it holds, else None."""

    waits: Callable[[Any], bool] = lambda _: False
    """Whether, by its argument, something must happen before it holds once more."""

    hears: bool = False
    """Whether it is about what was said."""


@dataclass(frozen=True)
class ActionKind:
    """A kind of action."""

    meaning: str
    """What it does, for the table of all."""

    read: Callable[[XmlElement], Any]
    """Returns its argument; raises CharacterError for one of no use."""

    perform: Callable[[TurnDraft, Any], None]
    """Adds it to a turn."""


@dataclass(frozen=True)
class Vocabulary:
    """The conditions and actions by the type that names them."""

    conditions: Mapping[str, ConditionKind]
    """Those of transitions, all of which must hold."""

    actions: Mapping[str, ActionKind]
    """What transitions do, one after the other."""

    def extended(
        self, conditions: Mapping[str, ConditionKind], actions: Mapping[str, ActionKind]
    ) -> Self:
        """Return these with others of a program."""
        return type(self)({**self.conditions, **conditions}, {**self.actions, **actions})


def localized_texts(element: XmlElement) -> Localized[str]:
    """Return the texts of an element: its own, or those of the elements `text` in it.

    Raises
    ------
    CharacterError
        One of them is not text.
    """
    children = [each for each in element.children if each.tag == "text"]
    texts: dict[str, tuple[str, ...]] = {}
    for each in children or [element]:
        code = each.attributes.get("lang", ANY_LANGUAGE)
        texts[code] = (*texts.get(code, ()), _tagged(each))
    loose = "".join(part for part in element.parts if isinstance(part, str))
    if children and (loose.strip() or len(children) < len(element.children)):
        raise CharacterError("has a text, or elements <text>, but not both")
    return Localized(texts)


def _tagged(element: XmlElement) -> str:
    """Return the text of an element with the tags of its gestures."""
    parts = []
    for part in element.parts:
        if isinstance(part, str):
            parts.append(part)
        elif part.tag in GESTURE_TAGS and not part.parts:
            values = "".join(f' {name}="{value}"' for name, value in part.attributes.items())
            parts.append(f"<{part.tag}{values}/>")
        else:
            raise CharacterError(f"<{part.tag}> is not text; tags are {', '.join(GESTURE_TAGS)}")
    text = " ".join("".join(parts).split())
    gesture = element.attributes.get("gesture")
    if gesture is not None:  # of the whole text
        text = f'<begin_gesture id="all" anim="{gesture}"/>{text}<end_gesture id="all"/>'
    return text


def only_text(element: XmlElement) -> str:
    """Return the text of an element that has nothing else; CharacterError if it is empty."""
    text = " ".join(element.text.split())
    if element.children or not text:
        raise CharacterError("needs a text")
    return text


def _patterns(element: XmlElement) -> Localized[WordPattern]:
    texts = localized_texts(element)
    return Localized(
        {
            code: tuple(pattern for text in each for pattern in patterns_of(text))
            for code, each in texts.by_language.items()
        }
    )


def _matches(moment: DialogueMoment, patterns: Localized[WordPattern]) -> Slots | None:
    heard = moment.heard
    if heard is None:
        return None
    words, spelled = set(heard.plain), set(moment.spelled)
    for pattern in patterns.of(moment.language):
        if pattern.is_open and not heard.typed:
            continue  # what the cube does needs no answer
        slots = None
        if words.issuperset(pattern.words):  # few of many patterns are worth to be matched
            slots = pattern.match(heard)
        if slots is None and moment.spelled and spelled.issuperset(pattern.words):
            slots = pattern.match(heard, moment.spelled)
        if slots is not None:
            return slots
    return None


def _topics(element: XmlElement) -> Localized[WordSet]:
    texts = localized_texts(element)
    sets = {
        code: (WordSet.of(word for text in each for word in Heard.of(text).plain),)
        for code, each in texts.by_language.items()
    }
    if not all(found.words for each in sets.values() for found in each):
        raise CharacterError("needs words")
    return Localized(sets)


def _is_about(moment: DialogueMoment, topics: Localized[WordSet]) -> Slots | None:
    heard = moment.heard
    if heard is None or not heard.typed:
        return None
    # A word that the script knows means itself, however like one of the topic's it is.
    words = {*heard.plain, *moment.spelled}
    found = any(not words.isdisjoint(topic.words) for topic in topics.of(moment.language))
    return {} if found else None


def _number(element: XmlElement, least: float, most: float) -> float:
    text = only_text(element)
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not least <= number <= most:
        raise CharacterError(f"'{text:.20}' is no number from {least:g} to {most:g}")
    return number


def _emotion(element: XmlElement) -> tuple[str, float]:
    """Return an emotion and a value, 0…1, as Egges writes them."""
    parts = {each.tag: each for each in element.children}
    if parts.keys() != {"emotion", "value"} or len(element.children) != 2:
        raise CharacterError("needs <emotion>fear</emotion><value>0.3</value>")
    word = only_text(parts["emotion"]).casefold()
    if word not in OCC_FACES:
        raise CharacterError(f"'{word:.40}' is none of the emotions {', '.join(OCC_FACES)}")
    return word, _number(parts["value"], 0.0, 1.0)


def _slot(element: XmlElement) -> str:
    name = only_text(element)
    if not name.isidentifier() or name != name.lower():
        raise CharacterError(f"'{name:.40}' is no slot: a word in small letters")
    return name


def _remembered(element: XmlElement) -> tuple[str, str]:
    """Return a slot and what is put there."""
    name = element.attributes.get("slot", "")
    if not name.isidentifier() or name != name.lower():
        raise CharacterError('needs a slot: <action type="remember" slot="pet">cat</action>')
    return name, only_text(element)


def _said(element: XmlElement) -> Localized[str]:
    """Return the texts that may be said, of which each has words and tags that fit together."""
    texts = localized_texts(element)
    for _, text in texts:
        plain = TaggedText.read(text).text
        if not Heard.of(plain).words:
            raise CharacterError("a reply that is not text: it has no words")
        if len(plain) > MAX_LINE_CHARS:
            raise CharacterError(
                f"a reply of {len(plain)} characters; at most {MAX_LINE_CHARS} are said at once"
            )
    return texts


def _if(holds: bool) -> Slots | None:
    return {} if holds else None


def _forget(draft: TurnDraft, slot: str) -> None:
    draft.profile.pop(slot, None)


def _nothing(element: XmlElement) -> None:
    if element.text.strip() or element.children:
        raise CharacterError("has nothing in it")


def always(_: Any) -> bool:
    """Return True: something must happen, whatever the argument."""
    return True


CONDITIONS: dict[str, ConditionKind] = {
    "input_match": ConditionKind(
        "what was said matches a pattern, or one of several with | between them",
        _patterns,
        _matches,
        always,
        hears=True,
    ),
    "about": ConditionKind(
        "what was said has one of these words, or one that is spelt almost so",
        _topics,
        _is_about,
        always,
        hears=True,
    ),
    "silence": ConditionKind(
        "nobody has said anything for so many seconds",
        lambda element: _number(element, 0.1, 3600.0),
        lambda now, seconds: _if(now.quiet_s >= seconds),
        always,
    ),
    "passed_over": ConditionKind(
        "another unit has answered since this one came to its state",
        _nothing,
        lambda now, _: _if(now.passed_over),
        always,
    ),
    "above_threshold": ConditionKind(
        "an emotion is stronger than a value",
        _emotion,
        lambda now, asked: _if(now.feelings.get(asked[0], 0.0) > asked[1]),
    ),
    "below_threshold": ConditionKind(
        "an emotion is weaker than a value",
        _emotion,
        lambda now, asked: _if(now.feelings.get(asked[0], 0.0) < asked[1]),
    ),
    "known": ConditionKind(
        "a slot is remembered", _slot, lambda now, slot: _if(slot in now.profile)
    ),
    "unknown": ConditionKind(
        "a slot is not remembered", _slot, lambda now, slot: _if(slot not in now.profile)
    ),
}
"""The conditions by the type that names them; a new one is a line here."""

ACTIONS: dict[str, ActionKind] = {
    "say": ActionKind(
        "say the text, or one of several",
        _said,
        lambda draft, texts: draft.texts.append(draft.choose(texts, draft.line)),
    ),
    "emotional_influence": ActionKind(
        "feel an emotion, as strongly as a value",
        _emotion,
        lambda draft, felt: draft.influences.append(felt),
    ),
    "remember": ActionKind(
        "put a text into a slot",
        _remembered,
        lambda draft, pair: draft.profile.update({pair[0]: fill(pair[1], draft.profile)}),
    ),
    "forget": ActionKind("empty a slot", _slot, lambda draft, slot: _forget(draft, slot)),
}
"""The actions by the type that names them; a new one is a line here."""

CORE_VOCABULARY = Vocabulary(CONDITIONS, ACTIONS)
"""What every script may name."""


def act(name: str, meaning: str, choices: tuple[str, ...] = ()) -> ActionKind:
    """Return an action that a program carries out; `choices` are all that it knows, () for any."""

    def read(element: XmlElement) -> str:
        text = only_text(element)
        if choices and text not in choices:
            raise CharacterError(f"'{text:.40}' is none of {', '.join(choices)}")
        return text

    return ActionKind(meaning, read, lambda draft, text: draft.acts.append((name, text)))
