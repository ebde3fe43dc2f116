"""A virtual screen for the tests that open a window."""

import os
import shutil
import subprocess
import sys

import pytest


@pytest.fixture
def on_screen(tmp_path):
    """Run Python with a virtual screen, as `.ci/run` installs it."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed")
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", "1600x900x24", "-nolisten", "tcp"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert server.stdout is not None
    display = f":{int(server.stdout.readline())}"
    # Where the systems keep preferences, so that a test does not meet those of the user.
    folders = {name: str(tmp_path) for name in ("HOME", "XDG_CONFIG_HOME", "APPDATA")}

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *map(str, arguments)],
            env={**os.environ, **folders, "DISPLAY": display, "COLUMNS": "120"},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=120,
        )

    yield run
    server.terminate()
    server.wait(timeout=10)
    server.stdout.close()
