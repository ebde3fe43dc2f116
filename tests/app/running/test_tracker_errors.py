"""An error of the tracker costs the frame: it is counted, said and recorded, and is no end."""

import logging

import pytest

from cubeling.app.running.opening import open_session
from cubeling.app.running.replay_check import check_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.ui.panels.tracking import REFUSALS
from cubeling.tracking import CubeTracker
from tests.app.conftest import SHORT_FRAMES

FAILING = (10, 11, 25)
"""Indices of the frames in which the tracker raises an error."""


@pytest.fixture
def failing(monkeypatch):
    """Let the tracker fail in some frames, as one with a bug would."""
    update = CubeTracker.update

    def update_or_fail(self, frame, markers=None):
        state = update(self, frame, markers)
        if frame.index in FAILING:
            raise KeyError("top")
        return state

    monkeypatch.setattr(CubeTracker, "update", update_or_fail)


def test_an_error_of_the_tracker_costs_the_frame_and_not_the_session(
    failing, short_session, tmp_path, caplog
):
    path = tmp_path / "kept.mcap"
    options = SessionOptions(
        scenario="companion", source=str(short_session), record=path, pictures=False
    )
    states = []
    with (
        caplog.at_level(logging.DEBUG, "cubeling"),
        open_session(options) as session,
    ):
        summary = run(session, lambda step: states.append(step.state))
    assert [state.verdict == "failed" for state in states] == [
        index in FAILING for index in range(SHORT_FRAMES)
    ]
    # The cube is found again in the next frame.
    assert all(states[index + 1].visible for index in (11, 25))
    assert summary.failed_frames == len(FAILING)
    assert summary.tracker_error.startswith("KeyError: 'top' in ")
    assert "failed" in REFUSALS
    assert sum("Traceback" in record.exc_text for record in caplog.records) == len(FAILING)
    with SessionFile(path) as recorded:
        told = [event for _, event in recorded.events if event.startswith("tracker failed: ")]
        assert told == [f"tracker failed: {summary.tracker_error}"] * len(FAILING)
        # A replay makes the same of it.
        assert check_session(recorded, recorded.info.options).identical


def test_the_summary_says_it_and_debug_shows_the_traceback(
    failing, short_session, cubeling, caplog
):
    caplog.set_level(logging.WARNING, "cubeling")  # and restore it: --debug lowers it
    caplog.handler.setLevel(logging.DEBUG)
    arguments = ("replay", short_session, "--no-pictures")
    code, said, _ = cubeling(*arguments)
    assert code == 0
    assert f"tracker failed  in {len(FAILING)} frames: KeyError: 'top' in " in said
    assert not caplog.records
    cubeling("--debug", *arguments)
    assert [bool(record.exc_text) for record in caplog.records] == [True] * len(FAILING)
