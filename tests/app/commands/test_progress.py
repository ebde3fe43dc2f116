"""What a session says while it runs and at its end, and what Ctrl-C leaves."""

import re
import signal
from dataclasses import replace
from pathlib import Path

import av
import cv2
import pytest

from cubeling.app.commands.play import progress
from cubeling.app.commands.play.progress import ProgressLines
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions, messages, session_info
from cubeling.app.session.encoding import MESSAGE_TYPES
from cubeling.app.ui.screen import NullScreen
from cubeling.app.ui.video_file import VideoFile
from cubeling.tracking.sources.base import StoredFrames
from tests.app.conftest import SHORT_FRAMES
from tests.examples import some


@pytest.fixture
def interrupt_after(monkeypatch):
    """Return a function that presses Ctrl-C when so many frames of a recording were read."""
    read = StoredFrames.__iter__

    def press(count):
        def frames(source):
            for number, frame in enumerate(read(source)):
                if number == count:
                    raise KeyboardInterrupt
                yield frame

        monkeypatch.setattr(StoredFrames, "__iter__", frames)

    return press


@pytest.mark.parametrize("suffix", some([".mp4", ".gif", ".mkv", ".webm"]))
def test_ctrl_c_keeps_what_was_rendered_and_says_so(
    cubeling, short_session, interrupt_after, suffix
):
    interrupt_after(7)
    code, out, err = cubeling("replay", short_session, "-o", f"out{suffix}")
    assert (code, err) == (130, "")
    assert f"Stopped: 0.2 s are kept in out{suffix}" in out
    assert [path.name for path in Path().iterdir()] == [f"out{suffix}"]
    with av.open(f"out{suffix}") as file:
        assert [frame.time for frame in file.decode(video=0)][-1] == pytest.approx(0.2, abs=0.01)


def test_ctrl_c_keeps_the_sheet_of_frames(cubeling, short_session, interrupt_after):
    interrupt_after(7)
    code, out, _ = cubeling("replay", short_session, "-o", "out.png")
    assert code == 130
    assert "0.2 s are kept in out.png" in out
    assert cv2.imread("out.png") is not None


def test_ctrl_c_before_the_first_picture_leaves_nothing(cubeling, short_session, interrupt_after):
    interrupt_after(0)
    code, _, err = cubeling("replay", short_session, "-o", "out.mp4", "--record", "out.mcap")
    assert (code, err) == (130, "")
    assert not list(Path().iterdir())


@pytest.mark.slow(reason="pictures are drawn")
def test_a_second_ctrl_c_leaves_no_broken_file(
    cubeling, short_session, interrupt_after, monkeypatch
):
    def interrupted(self):
        raise KeyboardInterrupt

    interrupt_after(10)
    monkeypatch.setattr(VideoFile, "_finish", interrupted)
    code, _, _ = cubeling("replay", short_session, "-o", "out.mp4")
    assert code == 130
    assert not list(Path().iterdir())


@pytest.fixture
def ctrl_c_interrupts():
    """As in a terminal: what a shell starts in the background begins with Ctrl-C ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("ctrl_c_interrupts")
def test_ctrl_c_within_a_frame_waits_for_its_end(short_session, tmp_path):
    class Pressing(NullScreen):
        """Presses Ctrl-C while the fifth frame is shown."""

        frames = 0

        def show(self, step, robot):
            self.frames += 1
            if self.frames == 5:
                signal.raise_signal(signal.SIGINT)
            return super().show(step, robot)

    path = tmp_path / "out.mcap"
    options = SessionOptions(
        scenario="companion", source=str(short_session), robot="none", record=path, pictures=False
    )
    with open_session(options, screen=Pressing()) as session:
        summary = run(session)
    assert summary.interrupted
    assert summary.frames == 5
    assert len(list(messages(path, *MESSAGE_TYPES))) == 5 * len(MESSAGE_TYPES)


@pytest.mark.slow(reason="a session is computed twice")
def test_progress_outside_a_terminal_is_plain_lines_on_standard_error(
    cubeling, short_session, monkeypatch
):
    monkeypatch.setattr(progress, "LINE_INTERVAL_S", 0.0)
    code, out, err = cubeling("replay", short_session, "--no-pictures", "--record", "out.mcap")
    assert code == 0
    lines = err.splitlines()
    assert len(lines) == SHORT_FRAMES
    for line in lines[1:]:
        assert re.fullmatch(r"replaying short.mcap: \d+ %, frame \d+, about \d+ s left", line)
    assert lines[-1].startswith(f"replaying short.mcap: 100 %, frame {SHORT_FRAMES}")
    assert "%, " not in out
    code, _, err = cubeling("replay", short_session, "--check")
    assert code == 0
    assert err.splitlines()[-1].startswith("checking short.mcap: 100 %")


def test_lines_of_progress_come_every_few_seconds_with_the_time_left(a_step, capsys):
    now = 0.0
    first = a_step(None)
    lines = ProgressLines("rendering", 20.0, lambda: now)
    unknown = ProgressLines("recording", None, lambda: now)
    for index in range(301):
        now = index / 10  # ten frames a second are processed of thirty that were recorded
        frame = replace(first.frame, timestamp=first.frame.timestamp + index / 30)
        step = replace(first, frame=frame)
        lines(step)
        if index == 60:
            unknown(step)
    expected = [f"rendering: {k * 100 / 12:.0f} %" for k in range(1, 7)]
    shown = capsys.readouterr().err.splitlines()
    assert "recording: frame 1, 0 s so far" in shown
    shown.remove("recording: frame 1, 0 s so far")
    assert [line.split(",")[0] for line in shown] == expected
    assert shown[0] == "rendering: 8 %, frame 51, about 55 s left"


def test_a_recording_says_what_was_kept_and_how_to_play_it(cubeling, short_session):
    code, out, _ = cubeling(
        "replay", short_session, "--no-pictures", "--record", "of [bold]today.mcap"
    )
    assert code == 0
    size = Path("of [bold]today.mcap").stat().st_size / 1e6
    last = out.splitlines()[-1]
    assert last == (
        f"Recorded to of [bold]today.mcap: {SHORT_FRAMES / 30:.1f} s, {SHORT_FRAMES} frames, "
        f"{size:.1f} MB. "
        "Play it again: cubeling replay 'of [bold]today.mcap'"
    )


def test_a_recording_that_ends_with_an_error_says_what_was_kept(
    cubeling, short_session, monkeypatch
):
    read = StoredFrames.__iter__

    def breaks(source):
        for number, frame in enumerate(read(source)):
            if number == 20:
                raise OSError(28, "No space left on device", "disk")
            yield frame

    monkeypatch.setattr(StoredFrames, "__iter__", breaks)
    code, out, err = cubeling("replay", short_session, "--no-pictures", "--record", "r.mcap")
    assert code == 2
    assert "No space left" in err
    assert "Recorded to r.mcap: 0.6 s, 20 frames" in out
    assert session_info(Path("r.mcap")).frames == 20


def test_progress_of_a_session_that_ends_before_its_source_names_no_end(
    short_session, monkeypatch, capsys
):
    monkeypatch.setattr(progress, "LINE_INTERVAL_S", 0.0)
    options = SessionOptions(
        scenario="companion", source=str(short_session), robot="none", pictures=False
    )
    progress.play_session(options, "talking", typed=["hello"])
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == SHORT_FRAMES
    for line in lines:
        assert re.fullmatch(r"talking: frame \d+, \d s so far", line)


def test_a_replay_says_why_no_window_opens(cubeling, short_session):
    told = "No window: there is no display here; -o FILE.mp4 writes a video\n"
    assert cubeling("replay", short_session)[::2] == (0, told)
    assert cubeling("replay", short_session, "--no-pictures")[::2] == (0, "")
