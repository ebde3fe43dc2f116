"""Cameras: the newest frame, and a one-line error in time if none arrives."""

import itertools
import queue
import threading

import cv2
import numpy as np
import pytest

from cubeling.tracking import open_source
from cubeling.tracking.sources.webcam.camera import MJPG, CameraSource
from tests.tracking.sources.live import SIZE, fails, fast_clock, jpeg, picture

TEST_TIMEOUT_S = 10.0
"""Real time after which a test that waits for another thread has failed."""


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


def test_images_of_another_size_are_left_out_and_counted(capture):
    capture.frames.put(picture(0))
    clock = fast_clock(0.05)
    with open_camera(capture, clock) as source:
        source.wait(0.0)
        upright = (np.full((64, 48, 3), number % 256, np.uint8) for number in itertools.count())
        usual, capture.frames.get = capture.frames.get, lambda timeout: next(upright)

        def lost():
            while True:
                assert source.wait(0.05, patience=3.0) is None

        fails(lost, "changed from 64x48 to 48x64")
        assert source.health.images_unusable
        assert source.health.unusable > 0
        capture.frames.get = usual
        pictures = map(picture, itertools.count(1))
        capture.frames.put(next(pictures))
        while (frame := source.wait(0.05)) is None:
            capture.frames.put(next(pictures))  # one may be read while the camera is reopened
        assert frame.image.shape == (48, 64, 3)


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
