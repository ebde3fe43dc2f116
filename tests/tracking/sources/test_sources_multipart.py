"""Parts are complete however the network splits the stream."""

import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.sources.streams.multipart import (
    MAX_PART_BYTES,
    MultipartError,
    MultipartParser,
)

bodies = st.lists(
    st.binary(max_size=60)
    .map(lambda body: b"\xff\xd8" + body + b"\xff\xd9")
    .filter(lambda body: b"--cut" not in body),
    max_size=5,
)


def stream(parts, *, line=b"\r\n", lengths=True, preamble=b"", dashes=b""):
    written = preamble
    for part in parts:
        head = b"Content-type:  image/jpeg" + line
        if lengths:
            head += b"CONTENT-LENGTH: %d" % len(part) + line
        written += dashes + b"--cut" + line + head + line + part + line
    return written + dashes + b"--cut--" + line


@given(
    parts=bodies,
    line=st.sampled_from([b"\r\n", b"\n"]),
    lengths=st.booleans(),
    preamble=st.sampled_from([b"", b"\r\n", b"hello\r\n"]),
    dashes=st.sampled_from([b"", b"--"]),
    data=st.data(),
)
def test_the_parts_do_not_depend_on_the_chunks(parts, line, lengths, preamble, dashes, data):
    written = stream(parts, line=line, lengths=lengths, preamble=preamble, dashes=dashes)
    cuts = data.draw(st.lists(st.integers(0, len(written)), max_size=8).map(sorted))
    parser = MultipartParser((dashes + b"cut").decode())
    got = []
    for start, end in zip([0, *cuts], [*cuts, len(written)], strict=True):
        got += parser.feed(written[start:end])
    assert got == parts
    assert parser.ended


def test_a_stream_can_arrive_byte_by_byte():
    parts = [b"\xff\xd8one\xff\xd9", b"\xff\xd8\r\n--cu two\r\n\xff\xd9"]
    for lengths in (True, False):
        parser = MultipartParser("cut")
        written = stream(parts, lengths=lengths)
        got = [part for byte in written for part in parser.feed(bytes([byte]))]
        assert got == parts


def test_a_body_with_a_length_may_contain_the_boundary():
    parts = [b"\xff\xd8\r\n--cut\r\n\r\n\xff\xd9"]
    assert MultipartParser("cut").feed(stream(parts)) == parts


def test_a_part_is_returned_with_its_last_byte():
    """With a length it need not wait for the next boundary, which saves a frame of delay."""
    parser = MultipartParser("cut")
    assert parser.feed(b"--cut\r\nContent-Length: 3\r\n\r\nabc") == [b"abc"]


@given(st.lists(st.binary(max_size=200), max_size=10))
def test_garbage_gives_no_exception(chunks):
    parser = MultipartParser("cut")
    for chunk in chunks:
        parser.feed(chunk)


def test_a_stream_without_boundaries_is_limited_in_memory():
    parser = MultipartParser("cut")
    for _ in range(MAX_PART_BYTES // 2**20):
        assert parser.feed(bytes(2**20)) == []
    with pytest.raises(MultipartError, match="more than 32 MB"):
        parser.feed(b"!")
