"""The panels, drawn and used in a window that needs no display."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.app.ui.panels.panels_script import NO_WINDOW

SCRIPT = Path(__file__).with_name("panels_script.py")


@pytest.mark.slow(reason="a window is opened")
def test_panels_are_drawn_moved_opened_closed_and_change_settings(short_session, tmp_path):
    done = subprocess.run(
        [sys.executable, SCRIPT, short_session, tmp_path],
        capture_output=True,
        text=True,
        timeout=120,
    )
    if done.returncode == NO_WINDOW:
        pytest.skip("GLFW opens no window without a display here")
    assert done.returncode == 0, done.stderr
