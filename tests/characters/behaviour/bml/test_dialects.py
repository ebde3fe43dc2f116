"""The BML of others is read: what is meant is kept, and what is changed is noted by its line."""

from contextlib import suppress

import pytest
from hypothesis import given, strategies as st

from cubeling.characters.behaviour import shown_by
from cubeling.characters.behaviour.bml import BmlWarning, parse
from cubeling.characters.behaviour.bml.dialects import parse_dialect
from cubeling.characters.errors import CharacterError
from tests.characters.behaviour.bml.suite import Session, block

MINDMAKERS = "http://www.mindmakers.org/projects/BML"

SPEECH = """<speech id="s1" start="0.0" language="english" text="">
<description level="1" type="gretabml"><reference>tmp/any.pho</reference></description>
<tm id="tm1"/>The lamp is red, <tm id="tm2"/>and the door is open. <tm id="tm3"/>
<pitchaccent id="pa1" type="HStar" level="strong" start="s1:tm2" end="s1:tm3"/></speech>"""


def read(inside: str, root: str = "bml"):
    """Return the behaviours of a block in a dialect by id, and its notes."""
    found = parse_dialect(f"<{root}>{inside}</{root.split()[0]}>")
    return {each.id: each for each in found.behaviours}, "\n".join(found.notes)


def times(behaviour):
    return {sync: str(moment) for sync, moment in behaviour.syncs.items()}


def test_a_block_needs_no_id_and_may_have_the_namespace_of_a_draft():
    found = parse_dialect(f'<bml xmlns="{MINDMAKERS}" character="Ann"><head lexeme="NOD"/></bml>')
    assert (found.id, found.character, len(found.behaviours)) == ("", "Ann", 1)
    assert MINDMAKERS in found.notes[0]
    session = Session()
    for _ in range(2):
        session.realizer.accept(found)
    warned = [each.id for each in session.realizer.update(0.0) if isinstance(each, BmlWarning)]
    assert warned == ["block1", "block2"]


def test_marks_and_texts_are_read_where_dialects_write_them():
    found, _ = read(SPEECH)
    speech = found["s1"]
    assert speech.text == "The lamp is red, and the door is open."
    assert [(mark.id, mark.at) for mark in speech.marks] == [("tm1", 0), ("tm2", 17), ("tm3", 38)]
    assert speech.get("lang", namespace="http://www.w3.org/XML/1998/namespace") == "en"
    assert times(found["s1-pa1"]) == {"attackPeak": "s1:tm2"}
    smart, _ = read(
        '<speech id="s"><mark name="T0"/>take <mark name="T1"/><mark name="T1"/>it</speech>'
    )
    assert [mark.id for mark in smart["s"].marks] == ["T0", "T1"]
    only, _ = read('<speech id="s" text="Hello"/>')
    assert only["s"].text == "Hello"


def test_what_starts_before_its_block_lets_the_block_begin_earlier():
    found, notes = read(
        SPEECH + '<head id="h" lexeme="NOD" start="-0.2" end="1.4"/><face id="f" au="1" start="0"/>'
    )
    assert times(found["h"]) == {"start": "0", "end": "1.6"}
    assert times(found["s1"]) == times(found["f"]) == {"start": "0.2"}
    assert "begins 0.2 s early" in notes


def test_ends_before_starts_are_durations():
    found, notes = read(
        '<face id="a" lexeme="joy" start="5" end="2"/><gesture id="b" lexeme="BEAT" start="1" '
        'stroke="0.5" end="3"/>'
    )
    assert times(found["a"]) == {"start": "5", "end": "7"}
    assert times(found["b"]) == {"start": "1", "stroke": "1.5", "end": "4"}
    assert "durations" in notes


def test_an_id_that_is_taken_is_another_behaviour_or_says_more_of_the_first():
    found, notes = read(
        '<face id="f" lexeme="joy"/>\n<gesture id="f" lexeme="BEAT"/>\n'
        '<gesture id="g" type="WAVE" start="1"/><gesture id="g" stroke="2"/>'
        '<gesture id="g" expressivityspc="-1"/>'
    )
    assert list(found) == ["f", "f-2", "g"]
    assert 'line 2: a second "f" is called "f-2"' in notes
    assert found["g"].get("spatial", namespace="urn:cubeling:behaviour") == "-1"
    assert "stroke" in found["g"].syncs


def test_expressivity_of_a_description_is_ours():
    numbers = {"SPC": -0.6, "TMP": 0.5, "FLD": 0.3, "PWR": 0.9, "OPN": 0.4, "TEN": -1.0}
    inside = "".join(f"<{name}.value>{value}</{name}.value>" for name, value in numbers.items())
    found, _ = read(f'<gesture id="g" lexeme="BEAT"><description>{inside}</description></gesture>')
    names = ("spatial", "tempo", "fluidity", "power", "openness", "tension")
    own = [found["g"].get(name, namespace="urn:cubeling:behaviour") for name in names]
    assert own == ["-0.6", "0.5", "0.3", "0.9", "0.7", "-1"]


@pytest.mark.parametrize(
    ("written", "kind", "lexeme"),
    [
        ('<gesture lexeme="hello-waving" type="LEXICALIZED"/>', "gesture", "WAVE"),
        ('<gesture lexeme="DEICTIC" type="YOU"/>', "gesture", "POINT_YOU"),
        ('<animation name="ChrBrad@Idle01_BeatMidBt01"/>', "gesture", "BEAT_BOTH"),
        ('<head type="NOD" repeats="1.0"/>', "head", "NOD"),
        ('<head><description><reference>head=head_shake</reference></description></head>', "head",
         "SHAKE"),
        ('<face><lexeme lexeme="Hstar"/></face>', "face", "RAISE_BROWS"),
        ('<face type="affect=complex:NEUTRAL_and_ANGER"/>', "face", "angry"),
        ('<torso posture="extend"/>', "posture", "ERECT"),
        ('<shoulder lexeme="up"/>', "gesture", "SHRUG"),
    ],
)  # fmt: skip
def test_names_of_others_are_ours(written, kind, lexeme):
    (found,) = parse_dialect(f"<act><bml>{written}</bml></act>").behaviours
    assert (found.kind, found.get("lexeme")) == (kind, lexeme)


def test_a_head_may_go_two_ways_at_once():
    found, _ = read('<head id="h" lexeme="Down_Aside_Right" start="1"/>')
    assert {name: each.get("lexeme") for name, each in found.items()} == {
        "h": "DOWN",
        "h-part2": "RIGHT",
    }


def test_smartbody_is_read_with_its_undeclared_prefix():
    found, notes = read(
        '<participant id="guide"/><bml>\n<sbm:animation name="Beat" stroke="1"/>'
        '<gaze target="a" sbm:joint-range="EYES CHEST"/><saccade mode="talk"/>\n'
        '<face type="FACS" au="1" side="both" amount="0.6"/></bml>',
        "act",
    )
    assert found["gesture1"].get("lexeme") == "BEAT"
    assert found["gaze1"].get("influence") == "SHOULDER"
    assert [child.attributes["au"] for child in found["face1"].children] == ["1"]
    assert 'line 2: nothing declares the prefix "sbm:"' in notes
    assert "<saccade> is left out" in notes


def test_times_that_mean_nothing_are_left_out_with_a_note():
    found, notes = read(SPEECH + '<head id="h" type="NOD" start="s1:tm9" end="soon"/>')
    assert not found["h"].syncs
    assert "its start is left out: there is no s1:tm9" in notes
    assert 'its end is left out: "soon" is no moment' in notes
    face, _ = read('<speech id="s">a</speech><face id="f" au="1" stroke="s:relax+1" relax="4"/>')
    assert times(face["f"]) == {"attackPeak": "s:end+1", "relax": "4"}


def test_intentions_of_greta_become_behaviours():
    intentions = (
        '<emotion id="e1" type="joyStrong" start="s1:tm1" end="s1:tm3" importance="1.0"/>'
        '<deictic id="d1" type="you" start="s1:tm2"/>'
        '<world id="w" ref_type="person" ref_id="self"/>'
    )
    document = f"<fml-apml><bml>{SPEECH}</bml><fml>{intentions}</fml></fml-apml>"
    shown = {each.id: each.get("lexeme") for each in shown_by(parse_dialect(document)).behaviours}
    assert shown["e1-1"] == "happy"
    assert shown["d1"] == "POINT_YOU"
    assert shown["w-1"] == "POINT_SELF"


def test_a_time_that_cannot_be_met_is_given_up_and_not_the_behaviour():
    session = Session()
    session.realizer.accept(
        parse_dialect('<bml>\n<head id="h" type="NOD" start="1" end="1.01"/></bml>')
    )
    (warning,) = [e for e in session.realizer.update(0.0) if isinstance(e, BmlWarning)]
    assert warning.description.startswith("line 2: its end is given up")
    assert [each.start for each in session.realizer.scheduled] == [1.0]


@pytest.mark.parametrize(
    "document",
    [
        '<!DOCTYPE bml [<!ENTITY a "b">]><bml id="b"/>',
        '<!DOCTYPE bml SYSTEM "bml.dtd" [<!ATTLIST head lexeme CDATA "NOD">]><bml id="b"/>',
        "<bml><head></bml>",
        "<bml>" + "<head/>" * 300 + "</bml>",
        "<x>" * 40 + "</x>" * 40,
        "<bml>&a;</bml>",
    ],
)
def test_what_is_refused_is_refused_in_one_line(document):
    with pytest.raises(CharacterError) as error:
        parse_dialect(document)
    assert "\n" not in str(error.value)


def test_a_dtd_that_is_only_named_is_not_read():
    found = parse_dialect(
        b'<?xml version="1.0" encoding="ISO-8859-1"?>\n<!-- old -->\n'
        b'<!DOCTYPE bml SYSTEM "bml.dtd" []>\n<bml>\n<speech id="s">caf\xe9</speech></bml>'
    )
    assert found.behaviours[0].text == "café"
    assert found.behaviours[0].line == 5
    assert found.notes == ("line 3: the DTD that it names is not read",)


@given(st.text(max_size=200), st.sampled_from(["", "<bml", "<bml>", "<!DOCTYPE bml", "<act><bml>"]))
def test_any_text_is_read_or_refused(text, start):
    with suppress(CharacterError):  # nothing else is raised
        parse_dialect(start + text)


def test_what_is_in_the_standard_stays_as_it_is():
    inside = (
        "<speech id='s'><text>Hey <sync id='a'/>you</text></speech>"
        "<gesture id='g' lexeme='BEAT' stroke='s:a' end='s:end+1'/><required>"
        "<gaze id='z' target='x' influence='WAIST' start='1'/></required>"
        "<faceLexeme id='f' lexeme='RAISE_BROWS' attackPeak='2'/>"
        "<postureShift id='p'><stance type='SITTING'/></postureShift>"
        "<constraint><after ref='s:end'><sync ref='f:start'/></after></constraint>"
        "<bmla:interrupt id='i' target='other'/>"
    )
    strict, lenient = parse(block(inside)), parse_dialect(block(inside))
    assert lenient.notes == ()
    assert (lenient.id, lenient.constraints) == (strict.id, strict.constraints)
    for one, other in zip(strict.behaviours, lenient.behaviours, strict=True):
        assert (one.id, one.kind, one.namespace) == (other.id, other.kind, other.namespace)
        assert (one.syncs, one.text, one.marks) == (other.syncs, other.text, other.marks)
        assert (one.attributes, one.required) == (other.attributes, other.required)
