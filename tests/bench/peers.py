"""Cost of a misbehaving robot for the picture: `python -m tests.bench.peers [--rounds N]`.

It measures the whole pipeline with its picture, on recorded frames, alternately without a robot and
with each of these behind a real pseudo-terminal, each in its own process: one that behaves, one
that falls silent, one that does not read either, one that sends noise at full speed, and one that
floods the host with valid frames of its session. The exit code is 1 if a frame with the worst takes
more than 5 % longer than without a robot.
"""

import argparse
import os
import select
import subprocess
import sys
import time
import tty
from collections import defaultdict
from contextlib import ExitStack, contextmanager

import moderngl
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.running.robots import RobotLine
from cubeling.app.session.bundled import bundled_session
from cubeling.characters.rendering import create_context
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack
from cubeling.robot.protocol.wire import encode_frame
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.tracking import Frame, Intrinsics, open_source

KINDS = ("well", "silent", "deaf", "babbling", "hostile")
NO_ROBOT = ("none", "none again")  # the second shows how much of a difference is noise
FRAMES = 90
MAX_TIME_RATIO = 1.05
"""Largest ratio of the time of a frame with the worst robot to that without one."""


def misbehave(kind: str) -> None:
    """Behave until a line arrives on the standard input, then misbehave until it is closed."""
    near, far = os.openpty()
    tty.setraw(far)
    os.set_blocking(near, False)
    sys.stdout.write(os.ttyname(far) + "\n")
    sys.stdout.flush()
    robot, end = Simulator(), sys.stdin.fileno()
    while end not in _waited([near, end], [])[0]:
        _serve(robot, near)
    sys.stdin.readline()
    flood = _flood(kind, robot.link.session)
    while True:
        listening = [end] if kind in ("deaf", "babbling") else [end, near]
        readable, writable = _waited(listening, [near] if flood else [])
        if end in readable:
            return
        if kind == "well":
            _serve(robot, near)
        elif near in readable:
            os.read(near, 65536)
        if writable:
            os.write(near, flood)


def _waited(readers: list[int], writers: list[int]) -> tuple[list[int], list[int]]:
    """Wait for one of them, at most one step of the robot."""
    readable, writable, _ = select.select(readers, writers, [], 0.020)
    return readable, writable


def _serve(robot: Simulator, near: int) -> None:
    data = os.read(near, 4096) if select.select([near], [], [], 0)[0] else b""
    robot.receive(data, time.monotonic())
    answer = robot.bytes_to_send()
    if answer:
        os.write(near, answer)


def _flood(kind: str, session: int) -> bytes:
    if kind == "babbling":
        return np.random.default_rng(0).bytes(4096)
    if kind != "hostile":
        return b""
    welcome = m.Welcome(2, 0, 1, 16, 254, 254, 254, "Mallory", "1")
    state = m.State(1, 1, 0, 0.0, 0.0, 1.0, 0, 0, 0, (0.0,) * 16)
    frames = [m.Gone(), welcome, m.Name(m.ITEM_MOTION, 0, "x"), state, m.Ack(1, 1)]
    return b"".join(
        encode_frame(pack(frame, session + shift)) for shift in range(12) for frame in frames
    )


@contextmanager
def peer(kind: str):
    """Start a robot; yield its port and a function that makes it misbehave."""
    command = [sys.executable, "-m", "tests.bench.peers", "--peer", kind]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        url = process.stdout.readline().decode().strip()

        def misbehave_now() -> None:
            assert process.stdin is not None
            process.stdin.write(b"go\n")
            process.stdin.flush()

        try:
            yield url, misbehave_now
        finally:
            process.stdin.close()
            process.wait(5.0)


def block(
    kind: str, frames: list[Frame], intrinsics: Intrinsics, context: moderngl.Context
) -> list[float]:
    """Return the time of each frame with such a robot [ms]."""
    with ExitStack() as closing:
        playground = Playground("companion", intrinsics, context=context)
        closing.callback(playground.close)
        url = "none"
        misbehave_now = None
        if kind != "none":
            url, misbehave_now = closing.enter_context(peer(kind))
        line = closing.enter_context(RobotLine.open(url, time.monotonic))
        if misbehave_now is not None:
            misbehave_now()
        took = []
        for frame in frames:
            began = time.perf_counter()
            step = playground.step(frame, Inputs())
            line.view()
            line.feel(step.emotion)
            took.append(1000 * (time.perf_counter() - began))
        return took


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7, help="blocks of frames with each robot")
    parser.add_argument("--peer", choices=KINDS, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.peer:
        misbehave(asked.peer)
        return
    context = create_context()
    with open_source(str(bundled_session("companion"))) as source:
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        frames = [frame for frame, _ in zip(source, range(200 + FRAMES), strict=False)][200:]
    block("none", frames, intrinsics, context)  # warm
    took: dict[str, list[list[float]]] = defaultdict(list)
    for turn in range(asked.rounds):
        for kind in (*NO_ROBOT, *KINDS)[:: 1 if turn % 2 else -1]:
            url = "none" if kind in NO_ROBOT else kind
            took[kind].append(block(url, frames, intrinsics, context))
    context.release()
    table = Table("robot", "frame, ms", "p99, ms", "against none")
    # Frames differ, so each is compared with itself: its median over the rounds.
    typical = {kind: np.median(times, axis=0) for kind, times in took.items()}
    worst = 0.0
    alone = np.mean([typical[kind].sum() for kind in NO_ROBOT])
    for kind in (*NO_ROBOT, *KINDS):
        ratio = float(typical[kind].sum() / alone)
        worst = max(worst, ratio if kind in KINDS else 0.0)
        slow = np.percentile(took[kind], 99)
        table.add_row(kind, f"{typical[kind].mean():.2f}", f"{slow:.1f}", f"× {ratio:.3f}")
    verdict = "reached" if worst <= MAX_TIME_RATIO else "MISSED"
    table.add_row("worst", "", f"target × {MAX_TIME_RATIO:.2f}", f"× {worst:.3f}: {verdict}")
    Console().print(table)
    sys.exit(worst > MAX_TIME_RATIO)


if __name__ == "__main__":
    main()
