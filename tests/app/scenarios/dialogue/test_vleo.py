"""What a child of eight says to Vleo is answered, in both languages and as children type it."""

import pytest

from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.app.scenarios.talk import Talk
from cubeling.characters.behaviour import Dialogue
from cubeling.characters.speech import TaggedText

ENGLISH = (
    ("hi i am tom and i am nine", "Tom"),
    ("can you roar", "oa|OA"),
    ("i have a dog", "called|name"),
    ("his name is max", "Max"),
    ("what is my dogs name", "Max"),
    ("do you like my dog", "Max|Friends"),
    ("what is your favrit dinosar", "Triceratops|Maiasaura"),
    ("do you eat peple", "leaves|ferns"),
    ("do you know trisseratops", "horns|Triceratops|stop"),
    ("how big is it", "elephants"),
    ("what does it eat", "ferns"),
    ("knock knock", "Who"),
    ("lola", "Lola who"),
    ("lola the ball", "aha|ihi"),
    ("whats 2 plus 2", "three|One"),
    ("because my frend moved away", "friend|cousin"),
    ("my brother hit me", "hurt|not right"),
    ("how old am i", "nine"),
    ("whats my name", "Tom"),
)
SPANISH = (
    ("ola me yamo pablo", "Pablo"),
    ("puedes rujir", "oa|OA|aar|AAR"),
    ("tengo un perro", "llama"),
    ("se llama toby", "Toby"),
    ("como se yama mi perro", "Toby"),
    ("comes jente", "hojas|helechos"),
    ("conoces el triceratops", "uernos|Triceratops"),
    ("como de grande era", "elefantes"),
    ("toc toc", "Quién"),
    ("lola", "Qué lola"),
    ("la pelota", "aja|iji"),
    ("me pega mi hermano", "daño|no está bien"),
)


@pytest.mark.parametrize(("language", "talk"), [("en", ENGLISH), ("es", SPANISH)])
@pytest.mark.parametrize("seed", range(3))
def test_a_child_is_answered(language, talk, seed):
    dialogue = Dialogue(Talk.script, language=language, seed=seed, vocabulary=TALK_VOCABULARY)
    assert dialogue.update(0.0) is None
    assert dialogue.update(2.0) is not None, "it speaks first"
    for number, (typed, words) in enumerate(talk):
        dialogue.hear(typed)
        turn = dialogue.update(3.0 + number)
        assert turn is not None, typed
        said = TaggedText.read(turn.text).text
        assert any(word in said for word in words.split("|")), (typed, said)
        assert turn.language == language


SORROWS = (
    ("en", "my dog died"), ("en", "my granny is in hospital"), ("en", "nobody likes me"),
    ("en", "my mum and dad are getting divorced"), ("en", "my mum is sad"), ("en", "i am sad"),
    ("es", "se murió mi perro"), ("es", "mi abuela está en el hospital"),
    ("es", "nadie me quiere"), ("es", "mis padres se van a separar"), ("es", "estoy triste"),
)  # fmt: skip
AFTERWARDS = {
    "en": (
        "he was old and he was my best friend", "because of my brother", "at school",
        "my cat slept on my bed", "it was on sunday",
    ),
    "es": (
        "era viejo y era mi mejor amigo", "por mi hermano", "en el cole",
        "mi gato duerme en mi cama", "fue el domingo",
    ),
}  # fmt: skip
"""What would be answered by a word of it, with a joke, if nothing sad had been said."""


def texts_of(*units):
    """Return what units can say, without tags and without what is filled in."""
    found = set()
    for unit in Talk.script.units:
        if unit.name in units:
            for state in unit.states.values():
                for transition in state.transitions:
                    for action in transition.actions:
                        if action.kind == "say":
                            found |= {TaggedText.read(text).text for _, text in action.argument}
    assert found
    return found


@pytest.mark.parametrize(("language", "sad"), SORROWS)
@pytest.mark.parametrize("seed", range(3))
def test_after_something_sad_it_listens(language, sad, seed):
    comforts = texts_of("listens", "listens closely")
    for typed in AFTERWARDS[language]:
        dialogue = Dialogue(Talk.script, language=language, seed=seed, vocabulary=TALK_VOCABULARY)
        dialogue.update(0.0)
        dialogue.update(2.0)
        dialogue.hear(sad)
        first = dialogue.update(3.0)
        assert first is not None
        dialogue.hear(typed)
        turn = dialogue.update(4.0)
        assert turn is not None
        said = TaggedText.read(turn.text).text
        said = said.replace("my friend", "{Name|my friend}").replace("peque.", "{Name|peque}.")
        assert said in comforts, (sad, typed, said)
        dialogue.hear("tell me a joke" if language == "en" else "cuéntame un chiste")
        turn = dialogue.update(5.0)
        assert turn is not None
        assert TaggedText.read(turn.text).text in texts_of("joke"), "it is not sad for ever"


@pytest.mark.parametrize(
    ("language", "typed", "not_of"),
    [
        ("en", "can you come", "end"),
        ("en", "my mother", "fear"),
        ("en", "a monster", "eggs"),
        ("es", "vale", "spinosaurus"),
        ("es", "un hueso", "eggs"),
        ("es", "te mueres", "eats people"),
    ],
)
def test_a_word_that_it_knows_is_not_read_as_another_one(language, typed, not_of):
    for seed in range(5):
        dialogue = Dialogue(Talk.script, language=language, seed=seed, vocabulary=TALK_VOCABULARY)
        dialogue.update(0.0)
        dialogue.update(2.0)
        dialogue.hear(typed)
        turn = dialogue.update(3.0)
        assert turn is not None
        assert TaggedText.read(turn.text).text not in texts_of(not_of)
