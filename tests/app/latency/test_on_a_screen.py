"""The command in a window on a virtual screen, with a camera that sees this screen."""

import json
import os
import shutil
import subprocess
import sys

import pytest

from tests.app.latency.screen_camera import ScreenCamera, framebuffer

DELAY_S = 0.04


@pytest.fixture
def screen(tmp_path):
    """A virtual screen: its display, and what it shows."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed")
    size = ("-screen", "0", "640x360x24", "-fbdir", str(tmp_path))
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", *size, "-nolisten", "tcp"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert server.stdout is not None
    yield f":{int(server.stdout.readline())}", framebuffer(tmp_path)
    server.terminate()
    server.wait(timeout=10)
    server.stdout.close()


def test_the_camera_sees_the_flips_of_the_window(screen, tmp_path):
    display, picture = screen
    camera = ScreenCamera(picture, DELAY_S)
    arguments = ("--source", camera.url, "--flips", "5", "--scenario", "none", "--json", "l.json")
    done = subprocess.run(
        [sys.executable, "-c", "from app.cli import main; main()", "latency", *arguments],
        env={**os.environ, "DISPLAY": display},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    camera.close()
    assert done.returncode == 0, done.stderr
    figures = json.loads((tmp_path / "l.json").read_text())
    assert figures["flips"] == 5
    assert figures["age"] > 0.9 * DELAY_S
