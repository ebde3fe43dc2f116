"""The window, opened on a virtual display.

Each test runs in its own process: a graphics driver keeps the first display that it opens.
"""

import re
from pathlib import Path

SCRIPT = Path(__file__).with_name("window_script.py")
REPLAY_SCRIPT = SCRIPT.with_name("replay_script.py")


def test_the_window_shows_the_picture_and_handles_keys(on_screen, short_session):
    done = on_screen(SCRIPT, short_session)
    assert done.returncode == 0, done.stderr


def test_a_replay_opens_the_window_and_waits_for_the_user_at_the_end(on_screen, short_session):
    done = on_screen(REPLAY_SCRIPT, "replay", short_session)
    assert done.returncode == 0, done.stderr
    counted = re.findall(r"(?:played|left out) +(\d+) frames", done.stdout)
    assert sum(map(int, counted)) == 60
    assert "waited 5 times" in done.stderr
