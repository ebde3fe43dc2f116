"""Sessions on disk: exact, append-only, and readable after damage."""

import errno
import os
import threading
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.session import (
    Recorder,
    SessionFile,
    frame_encoder,
    messages,
    session_info,
)
from cubeling.app.session.codecs import CODECS
from cubeling.app.session.encoding import FORMAT_KEY, SESSION_FORMAT
from cubeling.files import FileKind
from cubeling.tracking import CubeState, CubeTracker, Frame, Intrinsics
from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic import open_synthetic
from tests.app import session_parts

SIZE = (64, 48)

WAIT_S = 10.0
"""Real time after which a test that waits for the recorder's thread has failed."""


def frames(count=20, rate=30):
    random = np.random.default_rng(5)
    for index in range(count):
        image = random.integers(0, 255, (SIZE[1], SIZE[0], 3), dtype=np.uint8)
        yield Frame(image, round(index / rate, 9), index)


@pytest.mark.parametrize("codec", CODECS)
def test_an_encoded_frame_is_what_a_replay_decodes(codec, recorded):
    path, frames_written = recorded(codec)
    from cubeling.tracking import open_source

    with open_source(str(path)) as source:
        again = list(source)
    assert [frame.timestamp for frame in again] == [frame.timestamp for frame in frames_written]
    for one, other in zip(frames_written, again, strict=True):
        np.testing.assert_array_equal(one.image, other.image)


@pytest.mark.parametrize("codec", ["auto", "jpeg"])
def test_an_encoded_frame_is_not_encoded_again(codec):
    frame = next(frames())
    once = frame_encoder("jpeg", SIZE, 30)(frame)
    assert frame_encoder(codec, SIZE, 30)(once) is once


@pytest.mark.slow(reason="pictures are encoded twice and tracked")
def test_pictures_that_are_no_jpeg_take_a_tenth_of_it_and_show_the_cube_as_well():
    source = open_synthetic("static?size=640x360&hand=0")
    assert source.intrinsics is not None
    pictures = [source.frame(index) for index in range(16)]
    sizes, errors = {}, {}
    for codec in ("jpeg", "auto"):
        encode = frame_encoder(codec, source.size, source.rate)
        tracker = CubeTracker(source.cube, source.intrinsics)
        encoded = [encode(frame) for frame in pictures]
        sizes[codec] = sum(len(frame.encoded or b"") for frame in encoded)
        poses = [tracker.update(frame).camera_from_cube for frame in encoded]
        deltas = [se3.delta(pose, source.truth(0)) for pose in poses if pose is not None]
        assert len(deltas) == len(encoded)
        errors[codec] = np.median(np.linalg.norm(np.array(deltas)[:, :3], axis=1))
    assert sizes["auto"] < sizes["jpeg"] / 10
    assert errors["auto"] < max(1.2 * errors["jpeg"], 0.0001)


def test_pictures_of_odd_size_are_jpegs_unless_h264_is_asked_for():
    frame = Frame(np.zeros((47, 64, 3), np.uint8), 0.0, 0)
    assert frame_encoder("auto", (64, 47), 30)(frame).encoding == "jpeg"
    with pytest.raises(AppError, match="even width and height, not 64x47"):
        frame_encoder("h264", (64, 47), 30)


def test_an_unknown_codec_is_refused():
    with pytest.raises(AppError, match="choose one of auto, jpeg, h264"):
        frame_encoder("gif", SIZE, 30)


def test_a_session_describes_itself(recorded):
    path, frames_written = recorded("jpeg")
    info = session_info(path)
    assert (info.options.scenario, info.options.turns, info.frames) == (
        "follow",
        2.0,
        len(frames_written),
    )
    assert session_parts.events(path)[0] == (0.0, "started")


def test_a_replay_begins_with_the_same_doubt_of_the_lens(recorded):
    """So it learns the focal length from the same frames as the session did."""
    from cubeling.tracking import open_source

    with open_source(str(recorded("jpeg")[0])) as source:
        guess = Intrinsics.guess(SIZE)
        assert source.intrinsics is not None
        assert source.intrinsics.focal_deviation == guess.focal_deviation
        np.testing.assert_array_equal(source.intrinsics.matrix, guess.matrix)


def test_a_session_says_the_version_of_its_format(recorded):
    path, _ = recorded("jpeg", count=4)
    with SessionFile(path) as session:
        assert session.format == SESSION_FORMAT


@pytest.mark.parametrize("version", [f"{SESSION_FORMAT + 1}", "new"])
def test_a_session_of_a_newer_version_is_refused_in_one_line(tmp_path, version):
    path = tmp_path / "newer.mcap"
    with Recorder(path, {"scenario": "follow", FORMAT_KEY: version}) as recorder:
        recorder.event("started", 0.0)
        recorder._steps = 1  # a file without a frame is not kept
    with pytest.raises(AppError, match=rf"the format {version}, .* reads up to {SESSION_FORMAT}"):
        session_info(path)


@pytest.mark.parametrize("turns", ["[]", "", "two"])
def test_metadata_that_no_recorder_writes_is_refused_in_one_line(tmp_path, turns):
    path = tmp_path / "odd.mcap"
    with Recorder(path, {"scenario": "follow", "turns": turns}) as recorder:
        recorder.event("started", 0.0)
        recorder._steps = 1
    with pytest.raises(
        AppError, match=r"cannot read the session '.*odd\.mcap': its 'turns'"
    ) as told:
        session_info(path)
    assert str(told.value).isprintable()


def test_a_replay_opens_its_session_twice(cubeling, recorded, monkeypatch):
    """Once for all that stands in it, and once for the camera's frames."""
    path, _ = recorded("jpeg", count=4)
    opened, real_open = [], FileKind.open

    def noting(kind, file):
        opened.append(Path(file))
        return real_open(kind, file)

    monkeypatch.setattr(FileKind, "open", noting)
    assert cubeling("replay", path, "--no-pictures", "--robot", "none")[0] == 0
    assert opened.count(path) == 2


@pytest.mark.parametrize("whole", [True, False])
def test_two_readers_of_a_session_do_not_disturb_each_other(recorded, whole):
    path, _ = recorded("jpeg", count=60)
    if not whole:
        path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    with SessionFile(path, salvage=True) as session:
        alone = list(session.messages("/camera/image"))
        times = []
        for number, (_, time, _) in enumerate(session.messages("/camera/image")):
            times.append(time)
            if number == 3:
                assert len(list(session.messages("/camera/image"))) == len(alone)
    assert times == [time for _, time, _ in alone]
    assert len(times) > 10


def test_a_session_lasts_as_long_as_its_frames(recorded):
    path, frames_written = recorded("jpeg", robot_after_s=30.0)
    last = frames_written[-1].timestamp - frames_written[0].timestamp
    assert session_info(path).duration == pytest.approx(last)


def test_the_error_for_a_cut_session_says_how_much_can_be_read(recorded):
    path, frames_written = recorded("jpeg", count=60)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) * 2 // 3])
    with pytest.raises(AppError, match=r"cut off: \d+ frames .* --salvage"):
        session_info(path)
    info = session_info(path, salvage=True)
    assert 0 < info.frames < len(frames_written)
    assert info.options.scenario == "follow"


@pytest.mark.parametrize("cut", range(0, 2600, 97))
def test_a_cut_at_any_byte_is_one_line(recorded, cut):
    path, _ = recorded("jpeg", count=4)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(AppError) as caught:
        session_info(path)
    assert "\n" not in str(caught.value)


def test_a_recording_without_a_frame_leaves_no_file(tmp_path):
    path = tmp_path / "empty.mcap"
    Recorder(path, {"scenario": "follow"}).close()
    assert not path.exists()


def test_a_missing_folder_is_refused_in_one_line(tmp_path):
    with pytest.raises(AppError, match="cannot record"):
        Recorder(tmp_path / "no" / "x.mcap", {})


@pytest.fixture
def synced(monkeypatch):
    """Return a semaphore that is released whenever a recorder has told the disk to keep a file."""
    count, real_sync = threading.Semaphore(0), os.fsync

    def noting(file):
        real_sync(file)
        count.release()

    monkeypatch.setattr(os, "fsync", noting)
    return count


def test_the_first_picture_is_kept_at_once(tmp_path, recorder_steps, synced):
    """The bytes on disk before `close` are what `kill -9` leaves."""
    path = tmp_path / "killed.mcap"
    with Recorder(path, {"scenario": "follow"}) as recorder:
        recorder_steps(recorder, 1)
        assert synced.acquire(timeout=WAIT_S)
        assert len(messages_of(path.read_bytes(), tmp_path)) == 1


def test_a_chunk_ends_in_time_although_nothing_more_comes(
    tmp_path, recorder_steps, synced, monkeypatch
):
    monkeypatch.setattr("cubeling.app.session.recorder.CHUNK_S", 0.02)
    path = tmp_path / "killed.mcap"
    with Recorder(path, {"scenario": "follow"}) as recorder:
        recorder_steps(recorder, 10)
        while len(messages_of(path.read_bytes(), tmp_path)) < 10:
            assert synced.acquire(timeout=WAIT_S)


def test_a_chunk_ends_in_time_although_the_disk_is_slow(tmp_path, recorder_steps, monkeypatch):
    """What is written by `flush` survives a kill, even if it has not reached the disk."""
    monkeypatch.setattr("cubeling.app.session.recorder.CHUNK_S", 0.0)
    disk_is_back, first_sync = threading.Event(), threading.Event()

    def hanging(file):
        first_sync.set()
        assert disk_is_back.wait(WAIT_S)

    path = tmp_path / "killed.mcap"
    with Recorder(path, {"scenario": "follow"}) as recorder:
        ended = threading.Semaphore(0)
        end_chunk = recorder._end_chunk

        def noting():
            end_chunk()
            ended.release()

        monkeypatch.setattr(recorder, "_end_chunk", noting)
        monkeypatch.setattr(os, "fsync", hanging)
        recorder_steps(recorder, 10)
        while len(messages_of(path.read_bytes(), tmp_path)) < 10:
            assert ended.acquire(timeout=WAIT_S)
        assert first_sync.is_set()
        disk_is_back.set()


def test_a_disk_that_fails_ends_the_recording(tmp_path, recorder_steps, monkeypatch):
    def failing(file):
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(os, "fsync", failing)
    path = tmp_path / "failing.mcap"
    with Recorder(path, {"scenario": "follow"}) as recorder:
        recorder_steps(recorder, 3)
        recorder.flush()
        assert recorder.problem == f"recording to '{path}' stopped: Input/output error"


def test_a_session_that_was_killed_before_its_first_picture_says_what_it_was(tmp_path):
    path = tmp_path / "killed.mcap"
    with Recorder(path, {"scenario": "follow"}):
        left = path.read_bytes()
    path.write_bytes(left)
    info = session_info(path, salvage=True)
    assert (info.options.scenario, info.frames) == ("follow", 0)


def messages_of(data, folder):
    """Read a copy of the file, as after a kill."""
    copy = folder / "copy.mcap"
    copy.write_bytes(data)
    return list(messages(copy, "/camera/image"))


def unseen(time):
    """Return the state of a cube that is not looked for in noise, where that takes long."""
    nowhere = np.full(6, np.nan)
    return ReplayInputs(CubeState(False, None, nowhere, np.eye(6), "predicted", (), np.nan, time))


@pytest.fixture(scope="module")
def recorder_steps():
    """Return a function that records so many steps of a real pipeline, without pictures."""
    import dataclasses

    from cubeling.app.pipeline.playground import Playground

    def write(recorder, count, codec="jpeg"):
        playground = Playground("follow", Intrinsics.guess(SIZE))
        prepare = frame_encoder(codec, SIZE, 30)
        frames_written = []
        for frame in frames(count):
            step = playground.step(prepare(frame), replay=unseen(frame.timestamp))
            frames_written.append(step.frame)
            if frame.index == 0:
                recorder.camera(playground.intrinsics, 0.0)
                recorder.event("started", 0.0)
            recorder.write(dataclasses.replace(step))
        return frames_written

    return write


@pytest.fixture(scope="module")
def recordings(tmp_path_factory, recorder_steps):
    """Record a session of noise, once for each choice; return its bytes and what was tracked."""

    @cache
    def record(codec, count, robot_after_s):
        path = tmp_path_factory.mktemp("recorded") / "session.mcap"
        with Recorder(path, {"scenario": "follow", "cube": "locomotion"}) as recorder:
            frames_written = recorder_steps(recorder, count, codec)
            recorder.wire("rx", b"\0", frames_written[-1].timestamp + robot_after_s)
        assert recorder.problem is None
        return path.read_bytes(), frames_written

    return record


@pytest.fixture
def recorded(tmp_path, recordings):
    """Record a session of noise; return its path and the frames that the tracker saw."""

    def record(codec, count=20, robot_after_s=0.0):
        data, frames_written = recordings(codec, count, robot_after_s)
        path = tmp_path / "session.mcap"
        path.write_bytes(data)
        return path, frames_written

    return record
