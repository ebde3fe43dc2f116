"""Frames arrive whole or not at all, whatever the line does to them."""

import contextlib
import itertools

import pytest
from hypothesis import given, strategies as st

from cubeling.robot.protocol import wire
from cubeling.robot.protocol.wire import FrameReader

bodies = st.binary(min_size=1, max_size=wire.MAX_BODY)


def cut(data: bytes, places: list[int]) -> list[bytes]:
    edges = [0, *sorted(place % (len(data) + 1) for place in places), len(data)]
    return [data[a:b] for a, b in itertools.pairwise(edges)]


def test_the_checksum_is_crc16_ccitt_false():
    assert wire.crc16(b"123456789") == 0x29B1


@given(bodies)
def test_a_frame_holds_no_zero_but_its_edges_and_costs_six_bytes(body):
    frame = wire.encode_frame(body)
    assert frame[0] == frame[-1] == 0
    assert 0 not in frame[1:-1]
    assert len(frame) == len(body) + 6


@given(st.lists(bodies, max_size=6), st.lists(st.integers(0, 10_000), max_size=8))
def test_every_body_arrives_however_the_stream_is_split(sent, places):
    stream = b"".join(map(wire.encode_frame, sent))
    reader = FrameReader()
    assert [b for piece in cut(stream, places) for b in reader.feed(piece)] == sent
    assert reader.errors == 0


@given(st.binary(max_size=400), bodies)
def test_the_first_frame_after_any_garbage_is_received(garbage, body):
    assert FrameReader().feed(garbage + wire.encode_frame(body))[-1:] == [body]


@given(bodies, st.sets(st.integers(0, 8 * (wire.MAX_BODY + 6) - 1), min_size=1, max_size=3))
def test_up_to_three_wrong_bits_never_pass_unless_they_make_an_edge(body, places):
    frame = bytearray(wire.encode_frame(body))
    inner = frame[1:-1]
    for place in places:
        place %= 8 * len(inner)
        inner[place // 8] ^= 1 << place % 8
    if 0 not in inner and inner != frame[1:-1]:
        with pytest.raises(wire.FrameError):
            wire.decode_frame(bytes(inner))


@given(bodies, st.integers(0, 10**6), st.integers(1, 0xFFFF))
def test_a_burst_of_up_to_sixteen_wrong_bits_never_passes_unless_it_makes_an_edge(body, at, burst):
    inner = wire.encode_frame(body)[1:-1]
    wrong = int.from_bytes(inner, "big") ^ burst << at % (8 * len(inner) - 15)
    hurt = wrong.to_bytes(len(inner), "big")
    if 0 not in hurt:
        with pytest.raises(wire.FrameError):
            wire.decode_frame(hurt)


def test_no_single_wrong_bit_of_a_stream_of_frames_is_ever_taken_for_a_frame():
    # Exhaustive, edges included: three frames, every bit of them wrong once.
    sent = [bytes([0x10, 5, 0, 0, 0, 0, 1, 0xE4, 0x0C]), bytes(40), bytes(range(1, 60))]
    stream = b"".join(map(wire.encode_frame, sent))
    for place in range(8 * len(stream)):
        wrong = bytearray(stream)
        wrong[place // 8] ^= 1 << place % 8
        arrived = FrameReader().feed(bytes(wrong))
        assert all(body in sent for body in arrived)
        assert len(arrived) >= 1


@given(st.lists(st.binary(max_size=2000), max_size=5))
def test_a_babbling_line_is_survived_in_bounded_memory(pieces):
    reader = FrameReader()
    for piece in pieces:
        reader.feed(piece)
        assert reader.buffered <= wire.MAX_FRAME + 1


@pytest.mark.parametrize("size", [0, wire.MAX_BODY + 1])
def test_a_body_of_the_wrong_size_is_not_sent(size):
    with pytest.raises(ValueError, match="1 to 120 bytes"):
        wire.encode_frame(bytes(size))


@given(st.binary(max_size=130))
def test_decoding_anything_gives_a_body_or_a_frame_error(data):
    with contextlib.suppress(wire.FrameError):
        wire.decode_frame(data)
