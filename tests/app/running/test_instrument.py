"""What follows a session is told all that a recording keeps, and when its frames were taken."""

import time

import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running import opening
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.ui.playback.requests import MarkMoment, NameMark
from cubeling.app.ui.screen import NullScreen
from tests.app import session_parts
from tests.app.conftest import SHORT_FRAMES


class Witness(Instrument):
    """Keeps what it is told."""

    def __init__(self):
        self.begun, self.taken, self.events, self.stamps = [], [], [], []

    def begin(self, cast):
        self.begun.append([each.name for each in cast])

    def follow(self, step, cast, taken):
        self.taken.append((step.frame.timestamp, taken))
        self.stamps.append(time.monotonic())
        return Inputs(clear=len(self.taken) == 10, marks=("go",) if len(self.taken) == 14 else ())

    def happen(self, event, taken):
        self.events.append((event, taken))


class Marker(NullScreen):
    """Marks the 20th frame by key, and names it."""

    shown = 0

    def show(self, step, robot):
        self.shown += 1
        return Inputs()

    def take_requests(self):
        return {20: (MarkMoment(),), 21: (NameMark("error: fell"),)}.get(self.shown, ())


def follow(short_session, witness, **chosen):
    options = SessionOptions(
        scenario="companion", source=str(short_session), pictures=False, robot="none", **chosen
    )
    with open_session(options, screen=Marker(), instruments=[witness]) as session:
        run(session)


@pytest.mark.slow(reason="a session plays in real time")
def test_a_replay_is_followed_in_real_time_and_stamped_when_its_frames_are_due(short_session):
    witness = Witness()
    follow(short_session, witness)
    assert witness.begun == [["vleo"]]
    assert len(witness.taken) == SHORT_FRAMES
    offsets = {round(taken - timestamp, 6) for timestamp, taken in witness.taken}
    assert len(offsets) == 1, "one offset from the session's time, whatever a frame takes"
    assert all(at >= taken for at, (_, taken) in zip(witness.stamps, witness.taken, strict=True))
    marks = [event for event, _ in witness.events if event.startswith("mark")]
    assert marks == ["mark 1", "mark 1: go", "mark 2", "mark 2: error: fell"]
    at = dict(witness.events)
    assert at["mark 2"] == at["mark 2: error: fell"] == witness.taken[19][1]


def test_it_is_told_the_events_of_the_recording(short_session, tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "_pace", lambda *_: None)
    witness, path = Witness(), tmp_path / "r.mcap"
    follow(short_session, witness, record=path)
    recorded = session_parts.events(path)
    assert [name for _, name in recorded] == [event for event, _ in witness.events]
    assert {"placed top", "start over", "mark 1: go", "mark 2: error: fell"} <= {
        name for _, name in recorded
    }
    with SessionFile(path) as file:
        assert [(mark.kind, mark.name) for mark in file.marks] == [("", "go"), ("error", "fell")]
        assert len(file.start_overs) == 1
