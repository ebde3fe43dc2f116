"""The editor's window, on a virtual display."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.virtual_screen import VirtualScreen

SCRIPT = Path(__file__).with_name("window_script.py")
ROOT = SCRIPT.parents[4]


@pytest.mark.full  # by real keys what `test_session` does without a window
def test_a_gesture_is_made_and_saved_in_the_window(tmp_path):
    if not VirtualScreen.installed() or shutil.which("xdotool") is None:
        pytest.skip("Xvfb or xdotool is not installed")
    with VirtualScreen() as screen:
        done = subprocess.run(
            [sys.executable, str(SCRIPT), str(tmp_path)],
            env={**screen.environment, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            timeout=120,
        )
    assert done.returncode == 0, done.stderr
