"""Generated BML blocks in virtual time: `python -m tests.campaigns.behaviour --blocks 100000`.

Blocks of all kinds of behaviours, with constraints that may be met or not, come to realizers at
random times; some append, replace, interrupt, follow as chunks or wait to be activated, and some
of their sync points are moved while they run. For every session it is checked that

- what is reported comes in the order of time, within one frame of when it was due;
- a block that starts ends once, and all that it does lies in between;
- every behaviour is warned of, or reports each of its sync points once and in order; one that is
  interrupted leaves out only those before it relaxes;
- sync points that attributes link are linked, unless they were moved, interrupted or cut short;
- nothing raises.

Prints a table and exits with 1 if anything of it fails.
"""

import argparse
import sys
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.behaviour.bml import (
    SYNCS,
    Block,
    BlockProgress,
    BmlWarning,
    Feedback,
    Realizer,
    SyncPointProgress,
    parse,
)
from tests.characters.behaviour.bml.estimates import Estimates
from tests.characters.behaviour.bml.suite import block as document

BLOCKS_PER_SESSION = 12
"""Blocks that come to one realizer."""

KINDS = (*SYNCS, "gesture", "speech", "speech", "gesture", "unknown")
"""Kinds of behaviours, some of them more often."""


def generated_block(random: np.random.Generator, name: str, others: list[str]) -> str:
    """Return a document; `others` are ids of blocks that it may refer to."""
    kinds = [str(random.choice(KINDS)) for _ in range(int(random.integers(0, 7)))]
    inside = "".join(_behaviour(random, kinds, index, others) for index in range(len(kinds)))
    if kinds and random.random() < 0.3:
        inside += _constraint(random, kinds)
    if others and random.random() < 0.15:
        target, start = random.choice(others), random.uniform(0, 3)
        kind = random.choice(["interrupt", "activate"])
        inside += f'<bmla:{kind} id="c" target="{target}" start="{start:.2f}"/>'
    return document(inside, name=name, more=_composition(random, others))


def _composition(random: np.random.Generator, others: list[str]) -> str:
    chance = random.random()
    if chance < 0.2:
        return 'composition="APPEND"'
    if chance < 0.25:
        return 'composition="REPLACE"'
    if chance < 0.3:
        return 'bmla:preplan="true"'
    if not others or chance > 0.55:
        return ""
    other = random.choice(others)
    return (
        f'composition="APPEND-AFTER({other})"',
        f'bmla:chunkAfter="{other}"',
        f'bmla:interrupt="{other}"',
        f'bmla:onStart="{other}"',
    )[int(random.integers(4))]


def _behaviour(random: np.random.Generator, kinds: list[str], index: int, others: list[str]) -> str:
    kind = kinds[index]
    points = SYNCS.get(kind, ("start", "end"))
    chosen = random.choice(len(points), size=int(random.choice([0, 1, 1, 1, 2])), replace=False)
    begin = random.uniform(-0.2, 6)
    attributes = " ".join(
        f'{points[point]}="{_moment(random, kinds, index, others, begin + 0.4 * point)}"'
        for point in sorted(chosen)
    )
    inside = _text(random) if kind == "speech" else ""
    return f'<{kind} id="b{index}" {attributes}>{inside}</{kind}>'


def _moment(
    random: np.random.Generator, kinds: list[str], own: int, others: list[str], seconds: float
) -> str:
    chance = random.random()
    if chance < 0.4:
        return f"{seconds:.3f}"
    offset = f"{random.uniform(-0.5, 2):+.2f}" if random.random() < 0.4 else ""
    if others and chance < 0.45:
        return f"{random.choice(others)}:b{random.integers(4)}:end{offset}"
    return f"{_point(random, kinds, own)}{offset}"


def _point(random: np.random.Generator, kinds: list[str], own: int = -1) -> str:
    """Return a sync point of a behaviour, seldom of `own`; a few are not there."""
    index = int(random.integers(len(kinds)))
    if index == own:
        index = int(random.integers(len(kinds)))
    syncs = SYNCS.get(kinds[index], ("start", "s0"))
    return f"b{index}:{'nothing' if random.random() < 0.03 else random.choice(syncs)}"


def _text(random: np.random.Generator) -> str:
    words = [
        "well" * int(random.integers(1, 4))
        + (f'<sync id="s{index}"/>' if random.random() < 0.3 else "")
        for index in range(int(random.integers(1, 12)))
    ]
    return f"<text>{' '.join(words)}</text>"


def _constraint(random: np.random.Generator, kinds: list[str]) -> str:
    a, b = _point(random, kinds), _point(random, kinds)
    kind = random.choice(["synchronize", "before", "after"])
    if kind == "synchronize":
        moment = f"{random.uniform(0, 8):.2f}" if random.random() < 0.4 else b
        rule = f'<synchronize><sync ref="{a}"/><sync ref="{moment}"/></synchronize>'
    else:
        rule = f'<{kind} ref="{b}"><sync ref="{a}"/></{kind}>'
    return f"<constraint>{rule}</constraint>"


@dataclass
class Record:
    """What a session has done and reported."""

    frame: float
    blocks: dict[str, Block] = field(default_factory=dict)
    arrived: dict[str, float] = field(default_factory=dict)
    """When blocks came [s]."""
    feedback: list[Feedback] = field(default_factory=list)
    moved: bool = False
    """Whether sync points were moved."""
    late: float = 0.0
    """Greatest time from when something was due to its report [s]."""


def run_session(random: np.random.Generator, blocks: int = BLOCKS_PER_SESSION) -> Record:
    """Perform generated blocks until they are over."""
    record = Record(float(random.choice([1 / 60, 1 / 25, 1 / 10])))
    realizer, now, names = Realizer(Estimates()), 0.0, list[str]()
    moves = 0.01 if random.random() < 0.5 else 0.0
    for index in range(blocks):
        text = generated_block(random, f"k{index}", names[-4:])
        record.blocks[f"k{index}"], record.arrived[f"k{index}"] = parse(text), now
        names.append(f"k{index}")
        realizer.accept(text)
        until = now + random.exponential(2.0)
        while now < until:
            _frame(realizer, now, record)
            if random.random() < moves:
                _move(random, realizer, now, record)
            now += record.frame
    _finish(realizer, now, record)
    return record


def _finish(realizer: Realizer, now: float, record: Record) -> None:
    """Let frames pass until all is over; what waits for ever is replaced."""
    end = now + 30.0
    while not realizer.idle and now < end:
        _frame(realizer, now, record)
        now += record.frame
    realizer.accept(document(name="last", more='composition="REPLACE"'))
    record.blocks["last"] = Block("last", composition="REPLACE")
    record.arrived["last"] = now
    while realizer.idle is False:
        _frame(realizer, now, record)
        now += record.frame
        if now > end + 60.0:
            raise AssertionError("a block hangs")


def _frame(realizer: Realizer, now: float, record: Record) -> None:
    for feedback in realizer.update(now):
        record.feedback.append(feedback)
        if isinstance(feedback, BlockProgress | SyncPointProgress):
            record.late = max(record.late, now - feedback.time)
            assert feedback.time <= now


def _move(random: np.random.Generator, realizer: Realizer, now: float, record: Record) -> None:
    scheduled = realizer.scheduled
    if not scheduled:
        return
    chosen = scheduled[int(random.integers(len(scheduled)))]
    sync = str(random.choice(list(chosen.times)))
    realizer.retime(chosen.block, chosen.behaviour.id, sync, now + random.uniform(-1, 3))
    record.moved = True


def check(record: Record) -> Counter[str]:
    """Check a session; return how many of everything there was.

    Raises
    ------
    AssertionError
        If anything is out of order, lost or late.
    """
    events = [f for f in record.feedback if isinstance(f, BlockProgress | SyncPointProgress)]
    assert record.late <= record.frame + 1e-9, "late"
    assert all(a.time <= b.time + 1e-9 for a, b in pairwise(events)), "order"
    warned = {f.id for f in record.feedback if isinstance(f, BmlWarning)}
    times: dict[str, dict[str, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    bounds: dict[str, dict[str, int]] = defaultdict(dict)
    for index, event in enumerate(events):
        if isinstance(event, BlockProgress):
            assert event.sync not in bounds[event.block], "twice"
            bounds[event.block][event.sync] = index
        else:
            reported = times[event.block][event.behaviour]
            assert event.sync not in reported, "twice"
            assert [*bounds[event.block]] == ["start"], "outside its block"
            reported[event.sync] = event.time
    counts = Counter(warnings=len(warned), events=len(events), blocks=len(record.blocks))
    ends = {e.block: e.time for e in events if isinstance(e, BlockProgress) and e.sync == "end"}
    interrupted = _interrupted(record, ends)
    for name, block in record.blocks.items():
        if "start" not in bounds[name]:
            assert "end" in bounds[name] or name in warned, f"{name} is lost"
            continue
        assert "end" in bounds[name], f"{name} does not end"
        disturbed = record.moved or name in interrupted
        counts += _check_block(block, times[name], warned, disturbed)
    return counts


def _interrupted(record: Record, ends: dict[str, float]) -> set[str]:
    """Return the blocks that others may have ended."""
    found = set[str]()
    for block in record.blocks.values():
        found |= {*block.interrupt, *(b.get("target") for b in block.behaviours)}
        if block.composition == "REPLACE":
            arrived = record.arrived[block.id]
            found |= {name for name, end in ends.items() if end >= arrived}
    return found


def _check_block(
    block: Block, times: dict[str, dict[str, float]], warned: set[str], disturbed: bool
) -> Counter[str]:
    counts = Counter[str]()
    complete = {}
    for behaviour in block.behaviours:
        reported = times.get(behaviour.id, {})
        if f"{block.id}:{behaviour.id}" in warned:
            assert not reported or behaviour.kind in ("interrupt", "activate")
            counts["left out"] += 1
            continue
        if behaviour.kind in ("interrupt", "activate"):
            continue
        timing = Estimates().timing(behaviour, block)
        present = [sync for sync in timing.syncs if sync in reported]
        assert present == [*reported], "sync points out of order"
        values = [*reported.values()]
        assert values == sorted(values), "times out of order"
        if len(present) == len(timing.syncs):
            complete[behaviour.id] = reported
            counts["performed"] += 1
        elif present:
            lost = [sync for sync in timing.syncs if sync not in reported]
            assert timing.syncs[timing.release] in reported, "lost"
            assert all(timing.syncs.index(sync) < timing.release for sync in lost), "lost"
            counts["interrupted"] += 1
        else:
            counts["never started"] += 1
    if not disturbed:
        counts["links checked"] += _check_links(block, complete, times)
    return counts


def _check_links(
    block: Block, complete: dict[str, dict[str, float]], times: dict[str, dict[str, float]]
) -> int:
    checked = 0
    for behaviour in block.behaviours:
        for sync, reference in behaviour.syncs.items():
            if behaviour.id not in complete or reference.block:
                continue
            if reference.behaviour not in complete:
                continue
            other = times[reference.behaviour][reference.sync] + reference.offset
            late = abs(times[behaviour.id][sync] - other)
            assert late < 1e-4, f"{behaviour.id}:{sync} is {late} s from {reference}"
            checked += 1
    return checked


def run(blocks: int, seed: int) -> tuple[Counter[str], list[str]]:
    """Run sessions with so many blocks; return counts, and what failed with its seed."""
    counts, failures = Counter[str](), list[str]()
    for session in range(-(-blocks // BLOCKS_PER_SESSION)):
        try:
            counts += check(run_session(np.random.default_rng((seed, session))))
        except Exception as error:
            failures.append(f"session {session}: {type(error).__name__}: {error}")
    return counts, failures


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description="Perform generated BML blocks.")
    parser.add_argument("--blocks", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    began = time.perf_counter()
    counts, failures = run(wanted.blocks, wanted.seed)
    table = Table("what", "number", title="generated BML blocks")
    for what, number in counts.items():
        table.add_row(what, f"{number:,}")
    table.add_row("failures", f"{len(failures):,}")
    table.add_row("seconds", f"{time.perf_counter() - began:.0f}")
    Console().print(table, *failures[:20])
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
