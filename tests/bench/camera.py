"""Latency of live images, and time to detect a lost camera: `python -m tests.bench.camera`.

A simulated driver with four buffers delivers 30 images/s, as V4L2 does. A consumer that takes 10 to
100 ms per image reads it directly, like a loop around `cv2.VideoCapture`, and through `LiveSource`.
Then the device is unplugged or frozen, and restored. With `--source camera:0` a real camera is
measured, too.
"""

import argparse
import threading
import time
from collections import deque

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.commands.look.doctor import camera_report, read_for
from cubeling.tracking import Frame, TrackingError, open_source
from cubeling.tracking.sources.live import LiveSource

RATE_HZ = 30.0
BUFFERS = 4
OUTAGE_S = 2.5


class BufferedDriver:
    """Fills its buffers at a fixed rate in a thread; drops images if all are full."""

    settings = ()
    rate = RATE_HZ

    def __init__(self, pictures: list[bytes]) -> None:
        self._pictures = pictures
        self._filled: deque[tuple[bytes, float]] = deque()
        self._changed = threading.Condition()
        self.plugged = self.running = True
        self.frozen = False
        self.exposed: float | None = None
        self._thread = threading.Thread(target=self._fill, daemon=True)
        self._thread.start()

    def _fill(self) -> None:
        due, number = time.monotonic(), 0
        while self.running:
            due += 1 / self.rate
            time.sleep(max(0.0, due - time.monotonic()))
            number += not self.frozen
            with self._changed:
                if self.plugged and len(self._filled) < BUFFERS:
                    self._filled.append((self._pictures[number % len(self._pictures)], due))
                    self._changed.notify()

    def __call__(self) -> "BufferedDriver":
        if not self.plugged:
            raise TrackingError("camera 0 does not exist")
        return self

    def read(self) -> bytes | None:
        with self._changed:
            if not self._changed.wait_for(lambda: self._filled or not self.plugged, 10.0):
                return None
            if not self._filled:
                return None
            picture, self.exposed = self._filled.popleft()
            return picture

    def interrupt(self) -> None:
        """Nothing to interrupt."""

    def close(self) -> None:
        with self._changed:
            self._filled.clear()

    def pull(self, plugged: bool) -> None:
        with self._changed:
            self.plugged = plugged
            self._changed.notify_all()


def drawn() -> list[bytes]:
    """JPEGs of 1280x720 that all differ."""
    noise = np.random.default_rng(4).integers(0, 255, (90, 160, 3), np.uint8)
    large = cv2.resize(noise, (1280, 720), interpolation=cv2.INTER_CUBIC)
    return [cv2.imencode(".jpg", np.roll(large, 9 * n, 1))[1].tobytes() for n in range(30)]


def straight(driver: BufferedDriver, work: float, count: int) -> list[float]:
    ages = []
    for _ in range(count):
        jpeg = driver.read()
        assert jpeg is not None
        assert driver.exposed is not None
        cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
        ages.append(time.monotonic() - driver.exposed)
        time.sleep(work)
    return ages


def threaded(driver: BufferedDriver, work: float, count: int) -> tuple[list[float], int, int]:
    ages: list[float] = []
    with LiveSource(driver, "camera 0") as source:
        for frame in source:
            ages.append(time.monotonic() - frame.timestamp)
            time.sleep(work)
            if len(ages) >= count:
                break
        health = source.health
    return ages, health.dropped, health.max_queue


def delays(driver: BufferedDriver, table: Table) -> None:
    for work in (0.010, 0.025, 0.050, 0.100):
        plain = straight(driver, work, 40)[8:]
        ages, dropped, deepest = threaded(driver, work, 40)
        ours, theirs = (1000 * float(np.median(one)) for one in (ages[8:], plain))
        slow = 1000 * float(np.percentile(ages[8:], 95))
        table.add_row(
            f"{1000 * work:.0f}",
            f"{theirs:.1f}",
            f"{ours:.1f} ({slow:.1f})",
            f"{ours / theirs:.2f}",
            f"{dropped}",
            f"{deepest}",
        )


def runs(source: LiveSource) -> bool:
    return source.health.running


def losses(driver: BufferedDriver, console: Console) -> None:
    with LiveSource(driver, "camera 0") as source:
        for what in ("unplugged", "frozen"):
            while source.wait(0.05) is None or not runs(source):
                pass
            began = time.monotonic()
            driver.frozen = what == "frozen"
            driver.pull(what != "unplugged")
            while runs(source):
                source.wait(0.01)
            told = time.monotonic() - began
            time.sleep(max(0.0, began + OUTAGE_S - time.monotonic()))
            driver.frozen = False
            driver.pull(True)
            back = time.monotonic()
            frame: Frame | None = None
            while frame is None or frame.timestamp < back:
                frame = source.wait(0.01)
            console.print(
                f"{what:<10} told after {told:.2f} s, "
                f"pictures again {time.monotonic() - back:.2f} s after it was put right"
            )


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", help="a real camera to look at as well")
    uri = parser.parse_args().source
    console = Console()
    table = Table("work ms", "straight ms", "LiveSource ms (95 %)", "ratio", "dropped", "deepest")
    driver = BufferedDriver(drawn())
    delays(driver, table)
    console.print(table)
    losses(driver, console)
    driver.running = False
    if uri:
        with open_source(uri) as source:
            read_for(source, 10.0)
            console.print(camera_report(uri, source))


if __name__ == "__main__":
    main()
