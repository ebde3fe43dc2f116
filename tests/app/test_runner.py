"""Sessions that end badly: what was made until then is whole."""

import itertools

import pytest

from app.pipeline.playground import Playground
from app.running.clock import SessionClock
from app.running.opening import fitting
from app.running.runner import Plan, WireTap, run
from app.session import about, messages
from app.ui.screen import NullScreen
from tracking import TrackingError, open_source


class Breaking:
    """Some frames of a session, then an error, as a camera that is unplugged."""

    def __init__(self, session, frames, live):
        self._session = open_source(str(session))
        self._frames = frames
        self.live = live
        self.intrinsics = self._session.intrinsics
        self.size, self.rate, self.duration = self._session.size, self._session.rate, None

    def __iter__(self):
        yield from itertools.islice(self._session, self._frames)
        raise TrackingError("the camera gave no picture for 2 s")

    def close(self):
        self._session.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


@pytest.fixture
def plan(short_session, tmp_path):
    """Make a plan with a source that breaks off, recorded."""
    opened = []

    def make(frames, live):
        source = Breaking(short_session, frames, live)
        opened.append(source)
        playground = Playground("companion", fitting(source.intrinsics, source.size))
        record = tmp_path / "out.mcap"
        notes = {"scenario": "companion", "cube": "companion"}
        return Plan(source, playground, NullScreen(), "sim", record, about=notes)

    yield make
    for source in opened:
        source.close()


def test_a_camera_that_breaks_off_ends_the_session_and_keeps_the_recording(plan):
    chosen = plan(5, live=True)
    summary = run(chosen)
    assert summary.frames == 5
    assert about(chosen.record).frames == 5
    with pytest.raises(TrackingError, match="no picture"):
        summary.check()


def test_a_camera_that_gives_nothing_leaves_nothing(plan):
    chosen = plan(0, live=True)
    with pytest.raises(TrackingError):
        run(chosen)
    assert not chosen.record.exists()


def test_a_file_that_breaks_off_is_an_error(plan):
    with pytest.raises(TrackingError):
        run(plan(5, live=False))


def test_the_wire_is_recorded_in_the_time_of_the_frames(plan):
    chosen = plan(30, live=True)
    run(chosen)
    frames = [time for _, time, _ in messages(chosen.record, "/camera/image")]
    wire = [time for _, time, _ in messages(chosen.record, "/robot/wire")]
    assert wire
    assert min(wire) >= 0.0
    assert min(wire) < frames[0] + 0.5


def test_bytes_before_the_first_frame_wait_for_it():
    class Recorder:
        def __init__(self):
            self.wires = []

        def wire(self, *what):
            self.wires.append(what)

    recorder = Recorder()
    tap = WireTap(recorder)  # type: ignore[arg-type]  # it only calls `wire`
    tap("tx", b"a", 1.0)
    assert not recorder.wires
    tap.align(100.0)
    tap("rx", b"b", 2.0)
    assert recorder.wires == [("tx", b"a", 101.0), ("rx", b"b", 102.0)]


def test_a_driven_clock_shows_the_session_and_never_goes_back():
    clock = SessionClock()
    clock.drive(0.0)
    start = clock()
    clock.drive(2.5)
    assert clock() == start + 2.5
    clock.drive(1.0)
    assert clock() == start + 2.5
    clock.release()
    assert clock() >= start + 2.5
