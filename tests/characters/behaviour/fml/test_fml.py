"""What is meant becomes what is done."""

import pytest

from cubeling.characters.behaviour.bml import SYNCS, SyncReference
from cubeling.characters.behaviour.fml import Lexicon, behaviours_of
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.errors import CharacterError
from cubeling.toml_file import parse
from tests.characters.behaviour.bml.suite import Session

SPEECH = "<speech id='s'><text>Hello. <sync id='a'/>Look at the <sync id='b'/>cube.</text></speech>"

LEXICON = Lexicon.of(
    parse(
        """
[[emphasis.strong]]
behaviour = "gesture"
lexeme = "BEAT"
stroke = "start+0.1"
least = 0.5
[[emphasis.strong]]
behaviour = "head"
lexeme = "NOD"
amount = 0.6
scaled = ["amount"]
end = "end"
[[world.object]]
behaviour = "pointing"
target = "{target}"
stroke = "start"
""",
        "mine.toml",
    )
)


def planned(intention: str, lexicon: Lexicon | None = LEXICON):
    block = behaviours_of(f"<fml id='f'>{SPEECH}{intention}</fml>", lexicon)
    assert block.behaviours[0].text == "Hello. Look at the cube."
    return block.behaviours[1:]


def test_an_intention_is_shown_when_it_is_meant():
    beat, nod = planned("<emphasis id='e' type='strong' start='s:b-1' end='s:end'/>")
    assert (beat.id, beat.kind, beat.get("lexeme")) == ("e-1", "gesture", "BEAT")
    assert beat.syncs == {"stroke": SyncReference("s", "b", offset=-0.9)}
    assert nod.syncs == {"end": SyncReference("s", "end")}
    assert nod.get("amount") == "0.6"


def test_importance_scales_and_selects():
    (nod,) = planned("<emphasis type='strong' importance='0.4' start='s:b'/>")
    assert nod.get("amount") == "0.24"
    assert not nod.syncs


def test_an_intention_without_times_is_that_of_the_whole_speech():
    beat, nod = planned("<emphasis type='strong'/>")
    assert beat.syncs == {"stroke": SyncReference("s", "start", offset=0.1)}
    assert nod.syncs == {"end": SyncReference("s", "end")}


def test_what_it_is_about_is_what_behaviours_turn_to():
    (pointing,) = planned("<world type='object' target='cube' start='s:b'/>")
    assert pointing.get("target") == "cube"
    assert planned("<world type='object' start='s:b'/>") == ()


def test_what_is_not_known_gets_the_warning_of_the_standard():
    block = behaviours_of("<fml id='f'><emotion id='e' type='ennui'/></fml>", LEXICON)
    session = Session()
    session.realizer.accept(block)
    session.finish()
    assert [(w.id, w.type) for w in session.warnings] == [("f:e", "CUSTOM_BEHAVIOR_NOT_SUPPORTED")]
    session.check_blocks("f")


def test_nested_documents_are_read():
    block = behaviours_of(
        f"<fml-apml id='f'><bml>{SPEECH}</bml><fml><emotion type='joy'/></fml></fml-apml>"
    )
    assert [b.kind for b in block.behaviours] == ["speech", "faceLexeme"]


BUNDLED = Lexicon.load()


@pytest.mark.parametrize(("kind", "name"), BUNDLED.entries)
def test_every_entry_of_the_bundled_lexicon_is_performed(kind, name):
    meant = f"<{kind} id='i' type='{name}' target='cube' start='s:a' end='s:end'/>"
    shown = planned(meant, BUNDLED)
    assert len(shown) == len(BUNDLED.entries[kind, name])
    session = Session()
    session.realizer.accept(behaviours_of(f"<fml id='f'>{SPEECH}{meant}</fml>"))
    session.finish().check_clean()
    for behaviour in shown:
        session.check_syncs("f", behaviour.id, SYNCS[behaviour.kind])


def test_the_gestures_of_the_bundled_lexicon_are_in_the_library():
    gestures = GestureCollection.load_bundled()
    lexemes = {
        str(shown.attributes["lexeme"])
        for entry in BUNDLED.entries.values()
        for shown in entry
        if shown.behaviour == "gesture"
    }
    assert lexemes <= {*gestures.names}


@pytest.mark.parametrize(
    "text",
    [
        "emphasis = 1",
        "[emphasis]\nstrong = 1",
        "[emphasis]\nstrong = [1]",
        "[[emphasis.strong]]\nlexeme = 'NOD'",
        "[[emphasis.strong]]\nbehaviour = 'dance'",
        "[[emphasis.strong]]\nbehaviour = 'head'\nstart = 'later'",
        "[[emphasis.strong]]\nbehaviour = 'head'\nstart = 'start 1'",
        "[[emphasis.strong]]\nbehaviour = 'gazeShift'\nstroke = 'start'",
        "[[emphasis.strong]]\nbehaviour = 'head'\namount = []",
        "[[emphasis.strong]]\nbehaviour = 'head'\nlexeme = 'NOD'\nscaled = ['lexeme']",
        "[[emphasis.strong]]\nbehaviour = 'head'\nleast = 2",
        "[[emphasis.strong",
    ],
)
def test_bad_lexicons_are_refused_in_one_line(text):
    with pytest.raises(CharacterError) as error:
        Lexicon.of(parse(text, "mine.toml", CharacterError), "mine.toml")
    assert str(error.value).startswith("mine.toml: ")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("strength", ["much", "-1", "nan", "2"])
def test_strengths_are_numbers_from_nothing_to_one(strength):
    with pytest.raises(CharacterError, match="give 0 to 1"):
        planned(f"<emphasis type='strong' importance='{strength}'/>")
