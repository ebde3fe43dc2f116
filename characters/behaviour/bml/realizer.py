"""Play BML blocks in time: when each begins, what happens, and what is reported.

The realizer has no clock: `update` is told the time. What happens between two updates is worked
through in its order and reported with the times at which it was due, so that the rate of frames
shifts nothing. Composition is that of BML 1.0, section 2.3; interrupt, activate, preplan and
chunks are those of AsapRealizer (van Welbergen et al. 2014, sections 4 and 5).
"""

import math
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace

from cubeling.characters.behaviour.bml.document import BMLA, Behaviour, Block, SyncReference
from cubeling.characters.behaviour.bml.feedback import (
    BlockProgress,
    BmlWarning,
    Feedback,
    SyncPointProgress,
    WarningType,
)
from cubeling.characters.behaviour.bml.parser import parse
from cubeling.characters.behaviour.bml.realization import Realization
from cubeling.characters.behaviour.bml.schedule import (
    BehaviourTrack,
    BlockFailed,
    Scheduler,
    lead_over,
)
from cubeling.characters.behaviour.bml.timing import Scheduled, TimingEstimator
from cubeling.characters.errors import CharacterError

MAX_BLOCKS = 32
"""Blocks that are not over; one that replaces the others is taken even then."""

MAX_LOAD = 1000
"""Behaviours of blocks that are not over, and moments that their constraints tie: they may all be
scheduled in one frame."""

FULL = f"more than {MAX_BLOCKS} blocks, or too many behaviours; wait for their end or replace them"


class Realizer:
    """Plays blocks: lays each out in time, and tells what is active.

    Parameters
    ----------
    estimator
        Tells the natural times of their behaviours.
    """

    def __init__(self, estimator: TimingEstimator) -> None:
        self._estimator = estimator
        self._arrived: list[str | bytes | Block] = []
        self._realizations: dict[str, Realization] = {}
        self._feedback: list[Feedback] = []
        self._now = 0.0
        self._unnamed = 0

    def accept(self, bml: str | bytes | Block) -> None:
        """Accept a block, a document or what was read of one; it counts from the next update on."""
        self._arrived.append(bml)

    def update(self, now: float) -> tuple[Feedback, ...]:
        """Return what has happened since the last update, in its order.

        Parameters
        ----------
        now
            The time [s]; never less than before.
        """
        self._now = now
        arrived, self._arrived = self._arrived, []
        self._work()
        for bml in arrived:
            self._accept(bml)
            self._work()
        feedback, self._feedback = tuple(self._feedback), []
        return feedback

    def active(self, now: float) -> tuple[Scheduled, ...]:
        """Return the behaviours that are going on, in the order in which their blocks came."""
        return tuple(
            s for realization in self._running_realizations() for s in realization.behaviours(now)
        )

    @property
    def scheduled(self) -> tuple[Scheduled, ...]:
        """The behaviours that go on or are still to come, as far as their times are known."""
        return tuple(
            scheduled
            for realization in self._realizations.values()
            if math.isfinite(realization.start)
            for scheduled in realization.behaviours()
        )

    def end_of(self, block: str) -> float | None:
        """Return when nothing more happens in a block by itself, as far as is known [s].

        Infinite before it starts; None if it is over or unknown.
        """
        if any(isinstance(each, Block) and each.id == block for each in self._arrived):
            return math.inf
        realization = self._realizations.get(block)
        if realization is None or not math.isfinite(realization.start):
            return None if realization is None else math.inf
        times = [time for track in realization.tracks.values() for time in track.times]
        return max(time for time in (realization.start, *times) if math.isfinite(time))

    @property
    def idle(self) -> bool:
        """Whether nothing goes on or waits for its turn; blocks to be activated do not count."""
        return not self._arrived and all(
            realization.state == "preplanned" for realization in self._realizations.values()
        )

    def retime(self, block: str, behaviour: str, sync: str, time: float) -> None:
        """Move a sync point that has not happened, and what depends on it, in all blocks.

        A block that has not started is scheduled again when it does: its times are estimated again.

        Parameters
        ----------
        block, behaviour, sync
            Which; nothing is done if it is over or unknown.
        time
            When it is now expected [s]; what is past counts as now.
        """
        self.retime_all([(block, behaviour, sync, time)])

    def retime_all(self, moves: Iterable[tuple[str, str, str, float]]) -> None:
        """Move sync points as `retime` does, and find the times of what depends on them once.

        Parameters
        ----------
        moves
            Block, behaviour and sync point of each, and when it is now expected [s].
        """
        moved = {move[0] for move in moves if self._move(*move)}
        changed = set[str]()
        for other in self._running_realizations():
            if other.block.id in moved or other.refers_to(changed):
                changed.add(other.block.id)
                other.replan(self._now, self._external)
                lead_over(other.tracks.values(), self._others(other), self._now)
                self._feedback.append(other.prediction())
        if changed:
            self._reorder()

    def _move(self, block: str, behaviour: str, sync: str, time: float) -> bool:
        """Note when a sync point is to be; return whether it is still to come."""
        realization = self._realizations.get(block)
        if realization is None or realization.state != "running":
            return False
        track = realization.tracks.get(behaviour)
        if track is None or track.interrupted or sync not in track.timing.index:
            return False
        index = track.timing.index[sync]
        if index < track.happened:
            return False
        realization.move(track, index, time, self._now)
        return True

    # Arrival

    def _accept(self, bml: str | bytes | Block) -> None:
        if not isinstance(bml, Block):
            try:
                bml = parse(bml)
            except CharacterError as error:
                self._feedback.append(BmlWarning("", "PARSING_FAILURE", str(error), self._now))
                return
        if not bml.id:
            bml = replace(bml, id=self._new_name())
        for note in bml.notes:
            self._warn(bml, "", "READ_AS_DIALECT", note)
        if bml.id in self._realizations:
            self._warn(bml, "", "PARSING_FAILURE", "a block with this id is not over yet")
            return
        realization = Realization(bml, "preplanned", self._now)
        if bml.composition != "REPLACE" and not self._has_room_for(realization):
            self._warn(bml, "", "IMPOSSIBLE_TO_SCHEDULE", FULL)
            return
        self._realizations[bml.id] = realization
        if not bml.preplan:
            self._activate(realization, self._now)
        if not realization.awaits_nothing:
            self._preview(realization)

    def _new_name(self) -> str:
        self._unnamed += 1
        while f"block{self._unnamed}" in self._realizations:
            self._unnamed += 1
        return f"block{self._unnamed}"

    def _has_room_for(self, realization: Realization) -> bool:
        known = self._realizations.values()
        load = realization.load + sum(each.load for each in known)
        return len(known) < MAX_BLOCKS and load <= MAX_LOAD

    def _activate(self, realization: Realization, time: float) -> None:
        """Find out what a block has to wait for."""
        block = realization.block
        others = [name for name in self._realizations if name != block.id]
        realization.state, realization.ready = "waiting", time
        realization.awaits_release = {name for name in block.chunk_after if name in others}
        realization.awaits_end = {name for name in block.append_after if name in others}
        if block.composition == "APPEND":
            realization.awaits_end |= {
                name for name in others if self._realizations[name].state != "preplanned"
            }
        wanted = others if block.composition == "REPLACE" else block.interrupt
        realization.interrupts = tuple(name for name in wanted if name in others)

    def _preview(self, realization: Realization) -> None:
        """Predict a block that does not start yet; what it cannot do is known when it starts.

        It leaves what runs alone: its times are a guess.
        """
        if realization.state != "preplanned":
            ends = [self._realizations[name].end for name in realization.awaits_end]
            ends += [self._realizations[name].release for name in realization.awaits_release]
            realization.start = max([realization.ready, *ends])
        start = realization.start if math.isfinite(realization.start) else self._now
        with suppress(BlockFailed):
            scheduler = Scheduler(realization.block, self._estimator, self._external)
            realization.tracks = scheduler.schedule(start, ()).tracks
            realization.reorder()
            self._feedback.append(realization.prediction())

    def _schedule(self, realization: Realization, start: float) -> bool:
        """Schedule a block and send warnings; return whether it can be performed."""
        block = realization.block
        try:
            scheduler = Scheduler(block, self._estimator, self._external)
            schedule = scheduler.schedule(start, self._others(realization))
        except BlockFailed as failed:
            self._warn(block, "", failed.type, f"it is required: {failed}")
            self._finish(realization, start, report=False)
            return False
        realization.tracks, realization.constraints = schedule.tracks, schedule.constraints
        realization.reorder()
        self._reorder()  # behaviours of other blocks may lead over to its own
        lines = {each.id: each.line for each in block.behaviours if each.yielding}
        for failure in schedule.failures:
            line = lines.get(failure.id, 0)
            reason = f"line {line}: {failure.reason}" if line else failure.reason
            self._warn(block, failure.id, failure.type, reason)
        return True

    # Time

    def _work(self) -> None:
        """Do all that is due."""
        while True:
            due = [
                (time, kind, order, realization)
                for order, realization in enumerate(self._realizations.values())
                for time, kind in [self._due(realization)]
                if time <= self._now
            ]
            if not due:
                return
            time, kind, _, realization = min(due, key=lambda event: event[:3])
            (self._progress, self._finish, self._begin)[kind](realization, time)

    def _due(self, realization: Realization) -> tuple[float, int]:
        """Return when a block wants attention, and what for: a sync point, its end or its start."""
        if realization.awaits_nothing:
            return realization.ready, 2
        if realization.state != "running":
            return math.inf, 2
        track = realization.next_track()
        if track is None:
            return max(realization.end, realization.latest), 1
        return track.times[track.happened], 0

    def _begin(self, realization: Realization, time: float) -> None:
        """End what a block replaces; start it if that is over."""
        if realization.interrupts:
            for name in realization.interrupts:
                if name in self._realizations:
                    self._interrupt(self._realizations[name], time)
            realization.awaits_end = {n for n in realization.interrupts if n in self._realizations}
            realization.interrupts = ()
            return
        if not self._schedule(realization, time):
            return
        block = realization.block
        realization.state, realization.start, realization.latest = "running", time, time
        self._feedback.append(realization.prediction())
        self._feedback.append(BlockProgress(block.id, "start", time, block.character))
        self._activate_all(block, block.on_start, time)

    def _progress(self, realization: Realization, time: float) -> None:
        """Report a sync point, and do what it is for."""
        track = realization.next_track()
        assert track is not None
        block, behaviour = realization.block, track.behaviour
        sync = realization.advance()
        realization.latest = time
        self._feedback.append(
            SyncPointProgress(
                block.id, behaviour.id, sync, time, time - realization.start, block.character
            )
        )
        if behaviour.namespace == BMLA and sync == "start":
            self._control(block, behaviour, time)
        awaiting = [r for r in self._realizations.values() if block.id in r.awaits_release]
        if awaiting and realization.released:
            for other in awaiting:
                self._stop_waiting(other.awaits_release, other, realization, time)

    def _finish(self, realization: Realization, time: float, *, report: bool = True) -> None:
        """Forget a block, and let those that wait for it go on."""
        block = realization.block
        del self._realizations[block.id]
        realization.state = "over"
        if report:
            self._feedback.append(BlockProgress(block.id, "end", time, block.character))
        for other in self._realizations.values():
            self._stop_waiting(other.awaits_end, other, realization, time)
            self._stop_waiting(other.awaits_release, other, realization, time)

    def _stop_waiting(
        self, awaited: set[str], waiting: Realization, realization: Realization, time: float
    ) -> None:
        if realization.block.id in awaited:
            awaited.discard(realization.block.id)
            waiting.ready = max(waiting.ready, time)

    # Control of other blocks

    def _control(self, block: Block, behaviour: Behaviour, time: float) -> None:
        targets = _names(behaviour.get("target"))
        if behaviour.kind == "activate":
            self._activate_all(block, targets, time)
        if behaviour.kind != "interrupt":
            return
        for name in targets:
            target = self._realizations.get(name)
            if target is None:
                self._warn(block, behaviour.id, "NO_SUCH_TARGET", f"there is no block {name}")
            else:
                only, but = _names(behaviour.get("include")), _names(behaviour.get("exclude"))
                self._interrupt(target, time, only, but)

    def _activate_all(self, block: Block, names: Iterable[str], time: float) -> None:
        for name in names:
            target = self._realizations.get(name)
            if target is None or target.state != "preplanned":
                self._warn(block, "", "NO_SUCH_TARGET", f"{name} is no block to be activated")
            else:
                self._activate(target, time)

    def _interrupt(
        self,
        target: Realization,
        time: float,
        only: tuple[str, ...] = (),
        but: tuple[str, ...] = (),
    ) -> None:
        if target.state == "running":
            target.interrupt(time, only, but)
        elif not only and not but:
            self._finish(target, time)

    # Between blocks

    def _running_realizations(self) -> list[Realization]:
        return [p for p in self._realizations.values() if p.state == "running"]

    def _reorder(self) -> None:
        for realization in self._running_realizations():
            realization.reorder()

    def _others(self, realization: Realization) -> list[BehaviourTrack]:
        others = [other for other in self._running_realizations() if other is not realization]
        return [track for other in others for track in other.tracks.values()]

    def _external(self, reference: SyncReference) -> float | None:
        """Return when a sync point of another block is [s], None if that is not known."""
        realization = self._realizations.get(reference.block)
        if realization is None or not math.isfinite(realization.start):
            return None
        track = realization.tracks.get(reference.behaviour)
        if track is None or reference.sync not in track.timing.index:
            return None
        return track.times[track.timing.index[reference.sync]]

    def _warn(self, block: Block, part: str, kind: WarningType, why: str) -> None:
        name = f"{block.id}:{part}" if part else block.id
        self._feedback.append(BmlWarning(name, kind, why, self._now, block.character))


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.replace(",", " ").split())
