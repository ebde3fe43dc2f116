"""The window, opened on a virtual display.

Each test runs in its own process: a graphics driver keeps the first display that it opens.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from cubeling.app.preferences import Preferences, PreferenceStore
from tests.app.conftest import SHORT_FRAMES
from tests.virtual_screen import VirtualScreen

SCRIPT = Path(__file__).with_name("window_script.py")
REPLAY_SCRIPT = SCRIPT.with_name("replay_script.py")
PAINTERS_SCRIPT = SCRIPT.with_name("painters_script.py")


@pytest.fixture
def on_screen(tmp_path):
    """Run Python with a virtual screen, as `.ci/run` installs it."""
    if not VirtualScreen.installed():
        pytest.skip("Xvfb is not installed")
    # Where the systems keep preferences; the tests look at them.
    folders = {name: str(tmp_path) for name in ("HOME", "XDG_CONFIG_HOME", "APPDATA")}
    folders["PYTHONPATH"] = str(Path(__file__).parents[3])  # scripts import `tests`
    with VirtualScreen() as screen:
        folders["SCREEN_FILE"] = str(screen.file)

        def run(*arguments):
            return subprocess.run(
                [sys.executable, *map(str, arguments)],
                env={**screen.environment, **folders},
                cwd=tmp_path,
                capture_output=True,
                text=True,
                timeout=120,
            )

        yield run


@pytest.mark.slow(reason="a window is opened")
def test_the_window_shows_the_picture_and_handles_keys(on_screen, bundled_session):
    done = on_screen(SCRIPT, bundled_session)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow(reason="a window is opened")
def test_without_a_graphics_card_a_window_is_painted_in_memory_as_opengl_paints_it(on_screen):
    done = on_screen(PAINTERS_SCRIPT)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow(reason="a window is opened for two seconds and more")
def test_a_replay_opens_the_window_and_waits_for_the_user_at_the_end(
    on_screen, short_session, tmp_path
):
    done = on_screen(REPLAY_SCRIPT, "replay", short_session)
    assert done.returncode == 0, done.stderr
    counted = re.findall(r"(?:played|left out) +(\d+) frames?\b", done.stdout)
    assert sum(map(int, counted)) == SHORT_FRAMES
    assert "waited 5 times" in done.stderr
    kept = PreferenceStore(next(tmp_path.rglob("preferences.toml"))).now
    assert kept == Preferences(panels_shown=True, mirror=True)
