"""LSL: streams that a recorder lines up with the session, and markers that become marks.

A recorder is written here, of LSL's own inlets: it keeps what comes, with its stamps corrected to
its own clock as LabRecorder and pyxdf do.
"""

import time
import uuid
from pathlib import Path
from types import SimpleNamespace

import pytest

from cubeling.app.bridges.opening import configure_lsl, lsl_problem
from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from tests.app.scripted import play_script

PROBLEM = lsl_problem()
pytestmark = pytest.mark.skipif(
    PROBLEM is not None, reason=f"LSL: {PROBLEM and ': '.join(PROBLEM)}"
)

MAX_CLOCK_ERROR_S = 2e-4
"""Largest error of a stamp on one machine [s]."""

WAIT_S = 10.0
"""How long a stream or a sample is waited for at most [s]."""


@pytest.fixture(scope="module")
def lsl():
    """The library and our streams, which only this computer finds."""
    configure_lsl("machine")
    import pylsl

    from cubeling.app.bridges import lsl as bridge

    return SimpleNamespace(pylsl=pylsl, bridge=bridge)


@pytest.fixture
def streams(lsl):
    """Our streams under a name of their own, and a function that opens a recorder's inlet."""
    name = f"test-{uuid.uuid4().hex[:8]}"
    with lsl.bridge.LslOut(name) as out:

        def record(stream):
            (found,) = lsl.pylsl.resolve_byprop("name", f"{name} {stream}", timeout=WAIT_S)
            inlet = lsl.pylsl.StreamInlet(found)
            inlet.open_stream(timeout=WAIT_S)
            return inlet

        yield SimpleNamespace(out=out, record=record)


@pytest.fixture(scope="module")
def steps():
    found: list[Step] = []
    play_script("companion", progress=found.append, seconds=2.0)
    return found


def pull(inlet, count):
    """Return samples with their stamps in the recorder's clock [s]."""
    found = []
    for _ in range(count):
        sample, stamp = inlet.pull_sample(timeout=WAIT_S)
        assert sample is not None, "a sample is lost"
        found.append((sample, stamp + inlet.time_correction(timeout=WAIT_S)))
    return found


def channels(inlet):
    """Return label and unit of each channel, as XDF's metadata have them."""
    channel = inlet.info(timeout=WAIT_S).desc().child("channels").child("channel")
    found: list[tuple[str, str]] = []
    while not channel.empty():
        found.append((channel.child_value("label"), channel.child_value("unit")))
        channel = channel.next_sibling("channel")
    return found


@pytest.mark.full
def test_streams_say_their_units_and_have_no_rate(lsl, streams):
    cube = streams.record("cube")
    assert channels(cube)[:4] == [("x_m", "m"), ("y_m", "m"), ("z_m", "m"), ("qx", "none")]
    assert ("wx_rad_s", "rad/s") in channels(cube)
    assert channels(streams.record("emotion")) == [("valence", "none"), ("arousal", "none")]
    for stream in ("cube", "controls", "emotion", "actions", "events", "marks"):
        info = streams.record(stream).info(timeout=WAIT_S)
        assert info.nominal_srate() == lsl.pylsl.IRREGULAR_RATE
        assert info.source_id()


def test_stamps_are_right_in_lsls_clock(lsl, streams, steps):
    inlet = streams.record("emotion")
    truth = []
    for step in steps[:8]:
        truth.append(lsl.pylsl.local_clock())
        streams.out.follow(step, (), time.monotonic())
    got = pull(inlet, len(truth))
    errors = [abs(stamp - true) for (_, stamp), true in zip(got, truth, strict=True)]
    # The least of them: between two lines the computer may do something else.
    assert sorted(errors)[len(errors) // 2] < MAX_CLOCK_ERROR_S
    emotions = [step.emotion.emotion for step in steps[:8]]
    assert [sample for sample, _ in got] == [[e.valence, e.arousal] for e in emotions]


def test_a_sample_keeps_the_stamp_of_its_frame_however_late_it_is_pushed(lsl, streams, steps):
    inlet = streams.record("cube")
    taken = time.monotonic() - 0.25
    streams.out.follow(steps[0], (), taken)
    ((_, stamp),) = pull(inlet, 1)
    assert stamp == pytest.approx(lsl.bridge.lsl_time(taken), abs=MAX_CLOCK_ERROR_S)


def test_an_unseen_cube_is_no_number(streams, steps):
    from dataclasses import replace

    inlet = streams.record("cube")
    hidden = replace(steps[0].state, visible=False, camera_from_cube=None)
    streams.out.follow(replace(steps[0], state=hidden), (), time.monotonic())
    ((sample, _),) = pull(inlet, 1)
    assert sample[0] != sample[0]


@pytest.mark.full
def test_actions_events_and_marks_come_when_they_happen(streams, steps):
    actions, events, marks = map(streams.record, ("actions", "events", "marks"))
    for step in steps:
        streams.out.follow(step, (), time.monotonic())
    streams.out.happen("placed top", time.monotonic())
    streams.out.happen("mark 1: error: fell", time.monotonic())
    shown = [step.command.activity if step.command.visible else "hidden" for step in steps]
    changes = [each for at, each in enumerate(shown) if at == 0 or each != shown[at - 1]]
    assert [sample for sample, _ in pull(actions, len(changes))] == [[each] for each in changes]
    assert pull(events, 1)[0][0] == ["placed top"]
    assert pull(marks, 1)[0][0] == ["mark 1: error: fell"]


@pytest.mark.slow(reason="a session plays in real time")
def test_a_recorder_lines_up_with_the_session_and_its_markers_are_marks(
    lsl, streams, short_session, tmp_path
):
    """To one frame: the stamps of the recorder and those of the session differ by a constant."""
    name = f"buttons-{uuid.uuid4().hex[:8]}"
    outlet = lsl.pylsl.StreamOutlet(
        lsl.pylsl.StreamInfo(name, "Markers", 1, 0, lsl.pylsl.cf_string, name)
    )
    inlet, marks = streams.record("cube"), streams.record("marks")
    path = tmp_path / "r.mcap"
    said: list[str] = []
    options = SessionOptions(
        scenario="companion", source=str(short_session), record=path, pictures=False
    )
    pressed: list[float] = []

    def press(step):
        if outlet.have_consumers() and not pressed:
            pressed.append(step.frame.timestamp)
            outlet.push_sample(["start: now"])

    with lsl.bridge.LslIn(name, said.append) as taken:
        deadline = time.monotonic() + WAIT_S
        while not outlet.have_consumers() and time.monotonic() < deadline:
            taken.follow(None, (), 0.0)  # it is found before the short session begins
        with open_session(options, instruments=[streams.out, taken]) as session:
            run(session, press)
    with SessionFile(path) as file:
        times = [at for _, at, _ in file.messages("/camera/image")]
        (mark,) = file.marks
    assert (mark.kind, mark.name) == ("start", "now")
    assert said == [f"LSL: marks come from the stream {name}"]
    stamps = [stamp for _, stamp in pull(inlet, len(times))]
    frame = times[1] - times[0]
    offset = stamps[0] - times[0]
    assert max(abs(b - a - offset) for a, b in zip(times, stamps, strict=True)) < frame
    assert mark.at_s + times[0] > pressed[0], "in a frame after the press"
    (_, _), (sample, stamp) = pull(marks, 2)
    assert sample == ["mark 1: start: now"]
    # LSL estimates the clock for each stream by itself: on a busy computer, to some milliseconds.
    assert stamp == pytest.approx(mark.at_s + times[0] + offset, abs=frame)


def test_a_marker_stream_that_is_not_there_yet_is_looked_for(lsl):
    with lsl.bridge.LslIn(f"nobody-{uuid.uuid4().hex}", print) as taken:
        began = time.monotonic()
        for _ in range(20):
            assert taken.follow(None, (), 0.0).marks == ()
        assert time.monotonic() - began < 1.0


def test_the_guide_names_every_stream(lsl):
    guide = (Path(__file__).parents[3] / "docs" / "instruments.md").read_text("utf-8")
    for stream in (*lsl.bridge.NUMBER_STREAMS, *lsl.bridge.TEXT_STREAMS):
        assert f"`Cubeling {stream}`" in guide
