"""How long BML takes: `python -m tests.bench.bml`.

reading
    `parse` of a block of 20 behaviours.
scheduling
    The update in which that block is scheduled and starts, with its warnings and predictions.
    The performer's estimates are in it. "free": nothing is linked; "chain": each behaviour is
    linked to the one before; "speech": nods on the words of one speech; "orders": each behaviour
    has to be after the one before; "contradictions": every fourth behaviour has to be left out,
    and the block is scheduled again each time.
re-timing
    `retime` of the speech of the block "speech" while it runs.
a frame
    Mean of `update` and `active` while that block runs, at 60 Hz.
suite
    The public conformance cases, all of core and asap, in virtual time at 25 Hz.

Times are the least of many repetitions; the machine may be busy. Exits with 1 if a bar of issue 17
is missed: scheduling 20 behaviours ≤ 2 ms, the suite < 5 s.
"""

import sys
import time
from collections.abc import Callable
from functools import partial

import pytest
from rich.console import Console
from rich.table import Table

from cubeling.characters.behaviour.bml import Block, BmlWarning, Realizer, parse
from tests.characters.behaviour.bml.estimates import Estimates
from tests.characters.behaviour.bml.suite import block

REPETITIONS = 200
"""How often a block is scheduled."""

BAR_MS = 2.0
"""Most time to schedule a block of 20 behaviours [ms]."""

SUITE_BAR_S = 5.0
"""Most time for the conformance cases [s]."""

KINDS = ("head", "faceLexeme", "headDirectionShift", "faceShift")
"""Kinds that do not get into each other's way."""


def blocks() -> dict[str, str]:
    """Return documents with 20 behaviours each."""
    kinds = [KINDS[index % len(KINDS)] for index in range(20)]
    free = [f"<{kind} id='b{i}'/>" for i, kind in enumerate(kinds)]
    chain = [free[0]] + [
        f"<{kind} id='b{i}' start='b{i - 1}:end+0.1'/>" for i, kind in enumerate(kinds) if i
    ]
    marks = " ".join(f"word <sync id='m{i}'/>" for i in range(20))
    words = [f"<speech id='s'><text>{marks}</text></speech>"] + [
        f"<head id='b{i}' stroke='s:m{i}'/>" for i in range(19)
    ]
    orders = [
        f"<constraint><after ref='b{i}:end'><sync ref='b{i + 1}:start'/></after></constraint>"
        for i in range(19)
    ]
    wrong = [f"<head id='b{i}' start='2' end='1'/>" if i % 4 == 0 else free[i] for i in range(20)]
    parts = {"free": free, "chain": chain, "speech": words, "orders": free + orders}
    return {
        name: block("".join(part)) for name, part in (parts | {"contradictions": wrong}).items()
    }


def least(do: Callable[[], object], repetitions: int = REPETITIONS) -> float:
    """Return the least time that something takes [ms]."""
    times = []
    for _ in range(repetitions):
        began = time.perf_counter()
        do()
        times.append(time.perf_counter() - began)
    return 1000.0 * min(times)


def scheduling(read: Block) -> tuple[float, int]:
    """Return the least time to schedule a block [ms], and how many warnings there are."""
    warnings = 0

    def schedule() -> None:
        nonlocal warnings
        realizer = Realizer(Estimates())
        realizer.accept(read)
        warnings = sum(isinstance(f, BmlWarning) for f in realizer.update(0.0))

    return least(schedule), warnings


def running(read: Block) -> tuple[float, float]:
    """Return the least time of re-timing, and the mean time of a frame [ms]."""
    realizer = Realizer(Estimates())
    realizer.accept(read)
    realizer.update(0.0)
    retiming = least(partial(realizer.retime, "bml1", "s", "m10", 8.0))
    frames, began = 0, time.perf_counter()
    while not realizer.idle:
        realizer.update(frames / 60.0)
        realizer.active(frames / 60.0)
        frames += 1
    return retiming, 1000.0 * (time.perf_counter() - began) / frames


def suite() -> float:
    """Return the time of the conformance cases without that of pytest's start [s]."""
    path = "tests/characters/behaviour/bml/test_conformance.py"
    began = time.perf_counter()
    if pytest.main(["-q", "--no-header", "-p", "no:cacheprovider", path]) != 0:
        return float("inf")
    return time.perf_counter() - began


def main() -> int:
    """Print the table."""
    table = Table("what", "time", "warnings", "bar", title="BML, blocks of 20 behaviours")
    missed = False
    for name, text in blocks().items():
        table.add_row(f"reading, {name}", f"{least(partial(parse, text)):.2f} ms", "", "")
        took, warnings = scheduling(parse(text))
        missed |= took > BAR_MS
        table.add_row(f"scheduling, {name}", f"{took:.2f} ms", f"{warnings}", f"{BAR_MS:g} ms")
    retiming, frame = running(parse(blocks()["speech"]))
    table.add_row("re-timing", f"{retiming:.2f} ms", "", "")
    table.add_row("a frame", f"{frame:.3f} ms", "", "")
    cases = suite()
    table.add_row("conformance cases", f"{cases:.2f} s", "", f"{SUITE_BAR_S:g} s")
    Console().print(table)
    return 1 if missed or cases > SUITE_BAR_S else 0


if __name__ == "__main__":
    sys.exit(main())
