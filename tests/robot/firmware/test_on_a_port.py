"""The firmware as it is, behind a real pseudo-terminal, in real time."""

import subprocess
import sys
from pathlib import Path

import pytest

import cubeling.robot.firmware
from cubeling import robot

HERE = Path(cubeling.robot.firmware.__file__).parent
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")


def test_it_connects_shows_emotions_plays_and_stops(desk, soon):
    with robot.connect(desk.url) as dino:
        dino.express(robot.Emotion(0.5, 0.2, "happy"))
        soon(lambda: dino.telemetry.label == "happy")
        assert dino.telemetry.acknowledged == robot.Emotion(0.5, 0.2, "happy")
        dino.play("wag tail")
        soon(lambda: dino.telemetry.motion == "wag tail")
        soon(lambda: desk.hertz > 0)
        dino.stop()
        soon(lambda: dino.telemetry.stopped and dino.telemetry.motion is None)
        assert desk.hertz == 0
        assert dino.telemetry.reckoned
        assert set(desk.pulses) <= {16, 17, 18, 19, 21}
    assert desk.errors == []


def test_it_recovers_after_an_error(desk, soon, capfd):
    with robot.connect(desk.url) as dino:
        write = desk.write
        desk.write = None  # what a bug would look like
        soon(lambda: desk.errors)
        desk.write = write
        soon(lambda: dino.telemetry.counts.sessions >= 2 and dino.telemetry.state == "ready")
    assert "TypeError" in capfd.readouterr().err


def start(*command: str, folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)


@pytest.mark.parametrize(
    ("command", "folder"),
    [
        (("-m", "cubeling.robot.firmware"), HERE.parents[1]),
        # As it stands on a board: main.py beside the folder, and nothing of ours in reach.
        (("-I", "-S", "-c", "import sys; sys.path.insert(0, '.'); import main"), HERE),
    ],
    ids=["python -m cubeling.robot.firmware", "main.py alone"],
)
def test_it_runs_on_a_pseudo_terminal(command, folder):
    with start(sys.executable, *command, folder=folder) as process:
        try:
            assert process.stdout is not None
            url = process.stdout.readline().strip()
            with robot.connect(url) as dino:
                assert dino.catalogue.firmware == "dino 1"
        finally:
            process.kill()
