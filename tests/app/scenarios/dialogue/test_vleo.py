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
