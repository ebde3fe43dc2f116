"""The protocol's document says what the code does."""

import json
import re

import pytest

from cubeling.robot.protocol import wire
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import MESSAGES, unpack
from cubeling.robot.protocol.wire import FrameReader
from tools.protocol_reference import DOCUMENT, VECTORS_FILE, generated_files, updated
from tools.protocol_vectors import VECTORS

TEXT = DOCUMENT.read_text("utf-8")
PROSE = " ".join(TEXT.split())
HEX = re.compile(r"^ *(00(?: [0-9a-f]{2})+)(?:  +(.*))?$", re.MULTILINE)


def test_generated_files_are_current():
    for path, text in generated_files().items():
        assert path.read_text("utf-8") == text, f"{path.name}: `python -m tools.protocol_reference`"


def test_the_vectors_of_the_document_are_read_as_what_it_says():
    part = TEXT[TEXT.index("<!-- vectors") : TEXT.index("<!-- end of vectors")]
    lines = [line for line in part.splitlines() if " in session " in line]
    frames = [bytes.fromhex(found[1]) for found in HEX.finditer(part)]
    assert len(lines) == len(frames) == len(VECTORS)
    for line, frame in zip(lines, frames, strict=True):
        (body,) = FrameReader().feed(frame)
        session, content = unpack(body, MESSAGES[body[0]].sender)
        assert f"{content} in session {session}" == re.sub(r", version \d$", "", line)


def test_there_is_a_vector_for_every_message():
    assert {type(vector.content) for vector in VECTORS} == {spec.kind for spec in MESSAGES.values()}


def test_the_bytes_of_the_file_that_a_robot_skips_say_nothing_to_it():
    entries = json.loads(VECTORS_FILE.read_text())["skipped by a robot"]
    assert len(entries) > 10
    for entry in entries:
        for body in FrameReader().feed(bytes.fromhex(entry["bytes"])):
            try:
                _, message = unpack(body, "host")
            except MessageError:
                continue
            assert message is None, entry["why"]


def test_frames_that_the_document_says_to_drop_are_dropped():
    part = TEXT[TEXT.index("And three frames to drop") :]
    bad = [bytes.fromhex(found[1]) for found in HEX.finditer(part)]
    assert len(bad) == 3
    for frame in bad:
        reader = FrameReader()
        assert reader.feed(frame) == []
        assert reader.errors == 1


def test_numbers_quoted_in_the_prose_are_those_of_the_code():
    assert f"2 … {wire.MAX_BODY + 1} bytes" in PROSE
    assert f"After {wire.MAX_FRAME + 1} bytes without an edge" in PROSE
    assert f"has {8 * (wire.MAX_BODY + 1)} bits and 16 of the check" in PROSE


def test_a_document_without_its_marks_is_refused():
    with pytest.raises(ValueError, match="one part marked 'messages'"):
        updated("")
