"""Cameras and phones: the newest frame, and a one-line error in time if none arrives."""

import itertools
import queue
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar

import cv2
import numpy as np
import pytest

from tracking import TrackingError, open_source
from tracking.sources.camera import MJPG, CameraSource
from tracking.sources.http import HttpSource

SIZE = (64, 48)
TEST_TIMEOUT_S = 10.0
"""Real time after which a test that waits for another thread has failed."""


def picture(number):
    image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    cv2.circle(image, (8 + number % 40, 24), 6, (40, 200, 250), -1)
    return image


def jpeg(number):
    return cv2.imencode(".jpg", picture(number))[1].tobytes()


def fast_clock(step=0.25):
    """A clock that advances with every reading, so that seconds pass in milliseconds."""
    ticks = itertools.count()
    return lambda: next(ticks) * step


class FakeCapture:
    """Behaves like `cv2.VideoCapture` on V4L2, with good and bad drivers."""

    def __init__(self, *, opened=True, honours_mjpg=True, rate=30.0):
        self.opened, self.honours_mjpg, self.rate = opened, honours_mjpg, rate
        self.settings = {}
        self.frames: queue.Queue[np.ndarray | None] = queue.Queue()
        self.patience = 0.02
        """How long `read` blocks when there is no frame [s]."""
        self.asked = threading.Semaphore(0)
        self.released = threading.Event()

    def isOpened(self):  # noqa: N802
        return self.opened

    def set(self, prop, value):
        self.settings[prop] = value
        return True

    def get(self, prop):
        if prop == cv2.CAP_PROP_FOURCC:
            return float(self.settings.get(prop, 0) if self.honours_mjpg else 0)
        return self.rate if prop == cv2.CAP_PROP_FPS else 0.0

    def read(self):
        self.asked.release()
        try:
            frame = self.frames.get(timeout=self.patience)
        except queue.Empty:
            frame = None
        return frame is not None, frame

    def release(self):
        self.released.set()


def encoded(number):
    """A JPEG as V4L2 returns it: one row of bytes."""
    return np.frombuffer(jpeg(number), np.uint8)[None]


@pytest.fixture
def capture():
    made = FakeCapture()
    yield made
    made.frames.put(None)  # ends a thread that still reads


def open_camera(capture, clock=None):
    return CameraSource(0, SIZE, clock=clock or (lambda: 0.0), capture=lambda device: capture)


def test_a_camera_is_set_to_jpeg_and_size_and_returns_its_own_bytes(capture):
    capture.frames.put(encoded(0))
    with open_camera(capture) as source:
        assert (source.size, source.rate, source.live) == (SIZE, 30.0, True)
        assert capture.settings[cv2.CAP_PROP_FOURCC] == MJPG
        assert capture.settings[cv2.CAP_PROP_FRAME_WIDTH] == SIZE[0]
        assert capture.settings[cv2.CAP_PROP_CONVERT_RGB] == 0
        frame = next(iter(source))
    assert (frame.encoded, frame.encoding, frame.index) == (jpeg(0), "jpeg", 0)
    np.testing.assert_array_equal(frame.image, cv2.imdecode(encoded(0), 1))


def test_data_after_the_jpeg_is_cut_off(capture):
    capture.frames.put(np.frombuffer(jpeg(0) + bytes(999) + jpeg(1)[200:], np.uint8)[None])
    with open_camera(capture) as source:
        assert next(iter(source)).encoded == jpeg(0)


def test_a_camera_without_jpeg_returns_pixels(capture):
    capture.honours_mjpg = False
    capture.frames.put(picture(3))
    with open_camera(capture) as source:
        frame = next(iter(source))
    assert cv2.CAP_PROP_CONVERT_RGB not in capture.settings
    assert (frame.encoded, frame.encoding) == (None, "")
    np.testing.assert_array_equal(frame.image, picture(3))


def test_yuv_and_grey_images_become_bgr(capture):
    capture.frames.put(np.full((48, 64, 2), 128, np.uint8))
    with open_camera(capture) as source:
        frames = iter(source)
        np.testing.assert_allclose(next(frames).image[0, 0].astype(int), 130, atol=2)
        capture.frames.put(np.full((48, 64), 77, np.uint8))
        assert next(frames).image[5, 5].tolist() == [77, 77, 77]


def test_a_slow_reader_gets_the_newest_frame(capture):
    capture.patience = TEST_TIMEOUT_S  # so that each question but the last was answered
    capture.frames.put(encoded(0))
    with open_camera(capture) as source:
        frames = iter(source)
        assert next(frames).encoded == jpeg(0)
        for number in (1, 2, 3):
            capture.frames.put(encoded(number))
        for _ in range(5):  # the fifth question means that four frames were taken
            assert capture.asked.acquire(timeout=TEST_TIMEOUT_S)
        frame = next(frames)
        assert frame.encoded == jpeg(3)
        assert frame.index == 1


def test_truncated_images_are_skipped(capture):
    capture.frames.put(encoded(0))
    with open_camera(capture) as source:
        frames = iter(source)
        next(frames)
        capture.frames.put(encoded(1)[:, :200])
        assert capture.asked.acquire(timeout=TEST_TIMEOUT_S)
        capture.frames.put(encoded(2))
        assert next(frames).encoded == jpeg(2)


def fails(make, words):
    with pytest.raises(TrackingError) as caught:
        make()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("patience", [0.001, TEST_TIMEOUT_S])
def test_a_camera_that_never_delivers_an_image_is_one_line(capture, patience):
    """Both if `read` fails immediately and if it blocks."""
    capture.patience = patience
    fails(lambda: open_camera(capture, fast_clock()), "camera 0 delivered no image for 2 s")


def test_a_driver_that_blocks_while_opening_does_not_block_the_caller():
    never = threading.Event()

    def block(device):
        never.wait(TEST_TIMEOUT_S)
        return FakeCapture(opened=False)

    fails(
        lambda: CameraSource(0, SIZE, clock=fast_clock(), capture=block),
        "camera 0 did not open within 8 s",
    )
    never.set()


def test_a_camera_abandoned_while_opening_is_released_later():
    opened, came = threading.Event(), FakeCapture()
    came.frames.put(None)

    def slow(device):
        opened.wait(TEST_TIMEOUT_S)
        return came

    fails(lambda: CameraSource(0, SIZE, clock=fast_clock(), capture=slow), "did not open")
    opened.set()
    assert came.released.wait(TEST_TIMEOUT_S)


def test_a_camera_that_does_not_open_is_one_line():
    closed = FakeCapture(opened=False)
    fails(lambda: open_camera(closed), "camera 0 does not open: another program may use it")
    assert closed.released.wait(TEST_TIMEOUT_S)


def test_a_driver_that_raises_is_one_line():
    def broken(device):
        raise OSError("no such ioctl")

    fails(lambda: CameraSource(0, SIZE, capture=broken), "camera 0 failed: no such ioctl")


def test_an_unplugged_camera_returns_its_last_frame_and_then_fails_with_one_line(capture):
    capture.frames.put(encoded(0))
    with open_camera(capture, fast_clock()) as source:
        frames = iter(source)
        assert next(frames).encoded == jpeg(0)
        capture.patience = 0.0
        fails(lambda: next(frames), "camera 0 delivered no image for 3")


def test_a_camera_that_repeats_its_last_image_counts_as_lost(capture):
    """OpenCV #5746: after an unplug, some drivers repeat the same image."""
    capture.frames.get = lambda timeout: encoded(0)

    def watch():
        with open_camera(capture, fast_clock(0.05)) as source:
            for _ in source:
                pass

    fails(watch, "camera 0 has repeated the same image for 3")


def test_undecodable_images_are_one_line(capture):
    capture.patience = 0.001
    garbage = (np.full((1, 500), number % 256, np.uint8) for number in itertools.count())
    wait, capture.frames.get = capture.frames.get, lambda timeout: next(garbage)
    fails(lambda: open_camera(capture, fast_clock()), "images that cannot be decoded")
    capture.frames.get = wait


def test_a_change_of_size_is_one_line(capture):
    capture.frames.put(picture(0))
    with open_camera(capture) as source:
        frames = iter(source)
        next(frames)
        capture.frames.put(np.zeros((64, 48, 3), np.uint8))
        fails(lambda: next(frames), "changed from 64x48 to 48x64")


def test_close_ends_the_iteration_and_releases_the_camera(capture):
    capture.frames.put(encoded(0))
    source = open_camera(capture)
    capture.frames.put(encoded(1))
    source.close()
    source.close()
    assert list(source) == []
    assert capture.released.wait(TEST_TIMEOUT_S)


def test_a_camera_that_does_not_exist_is_one_line():
    fails(lambda: open_source("camera:97"), "camera 97")
    fails(lambda: open_source("camera:/dev/none"), "camera /dev/none")


class Phone(BaseHTTPRequestHandler):
    """Serves valid and invalid streams of phone apps."""

    ended = threading.Event()
    heard: ClassVar[list[str]] = []

    def log_message(self, *arguments):
        pass

    def answer(self, kind, status=200, **headers):
        self.send_response(status)
        self.send_header("Content-Type", kind)
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()

    def part(self, data, length=True):
        head = f"Content-Length: {len(data)}\r\n" if length else ""
        self.wfile.write(
            f"--frame\r\nContent-Type: image/jpeg\r\n{head}\r\n".encode() + data + b"\r\n"
        )

    def do_GET(self):
        kind = "multipart/x-mixed-replace; boundary=frame"
        self.heard.append(self.headers.get("Authorization", ""))
        match self.path:
            case "/page":
                self.answer("text/html")
            case "/photo":
                self.answer("image/jpeg")
            case "/secret":
                self.answer("text/html", 401)
            case "/moved":
                self.answer("text/html", 302, Location="http://elsewhere/video")
            case "/silent":
                self.answer(kind)
                self.ended.wait(TEST_TIMEOUT_S)
            case "/bare":
                self.answer('multipart/x-mixed-replace; boundary="--frame"')
                for number in range(3):
                    self.part(jpeg(number), length=False)
                self.wfile.write(b"--frame--\r\n")
            case "/video?quality=high":
                self.answer(kind)
                self.part(jpeg(0))
                self.part(jpeg(1))
                self.ended.wait(TEST_TIMEOUT_S)
            case "/stops":
                self.answer(kind)
                self.part(jpeg(0))
            case _:
                self.answer("text/plain", 404)


class QuietServer(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request, client_address):
        """Clients may close the connection."""


@pytest.fixture(scope="module")
def phone():
    Phone.ended.clear()
    server = QuietServer(("127.0.0.1", 0), Phone)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield f"127.0.0.1:{server.server_port}"
    Phone.ended.set()
    server.shutdown()
    thread.join()
    server.server_close()


def lost(source):
    """Read frames until there are none, without patience."""
    while True:
        source.wait(0.05, patience=0.0)


def test_a_phone_returns_its_own_jpeg_bytes(phone):
    with open_source(f"http://{phone}/video?quality=high", clock=lambda: 5.0) as source:
        assert (source.size, source.live, source.intrinsics) == (SIZE, True, None)
        frame = next(iter(source))
        assert frame.encoded in (jpeg(0), jpeg(1))
        assert (frame.encoding, frame.timestamp) == ("jpeg", 5.0)


def test_a_stream_without_lengths_is_understood(phone):
    with open_source(f"http://{phone}/bare") as source:
        frames = iter(source)
        assert next(frames).encoded in {jpeg(number) for number in range(3)}
        fails(lambda: lost(source), "ended its stream")


def test_name_and_password_are_sent_but_not_printed(phone):
    Phone.heard.clear()
    with pytest.raises(TrackingError) as caught:
        open_source(f"http://anna:s%20cret@{phone}/secret")
    assert Phone.heard == ["Basic YW5uYTpzIGNyZXQ="]
    assert "cret" not in str(caught.value).replace("/secret", "")
    assert "needs a password" in str(caught.value)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("/page", "is text/html, not a stream of JPEG images"),
        ("/photo", "is image/jpeg, not a stream of JPEG images"),
        ("/moved", "has moved: open http://elsewhere/video instead"),
        ("/none", "answers 404"),
    ],
)
def test_an_answer_other_than_a_stream_is_one_line(phone, path, words):
    fails(lambda: open_source(f"http://{phone}{path}"), words)


def test_a_phone_that_falls_silent_is_one_line(phone):
    fails(lambda: HttpSource(f"http://{phone}/silent", clock=fast_clock(0.05)), "no image for 2 s")


def test_a_closed_stream_is_one_line_after_its_last_frame(phone):
    with open_source(f"http://{phone}/stops") as source:
        frames = iter(source)
        assert next(frames).encoded == jpeg(0)
        fails(lambda: lost(source), "ended its stream")


def test_a_closed_stream_is_opened_again(phone):
    with open_source(f"http://{phone}/stops", clock=fast_clock(0.02)) as source:
        frames = iter(source)
        first, second = next(frames), next(frames)
        assert (first.encoded, second.encoded) == (jpeg(0), jpeg(0))
        assert (second.index, second.timestamp > first.timestamp) == (1, True)
        assert isinstance(source, HttpSource)
        assert source.health.gaps >= 1


def test_addresses_without_a_server_are_one_line(phone):
    fails(lambda: open_source("http://127.0.0.1:1/video"), "cannot connect to http://127.0.0.1:1")
    fails(lambda: open_source("http://"), "names no host")
    fails(lambda: open_source("http://phone:ninety/"), "is not a web address")
