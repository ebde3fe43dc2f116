"""Frames from videos and sessions: every complete frame, its time, and one-line errors."""

import struct
import sys
from collections.abc import Callable
from fractions import Fraction
from types import ModuleType
from typing import Any

import av
import cv2
import numpy as np
import pytest
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from hypothesis import example, given, settings, strategies as st
from mcap.writer import CompressionType
from mcap_protobuf.writer import Writer

from cubeling.tracking import FrameSource, Intrinsics, TrackingError, open_source
from cubeling.tracking.sources import SCHEME_MODULES, decoding
from cubeling.tracking.sources.base import StoredFrames, Timeline, nanoseconds_of, seconds_of
from tests.examples import examples

SIZE = (160, 120)
STEP_NS = 33_333_333


def picture(number):
    image = np.full((SIZE[1], SIZE[0], 3), (60, 90, 40), np.uint8)
    cv2.circle(image, (20 + 4 * number, 60), 15, (30, 200, 255), -1)
    return image


def jpeg(number):
    return cv2.imencode(".jpg", picture(number))[1].tobytes()


def access_units(count, keyint=250):
    codec = av.CodecContext.create("libx264", "w")
    codec.width, codec.height, codec.pix_fmt = *SIZE, "yuv420p"
    codec.time_base = Fraction(1, 30)
    codec.options = {
        "tune": "zerolatency",
        "x264-params": f"annexb=1:repeat-headers=1:keyint={keyint}:scenecut=0",
    }
    for number in range(count):
        frame = av.VideoFrame.from_ndarray(picture(number), format="bgr24")
        frame = frame.reformat(format="yuv420p")
        frame.pts = number
        yield b"".join(bytes(packet) for packet in codec.encode(frame))


def write_session(path, pictures, **options):
    """A session as the recorder writes it, with a calibration and a second channel."""
    with path.open("wb") as file:
        writer = Writer(file, **options)
        calibration = CameraCalibration(
            width=320, height=240, K=[200, 0, 159.5, 0, 200, 119.5, 0, 0, 1], D=[0.1, 0, 0, 0, 0]
        )
        writer.write_message("/camera/calibration", calibration, 0, 0)
        for number, message in enumerate(pictures):
            time = number * STEP_NS
            message.timestamp.FromNanoseconds(time)
            writer.write_message("/camera/image", message, time, time)
            writer.write_message("/other", CompressedImage(format="jpeg"), time, time)
        writer.finish()
    return path


def jpegs(count):
    return [CompressedImage(format="jpeg", data=jpeg(number)) for number in range(count)]


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    path = tmp_path_factory.mktemp("session") / "take.mcap"
    return write_session(path, jpegs(40), chunk_size=4000)


def read(path):
    """Return all frames, and the error that ended the iteration."""
    frames = []
    try:
        with open_source(str(path)) as source:
            for frame in source:
                frames.append(frame)  # also the frames before an error
    except TrackingError as error:
        return frames, str(error)
    return frames, ""


def test_a_session_returns_the_recorded_pixels_bytes_and_times(session):
    frames, error = read(session)
    assert not error
    assert [frame.index for frame in frames] == list(range(40))
    assert [nanoseconds_of(frame.timestamp) for frame in frames] == [
        number * STEP_NS for number in range(40)
    ]
    for number, frame in enumerate(frames):
        assert (frame.encoded, frame.encoding) == (jpeg(number), "jpeg")
        np.testing.assert_array_equal(
            frame.image, cv2.imdecode(np.frombuffer(jpeg(number), np.uint8), 1)
        )


def test_a_session_knows_size_rate_duration_and_intrinsics(session):
    with open_source(str(session)) as source:
        assert isinstance(source, FrameSource)
        assert (source.size, source.rate, source.live) == (SIZE, 30.0, False)
        assert source.duration == pytest.approx(39 * STEP_NS / 1e9)
        # The calibration was made at twice the size, and is brought to that of the frames.
        expected = Intrinsics(
            np.array([[200, 0, 159.5], [0, 200, 119.5], [0, 0, 1]]),
            np.array([0.1, 0, 0, 0, 0]),
            (320, 240),
        ).scale(SIZE)
        assert source.intrinsics is not None
        np.testing.assert_allclose(source.intrinsics.matrix, expected.matrix)
        np.testing.assert_array_equal(source.intrinsics.distortion, expected.distortion)


def test_closing_twice_and_early_ends_the_iteration(session):
    source = open_source(str(session))
    next(iter(source))
    source.close()
    source.close()
    assert list(source) == []


@pytest.mark.parametrize("compression", list(CompressionType))
def test_every_compression_of_mcap_is_read(tmp_path, compression):
    path = write_session(tmp_path / "take.mcap", jpegs(5), compression=compression)
    frames, error = read(path)
    assert (len(frames), error) == (5, "")


def test_an_h264_session_returns_one_frame_per_access_unit(tmp_path):
    units = list(access_units(25))
    messages = [CompressedVideo(format="h264", data=unit) for unit in units]
    frames, error = read(write_session(tmp_path / "take.mcap", messages))
    assert not error
    assert [frame.encoded for frame in frames] == units
    assert {frame.encoding for frame in frames} == {"h264"}
    for number, frame in enumerate(frames):
        assert nanoseconds_of(frame.timestamp) == number * STEP_NS
        assert np.abs(frame.image.astype(int) - picture(number)).mean() < 3


def test_every_complete_frame_of_a_truncated_session_is_read(session, tmp_path):
    data = session.read_bytes()
    whole, _ = read(session)
    path = tmp_path / "cut.mcap"
    counts = []
    for cut in np.linspace(0, len(data) - 1, 30).astype(int):
        path.write_bytes(data[:cut])
        frames, error = read(path)
        assert "truncated" in error or "is not MCAP" in error
        assert "\n" not in error
        if frames:
            amount = f"its first {len(frames)} frames" if len(frames) > 1 else "one frame"
            assert f"{amount} could be read" in error
        for frame, original in zip(frames, whole, strict=False):
            assert frame.encoded == original.encoded
        counts.append(len(frames))
    assert counts == sorted(counts)
    # A chunk holds less than two frames here, so little more than the cut itself is lost.
    assert counts[15] >= 17
    assert counts[-1] == 40


@given(place=st.floats(0.1, 0.9), bit=st.integers(0, 7))
@example(place=0.24608066831063077, bit=3)  # the type of a record: a whole chunk is skipped
@settings(max_examples=examples(40))
def test_a_flipped_bit_never_gives_a_wrong_image(session, tmp_path_factory, place, bit):
    data = bytearray(session.read_bytes())
    data[int(place * len(data))] ^= 1 << bit
    path = tmp_path_factory.getbasetemp() / "flipped.mcap"
    path.write_bytes(data)
    frames, _ = read(path)
    for frame in frames:
        recorded = round(frame.timestamp * 1e9 / STEP_NS)  # frames may be lost before it
        assert frame.timestamp == pytest.approx(recorded * STEP_NS / 1e9, abs=1e-9)
        assert frame.encoded == jpeg(recorded)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is not MCAP"),
        (b"a letter to grandmother", "is not MCAP"),
        (b"\x89MCAP0\r\n", "is truncated: no frame could be read"),
    ],
)
def test_an_invalid_session_is_refused_with_one_line(tmp_path, content, words):
    path = tmp_path / "letter.mcap"
    path.write_bytes(content)
    assert words in read(path)[1]


def test_sessions_without_or_with_unknown_images_are_refused_with_one_line(tmp_path):
    path = tmp_path / "take.mcap"
    assert "holds no camera frame on /camera/image" in read(write_session(path, []))[1]
    webp = CompressedImage(format="webp", data=b"RIFF")
    assert "images in 'webp', not jpeg or h264" in read(write_session(path, [webp]))[1]
    torn = CompressedImage(format="jpeg", data=jpeg(2)[:300])
    frames, error = read(write_session(path, [*jpegs(2), torn]))
    assert len(frames) == 2
    assert "has an image that is not JPEG: its first 2 frames could be read" in error


def h264_session(path):
    """40 images, of which the numbers 0, 12, 24 and 36 can be decoded alone."""
    pictures = [CompressedVideo(format="h264", data=unit) for unit in access_units(40, keyint=12)]
    return write_session(path, pictures)


@pytest.mark.parametrize("kind", ["jpeg", "h264", "mp4"])
@pytest.mark.parametrize("starts", [(0,), (1,), (11,), (12,), (13,), (25, 5), (39,), (60, 2)])
def test_frames_after_a_restart_are_the_same_as_before(session, tmp_path, kind, starts):
    path = session
    if kind == "h264":
        path = h264_session(tmp_path / "take.mcap")
    elif kind == "mp4":
        path = write_video(tmp_path / "take.mp4", count=40)
    expected = read(path)[0][starts[-1] :]
    with open_source(str(path)) as source:
        assert isinstance(source, StoredFrames)
        for start in starts:
            source.restart(start)
            next(iter(source), None)
        source.restart(starts[-1])
        frames = list(source)
    assert [frame.index for frame in frames] == [frame.index for frame in expected]
    for frame, other in zip(frames, expected, strict=True):
        assert frame.timestamp == other.timestamp
        np.testing.assert_array_equal(frame.image, other.image)


def test_frames_of_a_session_that_was_cut_off_are_returned_again(session, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(session.read_bytes()[:-500])
    with open_source(str(cut)) as source:
        assert isinstance(source, StoredFrames)
        first = next(iter(source))
        source.restart(0)
        again = next(iter(source))
    assert first.timestamp == again.timestamp
    assert again.index == 0


def test_a_restart_decodes_only_what_later_frames_need(tmp_path, monkeypatch):
    decoded = []

    def decode(frame):
        decoded.append(frame)
        return picture(0)

    monkeypatch.setattr(decoding, "bgr_of", decode)
    with open_source(str(h264_session(tmp_path / "take.mcap"))) as source:
        assert isinstance(source, StoredFrames)
        source.restart(26)
        next(iter(source))
    assert len(decoded) == 2  # the first one on opening; of 24 and 25, nobody sees the pixels


def write_video(path, count=20, rate=25, shape=None):
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=rate)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        if shape:
            stream.codec_context.sample_aspect_ratio = shape
        for number in range(count):
            frame = av.VideoFrame.from_ndarray(picture(number), format="bgr24")
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


@pytest.mark.parametrize("kind", ["mp4", "mkv", "avi"])
def test_a_video_returns_its_frames_with_the_times_of_its_container(tmp_path, kind):
    path = write_video(tmp_path / f"take.{kind}")
    frames, error = read(path)
    assert not error
    times = [frame.timestamp for frame in frames]
    assert times[0] == 0
    np.testing.assert_allclose(np.diff(times), 1 / 25, atol=1e-3)
    for number, frame in enumerate(frames):
        assert frame.encoded is None
        assert np.abs(frame.image.astype(int) - picture(number)).mean() < 3
    with open_source(str(path)) as source:
        assert (source.size, source.rate, source.live) == (SIZE, 25.0, False)
        assert source.duration == pytest.approx(0.8, abs=0.05)
        assert source.intrinsics is None


@pytest.mark.parametrize(("shape", "size"), [("4/3", (213, 120)), ("3/4", (160, 160))])
def test_a_video_of_pixels_that_are_not_square_is_stretched(tmp_path, shape, size):
    path = write_video(tmp_path / "take.mp4", count=1, shape=Fraction(shape))
    frames, _ = read(path)
    expected = cv2.resize(picture(0), size)
    assert frames[0].image.shape == expected.shape
    assert np.abs(frames[0].image.astype(int) - expected).mean() < 3


MATRICES: dict[str, tuple[tuple[int, int, int, int], Callable[[Any], Any]]] = {
    "as it is": ((1, 0, 0, 1), lambda image: image),
    "a quarter clockwise": ((0, 1, -1, 0), lambda image: np.rot90(image, -1)),
    "upside down": ((-1, 0, 0, -1), lambda image: np.rot90(image, 2)),
    "a quarter counter-clockwise": ((0, -1, 1, 0), np.rot90),
    "mirrored": ((-1, 0, 0, 1), np.fliplr),
    "mirrored upside down": ((1, 0, 0, -1), np.flipud),
    "transposed": ((0, 1, 1, 0), lambda image: np.swapaxes(image, 0, 1)),
    "mirrored, then a quarter clockwise": (
        (0, -1, -1, 0),
        lambda image: np.rot90(np.fliplr(image), -1),
    ),
}
"""Display matrices (a, b, c, d) of ISO/IEC 14496-12, section 6.2.2, and what a player shows."""


@pytest.mark.parametrize("name", MATRICES)
def test_a_video_is_turned_and_mirrored_as_it_says(tmp_path, name):
    path = write_video(tmp_path / "take.mp4", count=1)
    numbers, shown = MATRICES[name]
    identity, wanted = (
        struct.pack(">9i", a << 16, b << 16, 0, c << 16, d << 16, 0, 0, 0, 1 << 30)
        for a, b, c, d in ((1, 0, 0, 1), numbers)
    )
    head, mark, track = path.read_bytes().partition(b"tkhd")
    assert identity in track
    path.write_bytes(head + mark + track.replace(identity, wanted, 1))
    frames, _ = read(path)
    expected = shown(picture(0))
    assert frames[0].image.shape == expected.shape
    assert np.abs(frames[0].image.astype(int) - expected).mean() < 3


def test_a_truncated_video_returns_the_frames_it_has(tmp_path):
    path = write_video(tmp_path / "take.mkv", count=60)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    frames, _ = read(path)
    assert 5 < len(frames) < 60


def test_an_invalid_video_is_refused_with_one_line(tmp_path):
    text = tmp_path / "letter.mp4"
    text.write_text("dear grandmother", encoding="utf-8")
    assert "letter.mp4' is not a video" in read(text)[1]
    assert "No such file" in read(tmp_path / "none.mp4")[1]
    assert "it is a folder" in read(tmp_path)[1]


def test_an_unknown_scheme_is_refused_with_one_line():
    with pytest.raises(TrackingError, match="use camera, http, https, rtsp, rtsps, synth"):
        open_source("gopher://phone/video")


def test_a_new_source_is_a_module_and_one_line_of_the_table(monkeypatch, session):
    module = ModuleType("brand_new")
    module.open_uri = lambda uri, size, clock: open_source(str(session))  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "brand_new", module)
    monkeypatch.setitem(SCHEME_MODULES, "new", "brand_new")
    with open_source("new://anything") as source:
        assert source.size == SIZE


@given(st.floats(0, 1e9))
def test_a_stamp_survives_a_session_file_exactly(seconds):
    """Through whole nanoseconds and back, on a computer that has run for thirty years."""
    stamp = Timeline().stamp(seconds)
    assert seconds_of(nanoseconds_of(stamp)) == stamp
    assert abs(stamp - seconds) <= max(0.5e-9, np.spacing(seconds))


@given(st.lists(st.floats(-10, 10)))
def test_stamps_never_go_back(times):
    line = Timeline()
    stamps = [line.stamp(time) for time in times]
    assert stamps == sorted(stamps)
