"""What can be heard of a person who speaks: the phrases of a script's own patterns and words."""

from collections.abc import Iterator

from cubeling.characters.dialogue.patterns import Slot, WordPattern
from cubeling.characters.dialogue.script import DialogueScript, Localized
from cubeling.characters.dialogue.spelling import WordSet
from cubeling.characters.speech.recognition import SpokenPhrase


def phrases_of(script: DialogueScript, language: str) -> tuple[SpokenPhrase, ...]:
    """Return the phrases to which a script has an answer in a language, each once.

    A pattern with a slot is heard with the words that the script lists for it, and without a list
    it is not: nobody knows which of all words was said.
    """
    return tuple(dict.fromkeys(_phrases(script, language)))


def _phrases(script: DialogueScript, language: str) -> Iterator[SpokenPhrase]:
    for transition in script.transitions:
        for condition in transition.conditions:
            if not isinstance(condition.argument, Localized):
                continue
            for each in condition.argument.of(language):
                if isinstance(each, WordSet):
                    yield from (SpokenPhrase(((word,),), True, True) for word in sorted(each.words))
                elif isinstance(each, WordPattern) and each.words:
                    phrase = _phrase(each, script, language)
                    if phrase is not None:
                        yield phrase


def _phrase(pattern: WordPattern, script: DialogueScript, language: str) -> SpokenPhrase | None:
    """Return the phrase of a pattern; None if it has a slot whose words are not known."""
    places: list[tuple[str, ...]] = []
    for part in pattern.parts:
        for element in part:
            if isinstance(element, Slot):
                item = script.slots.get(element.name)
                listed = () if item is None else item.argument.of(language)
                if not listed:
                    return None
                places.append(listed)
            else:
                places.append((element,))
        places.append(())
    places.pop()
    opens, closes = not pattern.parts[0], not pattern.parts[-1]
    inner = places[1 if opens else 0 : len(places) - 1 if closes else len(places)]
    return SpokenPhrase(tuple(inner), opens, closes)
