"""Drives BML blocks through a realizer in virtual time, and checks what it reports.

The checks are those of the public conformance suite BMLRealizerTester (saiba, MIT).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import pytest

from cubeling.characters.behaviour.bml import (
    BML,
    BMLA,
    BlockPrediction,
    BlockProgress,
    BmlWarning,
    Feedback,
    Realizer,
    SyncPointProgress,
    TimingEstimator,
)
from tests.characters.behaviour.bml.estimates import Estimates

F = TypeVar("F")

FRAME = 0.04
"""Time between two updates [s]."""

TOLERANCE = 0.1
"""Seconds by which the suite lets sync points differ."""

LIMIT = 200.0
"""Virtual seconds after which a block that has not ended counts as hanging."""


@dataclass(frozen=True)
class Until:
    """A step of a session: wait until a block has started, or for some seconds."""

    started: str = ""
    seconds: float = 0.0


Step = str | bytes | Until


def block(inside: str = "", *, name: str = "bml1", more: str = "") -> str:
    """Return a document with a block."""
    return f'<bml xmlns="{BML}" xmlns:bmla="{BMLA}" id="{name}" {more}>{inside}</bml>'


class Session:
    """Performs documents, and keeps all feedback."""

    def __init__(self, *steps: Step, performer: TimingEstimator | None = None) -> None:
        self.realizer = Realizer(performer or Estimates())
        self.now = 0.0
        self.feedback: list[Feedback] = []
        for step in steps:
            if isinstance(step, Until):
                self._wait(step)
            else:
                self.realizer.accept(step)

    def _wait(self, until: Until) -> None:
        end = self.now + until.seconds
        if until.started:
            self.frame()
            assert any(
                (f.block, f.sync) == (until.started, "start") for f in self.of(BlockProgress)
            )
        while self.now < end:
            self.frame()

    def frame(self) -> None:
        """Let a frame pass, and check that what it reports was due within it."""
        for feedback in self.realizer.update(self.now):
            self.feedback.append(feedback)
            if isinstance(feedback, BlockProgress | SyncPointProgress):
                assert self.now - FRAME - 1e-9 <= feedback.time <= self.now, feedback
        self.now += FRAME

    def finish(self) -> "Session":
        """Let frames pass until nothing goes on."""
        while not self.realizer.idle:
            assert self.now < LIMIT, self.trace()
            self.frame()
        return self

    def of(self, kind: type[F]) -> list[F]:
        return [feedback for feedback in self.feedback if isinstance(feedback, kind)]

    def trace(self) -> str:
        return "\n".join(map(str, self.feedback))

    # What was reported

    @property
    def warnings(self) -> list[BmlWarning]:
        return self.of(BmlWarning)

    def blocks(self, sync: str) -> list[str]:
        """Return the ids of blocks that have started or ended, in that order."""
        return [f.block for f in self.of(BlockProgress) if f.sync == sync]

    def block_time(self, name: str, sync: str) -> float:
        (time,) = [f.time for f in self.of(BlockProgress) if (f.block, f.sync) == (name, sync)]
        return time

    def syncs(self, name: str, behaviour: str) -> list[str]:
        """Return the sync points of a behaviour that have come, in their order."""
        reports = self.of(SyncPointProgress)
        return [f.sync for f in reports if (f.block, f.behaviour) == (name, behaviour)]

    def report(self, point: str) -> SyncPointProgress:
        """Return the report of "block:behaviour:sync"."""
        reports = self.of(SyncPointProgress)
        (found,) = [f for f in reports if f"{f.block}:{f.behaviour}:{f.sync}" == point]
        return found

    # What the suite asserts

    def check_clean(self) -> None:
        assert not self.warnings, self.trace()
        self.check_no_duplicates()

    def check_no_duplicates(self) -> None:
        events = [f for f in self.feedback if isinstance(f, SyncPointProgress | BlockProgress)]
        keys = [(f.block, getattr(f, "behaviour", ""), f.sync) for f in events]
        assert len(set(keys)) == len(keys), self.trace()
        assert all(f.block_time >= 0.0 for f in self.of(SyncPointProgress))

    def check_blocks(self, *names: str) -> None:
        """Check which blocks have started and ended, in this order."""
        assert self.blocks("start") == list(names), self.trace()
        assert self.blocks("end") == list(names), self.trace()

    def check_syncs(self, name: str, behaviour: str, syncs: Sequence[str]) -> None:
        """Check the sync points of a behaviour: all, in order, and at times in order."""
        assert self.syncs(name, behaviour) == list(syncs), self.trace()
        times = [self.report(f"{name}:{behaviour}:{sync}").time for sync in syncs]
        assert times == sorted(times)

    def check_time(self, point: str, seconds: float) -> None:
        """Check when a sync point was, since the start of its block."""
        assert self.report(point).block_time == pytest.approx(seconds, abs=TOLERANCE), self.trace()

    def check_linked(self, first: str, second: str, offset: float = 0.0) -> None:
        """Check that a sync point is as long after another one."""
        times = self.report(first).time, self.report(second).time
        assert times[0] == pytest.approx(times[1] + offset, abs=TOLERANCE), self.trace()

    def check_after_block(self, later: str, earlier: str) -> None:
        """Check that a block has started when another one was over."""
        start, end = self.block_time(later, "start"), self.block_time(earlier, "end")
        assert end <= start <= end + TOLERANCE, self.trace()

    def predictions(self, name: str) -> list[BlockPrediction]:
        return [f for f in self.of(BlockPrediction) if f.block == name]
