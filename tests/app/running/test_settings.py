"""The settings of a scenario that is being played, and how long the parts of a frame take."""

import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions
from cubeling.app.ui.playback.requests import ChangeSetting
from cubeling.app.ui.screen import NullScreen


class Changes(NullScreen):
    """Changes settings after ten frames."""

    def __init__(self):
        self.shown = 0

    def show(self, step, robot):
        self.shown += 1
        return Inputs()

    def take_requests(self):
        if self.shown != 10:
            return ()
        settings: dict[str, str | float] = {"turns": 1.0, "look": "none", "personality": "shy"}
        return tuple(ChangeSetting(name, value) for name, value in settings.items())


@pytest.mark.parametrize("recorded", [False, True])
def test_settings_change_while_playing_unless_it_is_recorded(short_session, tmp_path, recorded):
    options = SessionOptions(
        scenario="companion",
        source=str(short_session),
        robot="none",
        record=tmp_path / "kept.mcap" if recorded else None,
        pictures=False,
    )
    with open_session(options, screen=Changes()) as session:
        run(session)
    now = session.monitor.options
    changed = (now.turns, now.look, now.personality)
    assert changed == ((2.0, "auto", None) if recorded else (1.0, "none", "shy"))
    last = session.monitor.step
    assert last is not None
    assert (last.command.gaze is None) != recorded
    parts = set(session.monitor.times.means())
    usual = {"capture", "tracking", "gestures", "appearance", "scenario", "animation", "drawing"}
    usual |= {"robot"}
    assert parts == usual | {"showing", "other"} | ({"recording"} if recorded else set())
