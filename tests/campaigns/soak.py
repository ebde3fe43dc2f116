"""Test that no memory grows in a day of use: `python -m tests.campaigns.soak --hours 24`.

Every protocol with a simulated robot runs for hours of virtual time, with light faults, a new
emotion every few seconds, and some motions. All objects of driver and robot are counted 24 times.
The exit code is 1 if their number grew, if the robot did not do the last request, or if a driver
raised an exception.
"""

import argparse
import gc
import os
import sys
import time
from collections import deque
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from types import FunctionType, ModuleType

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.affect import Emotion
from cubeling.robot.contract.driver import Driver
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.link.exchange import REOPEN_INTERVAL_S
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators import SIMULATORS
from cubeling.robot.simulators.faults import Faults, Outage
from cubeling.robot.simulators.faulty import FaultyRobot

SOAK_FAULTS = Faults(
    drop=0.005, flip=0.0001, dup=0.005, delay=0.002, jitter=0.001,
    stall=Outage(1.0, 600.0), unplug=Outage(2.0, 600.0), reboot=7200.0,
)  # fmt: skip
"""The faults."""

TICK_S = 0.020
"""Time between two steps of the host [s]."""

REQUEST_EVERY_S = 3.0
"""Mean time between two requests [s]."""

MEASUREMENT_COUNT = 24
"""Number of times at which all objects are counted."""

MAX_GROWTH_RATIO = 1.05
"""Most growth from the first half to the second."""

GROWTH_TOLERANCE_BYTES = 8192
"""More growth that is allowed [bytes]: numbers get longer, and buffers vary."""

GROWTH_TOLERANCE_OBJECTS = 200
"""More growth that is allowed [objects]: the number of pending requests varies."""

SETTLING_TIMEOUT_S = 120.0
"""Longest time without faults until the last request is acknowledged [s]."""


@dataclass
class SoakResult:
    """The result for one protocol."""

    name: str
    """The protocol."""

    hours: float
    """Virtual time [h]."""

    took: float = 0.0
    """Real time [s]."""

    requests: int = 0
    """Number of requests."""

    traffic: int = 0
    """Bytes in both directions."""

    unplugged: int = 0
    """Number of times that the port was unplugged."""

    held: list[tuple[int, int]] = field(default_factory=list)
    """Objects and bytes of driver and robot at each measurement."""

    tracked: list[int] = field(default_factory=list)
    """Objects known to the garbage collector at each measurement."""

    wrong: list[str] = field(default_factory=list)
    """The failures."""


def weight(*roots: object, logs: bool = True) -> tuple[int, int]:
    """Return the number of reachable objects, and their size [bytes]; classes are not counted.

    Without `logs`, a deque with a maximum length counts as empty: it fills up over hours.
    """
    seen: set[int] = set()
    waiting: list[object] = list(roots)
    size = 0
    while waiting:
        one = waiting.pop()
        if id(one) in seen or isinstance(one, type | ModuleType | FunctionType):
            continue
        seen.add(id(one))
        if not logs and isinstance(one, deque) and one.maxlen is not None:
            continue
        size += sys.getsizeof(one)
        waiting += gc.get_referents(one)
    return len(seen), size


class SoakRun:
    """A driver and its robot in virtual time."""

    def __init__(self, name: str, seed: int) -> None:
        self.driver: Driver = DRIVERS[name].make(7, None)
        self.robot = FaultyRobot(SIMULATORS[name](seed), SOAK_FAULTS, seed)
        self.random = np.random.default_rng((seed, 4))
        self.result = SoakResult(name, 0.0)
        self.now = self.request_at = self.tick_at = self.reopen_at = 0.0
        self.port_open = False
        self.unplug_count = 0

    def live_until(self, end: float) -> None:
        """Advance the time."""
        while self.now < end:
            self.now = min(max(self.now, min(self.tick_at, self.robot.due)), end)
            self.robot.advance(self.now)
            self._watch_plug()
            if self.now >= self.request_at:
                self._request()
            self._talk(self.robot.bytes_to_send())
            self.tick_at = self.now + TICK_S

    def _talk(self, arrived: bytes) -> None:
        if not self.port_open:
            return
        self.driver.receive(arrived, self.now)
        self.driver.tick(self.now)
        out = self.driver.bytes_to_send()
        self.result.traffic += len(arrived) + len(out)
        if out:
            self.robot.receive(out, self.now)

    def _watch_plug(self) -> None:
        if self.port_open and self.robot.unplug_count != self.unplug_count:
            self.driver.port_lost()
            self.port_open, self.reopen_at = False, self.now + REOPEN_INTERVAL_S
        if not self.port_open and self.now >= self.reopen_at:
            self.port_open, self.reopen_at = self.robot.plugged_in, self.now + REOPEN_INTERVAL_S
            if self.port_open:
                self.unplug_count = self.robot.unplug_count
                self.driver.port_opened(self.now)

    def _request(self) -> None:
        self.result.requests += 1
        valence, arousal = self.random.uniform(-1.0, 1.0, 2).tolist()
        kind = float(self.random.random())
        if kind < 0.1 and self.driver.catalogue and self.driver.catalogue.motions:
            count = len(self.driver.catalogue.motions)
            self.driver.play(m.ITEM_MOTION, int(self.random.integers(count)))
        elif kind < 0.12:
            self.driver.stop()
        else:
            self.driver.express(Emotion(valence, arousal))
        self.request_at = self.now + float(self.random.exponential(REQUEST_EVERY_S))


def soak(name: str, hours: float, seed: int = 1) -> SoakResult:
    """Run one protocol for a number of hours."""
    start, day = time.perf_counter(), SoakRun(name, seed)
    result, every = day.result, 3600.0 * hours / MEASUREMENT_COUNT
    try:
        for look in range(1, MEASUREMENT_COUNT + 1):
            day.live_until(look * every)
            gc.collect()
            result.held.append(weight(day.driver, day.robot, logs=False))
            result.tracked.append(len(gc.get_objects()))
        result.unplugged = day.robot.unplug_count
        _settle(day)
    except Exception as error:
        result.wrong.append(f"at {day.now:.3f} s: {error!r}")
    result.hours, result.took = day.now / 3600, time.perf_counter() - start
    for what, values in (
        ("objects held", [objects for objects, _ in result.held]),
        ("bytes held", [size for _, size in result.held]),
        ("objects of the process", result.tracked),
    ):
        result.wrong += growth(what, values)
    return result


def _settle(day: SoakRun) -> None:
    """End all faults, and wait for the acknowledgement of the last request."""
    day.robot.to_robot.cut = day.robot.from_robot.cut = False
    calm = FaultyRobot(day.robot.robot, Faults(), 0)
    day.robot, day.unplug_count = calm, calm.unplug_count
    day.request_at = float("inf")
    request = Emotion(0.5, 0.5)
    day.driver.express(request)
    end = day.now + SETTLING_TIMEOUT_S
    while day.driver.telemetry(day.now).acknowledged != request:
        if day.now >= end:
            state = day.driver.state(day.now)
            day.result.wrong.append(f"the last request is not acknowledged; the link is {state}")
            return
        day.live_until(day.now + 0.1)


def growth(what: str, values: list[int]) -> list[str]:
    """Return a failure if the values grew from the first half to the second, beyond a tolerance."""
    middle = len(values) // 2
    if len(values) < 4:
        return [f"{what} were counted {len(values)} times only"]
    # The first quarter is the warm-up.
    early, late = max(values[middle // 2 : middle]), max(values[middle:])
    tolerance = GROWTH_TOLERANCE_BYTES if "bytes" in what else GROWTH_TOLERANCE_OBJECTS
    if late <= MAX_GROWTH_RATIO * early + tolerance:
        return []
    return [f"{what} grew from {early:,} to {late:,}"]


def names() -> list[str]:
    """Return the protocols with a simulated robot."""
    return [name for name in DRIVERS if name in SIMULATORS]


def main() -> int:
    """Run all protocols; return 1 if one failed."""
    parser = argparse.ArgumentParser(description="Run every protocol for a day of virtual time.")
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", choices=names())
    wanted = parser.parse_args()
    chosen = [name for name in names() if wanted.only in (None, name)]
    start = time.perf_counter()
    with ProcessPoolExecutor(wanted.jobs) as pool:
        count = len(chosen)
        days = list(pool.map(soak, chosen, [wanted.hours] * count, [wanted.seed] * count))
    table = Table(title="Objects and memory after hours of virtual time")
    for head in (
        "protocol", "hours", "requests", "MB", "unplugged", "objects\nfirst", "\nlast",
        "kB\nfirst", "\nmost", "\nlast", "took s",
    ):  # fmt: skip
        table.add_column(head, justify="left" if head == "protocol" else "right")
    for day in days:
        held = day.held or [(0, 0)]
        table.add_row(
            day.name, f"{day.hours:.1f}", f"{day.requests:,}", f"{day.traffic / 1e6:.1f}",
            f"{day.unplugged}", f"{held[0][0]:,}", f"{held[-1][0]:,}",
            f"{held[0][1] / 1000:.1f}", f"{max(size for _, size in held) / 1000:.1f}",
            f"{held[-1][1] / 1000:.1f}", f"{day.took:.0f}",
        )  # fmt: skip
    console = Console(width=110)
    console.print(table)
    wrong = [f"{day.name}: {one}" for day in days for one in day.wrong]
    console.print(
        f"{time.perf_counter() - start:.0f} s, seed {wanted.seed}: "
        + ("; ".join(wrong) if wrong else "nothing grew"),
        style="red" if wrong else "green",
        soft_wrap=True,
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
