"""Cameras that come and go, on a clock that stands still until a test moves it."""

import queue
import threading

import numpy as np
import pytest

from tracking import Frame, TrackingError
from tracking.sources.base import LiveFrames
from tracking.sources.capture import MAX_ABANDONED_THREADS, STUCK_TIMEOUT_S
from tracking.sources.capture_timing import DISTRUST_IMAGES, ExposureClock, QueueGauge
from tracking.sources.live import LiveSource
from tracking.sources.video_device import persistent_path

ENOUGH_S = 10.0
"""Real time after which a test that waits for another thread has failed."""

GONE = object()


class Clock:
    """Time that a test moves."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Bench:
    """Makes devices that give what the test puts into their queue."""

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
        """Wait in real time for what the capture thread does by itself."""
        ended = threading.Event()
        for _ in range(int(ENOUGH_S / 0.005)):
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
            bench.hold.wait(ENOUGH_S)
            return None
        try:
            picture = bench.pictures.get(timeout=0.005)
        except queue.Empty:
            return None
        if picture is GONE:
            raise TrackingError("camera 0 was pulled out")
        return picture

    def interrupt(self):
        pass

    def close(self):
        self._bench.held -= 1


@pytest.fixture
def bench():
    made = Bench()
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
    """What the source says of itself at a time."""
    bench.clock.now = 100.0 + seconds
    return source.health


def awaited(source, bench):
    """The next frame, given real time to come and no time of the clock."""
    found: list[Frame] = []

    def came():
        found.extend(frame for frame in [source.wait(0.0)] if frame is not None)
        return bool(found)

    bench.until(came)
    return found[0]


def test_silence_is_told_within_a_second_though_the_driver_never_returns(bench, source):
    bench.blocks = True
    assert at(bench, 0.7, source).state == "running"
    health = at(bench, 1.0, source)
    assert (health.state, health.since) == ("lost", 100.0)
    assert "delivered no image for 1 s" in health.problem
    assert source.wait(0.0) is None  # blocks nobody


def test_a_camera_that_is_plugged_in_again_goes_on_by_itself(bench, source):
    bench.plugged = False
    bench.pictures.put(GONE)
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


def test_patience_that_is_over_is_one_line(bench, source):
    bench.plugged = False
    bench.pictures.put(GONE)
    bench.until(lambda: source.health.state == "lost")
    bench.clock.now += 5.0
    with pytest.raises(TrackingError, match=r"^camera 0 does not exist$|^camera 0 was pulled out$"):
        source.wait(0.0, patience=5.0)


def test_a_frozen_picture_is_told_within_a_second_and_only_another_one_ends_it(bench, source):
    bench.clock.now = 100.9
    bench.put(1)
    bench.until(lambda: source.health.state == "frozen")
    assert source.health.since == 100.0
    assert "repeated the same image" in source.health.problem

    def reopened():
        bench.clock.now += 0.05
        return bench.opened == 2

    bench.until(reopened)
    bench.put(1)  # what it gave before is still no news
    bench.until(lambda: bench.pictures.empty())
    assert source.wait(0.0) is None
    assert not source.health.running
    bench.put(7)
    assert awaited(source, bench).image[0, 0, 0] == 7
    assert source.health.state == "running"


def test_a_stall_that_ends_by_itself_counts_as_a_gap_without_opening_again(bench, source):
    bench.blocks = True
    bench.until(lambda: bench.asked.acquire(blocking=False))
    assert at(bench, 2.0, source).state == "lost"
    bench.blocks = False
    bench.put(3)
    bench.hold.set()
    awaited(source, bench)
    assert (source.health.state, source.health.gaps) == ("running", 1)


def test_a_thread_that_never_returns_is_left_behind_and_another_opens_the_camera(bench, source):
    bench.blocks = True
    while bench.asked.acquire(blocking=False):
        pass
    assert bench.asked.acquire(timeout=ENOUGH_S)
    bench.clock.now += STUCK_TIMEOUT_S - 1.0
    source.wait(0.0)
    assert bench.opened == 1, "opened while the old thread may yet return"
    bench.blocks = False
    bench.clock.now += 1.0
    source.wait(0.0)
    bench.until(lambda: bench.opened == 2)
    bench.put(9)
    assert awaited(source, bench).image[0, 0, 0] == 9
    bench.hold.set()  # the old thread returns: it lets go and says nothing
    bench.until(lambda: bench.held == 1)
    assert source.health.running


def test_only_so_many_threads_are_left_behind(bench, source):
    bench.blocks = True
    bench.until(lambda: bench.asked.acquire(blocking=False))
    for number in range(MAX_ABANDONED_THREADS + 3):
        bench.clock.now += STUCK_TIMEOUT_S
        source.wait(0.0)
        if number < MAX_ABANDONED_THREADS:
            bench.until(lambda: bench.asked.acquire(blocking=False))
    assert bench.opened == 1 + MAX_ABANDONED_THREADS


def test_the_drivers_time_is_taken_where_it_is_sane(bench, source):
    bench.clock.now, bench.exposed = 100.5, 100.46
    bench.put(2)
    assert awaited(source, bench).timestamp == 100.46
    assert source.health.stamped_by == "driver"


@pytest.mark.parametrize(
    "wrong",
    [0.0, -0.001, 5.0, 98.9, 100.2, 1.7e9],
    ids=["zero", "none", "wrap_angle", "old", "ahead", "epoch"],
)
def test_a_wrong_driver_time_gives_way_to_the_arrival_for_a_while(wrong):
    clock = ExposureClock()
    assert clock.stamp(99.9, 99.87) == 99.87
    assert clock.stamp(100.0, wrong) == 100.0
    given = [clock.stamp(100.0 + n, 99.96 + n) for n in range(1, DISTRUST_IMAGES + 3)]
    assert given[:DISTRUST_IMAGES] == [100.0 + n for n in range(1, DISTRUST_IMAGES + 1)]
    assert given[DISTRUST_IMAGES + 1] == 99.96 + DISTRUST_IMAGES + 2


def test_a_driver_time_that_stands_still_or_goes_back_is_not_believed():
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


def test_pictures_that_nobody_took_are_counted(bench, source):
    for number in (2, 3, 4):
        bench.put(number)
    bench.until(lambda: source.health.dropped == 2)
    assert awaited(source, bench).image[0, 0, 0] == 4


def test_a_camera_whose_number_moved_is_found_by_its_name(tmp_path):
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
