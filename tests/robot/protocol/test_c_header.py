"""The C header says the same as the Python code: compiled, fed with vectors and with noise."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import MESSAGES, pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from tools.protocol_reference import HEADER_FILE, VECTORS_FILE
from tools.protocol_vectors import VECTORS

COMPILER = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler here")

MAIN = """
#include <stdio.h>
#include "cubeling_messages.h"

/* Reads bytes; prints every message that it understands, packed again, as a frame. */
static void say(const uint8_t *body, size_t size)
{
    uint8_t wire[CUBELING_MAX_WIRE];
    size = cubeling_encode(body, size, wire);
    for (size_t at = 0; at < size; at++)
        printf("%02x", wire[at]);
    printf("\\n");
}

int main(void)
{
    cubeling_reader reader = {{0}, 0, 0};
    uint8_t body[CUBELING_MAX_BODY];
    size_t size;
    int byte;
    while ((byte = getchar()) != EOF) {
        size = cubeling_read(&reader, (uint8_t)byte);
        if (size < CUBELING_HEADER)
            continue;
        uint16_t session = cubeling_session(reader.bytes);
        switch (cubeling_number(reader.bytes)) {
        CASES
        }
    }
    printf("errors %u\\n", (unsigned)reader.errors);
    return 0;
}
"""


def case_of(spec) -> str:
    name = spec.name.lower()
    fields = any(part.fields for part in spec.parts)
    struct = f"cubeling_{name} m;" if fields else ""
    unpacked = f"cubeling_unpack_{name}(reader.bytes, size{', &m' if fields else ''})"
    packed = f"cubeling_pack_{name}(body, session, CUBELING_VERSION{', &m' if fields else ''})"
    return f"case CUBELING_{spec.name}: {{ {struct} if ({unpacked}) say(body, {packed}); break; }}"


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    folder = tmp_path_factory.mktemp("c")
    source, binary = folder / "main.c", folder / "main"
    source.write_text(MAIN.replace("CASES", "\n".join(map(case_of, MESSAGES.values()))))
    strict = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    checked = ["-fsanitize=undefined,address", "-fno-sanitize-recover=all"]
    include = ["-I", str(HEADER_FILE.parent)]
    assert COMPILER is not None
    command = [COMPILER, *strict, *checked, *include, "-o", str(binary), str(source)]
    built = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert built.returncode == 0, built.stderr
    return binary


def said(program: Path, data: bytes) -> tuple[list[str], int]:
    run = subprocess.run([program], input=data, capture_output=True, timeout=20, check=True)
    *frames, errors = run.stdout.decode().splitlines()
    return frames, int(errors.removeprefix("errors "))


def expected(data: bytes) -> tuple[list[str], int]:
    """What the Python code understands of the same bytes, packed again."""
    reader = FrameReader()
    frames = []
    for body in reader.feed(data):
        for sender in ("host", "robot"):
            try:
                session, message = unpack(body, sender)
            except MessageError:
                continue
            if message is not None:
                frames.append(encode_frame(pack(message, session)).hex())
    return frames, reader.errors


def test_every_vector_is_understood_by_the_c_code(program):
    for vector in VECTORS:
        frames, errors = said(program, vector.frame)
        assert errors == 0
        assert frames == expected(vector.frame)[0]
        assert len(frames) == 1


def test_what_a_robot_must_skip_is_skipped_by_the_c_code(program):
    document = json.loads(VECTORS_FILE.read_text())
    for entry in document["skipped by a robot"]:
        data = bytes.fromhex(entry["bytes"])
        assert said(program, data) == expected(data), entry["why"]


def test_c_and_python_understand_the_same_of_damaged_frames_and_noise(program):
    random = np.random.default_rng(5)
    stream = bytearray()
    for _ in range(4000):
        frame = bytearray(VECTORS[random.integers(len(VECTORS))].frame)
        kind = random.integers(4)
        if kind == 1:  # a value out of its range, or another message, with a check that fits
            body = bytearray(FrameReader().feed(bytes(frame))[0])
            body[random.integers(len(body))] = random.integers(128)
            frame = bytearray(encode_frame(bytes(body[: random.integers(1, len(body) + 1)])))
        elif kind == 2:
            frame[random.integers(len(frame))] ^= 1 << int(random.integers(8))
        elif kind == 3:
            frame = bytearray(random.bytes(int(random.integers(1, 200))))
        stream += frame
    data = bytes(stream)
    wanted = expected(data)
    assert len(wanted[0]) > 1000
    assert wanted[1] > 500
    assert said(program, data) == wanted
