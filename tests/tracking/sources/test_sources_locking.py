"""Exposure and focus: locked if the driver allows it, and reported if not."""

import cv2
import numpy as np
import pytest

from cubeling.tracking import TrackingError, open_source
from cubeling.tracking.sources.device import DeviceSetting
from cubeling.tracking.sources.webcam.camera import CameraOptions, CameraSource, CaptureDevice
from cubeling.tracking.sources.webcam.camera_controls import MAX_SETTLING_IMAGES

SIZE = (64, 48)


class FakeV4l2Driver:
    """A camera with controls, like good and bad V4L2 drivers."""

    def __init__(self, **controls):
        self.controls = {
            cv2.CAP_PROP_AUTO_EXPOSURE: 3.0,
            cv2.CAP_PROP_EXPOSURE: 156.0,
            cv2.CAP_PROP_AUTOFOCUS: 1.0,
            cv2.CAP_PROP_FOCUS: 30.0,
            cv2.CAP_PROP_BUFFERSIZE: 4.0,
            cv2.CAP_PROP_FPS: 30.0,
        }
        self.refused: set[int] = set()
        self.absent: set[int] = set()
        self.clamp = 1e9
        self.light = 100
        self.manual_light = 100
        self.hunting = False
        self.time = 0.0
        self.reads = 0
        self.only = 0
        """How many pictures there are; 0: no end."""
        self.released = False

    def isOpened(self):  # noqa: N802
        return True

    def set(self, prop, value):
        if prop in self.refused or prop in self.absent:
            return False
        self.controls[prop] = min(value, self.clamp) if prop == cv2.CAP_PROP_EXPOSURE else value
        return True

    def get(self, prop):
        if prop == cv2.CAP_PROP_POS_MSEC:
            return self.time
        if prop in self.absent:
            return -1.0
        if prop == cv2.CAP_PROP_FOCUS and self.hunting:
            return 30.0 + self.reads
        return self.controls.get(prop, 0.0)

    def read(self):
        self.reads += 1
        if self.only and self.reads > self.only:
            return False, None
        manual = self.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 1.0
        return True, np.full((48, 64, 3), self.manual_light if manual else self.light, np.uint8)

    def release(self):
        self.released = True


def after(driver, pictures, **options):
    """Return the settings after a number of images."""
    device = CaptureDevice(driver, "camera 0", SIZE, CameraOptions(**options))
    for _ in range(pictures):
        device.read()
    return {setting.name: setting for setting in device.settings}


def test_nothing_is_locked_before_it_has_settled():
    driver = FakeV4l2Driver()
    settings = after(driver, 29)
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 3.0
    assert settings["exposure"] == DeviceSetting("exposure", False, "still automatic")


def test_exposure_and_focus_are_locked_once_they_have_settled():
    driver = FakeV4l2Driver()
    settings = after(driver, 100)
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 1.0
    assert driver.controls[cv2.CAP_PROP_AUTOFOCUS] == 0.0
    assert settings["exposure"] == DeviceSetting("exposure", True, "locked at 15.6 ms")
    assert settings["focus"] == DeviceSetting("focus", True, "locked at 30")


def test_a_misreported_exposure_stays_automatic():
    driver = FakeV4l2Driver()
    driver.manual_light = 40
    settings = after(driver, 100)
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 3.0
    assert not settings["exposure"].applied
    assert "does not report the value" in settings["exposure"].detail


def test_closing_the_camera_restores_the_automatic_modes():
    driver = FakeV4l2Driver()
    driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] = 0.0  # this driver's value for automatic
    device = CaptureDevice(driver, "camera 0", SIZE, CameraOptions(focus=60.0))
    for _ in range(100):
        device.read()
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 1.0
    device.close()
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 0.0
    assert driver.controls[cv2.CAP_PROP_AUTOFOCUS] == 1.0


def test_an_exposure_left_locked_by_a_killed_program_settles_again():
    driver = FakeV4l2Driver()
    driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] = 1.0
    after(driver, 10)
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 3.0
    assert after(driver, 100)["exposure"].applied


def test_a_focus_that_hunts_stays_automatic():
    driver = FakeV4l2Driver()
    driver.hunting = True
    settings = after(driver, MAX_SETTLING_IMAGES + 30)
    assert driver.controls[cv2.CAP_PROP_AUTOFOCUS] == 1.0
    assert "does not settle" in settings["focus"].detail


def test_refused_and_missing_controls_are_reported():
    driver = FakeV4l2Driver()
    driver.refused = {cv2.CAP_PROP_AUTO_EXPOSURE}
    driver.absent = {cv2.CAP_PROP_FOCUS, cv2.CAP_PROP_AUTOFOCUS}
    settings = after(driver, 100)
    assert settings["exposure"].detail == "refused: the camera stays automatic"
    assert settings["focus"].detail == "the camera has no such setting"
    assert not settings["exposure"].applied
    assert not settings["focus"].applied


def test_a_given_exposure_is_set_immediately_and_read_back():
    driver = FakeV4l2Driver()
    settings = after(driver, 0, exposure=5.0, focus=60.0)
    assert driver.controls[cv2.CAP_PROP_EXPOSURE] == 50.0
    assert settings["exposure"] == DeviceSetting("exposure", True, "set to 5 ms")
    assert settings["focus"] == DeviceSetting("focus", True, "set to 60")
    clamped = FakeV4l2Driver()
    clamped.clamp = 20.0
    assert after(clamped, 0, exposure=5.0)["exposure"].detail == "refused: the camera reports 2 ms"
    assert clamped.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 3.0


def test_nothing_is_changed_with_lock_0():
    driver = FakeV4l2Driver()
    settings = after(driver, 100, lock=False)
    assert driver.controls[cv2.CAP_PROP_AUTO_EXPOSURE] == 3.0
    assert set(settings) == {"buffers"}


def test_the_number_of_buffers_is_requested_and_reported():
    assert after(FakeV4l2Driver(), 0)["buffers"] == DeviceSetting("buffers", True, "2, requested 2")
    stubborn = FakeV4l2Driver()
    stubborn.refused = {cv2.CAP_PROP_BUFFERSIZE}
    assert after(stubborn, 0)["buffers"] == DeviceSetting("buffers", False, "4, requested 2")
    silent = FakeV4l2Driver()
    silent.absent = {cv2.CAP_PROP_BUFFERSIZE}
    assert "does not report" in after(silent, 0)["buffers"].detail


def test_the_drivers_time_becomes_the_frames_timestamp():
    driver = FakeV4l2Driver()
    driver.time, driver.only = 99_960.5, 1
    with CameraSource(0, SIZE, clock=lambda: 100.0, capture=lambda device: driver) as source:
        assert next(iter(source)).timestamp == pytest.approx(99.9605, abs=1e-9)
        assert source.health.stamped_by == "driver"
        assert source.health.latency == pytest.approx(0.0395, abs=1e-9)


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("0?zoom=3", "has no option 'zoom': it has lock, exposure, focus, buffers"),
        ("0?exposure=0", "exposure must be from 0.1 to 1000, not 0"),
        ("0?exposure=nan", "exposure must be"),
        ("0?exposure=short", "exposure=short is not a number"),
        ("0?lock=maybe", "lock=maybe is neither 0 nor 1"),
        ("0?buffers=99", "buffers must be from 1 to 10"),
    ],
)
def test_a_wrong_option_is_refused_with_one_line(uri, words):
    with pytest.raises(TrackingError) as caught:
        open_source(f"camera:{uri}")
    assert words in str(caught.value)
