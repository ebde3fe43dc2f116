"""A session whose camera is lost: the screen stays alive, and the gap is shown and recorded."""

import errno
import itertools
import os
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from rich.console import Console

from cubeling.app.pipeline.step import RobotView
from cubeling.app.running.opening import open_session
from cubeling.app.running.robots import RobotLine
from cubeling.app.running.runner import run
from cubeling.app.running.summary.gap_watch import MAX_LINES, GapWatch
from cubeling.app.running.summary.gaps import Gap
from cubeling.app.running.summary.summary import MAX_SAMPLES, Summary
from cubeling.app.session import Recorder, SessionOptions, messages, session_info
from cubeling.app.ui.cards.overlay import notice_card
from cubeling.app.ui.notice import Notice, notice
from cubeling.app.ui.screen import NullScreen
from cubeling.tracking import TrackingError
from cubeling.tracking.sources.base import LiveFrames
from cubeling.tracking.sources.device import DeviceSetting, Health
from tests.app import session_parts
from tests.app.running.recorded_camera import RecordedCamera

RUNNING = Health(
    "camera 0", "running", 0.0, rate=30.0, settings=(DeviceSetting("focus", True, "30"),)
)
LOST = Health("camera 0", "lost", 0.0, "camera 0 delivered no image for 1 s")


class SourceWithGap(RecordedCamera):
    """Frames of a session, with so many waits without a frame after the fifth."""

    def __init__(self, session, waits):
        super().__init__(session, 10)
        self._left, self._waited = waits, 0.0
        self._given, self._ended = 0, False

    def wait(self, timeout, patience=None):
        if self._given == 5 and self._left:
            self._left -= 1
            self._waited += 1.0  # each wait lasts a second
            if patience is not None and self._waited >= patience:
                raise TrackingError(LOST.problem)
            return None
        self._given += 1
        frame = next(self._frames, None)
        if frame is None:
            self._ended = True
            return None
        return replace(frame, timestamp=frame.timestamp + (3.0 if self._given > 5 else 0.0))

    @property
    def health(self):
        if self._ended:
            return replace(RUNNING, state="closed")
        return LOST if self._given == 5 and self._left else RUNNING


class NoticeScreen(NullScreen):
    """A screen that keeps the notices it was given."""

    def __init__(self, ends_after=None):
        self.notices: list[Notice | None] = []
        self._ends_after = ends_after

    def wait(self, notice):
        self.notices.append(notice)

    @property
    def closed(self):  # type: ignore[override]
        return self._ends_after is not None and len(self.notices) >= self._ends_after


@pytest.fixture
def run_with_gap(short_session, tmp_path):
    """Run and record a session whose camera gives no frame for so many waits."""

    def run_session(waits, screen, said=None, **changes):
        path = tmp_path / "out.mcap"
        options = SessionOptions(
            scenario="companion",
            source="camera:0",
            robot="none",
            record=path,
            pictures=False,
            **changes,
        )
        with SourceWithGap(short_session, waits) as source:
            assert isinstance(source, LiveFrames)
            with open_session(options, source=source, screen=screen) as session:
                summary = run(session, say=[].append if said is None else said.append)
        return summary, path

    return run_session


def test_a_lost_camera_is_reported_on_the_screen_and_the_session_continues(run_with_gap):
    screen = NoticeScreen()
    summary, path = run_with_gap(4, screen)
    assert summary.frames == 10
    titles = [notice.title for notice in screen.notices if notice]
    assert titles == ["Camera lost: plug it in again"] * 3
    (gap,) = summary.gaps
    start, seconds = gap.start, gap.seconds
    assert (gap.part, gap.back) == ("camera", True)
    assert gap.played == pytest.approx(4 / 30)
    assert seconds == pytest.approx(3.0 + 1 / 30, abs=0.01)
    recorded = [
        (time, event) for time, event in session_parts.events(path) if event.startswith("camera")
    ]
    assert [event for _, event in recorded] == ["camera lost", "camera back"]
    assert [time for time, _ in recorded] == pytest.approx([start, start + seconds])
    summary.check()


def test_the_window_can_be_closed_while_the_camera_is_lost(run_with_gap):
    summary, _ = run_with_gap(7, NoticeScreen(ends_after=2))
    assert summary.frames == 5


def test_a_camera_that_does_not_come_back_ends_the_session_and_keeps_the_recording(run_with_gap):
    before = datetime.now(UTC)
    summary, path = run_with_gap(40, NullScreen())
    info = session_info(path)
    assert info.frames == 5
    zero = datetime.fromisoformat(info.clock_zero)
    first = next(at for _, at, _ in messages(path, "/camera/image"))
    taken = zero + timedelta(seconds=first)
    assert before - timedelta(milliseconds=1) <= taken <= datetime.now(UTC)
    with pytest.raises(TrackingError, match="delivered no image"):
        summary.check()
    (gap,) = summary.gaps
    assert (gap.part, gap.back) == ("camera", False)


def test_a_session_without_a_window_waits_as_long_for_the_camera_as_asked_and_says_so(run_with_gap):
    said: list[str] = []
    summary, _ = run_with_gap(29, NullScreen(), said)  # 30 s is the default
    assert summary.frames == 10
    assert said == [
        "camera lost after 0.1 s: camera 0 delivered no image for 1 s (the session waits 30 s for "
        "it)",
        "camera back after 3.0 s",
    ]


def test_how_long_to_wait_for_a_camera_can_be_chosen(run_with_gap):
    summary, _ = run_with_gap(6, NullScreen(), patience_s=5.0)
    assert summary.frames == 5


@pytest.mark.parametrize("patience", ["-1", "nan"])
def test_a_patience_that_is_no_time_is_refused_in_one_line(cubeling, patience):
    code, _, err = cubeling("play", "--patience", patience, "--no-pictures", "companion")
    assert (code, err.count("\n")) == (2, 1)
    assert "--patience is a time of 0 s or more" in err


class ComingAndGoing:
    """A robot that is lost from the third to the fifth frame, and from the ninth on."""

    def __init__(self):
        self.asked = 0

    def __call__(self):
        self.asked += 1
        lost = 3 <= self.asked <= 5 or self.asked >= 9
        return RobotView("lost" if lost else "ready", 0.0, "neutral")


def test_a_robot_that_is_lost_and_comes_back_is_in_summary_recording_and_output(
    run_with_gap, monkeypatch
):
    said: list[str] = []
    robot = ComingAndGoing()
    monkeypatch.setattr(RobotLine, "view", lambda line: robot())
    summary, path = run_with_gap(0, NullScreen(), said)
    first, second = (gap for gap in summary.gaps if gap.part == "robot")
    assert (first.back, second.back) == (True, False)
    assert first.seconds == pytest.approx(3.1)  # the camera's clock jumps by 3 s
    recorded = [event for _, event in session_parts.events(path) if event.startswith("robot")]
    assert recorded == ["robot lost", "robot back", "robot lost"]
    assert [line.split(" after")[0] for line in said] == recorded
    assert "until the end" in shown(summary)


def test_a_camera_that_stutters_says_so_a_number_of_times(short_session):
    said: list[str] = []
    with SourceWithGap(short_session, 0) as source:
        options = SessionOptions(
            scenario="companion", source="camera:0", robot="none", pictures=False
        )
        with open_session(options, source=source, screen=NullScreen()) as session:
            watch = GapWatch(session, Summary("companion"), said.append)
            for _ in range(50):
                watch.camera_lost("it stutters")
                watch.camera_back(1.0)
    assert len(said) == MAX_LINES + 1
    assert said[-1] == "camera: further gaps are in the summary"


def test_a_full_disk_ends_the_recording_and_not_the_session(run_with_gap, monkeypatch):
    said: list[str] = []
    syncs = itertools.count(1)

    def sync(file):
        if next(syncs) == 3:
            raise OSError(errno.ENOSPC, "No space left on device")

    def write_now(recorder, step, inputs=None):
        write(recorder, step, inputs)
        recorder.flush()

    write = Recorder.write
    monkeypatch.setattr(os, "fsync", sync)
    monkeypatch.setattr(Recorder, "write", write_now)
    summary, path = run_with_gap(0, NullScreen(), said)
    assert summary.frames == 10
    assert said == [f"recording to '{path}' stopped: No space left on device"]
    assert 1 <= session_info(path, salvage=True).frames < 10


@pytest.mark.parametrize(
    ("health", "title"),
    [
        (LOST, "Camera lost"),
        (replace(LOST, state="recovering"), "Camera lost"),
        (replace(LOST, state="frozen", frozen=True), "is frozen"),
        (replace(LOST, name="http://phone:8080/video"), "phone"),
        (replace(LOST, name="http://phone:8080/video", images_unusable=True), "cannot be used"),
    ],
)
def test_what_the_player_reads_fits_what_is_wrong(health, title):
    words = notice(health)
    assert words is not None
    assert title in words.title
    assert notice(RUNNING) is None


def test_the_card_of_a_notice_lies_in_the_middle():
    picture = np.full((360, 640, 3), 100, np.uint8)
    words = notice(LOST)
    assert words is not None
    notice_card(words, (640, 360)).blend_over(picture)
    assert (picture[0, 0] == 100).all()
    assert picture[180, 320].min() > 200


def test_the_summary_names_drops_gaps_and_latency():
    health = replace(
        RUNNING, latency=0.0412, dropped=3, unusable=2, max_queue=2, stamped_by="driver"
    )
    gap = Gap("camera", 61.0, 1.0, 6.25)
    words = shown(Summary("follow", camera=health, gaps=[gap]))
    assert (
        "30.0 pictures/s, 41 ms old (since exposure), 3 left out for newer ones, "
        "2 broken or of another size, at most 2 waited"
    ) in words
    assert "6.2 s: after 1.0 s" in words
    many = Summary("follow", gaps=[replace(gap, part="robot")] * 9)
    assert "56.2 s in all: after 1.0 s for 6.2 s, " in shown(many)
    assert "and 5 times more" in shown(many)


def shown(summary):
    console = Console(width=200)
    with console.capture() as capture:
        console.print(summary)
    return capture.get()


def test_a_session_that_ends_before_its_first_frame_has_a_summary():
    console = Console(width=140)
    with console.capture() as capture:
        console.print(Summary("follow", interrupted=True))
    assert "0 frames" in capture.get()


def test_a_summary_of_hours_is_as_small_as_one_of_minutes():
    taken = Summary("follow").frame_seconds
    for index in range(200_000):
        taken.add(index / 200_000)
    assert len(taken.values) <= MAX_SAMPLES
    assert np.median(taken.values) == pytest.approx(0.5, abs=0.001)


def test_the_summary_of_one_frame_is_in_the_singular():
    console = Console(width=140)
    with console.capture() as capture:
        console.print(Summary("follow", frames=1, left_out=1))
    shown = capture.get()
    assert "1 frame, 0.0 s" in shown
    assert "1 frame, to keep up" in shown
