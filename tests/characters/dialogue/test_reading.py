"""Scripts that cannot be played are named by line."""

import re
import time
from pathlib import Path

import pytest

from cubeling.characters.dialogue.patterns import Heard, WordPattern
from cubeling.characters.dialogue.reading import read_script
from cubeling.characters.errors import CharacterError

SAY = '<action type="say">Hello.</action>'
END = '<state name="end" accepting="yes"/>'

WRONG = {
    "not XML": ("<dialogue>\n<unit>", ":2: not XML"),
    "no unit": ("<dialogue/>", ":1: a dialogue without a unit"),
    "two units of one name": (
        f'<dialogue>\n<unit name="u">{END}</unit>\n<unit name="u">{END}</unit></dialogue>',
        ":3: a second unit 'u'; the first is at line 2",
    ),
    "unreachable state": (
        f'<dialogue><unit name="u">{END}\n<state name="far">\n<transition to="end"/></state>'
        "</unit></dialogue>",
        ":2: the state 'far' of the unit 'u' is never reached",
    ),
    "no such state": (
        '<dialogue><unit name="u"><state name="q">\n<transition to="there"/></state></unit>'
        "</dialogue>",
        ":2: there is no state 'there'",
    ),
    "dead end": (
        '<dialogue><unit name="u"><state name="a"><transition to="b"/></state>\n<state name="b"/>'
        "</unit></dialogue>",
        ":2: the state 'b' of the unit 'u' leads nowhere",
    ),
    "endless loop": (
        '<dialogue><unit name="u"><state name="a"><transition to="b"/></state>\n<state name="b">'
        '\n<transition to="a"/></state></unit></dialogue>',
        ":3: an endless loop in the unit 'u'",
    ),
    "endless cycle": (
        f'<dialogue><unit name="u" cyclic="yes"><state name="a">\n<transition to="end">{SAY}'
        f"</transition></state>{END}</unit></dialogue>",
        ":2: an endless loop",
    ),
    "a feeling is no event": (
        '<dialogue><unit name="u"><state name="a">\n<transition><condition type="above_threshold">'
        f"<emotion>fear</emotion><value>0.2</value></condition>{SAY}</transition></state></unit>"
        "</dialogue>",
        ":2: an endless loop",
    ),
    "unknown emotion": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n<action '
        'type="emotional_influence"><emotion>envy</emotion><value>1</value></action></transition>'
        f"</state>{END}</unit></dialogue>",
        ":2: action emotional_influence: 'envy' is none of the emotions",
    ),
    "value out of range": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n<action '
        'type="emotional_influence"><emotion>joy</emotion><value>nan</value></action></transition>'
        f"</state>{END}</unit></dialogue>",
        ":2: action emotional_influence: 'nan' is no number from 0 to 1",
    ),
    "unknown action": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n'
        f'<action type="fly">up</action></transition></state>{END}</unit></dialogue>',
        ":2: 'fly' is no action; there are say, ",
    ),
    "unknown condition": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n'
        f'<condition type="moon"/></transition></state>{END}</unit></dialogue>',
        ":2: 'moon' is no condition; there are input_match, ",
    ),
    "a reply that is not text": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n'
        f'<action type="say"><img src="x"/></action></transition></state>{END}</unit></dialogue>',
        ":2: action say: <img> is not text",
    ),
    "a reply without words": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n'
        f'<action type="say"> … ! </action></transition></state>{END}</unit></dialogue>',
        ":2: action say: a reply that is not text",
    ),
    "a gesture without an end": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n<action type="say">'
        '<begin_gesture id="g" anim="wave"/>Hi</action></transition></state>'
        f"{END}</unit></dialogue>",
        ":2: action say: gesture 'g' never ends",
    ),
    "a text in no language of the script": (
        '<dialogue languages="en"><unit name="u"><state name="a"><transition to="end">\n'
        f'<action type="say"><text lang="ca">Hola</text></action></transition></state>{END}'
        "</unit></dialogue>",
        ":2: lang='ca' is none of the languages en",
    ),
    "nothing to say in a language": (
        '<dialogue languages="en es"><unit name="u"><state name="a"><transition to="end">\n'
        f'<action type="say"><text lang="es">Hola</text></action></transition></state>{END}'
        "</unit></dialogue>",
        ":2: there is no text in 'en'",
    ),
    "a slot that nothing fills": (
        '<dialogue><unit name="u"><state name="a"><transition to="end">\n'
        f'<action type="say">Hello {{name}}</action></transition></state>{END}</unit></dialogue>',
        ":2: nothing fills {name}",
    ),
    "one answer to everything": (
        '<dialogue><unit name="u"><state name="a"><transition>\n'
        f'<condition type="input_match">*</condition>\n{SAY}</transition></state></unit>'
        "</dialogue>",
        ":3: one text answers everything in 'en'",
    ),
    "priority": (
        f'<dialogue>\n<unit name="u" priority="-1">{END}</unit></dialogue>',
        ":2: priority='-1'",
    ),
    "DTD": ('<!DOCTYPE x [<!ENTITY a "b">]><dialogue/>', ":1: DTDs and entities are not read"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_script_that_cannot_be_played_is_named_by_line(name: str, tmp_path: Path) -> None:
    text, message = WRONG[name]
    path = tmp_path / "my.xml"
    path.write_text(text)
    with pytest.raises(CharacterError, match=re.escape(f"my.xml{message}")) as refused:
        read_script(path)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("pattern", "text", "slots"),
    [
        ("*", "", {}),
        ("* dinosaur *", "dinosaur", {}),
        ("* dinosaur *", "a DINOSAUR, please", {}),
        ("* dinosaur *", "dinosaurs", None),
        ("a * b * c", "a b b c", {}),
        ("a * b * c", "a c b", None),
        ("* b", "b x b", {}),
        ("* b", "b x", None),
        ("i am {age} years old", "I'm 8 years old", None),
        ("i am {age} years old", "I am 8 years old!", {"age": "8"}),
        ("* {a} and {b} *", "you, Ana and Bob", {"a": "Ana", "b": "Bob"}),
        ("¿cómo estás?", "como estas", {}),
    ],
)
def test_patterns(pattern: str, text: str, slots: dict[str, str] | None) -> None:
    assert WordPattern.read(pattern).match(Heard.of(text)) == slots


def test_a_pattern_of_many_stars_takes_time_that_is_linear_in_the_text() -> None:
    pattern = WordPattern.read("* " + " * ".join(["a"] * 18) + " b")

    def seconds(words: int) -> float:
        text = "a " * words
        begin = time.thread_time()
        for _ in range(20):
            assert pattern.expression.fullmatch(text) is None
        return time.thread_time() - begin

    seconds(50)
    assert min(seconds(1600) for _ in range(3)) < 12 * min(seconds(400) for _ in range(3))


@pytest.mark.parametrize("pattern", ["", " | a", "{Name}", "{", "{a} {a}", "?!", "a " * 41])
def test_a_pattern_of_no_use_is_refused(pattern: str) -> None:
    with pytest.raises(CharacterError):
        [WordPattern.read(each) for each in pattern.split("|")]
