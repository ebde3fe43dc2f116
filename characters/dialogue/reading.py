"""Read a script from XML.

    <dialogue summary="Vleo talks" character="vleo" languages="en es">
      <unit name="hello" priority="2" cyclic="yes" strong="no">
        <state name="start">
          <transition to="end">
            <condition type="input_match">hello * | hi *</condition>
            <action type="say">Hello!</action>
          </transition>
        </state>
        <state name="end" accepting="yes"/>
      </unit>
    </dialogue>

Conditions and actions are as Egges, "Real-time animation of interactive virtual humans", 2006,
section 5.1, has them; his units, states and transitions were not published. A transition without
`to` leads back to its own state.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cubeling.characters.dialogue.checking import check_script
from cubeling.characters.dialogue.patterns import Heard, WordPattern, plain
from cubeling.characters.dialogue.script import (
    ANY_LANGUAGE,
    DialogueScript,
    Localized,
    ScriptItem,
    Unit,
    UnitState,
    UnitTransition,
)
from cubeling.characters.dialogue.spelling import Spelling, WordSet
from cubeling.characters.dialogue.vocabulary import (
    CORE_VOCABULARY,
    Vocabulary,
    localized_texts,
)
from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.tagged_text import TaggedText
from cubeling.characters.xml_elements import XmlElement, XmlLimits, read_xml
from cubeling.files import FileKind
from cubeling.toml_file import printable

LIMITS = XmlLimits(bytes=1 << 20, elements=20_000, depth=8)
"""How large a script may be."""

SCRIPT_FILE = FileKind(
    "script",
    (".xml",),
    CharacterError,
    LIMITS.bytes,
    "cubeling.characters.dialogue.reading:read_script",
)
"""A script of a dialogue."""

MAX_PRIORITY = 1_000_000
"""Greatest priority of a unit."""

MAX_LANGUAGES = 20
"""Most languages of a script."""

YES_NO = {"yes": True, "no": False}


def read_script(path: str | Path, vocabulary: Vocabulary = CORE_VOCABULARY) -> DialogueScript:
    """Read a script.

    Raises
    ------
    CharacterError
        It cannot be read, or in one line: what is wrong at which line of it.
    """
    text = SCRIPT_FILE.read(path)
    return _Reader(printable(str(path)), vocabulary).script(text)


class _Reader:
    def __init__(self, name: str, vocabulary: Vocabulary) -> None:
        self._name, self._vocabulary = name, vocabulary

    def script(self, text: bytes) -> DialogueScript:
        root = read_xml(text, LIMITS, lambda line: f"{self._name}:{line}")
        self._expect(root, "dialogue", "summary", "character", "personality", "languages")
        languages = tuple(root.attributes.get("languages", "en").split())
        if not 0 < len(set(languages)) == len(languages) <= MAX_LANGUAGES:
            raise self._error(root, 'languages="en es" names each language once')
        slots = [each for each in root.children if each.tag == "slot"]
        units = tuple(self._unit(each) for each in root.children if each.tag != "slot")
        script = DialogueScript(
            self._name,
            " ".join(root.attributes.get("summary", "a dialogue").split()).removesuffix("."),
            root.attributes.get("character", "vleo"),
            root.attributes.get("personality", "lively"),
            languages,
            units,
            spelling_of(languages, units),
            {self._name_of(each): self._slot(each) for each in slots},
        )
        check_script(script, root.line)
        return script

    def _slot(self, element: XmlElement) -> ScriptItem:
        """Return the words that may be heard for a slot."""
        unknown = element.attributes.keys() - {"name"}
        if unknown:
            raise self._error(element, f"<slot> has no '{min(unknown)}'; it has name")
        try:
            texts = localized_texts(element)
        except CharacterError as error:
            raise self._error(element, f"slot: {error}") from None
        words: dict[str, tuple[str, ...]] = {}
        for code, text in texts:
            listed = map(plain, text.split())
            words[code] = (*words.get(code, ()), *(word for word in listed if word))
        if not any(words.values()):
            raise self._error(element, "a slot without words")
        return ScriptItem("slot", Localized(words), element.line)

    def _unit(self, element: XmlElement) -> Unit:
        self._expect(element, "unit", "name", "priority", "cyclic", "strong", "fallback")
        states: dict[str, UnitState] = {}
        for each in element.children:
            state = self._state(each)
            if state.name in states:
                raise self._error(each, f"a second state '{state.name}'")
            states[state.name] = state
        if not states:
            raise self._error(element, "a unit without a state")
        priority = element.attributes.get("priority", "0")
        if not (priority.isascii() and priority.isdecimal()) or int(priority) > MAX_PRIORITY:
            raise self._error(element, f"priority='{priority:.20}' is no whole number of 0 or more")
        return Unit(
            self._name_of(element),
            states,
            int(priority),
            self._flag(element, "cyclic"),
            self._flag(element, "strong"),
            self._flag(element, "fallback"),
            element.line,
        )

    def _state(self, element: XmlElement) -> UnitState:
        self._expect(element, "state", "name", "accepting")
        name = self._name_of(element)
        transitions = tuple(self._transition(each, name) for each in element.children)
        return UnitState(name, transitions, self._flag(element, "accepting"), element.line)

    def _transition(self, element: XmlElement, state: str) -> UnitTransition:
        self._expect(element, "transition", "to")
        known = self._vocabulary
        conditions, actions = list[ScriptItem](), list[ScriptItem]()
        for each in element.children:
            if each.tag == "condition":
                conditions.append(self._item(each, known.conditions))
            elif each.tag == "action":
                actions.append(self._item(each, known.actions))
            else:
                raise self._error(each, f"<{each.tag}> is no <condition> or <action>")
        return UnitTransition(
            element.attributes.get("to", state),
            tuple(conditions),
            tuple(actions),
            any(known.conditions[each.kind].hears for each in conditions),
            any(known.conditions[each.kind].waits(each.argument) for each in conditions),
            element.line,
        )

    def _item(self, element: XmlElement, kinds: Mapping[str, Any]) -> ScriptItem:
        name = element.attributes.get("type", "")
        if name not in kinds:
            raise self._error(
                element, f"'{name:.40}' is no {element.tag}; there are {', '.join(kinds)}"
            )
        try:
            argument = kinds[name].read(element)
        except CharacterError as error:
            raise self._error(element, f"{element.tag} {name}: {error}") from None
        return ScriptItem(name, argument, element.line)

    def _expect(self, element: XmlElement, tag: str, *attributes: str) -> None:
        """Refuse an element of another name, with other attributes, or with loose text."""
        if element.tag != tag:
            raise self._error(element, f"<{element.tag}> where <{tag}> is expected")
        for name in element.attributes:
            if name not in attributes:
                raise self._error(element, f"<{tag}> has no '{name}'; it has {_list(attributes)}")
        if any(isinstance(part, str) and part.strip() for part in element.parts):
            raise self._error(element, f"a text in <{tag}>; write <action type='say'> around it")

    def _name_of(self, element: XmlElement) -> str:
        name = element.attributes.get("name", "").strip()
        if not name:
            raise self._error(element, f"a {element.tag} without a name")
        return name

    def _flag(self, element: XmlElement, name: str) -> bool:
        text = element.attributes.get(name, "no")
        if text not in YES_NO:
            raise self._error(element, f"{name}='{text:.20}' is neither yes nor no")
        return YES_NO[text]

    def _error(self, element: XmlElement, why: str) -> CharacterError:
        return CharacterError(printable(f"{self._name}:{element.line}: {why}"))


def _list(names: tuple[str, ...]) -> str:
    return ", ".join(names) or "none"


def spelling_of(languages: tuple[str, ...], units: tuple[Unit, ...]) -> Spelling:
    """Return the words that units match and say, by language."""
    matched: dict[str, set[str]] = {each: set() for each in languages}
    known: dict[str, set[str]] = {each: set() for each in languages}
    items = (
        item
        for unit in units
        for state in unit.states.values()
        for transition in state.transitions
        for item in (*transition.conditions, *transition.actions)
        if isinstance(item.argument, Localized)
    )
    for item in items:
        for code, each in item.argument:
            # What is not of a language is of the first one: a script without languages has that.
            language = languages[0] if code == ANY_LANGUAGE else code
            if language not in known:
                continue
            if isinstance(each, WordPattern | WordSet):
                matched[language].update(each.words)
            else:
                known[language].update(Heard.of(TaggedText.read(each).text).plain)
    return Spelling(
        {code: WordSet.of(words) for code, words in matched.items()},
        {code: frozenset(words | known[code]) for code, words in matched.items()},
    )
