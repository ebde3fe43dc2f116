"""Does anything grow in a day? `python -m tests.campaigns.soak --hours 24`.

Every protocol that has a simulated robot is used for so many hours of virtual time, with light
faults, a new emotion every few seconds, and a motion now and then. Twenty-four times on the way
everything that driver and robot hold is counted. The exit code is 1 if it grew, if the robot did
not do what was asked last, or if a driver raised.
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

from affect import Emotion
from robot.contract.driver import Driver
from robot.drivers import DRIVERS
from robot.link.exchange import REOPEN_INTERVAL_S
from robot.protocol import messages as m
from robot.simulators import SIMULATORS
from robot.simulators.faults import Faults, Outage
from robot.simulators.faulty import FaultyRobot

FAULTS = Faults(
    drop=0.005, flip=0.0001, dup=0.005, delay=0.002, jitter=0.001,
    stall=Outage(1.0, 600.0), unplug=Outage(2.0, 600.0), reboot=7200.0,
)  # fmt: skip
"""What goes wrong."""

TICK = 0.020
"""How often the host looks at its clock [s]."""

WISH_EVERY = 3.0
"""Mean time between two wishes [s]."""

LOOKS = 24
"""How often everything is counted."""

SLACK = 1.05
"""How much more the second half may hold than the first."""

SLACK_BYTES = 8192
"""And so much on top of that [bytes]: numbers get longer, and a buffer is fuller now than then."""

SLACK_OBJECTS = 200
"""And so many objects: a few wishes wait at one look, and none at another."""

SETTLED_WITHIN = 120.0
"""The last wish must be known to the driver after this long without faults [s]."""


@dataclass
class Soaked:
    """What came of one protocol."""

    name: str
    """Which."""

    hours: float
    """Virtual time [h]."""

    took: float = 0.0
    """Real time [s]."""

    wishes: int = 0
    """What was asked for."""

    traffic: int = 0
    """Bytes in both directions."""

    unplugged: int = 0
    """How often."""

    held: list[tuple[int, int]] = field(default_factory=list)
    """Objects, and bytes, that driver and robot held at each look."""

    tracked: list[int] = field(default_factory=list)
    """Objects that the interpreter's collector knew of at each look, in the whole process."""

    wrong: list[str] = field(default_factory=list)
    """What was wrong."""


def weight(*roots: object, logs: bool = True) -> tuple[int, int]:
    """Return how many objects can be reached, and their size [bytes]; classes are not counted.

    Without `logs`, a deque with a longest length counts as empty: it fills up for hours, and then
    holds no more.
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


class Day:
    """One driver and its robot, from event to event."""

    def __init__(self, name: str, seed: int) -> None:
        self.driver: Driver = DRIVERS[name].make(7, None)
        self.robot = FaultyRobot(SIMULATORS[name](seed), FAULTS, seed)
        self.random = np.random.default_rng((seed, 4))
        self.soaked = Soaked(name, 0.0)
        self.now = self.wish_at = self.tick_at = self.reopen_at = 0.0
        self.port_open = False
        self.unplug_count = 0

    def live_until(self, end: float) -> None:
        """Let time pass."""
        while self.now < end:
            self.now = min(max(self.now, min(self.tick_at, self.robot.due)), end)
            self.robot.advance(self.now)
            self._watch_plug()
            if self.now >= self.wish_at:
                self._wish()
            self._talk(self.robot.bytes_to_send())
            self.tick_at = self.now + TICK

    def _talk(self, arrived: bytes) -> None:
        if not self.port_open:
            return
        self.driver.receive(arrived, self.now)
        self.driver.tick(self.now)
        out = self.driver.bytes_to_send()
        self.soaked.traffic += len(arrived) + len(out)
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

    def _wish(self) -> None:
        self.soaked.wishes += 1
        valence, arousal = self.random.uniform(-1.0, 1.0, 2).tolist()
        kind = float(self.random.random())
        if kind < 0.1 and self.driver.catalogue and self.driver.catalogue.motions:
            count = len(self.driver.catalogue.motions)
            self.driver.play(m.ITEM_MOTION, int(self.random.integers(count)))
        elif kind < 0.12:
            self.driver.stop()
        else:
            self.driver.express(Emotion(valence, arousal))
        self.wish_at = self.now + float(self.random.exponential(WISH_EVERY))


def soak(name: str, hours: float, seed: int = 1) -> Soaked:
    """Use one protocol for so many hours."""
    start, day = time.perf_counter(), Day(name, seed)
    soaked, every = day.soaked, 3600.0 * hours / LOOKS
    try:
        for look in range(1, LOOKS + 1):
            day.live_until(look * every)
            gc.collect()
            soaked.held.append(weight(day.driver, day.robot, logs=False))
            soaked.tracked.append(len(gc.get_objects()))
        soaked.unplugged = day.robot.unplug_count
        _settle(day)
    except Exception as error:
        soaked.wrong.append(f"at {day.now:.3f} s: {error!r}")
    soaked.hours, soaked.took = day.now / 3600, time.perf_counter() - start
    for what, values in (
        ("objects held", [objects for objects, _ in soaked.held]),
        ("bytes held", [size for _, size in soaked.held]),
        ("objects of the process", soaked.tracked),
    ):
        soaked.wrong += growth(what, values)
    return soaked


def _settle(day: Day) -> None:
    """End all faults, and see the last wish acknowledged."""
    day.robot.to_robot.cut = day.robot.from_robot.cut = False
    calm = FaultyRobot(day.robot.robot, Faults(), 0)
    day.robot, day.unplug_count = calm, calm.unplug_count
    day.wish_at = float("inf")
    wish = Emotion(0.5, 0.5)
    day.driver.express(wish)
    end = day.now + SETTLED_WITHIN
    while day.driver.telemetry(day.now).acknowledged != wish:
        if day.now >= end:
            state = day.driver.state(day.now)
            day.soaked.wrong.append(f"the last wish is not taken; the link is {state}")
            return
        day.live_until(day.now + 0.1)


def growth(what: str, values: list[int]) -> list[str]:
    """Say if the second half of the values is larger than the first, but for some slack."""
    middle = len(values) // 2
    if len(values) < 4:
        return [f"{what} were counted {len(values)} times only"]
    # What was there in the first quarter is the warming up.
    early, late = max(values[middle // 2 : middle]), max(values[middle:])
    if late <= SLACK * early + (SLACK_BYTES if "bytes" in what else SLACK_OBJECTS):
        return []
    return [f"{what} grew from {early:,} to {late:,}"]


def names() -> list[str]:
    """Return the protocols that have a simulated robot."""
    return [name for name in DRIVERS if name in SIMULATORS]


def main() -> int:
    """Soak all of them; return 1 if something was wrong."""
    parser = argparse.ArgumentParser(description="Use every protocol for a day of virtual time.")
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
    table = Table(title="Hours of virtual time, and what is held after them")
    for head in (
        "protocol", "hours", "wishes", "MB", "unplugged", "objects\nfirst", "\nlast",
        "kB\nfirst", "\nmost", "\nlast", "took s",
    ):  # fmt: skip
        table.add_column(head, justify="left" if head == "protocol" else "right")
    for day in days:
        held = day.held or [(0, 0)]
        table.add_row(
            day.name, f"{day.hours:.1f}", f"{day.wishes:,}", f"{day.traffic / 1e6:.1f}",
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
