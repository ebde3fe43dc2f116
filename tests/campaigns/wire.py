"""Does the wire keep its promises? `python -m tests.campaigns.wire --exchanges 1e6`.

Host and robot talk in virtual time over a line that does harm, one mixture of faults after the
other. An exchange is one command taken by the robot and acknowledged; heartbeats are counted apart.
A broken promise is printed with what repeats it, and the exit code is 1.

What is checked, at every event: no emotion is made up, lost, doubled or out of order; no command's
number takes effect twice; an action is played at most once; a silent host is acted on within 500
ms; what was asked for last comes true within a bound; nothing grows; and of frames with wrong bits
no more pass than CRC-16 lets pass.
"""

import argparse
import math
import os
import sys
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.stats import binom

from tests.campaigns.mixes import MIXES, Mix
from tests.campaigns.witness import BIN
from tests.campaigns.world import CampaignWorld, Outcome

RUN = 20_000
"""Exchanges in one run; then a new world begins [exchanges]."""

TELL_EVERY = 20
"""So many runs between two lines about how far it is."""

CRC_CHANCE = 2**-16
"""Chance that a stretch with many wrong bits passes the check, at most; see tests.campaigns.crc."""

DOUBT = 1e-6
"""Chance of a false alarm that each statistical check may have."""

BAR_MIX, BAR_MEDIAN, BAR_P99 = "drop", 0.050, 0.150
"""With 5 % of the frames lost, an emotion is on the robot so soon [s]."""


@dataclass(frozen=True)
class Run:
    """One world, to be run anywhere."""

    mix: Mix
    """What goes wrong in it."""

    seed: int
    """Of all that is drawn."""

    exchanges: int
    """How many it does."""


def runs_for(exchanges: int, seed: int, mixes: Iterable[Mix] = MIXES) -> list[Run]:
    """Divide the exchanges among the mixtures, and those into runs; the slow ones first."""
    mixes = tuple(mixes)
    total = sum(mix.share for mix in mixes)
    runs = []
    for mix in reversed(mixes):
        wanted = math.ceil(exchanges * mix.share / total)
        count = math.ceil(wanted / RUN)
        for index in range(count):
            runs.append(Run(mix, seed * 100_000 + index, math.ceil(wanted / count)))
    return runs


def carry_out(run: Run) -> Outcome:
    """Live through one world."""
    return CampaignWorld(run.mix, run.seed).run(run.exchanges)


def gather(outcomes: list[Outcome]) -> Outcome:
    """Add up the outcomes of one mixture."""
    total = outcomes[0]
    for one in outcomes[1:]:
        total.seconds += one.seconds
        total.counts += one.counts
        total.recoveries += one.recoveries
        total.worst_recovery = max(total.worst_recovery, one.worst_recovery)
        total.worst_failsafe = max(total.worst_failsafe, one.worst_failsafe)
        total.latencies = [a + b for a, b in zip(total.latencies, one.latencies, strict=True)]
        names = total.largest.keys() | one.largest.keys()
        total.largest = {
            name: max(total.largest.get(name, 0), one.largest.get(name, 0)) for name in names
        }
    return total


def quantile(histogram: list[int], share: float) -> float:
    """Return the latency [s] that this share of the wishes does not exceed."""
    cumulated = np.cumsum(histogram)
    return BIN * (int(np.searchsorted(cumulated, share * cumulated[-1])) + 1)


def complaints(outcomes: list[Outcome], seen: list[Outcome]) -> list[str]:
    """Return what was wrong: in single runs, then in the sums."""
    wrong = [
        f"{one.mix!r}: {one.violation}\n  again: python -m tests.campaigns.wire "
        f"--only {one.mix!r} --run-seed {one.seed}"
        for one in outcomes
        if one.violation
    ]
    for mix in seen:
        stretches = mix.counts["detected"] + mix.counts["undetected"]
        passed = mix.counts["undetected"]
        if passed and binom.sf(passed - 1, stretches, CRC_CHANCE) < DOUBT:
            wrong.append(f"{mix.mix!r}: {passed} of {stretches} damaged frames passed the check")
        if mix.mix == BAR_MIX and any(mix.latencies):
            median, p99 = quantile(mix.latencies, 0.5), quantile(mix.latencies, 0.99)
            if median > BAR_MEDIAN or p99 > BAR_P99:
                wrong.append(f"{mix.mix!r}: emotions take {median:.3f} s, {p99:.3f} s at p99")
    return wrong


_FAULTS = ("drop", "flip", "dup", "split", "babble", "lost", "stall", "unplug", "reboot", "restart")


def table_of(seen: list[Outcome]) -> Table:
    """Return the table of all mixtures."""
    table = Table(title="The robot's wire, in virtual time", caption=_CAPTION)
    table.add_column("mixture")
    for head in (
        "exchanges", "beats", "virtual\nh", "faults", "found", "passed", "recov-\neries",
        "worst\ns", "fail-\nsafes", "worst\nms", "to body\nmedian ms", "p99\nms",
    ):  # fmt: skip
        table.add_column(head, justify="right")
    for one in seen:
        counts = one.counts
        some = any(one.latencies)
        table.add_row(
            one.mix, f"{counts['exchanges']:,}", f"{counts['heartbeats']:,}",
            f"{one.seconds / 3600:.2f}", f"{sum(counts[name] for name in _FAULTS):,}",
            f"{counts['detected']:,}", f"{counts['undetected']}", f"{one.recoveries:,}",
            f"{one.worst_recovery:.2f}", f"{counts['failsafe']:,}",
            f"{1000 * one.worst_failsafe:.0f}",
            f"{1000 * quantile(one.latencies, 0.5):.1f}" if some else "",
            f"{1000 * quantile(one.latencies, 0.99):.1f}" if some else "",
        )  # fmt: skip
    return table


_CAPTION = (
    "faults: frames lost, doubled, split, bytes flipped, bytes of noise, stalls …; found, passed: "
    "damaged stretches that the check refused, and let pass; worst: longest way back to the last "
    "wish; failsafe of a robot that did not hang, at most 500 ms"
)


def faults_line(seen: list[Outcome]) -> str:
    """Say how often which fault was injected, over all mixtures."""
    kinds = (f"{name} {sum(one.counts[name] for one in seen):,}" for name in _FAULTS)
    sizes = {name for one in seen for name in one.largest}
    largest = (f"{name} {max(one.largest.get(name, 0) for one in seen)}" for name in sorted(sizes))
    return f"faults: {', '.join(kinds)}\nlargest: {', '.join(largest)}"


def main() -> int:
    """Run the campaign; return 1 if a promise was broken."""
    parser = argparse.ArgumentParser(description="Hunt for broken promises on the robot's wire.")
    parser.add_argument("--exchanges", type=float, default=1e6, help="of all mixtures, 1e6")
    parser.add_argument("--seed", type=int, default=1, help="of the campaign")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--only", choices=[mix.name for mix in MIXES], help="one mixture")
    parser.add_argument("--run-seed", type=int, help="one run of it, with this seed")
    wanted = parser.parse_args()
    mixes = [mix for mix in MIXES if wanted.only in (None, mix.name)]
    runs = runs_for(int(wanted.exchanges), wanted.seed, mixes)
    if wanted.run_seed is not None:
        runs = [Run(mixes[0], wanted.run_seed, RUN)]
    console, start = Console(width=130), time.perf_counter()
    with ProcessPoolExecutor(wanted.jobs) as pool:
        outcomes = []
        for outcome in pool.map(carry_out, runs):
            outcomes.append(outcome)
            if len(outcomes) % TELL_EVERY == 0:
                done = sum(one.counts["exchanges"] for one in outcomes)
                broken = sum(one.violation is not None for one in outcomes)
                took = time.perf_counter() - start
                console.print(f"{done:,} exchanges, {broken} runs broken, {took:.0f} s")
    groups = {mix.name: [one for one in outcomes if one.mix == mix.name] for mix in mixes}
    violations = [one for one in outcomes if one.violation]
    seen = [gather(group) for group in groups.values() if group]
    console.print(table_of(seen))
    console.print(faults_line(seen))
    exchanges = sum(one.counts["exchanges"] for one in seen)
    beats = sum(one.counts["heartbeats"] for one in seen)
    wrong = complaints(violations, seen)
    if wanted.run_seed is None and exchanges < wanted.exchanges and not wrong:
        wrong.append(f"only {exchanges} exchanges were done")
    console.print(
        f"{exchanges:,} exchanges and {beats:,} heartbeats in {time.perf_counter() - start:.0f} s, "
        f"seed {wanted.seed}: " + ("; ".join(wrong) if wrong else "every promise was kept"),
        style="red" if wrong else "green",
        soft_wrap=True,
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
