"""What a session that somebody watches loads before its first frame."""

import pytest

from cubeling.app.running import open_session, opening as module
from cubeling.app.session import SessionOptions
from cubeling.app.ui.screen import NullScreen


@pytest.mark.parametrize("watched", [True, False])
def test_the_first_gesture_delays_no_frame_that_somebody_waits_for(
    watched, short_session, monkeypatch
):
    prepared: list[object] = []
    monkeypatch.setattr(module, "prepare_gestures", prepared.append)
    options = SessionOptions(
        scenario="follow", source=str(short_session), pictures=watched, robot="none"
    )
    with open_session(options, screen=NullScreen()) as session:
        assert prepared == ([session.playground.character] if watched else [])
