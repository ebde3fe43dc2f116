"""Messages in the tree: what is written is read, what is wrong is refused, the document is true."""

import json

import pytest
from hypothesis import given, strategies as st

from cubeling.robot.network import messages as m
from cubeling.robot.network.messages import MalformedError, decode, encode
from cubeling.robot.network.topics import Member, is_name, member_of, topic_matches
from tools.network_reference import DOCUMENT, updated

MESSAGE_TYPES = list(dict.fromkeys(m.MESSAGE_TYPES.values()))
COUNTS = st.integers(1, m.MAX_INTEGER)
UNITS = st.floats(-1, 1)
TEXTS = st.text(max_size=20).filter(lambda text: text.isprintable())
MESSAGES = st.one_of(
    st.builds(m.StatusMessage, COUNTS, COUNTS, st.sampled_from(["online", "lost", "closed"]),
              st.lists(TEXTS, max_size=5).map(tuple)),
    st.builds(m.ActionMessage, COUNTS, COUNTS, COUNTS, TEXTS, UNITS, st.floats(0, 1e6)),
    st.builds(m.EmotionMessage, COUNTS, COUNTS, UNITS, UNITS, st.none() | TEXTS),
    st.builds(m.AckMessage, COUNTS, COUNTS,
              st.dictionaries(TEXTS, st.tuples(COUNTS, COUNTS), max_size=5)),
    st.builds(m.StateMessage, COUNTS, COUNTS, TEXTS, observed=st.none() | st.tuples(UNITS, UNITS),
              battery=st.none() | st.floats(0, 1)),
)  # fmt: skip


@given(MESSAGES)
def test_decoding_reverses_encoding(message):
    assert decode(type(message), encode(message)) == message


@given(MESSAGES, st.dictionaries(st.text(max_size=8), st.integers() | st.text(max_size=8)))
def test_fields_of_a_later_version_are_skipped(message, later):
    fields = set(message.__struct_fields__)
    document = {k: v for k, v in later.items() if k not in fields} | json.loads(encode(message))
    assert decode(type(message), json.dumps(document).encode()) == message


ACTION = m.ActionMessage
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=8,
)


@given(st.sampled_from(MESSAGE_TYPES), st.data())
def test_any_payload_is_decoded_or_refused_with_one_error(kind, data):
    names = list(kind.__struct_fields__)
    document = data.draw(st.dictionaries(st.sampled_from(names), JSON))
    for payload in (json.dumps(document).encode(), data.draw(st.binary(max_size=60))):
        try:
            message = decode(kind, payload)
        except MalformedError:
            continue
        assert decode(kind, encode(message)) == message


@pytest.mark.parametrize(
    ("kind", "payload", "says"),
    [
        (ACTION, b"x" * 4097, "4097 bytes"),
        (ACTION, b"[]", "Expected `object`"),
        (ACTION, b'{"session":1,"number":1,"oldest":1}', "missing required field `name`"),
        (ACTION, b'{"session":1,"number":0,"oldest":1,"name":"a"}', "number"),
        (ACTION, b'{"session":1,"number":true,"oldest":1,"name":"a"}', "number"),
        (
            m.ActionMessage,
            b'{"session":1,"number":9007199254740993,"oldest":1,"name":"a"}',
            "number",
        ),
        (ACTION, b'{"session":1,"number":1,"oldest":1,"name":"a\\n"}', "name"),
        (ACTION, b'{"session":1,"number":1,"oldest":1,"name":"a","weight":1.1}', "weight"),
        (
            m.EmotionMessage,
            b'{"session":1,"number":1,"valence":NaN,"arousal":0}',
            "JSON is malformed",
        ),
        (m.StatusMessage, b'{"session":1,"number":1,"status":"here"}', "status"),
        (m.AckMessage, b'{"session":1,"number":1,"players":{"a/b":[1]}}', "players"),
    ],
)
def test_invalid_payloads_are_refused(kind, payload, says):
    with pytest.raises(MalformedError, match=says):
        decode(kind, payload)


def test_the_largest_messages_fit():
    place = "ä" * 16 + "/" + "ä" * 16
    marks = {f"{place[:-1]}{n:02}": (m.MAX_INTEGER,) * 2 for n in range(m.MAX_ENTRIES)}
    follows = tuple(marks)
    for message in (
        m.AckMessage(1, m.MAX_INTEGER, marks),
        m.StatusMessage(1, 1, "online", follows),
    ):
        assert decode(type(message), encode(message)) == message


def test_the_document_is_current():
    text = DOCUMENT.read_text("utf-8")
    assert updated(text) == text, "run python -m tools.network_reference"
    for form in MESSAGE_TYPES:
        for name in form.__struct_fields__:
            assert f"| `{name}` |" in text


@given(st.text(max_size=40))
def test_a_name_has_no_special_meaning_in_a_topic(text):
    if is_name(text):
        topic = Member(text, "robot", text).topic("state")
        assert member_of(topic) == (Member(text, "robot", text), "state")
        assert not set(text) & set("/+#$\0 :=")
        assert topic_matches("cubeling/1/+/robot/+/state", topic)


@pytest.mark.parametrize(
    "topic", ["", "cubeling/1/a/robot/b", "cubeling/2/a/robot/b/state", "cubeling/1/a/cat/b/state",
              "cubeling/1//robot/b/state", "cubeling/1/a/robot/b/state/c", "x/cubeling/1/a/b/c"],
)  # fmt: skip
def test_other_topics_are_ignored(topic):
    assert member_of(topic) is None
