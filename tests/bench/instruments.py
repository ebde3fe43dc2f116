"""`python -m tests.bench.instruments`: what other programs cost a session, and how right LSL is.

Steps of the companion's script are followed by OSC, VMC and LSL, and their time is compared with
that of the steps: time of the processor, which other programs do not change much. Then another
process sends OSC to the session as fast as it can. At last, LSL's streams are recorded by an inlet
of LSL's own: a stamp that says when a frame was taken is compared with LSL's clock at that moment.
"""

import argparse
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.bridges.opening import configure_lsl, lsl_problem
from cubeling.app.bridges.osc import OscIn, OscOut
from cubeling.app.bridges.vmc import VmcOut
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import Step
from cubeling.app.running.instrument import Instrument
from cubeling.characters import Character
from cubeling.tracking import open_source

FRAMES, WARM_FRAMES = 120, 20
"""Steps that are measured, after some that load what is loaded once."""

FLOOD_S = 10.0
"""How long the other process sends at most [s]."""

MESSAGES_A_DATAGRAM = 50
"""Messages in a datagram of the flood: more come in a second than a process could send alone."""

MAX_CLOCK_ERROR_S = 2e-4
"""Largest median error of LSL's stamps on one machine [s]."""

FLOOD = """
import socket, struct, sys, time
port, count, seconds = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
one = b"/cubeling/in/gesture\\0\\0\\0\\0,s\\0\\0nod\\0"
data = b"#bundle\\0" + struct.pack(">Q", 1) + (struct.pack(">i", len(one)) + one) * count
sent, end = 0, time.monotonic() + seconds
with socket.socket(type=socket.SOCK_DGRAM) as ours:
    while time.monotonic() < end:
        for _ in range(100):
            ours.sendto(data, ("127.0.0.1", port))
        sent += 100 * count
print(sent)
"""


def play(
    instruments: Sequence[Instrument],
    character: str,
    ready: Callable[[], None] = lambda: None,
    got: list[bool] | None = None,
) -> tuple[list[Step], np.ndarray, np.ndarray]:
    """Return steps of a session, and the times of each and of following it [s].

    `ready` is called before the steps that are measured, and `got` gets whether acts came in.
    """
    with open_source("synthetic:companion?size=640x360") as source:
        assert source.intrinsics is not None, "what is drawn has a lens"
        playground = Playground("companion", source.intrinsics, character=Character.load(character))
        cast = [member.character for member in playground.cast.members]
        for each in instruments:
            each.begin(cast)
        steps, of_step, of_follow = [], [], []
        for frame in source:
            began = time.thread_time()
            step = playground.step(frame)
            between = time.thread_time()
            asked = [each.follow(step, cast, time.monotonic()) for each in instruments]
            if got is not None:
                got.append(any(each.acts for each in asked))
            of_step.append(between - began)
            of_follow.append(time.thread_time() - between)
            steps.append(step)
            if len(steps) == WARM_FRAMES:
                ready()
            if len(steps) == WARM_FRAMES + FRAMES:
                break
    return steps, np.array(of_step[WARM_FRAMES:]), np.array(of_follow[WARM_FRAMES:])


def costs(console: Console) -> None:
    """Print what following a step costs."""
    table = Table("followed by", "CPU time of a step", "of following it", "95 %", "share")
    target = UdpAddress("127.0.0.1", 9)  # where nobody listens
    kinds: dict[str, Callable[[], Instrument]] = {
        "OSC, every channel": partial(OscOut, target),
        "VMC": partial(VmcOut, target),
    }
    if lsl_problem() is None:
        from cubeling.app.bridges.lsl import LslOut

        kinds["LSL"] = partial(LslOut, "bench")
    for name, make in kinds.items():
        with make() as instrument:
            _, step, follow = play([instrument], "human")
        table.add_row(
            name,
            f"{1e3 * np.median(step):.1f} ms",
            f"{1e3 * np.median(follow):.2f} ms",
            f"{1e3 * np.percentile(follow, 95):.2f} ms",
            f"{100 * np.median(follow) / np.median(step):.0f} %",
        )
    console.print(table)


def flood(console: Console) -> None:
    """Print what a flood of OSC costs; the sender takes a core of its own."""
    table = Table("OSC in", "messages/s", "CPU time of a step", "of following it", "95 %", "told")
    for flooded in (False, True):
        said: list[str] = []
        with OscIn(UdpAddress("127.0.0.1", 0), said.append) as taken:
            senders: list[subprocess.Popen[str]] = []

            def send(port: int = taken.port, senders: list[Any] = senders) -> None:
                arguments = [str(port), str(MESSAGES_A_DATAGRAM), str(FLOOD_S)]
                command = [sys.executable, "-c", FLOOD, *arguments]
                senders.append(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))

            got: list[bool] = []
            _, step, follow = play([taken], "vleo", send if flooded else lambda: None, got)
            sent = sum(int(each.communicate()[0]) for each in senders)
        if flooded:  # on a busy computer the sender may come too late for a frame
            came = np.array(got[WARM_FRAMES:])
            step, follow = step[came], follow[came]
        table.add_row(
            "a flood" if flooded else "silence",
            f"{sent / FLOOD_S:,.0f}",
            f"{1e3 * np.median(step):.1f} ms",
            f"{1e3 * np.median(follow):.2f} ms",
            f"{1e3 * np.percentile(follow, 95):.2f} ms",
            f"{len(said)} lines",
        )
    console.print(table)


def clock(console: Console) -> bool:
    """Print the error of LSL's stamps; return whether it is small enough."""
    import pylsl

    from cubeling.app.bridges.lsl import LslOut

    steps, _, _ = play([], "vleo")
    with LslOut("bench-clock") as out:
        (found,) = pylsl.resolve_byprop("name", "bench-clock emotion", timeout=10.0)
        inlet = pylsl.StreamInlet(found)
        inlet.open_stream(timeout=10.0)
        correction = inlet.time_correction(timeout=10.0)
        errors = []
        for step in steps:
            taken, truth = time.monotonic(), pylsl.local_clock()
            out.follow(step, (), taken)
            _, stamp = inlet.pull_sample(timeout=10.0)
            errors.append(abs(stamp - truth))
        del inlet
    median, worst = np.median(errors), np.percentile(errors, 99)
    console.print(
        f"LSL: stamps are right to {1e6 * median:.0f} µs (median), {1e6 * worst:.0f} µs (99 %); a "
        f"recorder on this computer corrects them by {1e6 * correction:+.0f} µs"
    )
    return bool(median + abs(correction) < MAX_CLOCK_ERROR_S)


def main() -> int:
    """Print all; return 1 if LSL's clock is not right."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    console = Console()
    problem = lsl_problem()
    if problem is None:
        configure_lsl("machine")
    costs(console)
    flood(console)
    if problem is not None:
        console.print(f"LSL: not measured, {problem[0]}: {problem[1]}")
        return 0
    return 0 if clock(console) else 1


if __name__ == "__main__":
    sys.exit(main())
