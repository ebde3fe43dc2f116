"""Every message keeps its meaning over the wire, and nonsense has none."""

import contextlib
from typing import get_args

import pytest
from hypothesis import given, strategies as st

from cubeling.robot.protocol import messages as m, wire
from cubeling.robot.protocol.fields import FieldSpec, MessageError
from cubeling.robot.protocol.schema import HEADER, MESSAGES, MessageSpec, Sender, pack, unpack
from cubeling.robot.protocol.timing import VERSION

specs = st.sampled_from(sorted(MESSAGES.values(), key=lambda spec: spec.number))


def values_of(field: FieldSpec) -> st.SearchStrategy:
    if field.is_text:
        return st.text(
            st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=4
        )
    low, high = {"u8": (0, 255), "u16": (0, 65535), "u32": (0, 2**32 - 1)}.get(
        field.wire_type, (-32768, 32767)
    )
    low = low if field.low is None else round(field.low / field.scale)
    high = high if field.high is None else round(field.high / field.scale)
    per_unit = round(1 / field.scale)
    one = st.integers(low, high).map(lambda n: n if per_unit == 1 else n / per_unit)
    return st.tuples(*[one] * 16) if field.wire_type == "i16x16" else one


@st.composite
def contents(draw):
    spec: MessageSpec = draw(specs)
    return spec, spec.kind(**{f.name: draw(values_of(f)) for f in spec.fields})


@given(contents(), st.integers(0, 65535), st.binary(max_size=20))
def test_a_message_survives_the_wire_exactly_even_with_fields_of_a_later_version(
    sent, session, new
):
    spec, content = sent
    body = pack(content, session)
    assert len(body) == spec.parts[-1].end <= wire.MAX_BODY
    assert unpack(body + new, spec.sender) == (session, content)


@given(contents(), st.data())
def test_a_message_cut_short_is_refused(sent, data):
    spec, content = sent
    body = pack(content, 1)
    shorter = data.draw(st.integers(0, spec.size - 1))
    with pytest.raises(MessageError):
        unpack(body[:shorter], spec.sender)


@given(contents(), st.data())
def test_what_an_earlier_version_does_not_say_has_its_default(sent, data):
    spec, content = sent
    version = data.draw(st.integers(1, VERSION))
    body = pack(content, 1, version)
    _, received = unpack(body, spec.sender)
    for part in spec.parts:
        for field in part.fields:
            known = part.since <= version
            expected = content if known else spec.kind
            assert getattr(received, field.name) == getattr(expected, field.name)
    assert pack(received, 1, version) == body


def test_the_first_version_is_still_what_it_was():
    """A robot made for version 1 goes on working; these are its bytes."""
    first = pack(m.Express(1, 0.8, -0.25, 1), 0xABCD, version=1)
    assert first.hex(" ") == "10 cd ab 01 00 00 00 40 1f 3c f6"
    assert unpack(first, "host") == (0xABCD, m.Express(1, 0.8, -0.25, m.NOTHING))


@given(contents())
def test_an_echo_of_the_own_side_is_no_message(sent):
    spec, content = sent
    other: Sender = "robot" if spec.sender == "host" else "host"
    assert unpack(pack(content, 3), other) == (3, None)


@given(st.integers(0, 255).filter(lambda number: number not in MESSAGES), st.binary(max_size=60))
def test_an_unknown_message_is_skipped(number, rest):
    assert unpack(HEADER.pack(number, 9) + rest, "host") == (9, None)


@given(st.binary(max_size=wire.MAX_BODY))
def test_any_body_gives_a_message_or_a_message_error(body):
    senders: tuple[Sender, ...] = get_args(Sender)
    for sender in senders:
        with contextlib.suppress(MessageError):
            unpack(body, sender)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (m.Express(1, 1.5, 0), "valence must be from -1 to 1"),
        (m.Express(0, 0.5, 0), "number must be from 1"),
        (m.Name(1, 0, "a name that is too long"), "at most 16 bytes"),
        (m.Hello(0, 5), "version must be from 1"),
    ],
)
def test_a_field_out_of_its_range_is_not_sent(content, says):
    with pytest.raises(ValueError, match=says):
        pack(content, 1)


def test_a_field_out_of_its_range_is_not_believed():
    body = bytearray(pack(m.Express(1, 0.5, 0), 1))
    body[7:9] = (32767).to_bytes(2, "little")
    with pytest.raises(MessageError, match="valence"):
        unpack(bytes(body), "host")
