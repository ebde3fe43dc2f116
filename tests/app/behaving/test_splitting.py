"""Streams of XML documents, cut wherever the network cuts them."""

import time
from contextlib import suppress

import pytest
from hypothesis import given, strategies as st

from cubeling.app.behaving.splitting import MAX_BYTES, DocumentSplitter, StreamBroken

DOCUMENTS = [
    b'<bml id="a"/>',
    b'<?xml version="1.0"?><bml id="b > c"><speech><text>1 &lt; 2 \xc3\xa9</text></speech></bml>',
    b"<bml><!-- a > b </bml> --><x/></bml>",
    b"<bml>\n<x><![CDATA[</bml>]]></x></bml>",
    b"<bml a='>\"' b=\">'/>\"><!-- - > ' \" --><?x ?>?><![CDATA[]]]]></bml>",
    b"<bml><a/>text<b>&gt;</b\n></bml\t>",
]


@given(st.lists(st.sampled_from(DOCUMENTS), max_size=6), st.data())
def test_documents_are_found_wherever_the_stream_is_cut(documents, data):
    stream = b" \n ".join(documents)
    cuts = data.draw(st.lists(st.integers(0, len(stream)), max_size=8).map(sorted))
    splitter = DocumentSplitter()
    found: list[bytes] = []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        found += splitter.feed(stream[start:end])
    assert found == documents


@pytest.mark.parametrize(
    ("stream", "why"),
    [
        (b"hello", "not XML"),
        (b"<a></b>", "not XML"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><a/>', "DTD"),
        (b"\xff\xfe<a", "not XML"),
        (b'<?xml version="1.0" encoding="klingon"?><a/>', "not XML"),
        (b"<a>" + b"x" * MAX_BYTES, "more than"),
    ],
)
def test_what_is_no_xml_breaks_the_stream_in_one_line(stream, why):
    with pytest.raises(StreamBroken) as caught:
        list(DocumentSplitter().feed(stream))
    assert why in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("opening", [b"<!--", b"<b c='", b"<![CDATA[", b"<?x ", b"<b>", b""])
def test_a_document_full_of_ends_costs_as_much_as_it_is_long(opening):
    """The parser was given each piece up to the next >, and looked at all before it again."""
    document = b"<a>" + opening + b">" * (MAX_BYTES // 2)
    began = time.process_time()
    splitter = DocumentSplitter()
    for start in range(0, len(document), 4096):
        assert not list(splitter.feed(document[start : start + 4096]))
    assert splitter.open
    assert time.process_time() - began < 2.0  # 90 s then, 10 ms now


@given(st.binary(max_size=60))
def test_no_bytes_raise_anything_else(stream):
    with suppress(StreamBroken):
        list(DocumentSplitter().feed(b"<a" + stream))
