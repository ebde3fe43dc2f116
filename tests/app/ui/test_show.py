"""Cards over the picture, videos on disk, and the summary."""

import dataclasses
from dataclasses import replace
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from rich.console import Console

from cubeling.app.commands.play import demo
from cubeling.app.errors import AppError
from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.pipeline.step import RobotView
from cubeling.app.running.summary.summary import Summary
from cubeling.app.ui import output_file, video_file
from cubeling.app.ui.canvas import Canvas, rounded_rectangle
from cubeling.app.ui.cards.overlay import overlay
from cubeling.app.ui.output_file import ENDING_RATE, ENDING_S, MAX_FRAMES, FrameSheet
from cubeling.app.ui.output_formats import VIDEO_FORMATS
from cubeling.app.ui.video_file import VideoFile
from cubeling.tracking import LensEstimate
from tests.app.conftest import SHORT_FRAMES

ROBOT = RobotView("ready", 0.4, "happy")


def test_a_card_covers_only_its_own_place():
    picture = np.full((200, 300, 3), 50, np.uint8)
    Canvas(100, 40, 1.0).card(-20, 180).blend_over(picture)
    assert (picture[:175] == 50).all()
    assert (picture[:, 90:] == 50).all()
    assert picture[190, 30].min() > 200


def test_round_corners_are_symmetric():
    mask = rounded_rectangle(60, 40, 12, 255)
    np.testing.assert_array_equal(mask, mask[::-1, ::-1])
    assert mask[0, 0] == 0
    assert mask[20, 30] == 255


def test_the_same_step_gives_the_same_cards(a_step):
    step = a_step(None)
    pictures = [overlay(step.frame.image.copy(), step, ROBOT) for _ in range(2)]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert (pictures[0] != step.frame.image).any()


def test_a_video_appears_only_when_it_is_whole(tmp_path):
    path = tmp_path / "out.mp4"
    with VideoFile(path, (64, 48), 30) as video:
        for index in range(10):
            video.write(np.full((48, 64, 3), 20 * index, np.uint8), index / 30)
        assert not path.exists()
    with av.open(str(path)) as file:
        times = [frame.time for frame in file.decode(video=0)]
    assert times == pytest.approx(np.arange(10) / 30, abs=0.002)
    assert list(tmp_path.iterdir()) == [path]


def test_a_video_keeps_the_uneven_times_of_a_live_camera(tmp_path):
    path = tmp_path / "out.mp4"
    gaps = np.random.default_rng(3).choice([0.001, 0.012, 0.033, 0.034, 0.1, 0.7], 120)
    times = 5000.0 + np.cumsum(gaps)
    with VideoFile(path, (64, 48), 30) as video:
        for time in times:
            video.write(np.full((48, 64, 3), 90, np.uint8), float(time))
    with av.open(str(path)) as file:
        seen = [frame.time for frame in file.decode(video=0)]
    assert seen == pytest.approx(times - times[0], abs=0.003)


@pytest.mark.parametrize(
    ("suffix", "encoder"),
    [(suffix, name) for suffix, kind in VIDEO_FORMATS.items() for name in kind.encoders],
)
def test_a_video_holds_the_pictures_of_every_encoder_of_its_kind(tmp_path, suffix, encoder):
    path = tmp_path / f"out{suffix}"
    across, down = np.meshgrid(np.arange(96), np.arange(64))
    picture = np.stack([2 * across, 3 * down, across + down], axis=2).astype(np.uint8)
    with VideoFile(path, (96, 64), 30, codec=encoder) as video:
        for index in range(12):
            video.write(picture, index / 30)
    with av.open(str(path)) as file:
        shown = [frame.to_ndarray(format="bgr24") for frame in file.decode(video=0)]
    assert len(shown) == (12 if suffix != ".gif" else 4)
    error = np.abs(shown[-1].astype(float) - picture).mean()
    assert error < 6.0


def test_an_encoder_that_pyav_lacks_is_named_with_those_it_has(tmp_path, monkeypatch):
    monkeypatch.setattr(video_file, "_is_available", lambda name: name == "mpeg4")
    with pytest.raises(AppError, match="PyAV lacks libx264; it has mpeg4"):
        VideoFile(tmp_path / "out.mp4", (64, 48), 30, codec="libx264")
    VideoFile(tmp_path / "out.mp4", (64, 48), 30).close()  # the usual one is missing: the next
    with pytest.raises(AppError, match="PyAV lacks libvpx-vp9, libsvtav1, libvpx"):
        VideoFile(tmp_path / "out.webm", (64, 48), 30)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("suffix", "container", "codec"),
    [
        (".mp4", "mp4", "h264"),
        (".MKV", "matroska", "h264"),
        (".webm", "webm", "vp9"),
        (".gif", "gif", "gif"),
    ],
)
def test_a_video_is_what_its_suffix_says(tmp_path, suffix, container, codec):
    path = tmp_path / f"out{suffix}"
    colors = np.array([[200, 60, 40], [30, 160, 230]])
    with VideoFile(path, (64, 48), 30) as video:
        for index in range(31):
            picture = np.broadcast_to(colors[index // 16], (48, 64, 3)).astype(np.uint8)
            video.write(picture, 100 + index / 30)
    with av.open(str(path)) as file:
        assert container in file.format.name
        assert file.streams.video[0].codec.name == codec
        pictures = list(file.decode(video=0))
    assert pictures[-1].time == pytest.approx(1.0, abs=0.011)
    for frame, color in ((pictures[0], colors[0]), (pictures[-1], colors[1])):
        shown = frame.to_ndarray(format="bgr24")
        np.testing.assert_allclose(shown.mean(axis=(0, 1)), color, atol=6)


def test_a_wide_gif_is_scaled_down_and_has_ten_pictures_a_second(tmp_path):
    with VideoFile(tmp_path / "out.gif", (1280, 720), 30) as video:
        for index in range(30):
            video.write(np.full((720, 1280, 3), 8 * index, np.uint8), index / 30)
    with av.open(str(tmp_path / "out.gif")) as file:
        pictures = list(file.decode(video=0))
    assert [picture.time for picture in pictures] == pytest.approx(np.arange(10) / 10)
    assert (pictures[0].width, pictures[0].height) == (480, 270)


@pytest.mark.parametrize("count", [1, 8, 1000])
def test_a_sheet_of_frames_spans_a_session_of_any_length(tmp_path, count):
    sheet = FrameSheet(tmp_path / "out.png")
    for index in range(count):
        sheet.write(np.full((90, 160, 3), 250 * index // count, np.uint8), index / 30)
    sheet.close()
    picture = cv2.imread(str(tmp_path / "out.png"))
    assert picture is not None
    shown = min(count, MAX_FRAMES)
    assert picture.shape[1] == pytest.approx(400 * min(shown, 4), abs=80)
    assert picture.shape[0] == pytest.approx(251 * -(-shown // 4), abs=80)
    last = picture[-100, -100].mean()
    assert last == pytest.approx(250 * (count - 1) // count, abs=15)
    assert list(tmp_path.iterdir()) == [tmp_path / "out.png"]


def test_captions_of_a_part_of_a_recording_count_from_its_first_frame(tmp_path, monkeypatch):
    captions = []
    monkeypatch.setattr(output_file, "frame_sheet", lambda _, frames: captions.extend(frames))
    monkeypatch.setattr(output_file, "save", lambda *_: None)
    sheet = FrameSheet(tmp_path / "out.png", start_s=12.0)
    for time in (712.0, 713.5):  # of a camera that has run for a while
        sheet.write(np.zeros((90, 160, 3), np.uint8), time)
    sheet.close()
    assert [caption for caption, _ in captions] == ["12.0 s", "13.5 s"]


@pytest.mark.parametrize("suffix", VIDEO_FORMATS)
def test_a_video_without_a_picture_leaves_nothing(tmp_path, suffix):
    VideoFile(tmp_path / f"out{suffix}", (64, 48), 30).close()
    assert not list(tmp_path.iterdir())


def test_a_video_that_fails_leaves_nothing(tmp_path):
    wrong = np.zeros((48, 64), np.uint8)
    with (
        pytest.raises(ValueError, match="ndim"),
        VideoFile(tmp_path / "out.mp4", (64, 48), 30) as video,
    ):
        video.write(wrong, 0.0)
    assert not list(tmp_path.iterdir())


def test_a_video_that_cannot_be_written_is_one_line(tmp_path):
    with pytest.raises(AppError, match="cannot write the video"):
        VideoFile(tmp_path / "no" / "out.mp4", (64, 48), 30)


def test_the_summary_shows_frames_moods_and_processing_time(a_step):
    summary = Summary("companion")
    step = a_step(None)
    for _ in range(4):
        summary.add(step, ROBOT, 0.02)
    assert summary.robots["robot"].labels == [(0.0, "happy")]
    shown = printed(summary)
    assert "4 frames" in shown
    assert "20.0 ms in the median, 20.0 ms at the 95th percentile" in shown


def test_the_summary_has_the_moods_of_both_robots_by_their_names(a_step):
    summary = Summary("companion")
    ann = dataclasses.replace(ROBOT, name="ann", label="angry")
    summary.add(a_step(None), dataclasses.replace(ROBOT, name="tim", second=ann), 0.02)
    shown = printed(summary)
    assert "tim felt" in shown
    assert "ann felt" in shown
    assert "robot felt" not in shown


def test_the_summary_names_every_scenario_that_was_played(a_step):
    summary = Summary("follow")
    step = a_step(None)
    for second, name in enumerate(["follow", "companion", "companion", "follow"]):
        frame = replace(step.frame, timestamp=float(second))
        summary.add(replace(step, frame=frame, scenario=name), ROBOT, 0.02)
    shown = printed(summary)
    assert "─ follow, companion ─" in shown
    assert "follow 1.0 s → companion 2.0 s" in shown


def test_the_summary_counts_hops_as_what_was_seen(a_step):
    summary = Summary("follow")
    step = a_step(None)
    for second, state in enumerate(["idle", "hop", "hop", "hop", "idle", "idle"]):
        frame, posed = (
            replace(step.frame, timestamp=float(second)),
            replace(step.posed, state=state),
        )
        summary.add(replace(step, frame=frame, posed=posed), ROBOT, 0.02)
    assert "idle 1.0 s → hop 3.0 s → idle 1.0 s" in printed(summary)


def printed(summary):
    console = Console(width=120)
    with console.capture() as capture:
        console.print(summary)
    return capture.get()


@pytest.mark.slow(reason="forty frames are drawn and written as a video")
def test_the_demo_without_a_display_renders_a_video_and_says_what_happened(
    cubeling, short_session, monkeypatch
):
    monkeypatch.setattr(demo, "bundled_session", lambda name: short_session)
    code, out, err = cubeling("demo")
    assert (code, err) == (0, "")
    assert str(Path("demo.mp4").resolve()) in out
    assert "cube found" in out
    assert "robot felt" in out
    assert [path.name for path in Path().iterdir()] == ["demo.mp4"]
    with av.open("demo.mp4") as file:
        pictures = list(file.decode(video=0))
    assert len(pictures) == SHORT_FRAMES + ENDING_S * ENDING_RATE
    assert pictures[-1].time == pytest.approx((SHORT_FRAMES - 1) / 30 + ENDING_S, abs=0.01)
    before, last = (pictures[index].to_ndarray(format="gray") for index in (SHORT_FRAMES - 1, -1))
    middle = np.s_[125:250, 210:430]
    assert last[middle].mean() > before[middle].mean() + 50, "no card lies over the last picture"


@pytest.mark.full
@pytest.mark.slow(reason="two demos are rendered")
def test_the_demo_writes_over_its_own_video_and_over_others_only_when_asked(
    cubeling, short_session, monkeypatch
):
    monkeypatch.setattr(demo, "bundled_session", lambda name: short_session)
    for name, options in (("demo.mp4", []), ("mine.png", ["-o", "mine.png", "--overwrite"])):
        Path(name).write_text("old")
        assert cubeling("demo", "--end", "0.5", *options)[0] == 0
        assert Path(name).stat().st_size > 1000


@pytest.mark.slow(reason="a session is recorded and checked")
def test_a_replay_can_be_recorded_again_and_checked(cubeling, short_session):
    code, out, err = cubeling("replay", short_session, "--no-pictures", "--record", "again.mcap")
    assert (code, err) == (0, "")
    code, out, err = cubeling("replay", "again.mcap", "--check")
    assert (code, err) == (0, "")
    assert "/cube/state" in out


def test_what_is_whole_of_a_cut_session_can_be_played(cubeling, short_session):
    data = short_session.read_bytes()
    Path("cut.mcap").write_bytes(data[: len(data) // 2])
    code, _, err = cubeling("replay", "cut.mcap", "--no-pictures")
    assert code == 2
    assert "--salvage" in err
    code, out, err = cubeling("replay", "cut.mcap", "--no-pictures", "--salvage")
    assert (code, err) == (0, "")
    assert "cube found" in out


@pytest.mark.slow(reason="a session is replayed twice")
def test_a_lens_that_is_not_as_it_claims_is_named_once_in_play_and_in_the_summary(
    cubeling, short_session, monkeypatch
):
    _, out, _ = cubeling("replay", short_session, "--no-pictures")
    assert "This camera's lens" not in out
    monkeypatch.setattr(TrackedCube, "lens", LensEstimate(0.1, 0.01))
    code, out, err = cubeling("replay", short_session, "--no-pictures")
    assert (code, err) == (0, "")
    line, row = out.split("This camera's lens")[1:]
    assert "cubeling calibrate" in " ".join(line.split())
    assert "cubeling calibrate" in " ".join(row.replace("│", "").split())
