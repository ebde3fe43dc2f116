"""A study in a window on a virtual screen: questions, pictures, films, a window that is closed."""

import subprocess
import sys
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np
import pytest

from cubeling.app.ui.video_file import VideoFile
from cubeling.app.workshop.study.participants.study_log import read_participant
from tests.app.workshop.study.test_page_desk import PROTOCOL
from tests.virtual_screen import VirtualScreen

SCRIPT = Path(__file__).with_name("window_desk_script.py")


@pytest.fixture
def led(tmp_path):
    """Lead a participant with keys for each sheet; return the finished program."""
    if not VirtualScreen.installed():
        pytest.skip("Xvfb is not installed")
    (tmp_path / "shown").mkdir()
    cv2.imwrite(str(tmp_path / "shown" / "red.png"), np.full((80, 80, 3), (0, 0, 255), np.uint8))
    with VideoFile(tmp_path / "shown" / "green.mp4", (80, 80), 25.0) as film:
        for number in range(3):
            film.write(np.full((80, 80, 3), (0, 200 + 10 * number, 0), np.uint8), number / 25.0)
    path = tmp_path / "x.toml"
    path.write_text(PROTOCOL.replace("[[phase]]", "light_patch = true\n[[phase]]", 1))
    with VirtualScreen() as screen:

        def run(*answers):
            return subprocess.run(
                [sys.executable, SCRIPT, path, *answers],
                env={**screen.environment, "PYTHONPATH": str(Path(__file__).parents[4])},
                capture_output=True,
                text=True,
                timeout=120,
            )

        yield run


@pytest.mark.full
@pytest.mark.slow(reason="a window is opened, twice")
def test_a_participant_answers_in_a_window_and_goes_on_after_it_was_closed(led, tmp_path):
    stopped = led("", "2 →", "stop")
    assert "KeyboardInterrupt" in stopped.stderr
    (_, side) = read_participant(tmp_path / "s" / "P01").entries
    assert side["answer"] == 1.0
    # It was on the screen after the question before, and before its answer.
    onset, answered = (datetime.fromisoformat(side[name]) for name in ("onset_at", "at"))
    assert 0.0 < (answered - onset).total_seconds() <= side["seconds"]
    done = led("Home → →", "2", "a F q b", "")
    assert done.returncode == 0, done.stderr
    entries = read_participant(tmp_path / "s" / "P01").entries
    assert [each.get("answer") for each in entries] == [None, 1.0, 0.02, "green", "aFqb"]
    assert [name for each in entries for name in each if name == "onset_at"] == ["onset_at"]
