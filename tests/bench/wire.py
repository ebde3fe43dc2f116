"""Latency of the robot's line: `python -m tests.bench.wire`.

Over a real pseudo-terminal with the real thread at each end, and over a line in virtual time that
loses 5 % of the frames.
"""

import threading
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.protocol.messages import Beat
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.faults import Faults
from cubeling.robot.simulators.faulty import FaultyRobot

SAMPLES = 1000


class WatchedSimulator(Simulator):
    """Records when the body receives an emotion."""

    def __init__(self) -> None:
        super().__init__()
        self.received = threading.Event()
        self.received_at = 0.0
        express = self.body.express

        def watched(emotion: Emotion, mood: int = 255) -> None:
            self.received_at = time.perf_counter()
            express(emotion, mood)
            self.received.set()

        self.body.express = watched  # type: ignore[method-assign] # a spy on this one body


def emotion_latency() -> tuple[list[float], list[float]]:
    """Time from `express` to the robot's body, and the link's own round trips [s]."""
    simulator = WatchedSimulator()
    took, trips = [], []
    random = np.random.default_rng(0)
    with robot.SimulatedPort(simulator) as port, robot.connect(port.url) as dino:
        for index in range(SAMPLES // 2):
            simulator.received.clear()
            start = time.perf_counter()
            dino.express(Emotion((index + 1) / 10_000, 0.0))
            assert simulator.received.wait(2.0), "the robot received no emotion within 2 s"
            took.append(simulator.received_at - start)
            trips.append(dino.telemetry.round_trip or 0.0)
            time.sleep(
                float(random.uniform(0.0, 0.01))
            )  # so that every phase of the threads' waits occurs
    return took, trips


def bare_round_trip() -> list[float]:
    """Time from BEAT to STATE over the pseudo-terminal, asked one after the other [s]."""
    import serial

    took = []
    with (
        robot.SimulatedPort() as port,
        serial.Serial(port.url, 115200, timeout=1.0, exclusive=True) as line,
    ):
        link, reader = HostLink(host=1), FrameReader()
        link.port_opened(0.0)
        line.write(link.bytes_to_send())
        while not reader.feed(line.read(1)):
            pass
        for index in range(SAMPLES):
            start = time.perf_counter()
            line.write(encode_frame(pack(Beat(index), 1)))
            wanted = index
            while not any(
                getattr(unpack(body, "robot")[1], "beat", None) == wanted
                for body in reader.feed(line.read(max(1, line.in_waiting)))
            ):
                pass
            took.append(time.perf_counter() - start)
    return took


def latency_with_loss(drop: float) -> list[float]:
    """Time from `express` to the body in virtual time, with this share of frames lost [s]."""
    host, device = HostLink(host=7), Simulator()
    faulty = FaultyRobot(device, Faults(drop=drop), seed=1)
    now, step = 0.0, 0.001
    host.port_opened(now)

    def step_once() -> None:
        nonlocal now
        now += step
        faulty.advance(now)
        host.receive(faulty.bytes_to_send(), now)
        host.tick(now)
        faulty.receive(host.bytes_to_send(), now)

    for _ in range(1000):
        step_once()
    took = []
    for index in range(1, 2001):
        wanted = Emotion(index / 10_000, 0.0)
        host.express(wanted)
        start = now
        while device.body.target != wanted:
            step_once()
        took.append(now - start)
        for _ in range(index % 50):
            step_once()
    return took


def codec_time() -> list[float]:
    """Time to encode and decode an EXPRESS [s]; each sample is the mean of 100."""
    from cubeling.robot.protocol.messages import Express

    message, took = Express(7, 0.5, -0.5), []
    for _ in range(100):
        start = time.perf_counter()
        for _ in range(100):
            (body,) = FrameReader().feed(encode_frame(pack(message, 1)))
            unpack(body, "host")
        took.append((time.perf_counter() - start) / 100)
    return took


def main() -> None:
    """Print the table."""
    table = Table("what", "median", "p99", "worst", "bar", title="The robot's wire")

    def row(what: str, seconds: list[float], bar: str) -> None:
        figures = (f"{1000 * f(seconds):.3f} ms" for f in (np.median, _p99, np.max))
        table.add_row(what, *figures, bar)

    latencies, trips = emotion_latency()
    row("BEAT → STATE over a pseudo-terminal, bare pySerial", bare_round_trip(), "median ≤ 2 ms")
    row("BEAT → STATE as the link measures it, smoothed", trips, "median ≤ 2 ms")
    row("express() → the robot's body over a pseudo-terminal", latencies, "median ≤ 50 ms")
    for drop in (0.0, 0.05):
        what = f"express() → body, virtual time, {drop:.0%} of frames lost"
        row(what, latency_with_loss(drop), "≤ 50 ms, p99 ≤ 150 ms")
    row("EXPRESS encoded and decoded", codec_time(), "")
    Console().print(table)


def _p99(seconds: list[float]) -> float:
    return float(np.percentile(seconds, 99))


if __name__ == "__main__":
    main()
