"""The command in a window on a virtual screen, with a camera that sees this screen."""

import json
import subprocess
import sys

import pytest

from tests.app.workshop.latency.screen_camera import ScreenCamera
from tests.virtual_screen import VirtualScreen

DELAY_S = 0.15
RATE = 30.0
FLIPS = 5


@pytest.fixture
def screen():
    if not VirtualScreen.installed():
        pytest.skip("Xvfb is not installed")
    with VirtualScreen((640, 360)) as opened:
        yield opened


@pytest.mark.slow(reason="a window is opened, and filmed")
def test_the_camera_sees_the_flips_of_the_window(screen, tmp_path):
    camera = ScreenCamera(screen.pixels(), DELAY_S, RATE)
    asked = ("--flips", str(FLIPS), "--scenario", "none", "--json", "l.json")
    arguments = ("--source", camera.url, *asked)
    done = subprocess.run(
        [sys.executable, "-c", "from cubeling.app.cli import main; main()", "latency", *arguments],
        env=screen.environment,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    camera.close()
    assert done.returncode == 0, done.stderr
    figures = json.loads((tmp_path / "l.json").read_text())
    assert figures["flips"] == FLIPS
    # A flip falls between two pictures, and a few flips do not tell where; `test_latency` tests how
    # exact the figure is where the clock is ours.
    assert figures["age"] > DELAY_S - 1 / RATE
