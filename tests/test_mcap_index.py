"""The index of a recording gives the messages that reading all of it gives, from any time on."""

import pytest
from mcap.writer import IndexType, Writer

from cubeling.mcap_index import McapIndex

STEP_NS = 40_000_000


@pytest.fixture(params=["indexed", "without lists of messages", "without chunks"])
def index(request, tmp_path):
    """100 messages on /a, and each third time one on /b, seven times to a chunk."""
    path = tmp_path / "x.mcap"
    with path.open("wb") as file:
        chunked = request.param != "without chunks"
        listed = request.param == "indexed"
        kinds = IndexType.ALL if listed else IndexType.ALL & ~IndexType.MESSAGE
        writer = Writer(file, use_chunking=chunked, index_types=kinds)
        writer.start()
        writer.add_metadata("about", {"name": "x"})
        schema = writer.register_schema("s", "jsonschema", b"{}")
        first, second = (writer.register_channel(each, "json", schema) for each in ("/a", "/b"))
        for number in range(100):
            writer.add_message(first, number * STEP_NS, b"%d" % number, 0)
            if number % 3 == 0:
                writer.add_message(second, number * STEP_NS, b"b%d" % number, 0)
            if number % 7 == 6:
                writer.flush()
        writer.finish()
    with path.open("rb") as file:
        yield McapIndex(file)


def numbers(found):
    return [int(message.data) for _, _, message in found]


def test_messages_come_from_any_time_on_in_both_directions(index):
    assert index.metadata() == {"about": {"name": "x"}}
    assert numbers(index.messages(("/a",))) == list(range(100))
    assert len(list(index.messages())) == 134
    assert numbers(index.messages(("/a",), reverse=True)) == list(range(99, -1, -1))
    assert [m.data for _, _, m in index.messages(("/b",))][:2] == [b"b0", b"b3"]


@pytest.mark.parametrize("index", ["indexed", "without lists of messages"], indirect=True)
@pytest.mark.parametrize("number", [0, 1, 6, 7, 50, 98, 99])
def test_numbers_and_times_lead_to_each_other(index, number):
    time = number * STEP_NS
    assert index.time_of("/a", number) == time
    assert index.number_at("/a", time) == number
    assert index.number_at("/a", time - 1) == number
    assert index.number_at("/a", time + 1) == number + 1
    assert numbers(index.messages(("/a",), since=time)) == list(range(number, 100))
    assert numbers(index.back_from("/a", time)) == list(range(number, -1, -1))
    assert index.time_of("/a", 100) is None


def test_a_file_that_was_cut_off_has_no_index(tmp_path):
    path = tmp_path / "x.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.flush()
        file.write(b"\x00" * 40)
    with path.open("rb") as file, pytest.raises(Exception):  # noqa: B017, PT011 # mcap's own
        McapIndex(file)
