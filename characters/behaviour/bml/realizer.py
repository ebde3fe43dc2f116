"""Perform BML blocks in time: when each begins, what happens, and what is reported.

The realizer has no clock: `update` is told the time. What happens between two updates is worked
through in its order and reported with the times at which it was due, so that the rate of frames
shifts nothing. Composition is that of BML 1.0, section 2.3; interrupt, activate, preplan and
chunks are those of AsapRealizer (van Welbergen et al. 2014, sections 4 and 5).
"""

import math
from collections.abc import Iterable
from contextlib import suppress

from cubeling.characters.behaviour.bml.document import BMLA, Behaviour, Block, SyncReference
from cubeling.characters.behaviour.bml.feedback import (
    BlockProgress,
    BmlWarning,
    Feedback,
    SyncPointProgress,
    WarningType,
)
from cubeling.characters.behaviour.bml.parser import parse
from cubeling.characters.behaviour.bml.performance import Realization
from cubeling.characters.behaviour.bml.performer import Scheduled, TimingEstimator
from cubeling.characters.behaviour.bml.schedule import (
    BehaviourTrack,
    BlockFailed,
    Scheduler,
    lead_over,
)
from cubeling.characters.errors import CharacterError


class Realizer:
    """Performs blocks.

    Parameters
    ----------
    performer
        Whoever performs their behaviours: it is asked for their natural times.
    """

    def __init__(self, performer: TimingEstimator) -> None:
        self._estimator = performer
        self._arrived: list[str | bytes | Block] = []
        self._realizations: dict[str, Realization] = {}
        self._feedback: list[Feedback] = []
        self._now = 0.0

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
        return tuple(s for performance in self._running() for s in performance.behaviours(now))

    @property
    def scheduled(self) -> tuple[Scheduled, ...]:
        """The behaviours that go on or are still to come, as far as their times are known."""
        return tuple(
            scheduled
            for performance in self._realizations.values()
            if math.isfinite(performance.start)
            for scheduled in performance.behaviours()
        )

    @property
    def idle(self) -> bool:
        """Whether nothing goes on or waits for its turn; blocks to be activated do not count."""
        return not self._arrived and all(
            performance.state == "preplanned" for performance in self._realizations.values()
        )

    def retime(self, block: str, behaviour: str, sync: str, time: float) -> None:
        """Move a sync point that has not happened, and what depends on it, in all blocks.

        A block that has not started is scheduled again when it does: its performer is asked again.

        Parameters
        ----------
        block, behaviour, sync
            Which; nothing is done if it is over or unknown.
        time
            When it is now expected [s]; what is past counts as now.
        """
        performance = self._realizations.get(block)
        if performance is None or performance.state != "running":
            return
        track = performance.tracks.get(behaviour)
        if track is None or track.interrupted or sync not in track.timing.syncs:
            return
        index = track.timing.syncs.index(sync)
        if index < track.happened:
            return
        performance.move(track, index, time, self._now)
        changed = set[str]()
        for other in self._running():
            if other is performance or other.refers_to(changed):
                changed.add(other.block.id)
                other.replan(self._now, self._external)
                lead_over(other.tracks.values(), self._others(other), self._now)
                self._feedback.append(other.prediction())

    # Arrival

    def _accept(self, bml: str | bytes | Block) -> None:
        if not isinstance(bml, Block):
            try:
                bml = parse(bml)
            except CharacterError as error:
                self._feedback.append(BmlWarning("", "PARSING_FAILURE", str(error), self._now))
                return
        if bml.id in self._realizations:
            self._warn(bml, "", "PARSING_FAILURE", "a block with this id is not over yet")
            return
        performance = Realization(bml, "preplanned", self._now)
        self._realizations[bml.id] = performance
        if not bml.preplan:
            self._activate(performance, self._now)
        if not performance.awaits_nothing:
            self._preview(performance)

    def _activate(self, performance: Realization, time: float) -> None:
        """Find out what a block has to wait for."""
        block = performance.block
        others = [name for name in self._realizations if name != block.id]
        performance.state, performance.ready = "waiting", time
        performance.awaits_release = {name for name in block.chunk_after if name in others}
        performance.awaits_end = {name for name in block.append_after if name in others}
        if block.composition == "APPEND":
            performance.awaits_end |= {
                name for name in others if self._realizations[name].state != "preplanned"
            }
        wanted = others if block.composition == "REPLACE" else block.interrupt
        performance.interrupts = tuple(name for name in wanted if name in others)

    def _preview(self, performance: Realization) -> None:
        """Predict a block that does not start yet; what it cannot do is known when it starts.

        It leaves what runs alone: its times are a guess.
        """
        if performance.state != "preplanned":
            ends = [self._realizations[name].end for name in performance.awaits_end]
            ends += [self._realizations[name].release for name in performance.awaits_release]
            performance.start = max([performance.ready, *ends])
        start = performance.start if math.isfinite(performance.start) else self._now
        with suppress(BlockFailed):
            scheduler = Scheduler(performance.block, self._estimator, self._external)
            performance.tracks = scheduler.schedule(start, ()).tracks
            self._feedback.append(performance.prediction())

    def _schedule(self, performance: Realization, start: float) -> bool:
        """Schedule a block and send warnings; return whether it can be performed."""
        block = performance.block
        try:
            scheduler = Scheduler(block, self._estimator, self._external)
            schedule = scheduler.schedule(start, self._others(performance))
        except BlockFailed as failed:
            self._warn(block, "", failed.type, f"it is required: {failed}")
            self._finish(performance, start, report=False)
            return False
        performance.tracks, performance.constraints = schedule.tracks, schedule.constraints
        for failure in schedule.failures:
            self._warn(block, failure.id, failure.type, failure.reason)
        return True

    # Time

    def _work(self) -> None:
        """Do all that is due."""
        while True:
            due = [
                (time, kind, order, performance)
                for order, performance in enumerate(self._realizations.values())
                for time, kind in [self._due(performance)]
                if time <= self._now
            ]
            if not due:
                return
            time, kind, _, performance = min(due, key=lambda event: event[:3])
            (self._progress, self._finish, self._begin)[kind](performance, time)

    def _due(self, performance: Realization) -> tuple[float, int]:
        """Return when a block wants attention, and what for: a sync point, its end or its start."""
        if performance.awaits_nothing:
            return performance.ready, 2
        if performance.state != "running":
            return math.inf, 2
        track = performance.next_track()
        if track is None:
            return max(performance.end, performance.latest), 1
        return track.times[track.happened], 0

    def _begin(self, performance: Realization, time: float) -> None:
        """End what a block replaces; start it if that is over."""
        if performance.interrupts:
            for name in performance.interrupts:
                if name in self._realizations:
                    self._interrupt(self._realizations[name], time)
            performance.awaits_end = {n for n in performance.interrupts if n in self._realizations}
            performance.interrupts = ()
            return
        if not self._schedule(performance, time):
            return
        block = performance.block
        performance.state, performance.start, performance.latest = "running", time, time
        self._feedback.append(performance.prediction())
        self._feedback.append(BlockProgress(block.id, "start", time, block.character))
        self._activate_all(block, block.on_start, time)

    def _progress(self, performance: Realization, time: float) -> None:
        """Report a sync point, and do what it is for."""
        track = performance.next_track()
        assert track is not None
        block, behaviour = performance.block, track.behaviour
        sync = track.timing.syncs[track.happened]
        track.happened += 1
        performance.latest = time
        self._feedback.append(
            SyncPointProgress(
                block.id, behaviour.id, sync, time, time - performance.start, block.character
            )
        )
        if behaviour.namespace == BMLA and sync == "start":
            self._control(block, behaviour, time)
        if performance.released:
            for other in self._realizations.values():
                self._stop_waiting(other.awaits_release, other, performance, time)

    def _finish(self, performance: Realization, time: float, *, report: bool = True) -> None:
        """Forget a block, and let those that wait for it go on."""
        block = performance.block
        del self._realizations[block.id]
        performance.state = "over"
        if report:
            self._feedback.append(BlockProgress(block.id, "end", time, block.character))
        for other in self._realizations.values():
            self._stop_waiting(other.awaits_end, other, performance, time)
            self._stop_waiting(other.awaits_release, other, performance, time)

    def _stop_waiting(
        self, awaited: set[str], waiting: Realization, performance: Realization, time: float
    ) -> None:
        if performance.block.id in awaited:
            awaited.discard(performance.block.id)
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

    def _running(self) -> list[Realization]:
        return [p for p in self._realizations.values() if p.state == "running"]

    def _others(self, performance: Realization) -> list[BehaviourTrack]:
        others = [other for other in self._running() if other is not performance]
        return [track for other in others for track in other.tracks.values()]

    def _external(self, reference: SyncReference) -> float | None:
        """Return when a sync point of another block is [s], None if that is not known."""
        performance = self._realizations.get(reference.block)
        if performance is None or not math.isfinite(performance.start):
            return None
        track = performance.tracks.get(reference.behaviour)
        if track is None or reference.sync not in track.timing.syncs:
            return None
        return track.times[track.timing.syncs.index(reference.sync)]

    def _warn(self, block: Block, part: str, kind: WarningType, why: str) -> None:
        name = f"{block.id}:{part}" if part else block.id
        self._feedback.append(BmlWarning(name, kind, why, self._now, block.character))


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.replace(",", " ").split())
