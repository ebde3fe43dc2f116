"""BML documents are read, and what is no BML is refused in one line."""

import pytest
from hypothesis import given, strategies as st

from cubeling.characters.behaviour.bml import BML, SyncMark, SyncReference, parse
from cubeling.characters.behaviour.bml.parser import (
    LIMITS,
    MAX_BEHAVIOURS,
    MAX_ID_CHARS,
    MAX_MARKS,
    MAX_NAMES,
    MAX_TIED,
    reference,
)
from cubeling.characters.errors import CharacterError
from tests.characters.behaviour.bml.suite import block

BEFORE = "<before ref='1'><sync ref='2'/></before>"


def test_text_has_single_spaces_and_marks_between_words():
    (speech,) = parse(
        block("<speech id='s'><text>\n Hey  punk <sync id='a'/>what <b>do <sync id='b'/></b>"
              "ya\twant?<sync id='c'/> </text></speech>")
    ).behaviours  # fmt: skip
    assert speech.text == "Hey punk what do ya want?"
    assert speech.marks == (SyncMark("a", 9), SyncMark("b", 17), SyncMark("c", 25))


def test_attributes_are_sync_points_or_others():
    (gesture,) = parse(
        block("<gesture xmlns:c='urn:c' id='g' lexeme='BEAT' stroke='s:a-0.25' c:power='1'/>")
    ).behaviours
    assert dict(gesture.syncs) == {"stroke": SyncReference("s", "a", offset=-0.25)}
    assert gesture.get("lexeme") == "BEAT"
    assert gesture.get("power", namespace="urn:c") == "1"
    assert gesture.get("mode", "BOTH_HANDS") == "BOTH_HANDS"


def test_foreign_behaviours_and_children_are_kept():
    foreign, posture = parse(
        block("<x:dance xmlns:x='urn:x' id='d'><x:step/></x:dance>"
              "<postureShift id='p'><stance type='SITTING'/></postureShift>")
    ).behaviours  # fmt: skip
    assert (foreign.kind, foreign.namespace) == ("dance", "urn:x")
    assert posture.children[0].tag == "stance"
    assert posture.children[0].attributes == {"type": "SITTING"}


def test_what_is_required_is_marked():
    read = parse(
        block("<required><head id='n' lexeme='NOD'/><constraint><synchronize><sync ref='n:start'/>"
              "<sync ref='1'/></synchronize></constraint></required><gaze id='g'/>")
    )  # fmt: skip
    assert [b.required for b in read.behaviours] == [True, False]
    assert [c.required for c in read.constraints] == [True]


def test_constraints_name_moments():
    read = parse(
        block("<constraint id='c'><before ref='a:end'><sync ref='b:start'/></before>"
              "<after ref='1'><sync ref='b:start'/></after></constraint>")
    )  # fmt: skip
    assert [(c.kind, str(c.reference)) for c in read.constraints] == [
        ("before", "a:end"),
        ("after", "1"),
    ]
    assert len({c.id for c in read.constraints}) == 2


@pytest.mark.parametrize(
    ("more", "field", "value"),
    [
        ('composition="append"', "composition", "APPEND"),
        ('composition="REPLACE"', "composition", "REPLACE"),
        ('composition="APPEND-AFTER(a,b)"', "append_after", ("a", "b")),
        ('bmla:chunkAfter="a"', "chunk_after", ("a",)),
        ('bmla:interrupt="a, b"', "interrupt", ("a", "b")),
        ('bmla:onStart="a"', "on_start", ("a",)),
        ('bmla:preplan="true"', "preplan", True),
        ('characterId="Anna"', "character", "Anna"),
    ],
)
def test_block_attributes(more, field, value):
    assert getattr(parse(block(more=more)), field) == value


@pytest.mark.parametrize(
    "document",
    [
        "",
        "hello",
        "<bml",
        "<html/>",
        f'<bml xmlns="{BML}"/>',
        '<!DOCTYPE bml [<!ENTITY a "b">]><bml id="a">&a;</bml>',
        '<!DOCTYPE bml SYSTEM "file:///etc/passwd"><bml id="a"/>',
        block("<head id='a'/><head id='a'/>"),
        block("<head id='a' start='soon'/>"),
        block("<head id='a' start='b:end 3'/>"),
        block("<head id='a' start='1e99'/>"),
        block("<head id='a' start='nan'/>"),
        block("<constraint><before><sync ref='1'/></before></constraint>"),
        block("<constraint><during/></constraint>"),
        block("<constraint><synchronize><sync/></synchronize></constraint>"),
        block("<speech id='s'><text>a<sync id='end'/></text></speech>"),
        block(more='composition="LATER"'),
        block("<g>" * LIMITS.depth + "</g>" * LIMITS.depth),
        block(f"<gesture>{'<g/>' * LIMITS.elements}</gesture>"),
        block("<g/>" * (MAX_BEHAVIOURS + 1)),
        block(f"<constraint>{BEFORE * MAX_TIED}</constraint>"),
        block(
            "<speech><text>"
            + "".join(f"<sync id='m{i}'/>" for i in range(MAX_MARKS + 1))
            + "</text></speech>"
        ),
        block(name="b" * (MAX_ID_CHARS + 1)),
        block(f"<wait id='{'w' * (MAX_ID_CHARS + 1)}'/>"),
        block(more=f"composition='APPEND-AFTER({'a ' * (MAX_NAMES + 1)})'"),
        block("<wait start='3601'/>"),
        block("<wait start='w:end+3601'/>"),
        block(f"<wait start='{'1' * 100_000}x'/>"),
        block(f"<{'g' * 300}/>"),
        block(" " * LIMITS.bytes),
        b"\xff\xfe<",
        b'<?xml version="1.0" encoding="none"?><bml id="a"/>',
        "<bml id='\ud800'/>",
    ],
)
def test_bad_documents_are_refused_in_one_line(document):
    with pytest.raises(CharacterError) as error:
        parse(document)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 250


@given(
    st.builds(
        SyncReference,
        st.from_regex(r"[a-z]\w{0,5}", fullmatch=True),
        st.from_regex(r"[a-z]\w{0,5}", fullmatch=True),
        st.sampled_from(["", "bml1"]),
        st.floats(-1000, 1000).map(lambda x: float(f"{x:g}")),
    )
)
def test_moments_are_read_as_they_are_written(moment):
    assert reference(str(moment)) == moment


@given(st.text(max_size=200) | st.binary(max_size=200))
def test_anything_else_is_refused_and_nothing_else_happens(text):
    with pytest.raises(CharacterError):
        parse(text)
