"""Sessions that end with an error: what was recorded until then is complete."""

import functools
import itertools

import pytest

from cubeling.app.running import opening
from cubeling.app.running.clock import Pace, SessionClock
from cubeling.app.running.opening import open_session
from cubeling.app.running.recording.wire_tap import WireTap
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions, messages, session_info
from cubeling.robot import SimulatedPort
from cubeling.tracking import TrackingError, open_source
from tests.app.conftest import SHORT_FRAMES


class FailingSource:
    """Gives some frames of a session, then an error, like a camera that is unplugged."""

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
def run_recorded(short_session, tmp_path):
    """Run a session whose source breaks off after so many frames; return its summary."""

    def run_session(frames, live):
        options = SessionOptions(
            scenario="companion", source="camera:0", record=tmp_path / "out.mcap", pictures=False
        )
        with (
            FailingSource(short_session, frames, live) as source,
            open_session(options, source=source) as session,
        ):
            return run(session)

    return run_session


class VirtualTime:
    """A clock that only sleeping advances."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


@pytest.mark.parametrize(
    ("robot", "fast", "seconds"),
    [("real", False, SHORT_FRAMES / 30), ("real", True, 0.0), ("sim", False, 0.0)],
)
def test_a_real_robot_gets_a_recording_in_real_time(
    cubeling, short_session, monkeypatch, robot, fast, seconds
):
    virtual = VirtualTime()
    monkeypatch.setattr(
        opening, "Pace", functools.partial(Pace, clock=virtual.monotonic, sleep=virtual.sleep)
    )
    with SimulatedPort() as port:
        url = port.url if robot == "real" else robot
        options = ["--robot", url, *(["--fast"] if fast else [])]
        code, _, err = cubeling("replay", short_session, "--no-pictures", *options)
    assert (code, err) == (0, "")
    assert virtual.now == pytest.approx(seconds, abs=0.1)


def test_a_camera_that_fails_ends_the_session_and_keeps_the_recording(run_recorded, tmp_path):
    summary = run_recorded(5, live=True)
    assert summary.frames == 5
    assert session_info(tmp_path / "out.mcap").frames == 5
    with pytest.raises(TrackingError, match="no picture"):
        summary.check()


def test_a_camera_that_gives_no_frame_leaves_no_file(run_recorded, tmp_path):
    with pytest.raises(TrackingError):
        run_recorded(0, live=True)
    assert not (tmp_path / "out.mcap").exists()


def test_a_file_that_breaks_off_is_an_error(run_recorded):
    with pytest.raises(TrackingError):
        run_recorded(5, live=False)


def test_the_wire_is_recorded_with_the_timestamps_of_the_frames(run_recorded, tmp_path):
    run_recorded(30, live=True)
    path = tmp_path / "out.mcap"
    frames = [time for _, time, _ in messages(path, "/camera/image")]
    wire = [time for _, time, _ in messages(path, "/robot/wire")]
    assert wire
    assert min(wire) >= 0.0
    assert min(wire) < frames[0] + 0.5


class Recorder:
    """Keeps the bytes of the wire that it is given."""

    def __init__(self):
        self.wires = []

    def wire(self, *what):
        *bytes_and_time, topic = what
        assert topic == "/robots/rex/wire"
        self.wires.append(tuple(bytes_and_time))


def test_bytes_before_the_first_frame_wait_for_it():
    recorder, wire = Recorder(), WireTap("/robots/rex/wire")
    wire.record_to(recorder)  # type: ignore[arg-type]  # it only calls `wire`
    wire("tx", b"a", 1.0)
    assert not recorder.wires
    wire.align(100.0)
    wire("rx", b"b", 2.0)
    assert recorder.wires == [("tx", b"a", 101.0), ("rx", b"b", 102.0)]
    wire.hold(102.5)  # a pause of 30 s
    wire("tx", b"c", 20.0)
    wire.align(70.0)
    wire("rx", b"d", 33.0)
    assert recorder.wires[2:] == [("tx", b"c", 102.5), ("rx", b"d", 103.0)]


def test_a_recording_that_begins_later_has_the_handshake_too():
    recorder, wire = Recorder(), WireTap("/robots/rex/wire")
    wire("tx", b"hello", 1.0)
    wire.align(100.0)
    wire("tx", b"not recorded", 2.0)
    wire.record_to(recorder, since=110.0)  # type: ignore[arg-type]
    wire("rx", b"b", 11.0)
    wire.record_to(None)
    wire("rx", b"not recorded", 12.0)
    assert recorder.wires == [("tx", b"hello", 110.0), ("rx", b"b", 111.0)]


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
