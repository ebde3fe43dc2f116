"""Cameras that are lost and come back, on a clock that the test controls."""

import queue
import threading

import numpy as np
import pytest

from cubeling.tracking import Frame, TrackingError
from cubeling.tracking.sources.base import LiveFrames
from cubeling.tracking.sources.capture import MAX_ABANDONED_THREADS, STUCK_TIMEOUT_S
from cubeling.tracking.sources.capture_timing import DISTRUST_IMAGES, ExposureClock, QueueGauge
from cubeling.tracking.sources.live import LiveSource
from cubeling.tracking.sources.webcam.video_device import persistent_path

TEST_TIMEOUT_S = 10.0
"""Real time after which a test that waits for another thread has failed."""

UNPLUG = object()


class Clock:
    """A clock that the test moves."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class CameraBench:
    """Opens fake devices that return what the test puts into their queue."""

    def __init__(self):
        self.clock = Clock()
        self.pictures: queue.Queue[object] = queue.Queue()
        self.plugged = True
        self.opened = self.held = 0
        self.most_held = 0
        self.asked = threading.Semaphore(0)
        self.tried = threading.Semaphore(0)
        self.hold = threading.Event()
        self.blocks = False
        self.exposed = None

    def __call__(self):
        self.tried.release()
        if not self.plugged:
            raise TrackingError("camera 0 does not exist")
        self.opened += 1
        self.held += 1
        self.most_held = max(self.most_held, self.held)
        return FakeDevice(self)

    def put(self, number):
        self.pictures.put(np.full((48, 64, 3), number, np.uint8))

    def until(self, met):
        """Wait in real time for the capture thread."""
        ended = threading.Event()
        for _ in range(int(TEST_TIMEOUT_S / 0.005)):
            if met():
                return
            ended.wait(0.005)
        raise AssertionError("the capture thread did not get there")


class FakeDevice:
    rate = 30.0
    settings = ()

    def __init__(self, bench):
        self._bench = bench

    @property
    def exposed(self):
        return self._bench.exposed

    def read(self):
        bench = self._bench
        bench.asked.release()
        if bench.blocks:
            bench.hold.wait(TEST_TIMEOUT_S)
            return None
        try:
            picture = bench.pictures.get(timeout=0.005)
        except queue.Empty:
            return None
        if picture is UNPLUG:
            raise TrackingError("camera 0 was pulled out")
        return picture

    def interrupt(self):
        pass

    def close(self):
        self._bench.held -= 1


@pytest.fixture
def bench():
    made = CameraBench()
    yield made
    made.hold.set()


@pytest.fixture
def source(bench):
    bench.put(1)
    with LiveSource(bench, "camera 0", bench.clock) as opened:
        assert isinstance(opened, LiveFrames)
        frame = opened.wait(0.0)
        assert frame is not None
        assert frame.image[0, 0, 0] == 1
        yield opened


def at(bench, seconds, source):
    """The source's health at a time."""
    bench.clock.now = 100.0 + seconds
    return source.health


def awaited(source, bench):
    """The next frame, waiting in real time only."""
    found: list[Frame] = []

    def came():
        found.extend(frame for frame in [source.wait(0.0)] if frame is not None)
        return bool(found)

    bench.until(came)
    return found[0]


def test_silence_is_reported_within_a_second_while_the_driver_blocks(bench, source):
    bench.blocks = True
    assert at(bench, 0.7, source).state == "running"
    health = at(bench, 1.0, source)
    assert (health.state, health.since) == ("lost", 100.0)
    assert "delivered no image for 1 s" in health.problem
    assert source.wait(0.0) is None  # does not block


def test_a_camera_that_is_plugged_in_again_continues(bench, source):
    bench.plugged = False
    bench.pictures.put(UNPLUG)
    bench.until(lambda: source.health.state == "lost")
    assert source.health.problem == "camera 0 was pulled out"
    assert bench.held == 0, "the lost device was not let go of"
    bench.clock.now += 5.0
    assert source.wait(0.0, patience=6.0) is None
    bench.plugged = True

    def reopened():
        bench.clock.now += 0.1
        return bench.opened == 2

    bench.until(reopened)
    bench.until(lambda: source.health.state == "recovering")
    bench.put(2)
    frame = awaited(source, bench)
    assert (frame.index, frame.image[0, 0, 0]) == (1, 2)
    assert frame.timestamp >= 105.0
    health = source.health
    assert (health.state, health.gaps, health.problem) == ("running", 1, "")
    assert bench.most_held == 1


def test_a_loss_longer_than_the_patience_is_one_line(bench, source):
    bench.plugged = False
    bench.pictures.put(UNPLUG)
    bench.until(lambda: source.health.state == "lost")
    bench.clock.now += 5.0
    with pytest.raises(TrackingError, match=r"^camera 0 does not exist$|^camera 0 was pulled out$"):
        source.wait(0.0, patience=5.0)


def test_a_frozen_image_is_reported_until_another_one_arrives(bench, source):
    bench.clock.now = 100.9
    bench.put(1)
    bench.until(lambda: source.health.state == "frozen")
    assert source.health.since == 100.0
    assert "repeated the same image" in source.health.problem

    def reopened():
        bench.clock.now += 0.05
        return bench.opened == 2

    bench.until(reopened)
    bench.put(1)  # still the same image
    bench.until(lambda: bench.pictures.empty())
    assert source.wait(0.0) is None
    assert not source.health.running
    bench.put(7)
    assert awaited(source, bench).image[0, 0, 0] == 7
    assert source.health.state == "running"


def test_a_stall_counts_as_a_gap_without_reopening(bench, source):
    bench.blocks = True
    bench.until(lambda: bench.asked.acquire(blocking=False))
    assert at(bench, 2.0, source).state == "lost"
    bench.blocks = False
    bench.put(3)
    bench.hold.set()
    awaited(source, bench)
    assert (source.health.state, source.health.gaps) == ("running", 1)


def test_a_blocked_thread_is_replaced(bench, source):
    bench.blocks = True
    while bench.asked.acquire(blocking=False):
        pass
    assert bench.asked.acquire(timeout=TEST_TIMEOUT_S)
    bench.clock.now += STUCK_TIMEOUT_S - 1.0
    source.wait(0.0)
    assert bench.opened == 1, "opened while the old thread may yet return"
    bench.blocks = False
    bench.clock.now += 1.0
    source.wait(0.0)
    bench.until(lambda: bench.opened == 2)
    bench.put(9)
    assert awaited(source, bench).image[0, 0, 0] == 9
    bench.hold.set()  # the old thread returns: it releases the device silently
    bench.until(lambda: bench.held == 1)
    assert source.health.running


def test_the_number_of_abandoned_threads_is_limited(bench, source):
    bench.blocks = True
    bench.until(lambda: bench.asked.acquire(blocking=False))
    for number in range(MAX_ABANDONED_THREADS + 3):
        bench.clock.now += STUCK_TIMEOUT_S
        source.wait(0.0)
        if number < MAX_ABANDONED_THREADS:
            bench.until(lambda: bench.asked.acquire(blocking=False))
    assert bench.opened == 1 + MAX_ABANDONED_THREADS


def test_a_plausible_driver_time_is_used(bench, source):
    bench.clock.now, bench.exposed = 100.5, 100.46
    bench.put(2)
    assert awaited(source, bench).timestamp == 100.46
    assert source.health.stamped_by == "driver"


@pytest.mark.parametrize(
    "wrong",
    [0.0, -0.001, 5.0, 98.9, 100.2, 1.7e9],
    ids=["zero", "none", "wrap_angle", "old", "ahead", "epoch"],
)
def test_a_wrong_driver_time_is_replaced_by_the_arrival_for_a_while(wrong):
    clock = ExposureClock()
    assert clock.stamp(99.9, 99.87) == 99.87
    assert clock.stamp(100.0, wrong) == 100.0
    given = [clock.stamp(100.0 + n, 99.96 + n) for n in range(1, DISTRUST_IMAGES + 3)]
    assert given[:DISTRUST_IMAGES] == [100.0 + n for n in range(1, DISTRUST_IMAGES + 1)]
    assert given[DISTRUST_IMAGES + 1] == 99.96 + DISTRUST_IMAGES + 2


def test_a_driver_time_that_does_not_increase_is_not_used():
    clock = ExposureClock()
    clock.stamp(10.0, 9.95)
    assert clock.stamp(10.033, 9.95) == 10.033
    clock = ExposureClock()
    clock.stamp(10.0, 9.95)
    assert clock.stamp(10.033, 9.90) == 10.033


def test_the_depth_of_the_queue_is_measured_with_and_without_the_drivers_time():
    for stamped in (True, False):
        gauge = QueueGauge(30.0)
        for number in range(5):
            now = number / 30
            assert gauge.add(1 / 30, now, 0.03 if stamped else None) == 0
        # The reader sleeps for four periods, in which the queue fills; then it reads at once.
        late = [4 / 30 + 0.03 - n / 30 for n in range(1, 4)]
        depths = [gauge.add(0.0, 9 / 30, age if stamped else None) for age in late]
        assert depths == ([3, 2, 1] if stamped else [1, 2, 3])
        assert gauge.max_depth == 3


def test_the_rate_is_that_of_the_arrivals():
    gauge = QueueGauge(30.0)
    for number in range(40):
        gauge.add(0.06, number / 15, None)
    assert gauge.rate == pytest.approx(15.0)


def test_dropped_images_are_counted(bench, source):
    for number in (2, 3, 4):
        bench.put(number)
    bench.until(lambda: source.health.dropped == 2)
    assert awaited(source, bench).image[0, 0, 0] == 4


def test_images_that_are_kept_come_in_their_order(bench, source):
    source.max_waiting = 3
    for number in (2, 3, 4, 5):
        bench.put(number)
    bench.until(lambda: source.health.dropped == 1)
    assert source.waiting == 3
    assert [awaited(source, bench).image[0, 0, 0] for _ in range(3)] == [3, 4, 5]
    for number in (6, 7):
        bench.put(number)
    bench.until(lambda: source.waiting == 2)
    source.max_waiting = 1
    assert source.health.dropped == 2
    assert awaited(source, bench).image[0, 0, 0] == 7


def test_an_old_frame_of_the_opening_gives_way_to_a_newer_one(bench):
    bench.put(1)
    with LiveSource(bench, "camera 0", bench.clock) as source:
        for number in (2, 3):
            bench.put(number)
        bench.until(lambda: source.health.dropped == 1)
        bench.clock.now += 3.5
        assert awaited(source, bench).image[0, 0, 0] == 3


def test_a_camera_with_a_new_number_is_found_by_its_name(tmp_path):
    links = tmp_path / "by-id"
    links.mkdir()
    first, second = tmp_path / "video0", tmp_path / "video2"
    first.touch()
    link = links / "usb-Webcam-index0"
    link.symlink_to(first)
    path = persistent_path(first, links)
    link.unlink()
    first.unlink()
    second.touch()
    link.symlink_to(second)
    assert path.resolve() == second.resolve()
    assert persistent_path(tmp_path / "video9", links) == tmp_path / "video9"
