"""The panels, drawn and used on a virtual display."""

from pathlib import Path

SCRIPT = Path(__file__).with_name("panels_script.py")


def test_panels_are_drawn_moved_opened_closed_and_change_settings(
    on_screen, short_session, tmp_path
):
    done = on_screen(SCRIPT, short_session, tmp_path)
    assert done.returncode == 0, done.stderr
