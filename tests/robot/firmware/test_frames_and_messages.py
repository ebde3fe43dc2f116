"""The firmware's frames and messages are those of the protocol, byte for byte."""

import json
import struct
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

import cubeling.robot.protocol
from cubeling.robot.firmware.dino import codec, frames, messages
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import pack, spec_of, unpack
from cubeling.robot.protocol.wire import MAX_BODY, MAX_FRAME, FrameReader, encode_frame

VECTORS = json.loads(
    (Path(cubeling.robot.protocol.__file__).parent / "vectors.json").read_text("utf-8")
)
BODIES = st.binary(min_size=1, max_size=MAX_BODY)


def read(data: bytes) -> list[bytes]:
    """Feed the firmware's reader; return the bodies that it found."""
    reader = frames.FrameDecoder()
    found = []
    for byte in data:
        size = reader.feed(byte)
        if size:
            found.append(bytes(reader.body[:size]))
    return found


def frame(body: bytes) -> bytes:
    """Return the firmware's frame of a body."""
    out = frames.TransmitBuffer(256)
    out.put(bytearray(body), len(body))
    return bytes(out.data[: out.end])


@pytest.mark.parametrize("vector", VECTORS["frames"], ids=lambda vector: vector["message"])
def test_every_vector_is_read_and_written_byte_for_byte(vector):
    body, whole = bytes.fromhex(vector["body"]), bytes.fromhex(vector["frame"])
    assert read(whole) == [body]
    assert frame(body) == whole


@pytest.mark.parametrize("vector", VECTORS["frames"], ids=lambda vector: vector["message"])
def test_every_vector_of_a_robot_is_packed_from_its_values(vector):
    body = bytearray.fromhex(vector["body"])
    if body[0] in messages.FROM_ROBOT:
        layout, _ = messages.FROM_ROBOT[body[0]]
        values = struct.unpack_from(layout, body.ljust(MAX_BODY), 0)
        out = bytearray(MAX_BODY)
        assert out[: codec.pack(out, vector["version"], *values)] == body
    else:
        heard = codec.unpack(body + bytearray(MAX_BODY), len(body))
        assert heard is not None
        assert heard[:2] == (body[0], vector["session"])


@pytest.mark.parametrize("entry", VECTORS["skipped by a robot"], ids=lambda entry: entry["why"])
def test_vectors_to_be_skipped_are_skipped(entry):
    for body in read(bytes.fromhex(entry["bytes"])):
        assert codec.unpack(bytearray(body).ljust(MAX_BODY + 1), len(body)) is None


@given(BODIES)
def test_any_body_is_framed_as_the_host_frames_it(body):
    assert frame(body) == encode_frame(body)
    assert read(encode_frame(body)) == [body]


@given(st.binary(max_size=300), BODIES)
def test_after_any_garbage_the_next_whole_frame_is_received(garbage, body):
    assert read(garbage + encode_frame(body))[-1] == body


@given(st.binary(max_size=600))
def test_any_stream_gives_the_frames_that_the_host_finds_in_it(stream):
    # Zero bytes are rare in what Hypothesis draws, and edges are what matters here.
    stream = bytes(byte if byte > 40 else 0 for byte in stream)
    assert read(stream) == FrameReader().feed(stream)


@given(BODIES, st.lists(st.integers(0, 8 * MAX_FRAME), min_size=1, max_size=3, unique=True))
def test_up_to_three_wrong_bits_are_detected(body, wrong):
    encoded = bytearray(encode_frame(body)[1:-1])
    for bit in {bit % (8 * len(encoded)) for bit in wrong}:
        encoded[bit // 8] ^= 1 << bit % 8
    assert 0 in encoded or read(b"\0" + encoded + b"\0") == []


def test_the_longest_frame_fits_and_a_longer_one_is_dropped():
    body = bytes(range(1, MAX_BODY + 1))
    assert read(encode_frame(body)) == [body]
    assert read(b"\0" + b"\x7a" * (MAX_FRAME + 1) + b"\0" + encode_frame(body)) == [body]
    assert read(encode_frame(body)[:-1] + b"\1\0") == [], "its begin alone is no frame"


def _hosts() -> st.SearchStrategy[object]:
    number = st.integers(1, 2**32 - 1)
    unit = st.integers(-10_000, 10_000).map(lambda count: count / 10_000)
    byte = st.integers(0, 255)
    return st.one_of(
        st.builds(m.Hello, st.integers(1, 255), number),
        st.builds(m.Ask, byte, byte),
        st.builds(m.Beat, st.integers(0, 65535)),
        st.builds(m.Express, number, unit, unit, byte),
        st.builds(m.Play, number, st.integers(1, 2), byte),
        st.builds(m.Stop, number),
        st.builds(
            m.Move, number, st.integers(0, 65535).map(lambda count: count / 1000),
            st.integers(0, 65535), st.integers(0, 65535),
            st.tuples(*[st.integers(-32768, 32767).map(lambda count: count / 1000)] * 16),
        ),
        st.just(m.Bye()),
    )  # fmt: skip


@given(_hosts(), st.integers(0, 65535), st.integers(1, 3), st.binary(max_size=9))
def test_messages_of_all_versions_and_of_later_ones_are_read(message, session, version, later):
    body = pack(message, session, version)
    if version == 3:
        body += later  # fields that we do not know yet
    values = codec.unpack(bytearray(body).ljust(MAX_BODY + 1, b"\x55"), len(body))
    assert values is not None
    _, expected = unpack(body, "host")
    counts = [one for f in spec_of(type(message)).fields for one in f.to_wire(
        getattr(expected, f.name))]  # fmt: skip
    assert values == (body[0], session, *counts)


@given(st.sampled_from([1, 2, 3, 0x10, 0x11, 0x12, 0x13, 0x1F, 0x84, 0x42]), st.binary(max_size=48))
def test_a_body_is_skipped_exactly_where_the_host_side_code_skips_it(number, rest):
    body = bytes([number]) + rest
    try:
        expected = unpack(body, "host")[1]
    except MessageError:
        expected = None
    values = codec.unpack(bytearray(body).ljust(MAX_BODY + 1, b"\x55"), len(body))
    assert (values is None) == (expected is None)


def test_a_frame_without_room_is_dropped_as_a_whole():
    out = frames.TransmitBuffer(100)
    for size in (40, 40, 40, 3):
        out.put(bytearray(40), size)
    assert (out.end, out.dropped) == (92, 2)
    assert read(bytes(out.data[: out.end])) == [bytes(40)] * 2
    out.drop(92)
    assert (out.start, out.end) == (0, 0)
