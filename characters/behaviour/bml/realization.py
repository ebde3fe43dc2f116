"""A block laid out in time, which plays or waits for its turn."""

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from heapq import heapify, heappop, heapreplace
from typing import Literal

from cubeling.characters.behaviour.bml.constraints import External, Resolver
from cubeling.characters.behaviour.bml.document import Block, Constraint
from cubeling.characters.behaviour.bml.feedback import BlockPrediction, PredictedBehaviour
from cubeling.characters.behaviour.bml.planner import plan
from cubeling.characters.behaviour.bml.problem import TimingProblem
from cubeling.characters.behaviour.bml.schedule import BehaviourTrack
from cubeling.characters.behaviour.bml.timing import Scheduled

State = Literal["preplanned", "waiting", "running", "over"]


@dataclass(eq=False)
class Realization:
    """A block and how far it has got."""

    block: Block

    state: State
    """Whether it waits to be activated, waits for others, or runs."""

    ready: float
    """When what it waited for was over, so far [s]."""

    start: float = math.inf
    """When it starts, as far as is known [s]."""

    latest: float = math.inf
    """When something last happened to it [s]."""

    tracks: dict[str, BehaviourTrack] = field(default_factory=dict)
    """Its behaviours by id, in the document's order."""

    constraints: tuple[Constraint, ...] = ()
    """Its constraints that are kept."""

    awaits_end: set[str] = field(default_factory=set)
    """Blocks that must be over before it starts."""

    awaits_release: set[str] = field(default_factory=set)
    """Blocks whose behaviours must relax before it starts."""

    interrupts: tuple[str, ...] = ()
    """Blocks that it has to end before it starts."""

    _coming: list[tuple[float, int, BehaviourTrack]] | None = None
    """A heap of the behaviours by their next sync points; None if times have changed since."""

    @property
    def load(self) -> int:
        """How much there is to schedule: behaviours, and moments that constraints tie."""
        return len(self.block.behaviours) + sum(len(c.syncs) for c in self.block.constraints)

    @property
    def awaits_nothing(self) -> bool:
        """Whether it can start."""
        return self.state == "waiting" and not self.awaits_end and not self.awaits_release

    @property
    def over(self) -> bool:
        """Whether it runs no more."""
        return self.state == "running" and all(track.over for track in self.tracks.values())

    @property
    def released(self) -> bool:
        """Whether all its behaviours have relaxed."""
        return self.state == "running" and all(t.released for t in self.tracks.values())

    @property
    def end(self) -> float:
        """When it is over, as far as is known [s]."""
        ends = [track.times[-1] for track in self.tracks.values()]
        return max([self.start, *ends]) if math.isfinite(self.start) else math.inf

    @property
    def release(self) -> float:
        """When its behaviours have relaxed, as far as is known [s]."""
        releases = [track.release for track in self.tracks.values()]
        return max([self.start, *releases]) if math.isfinite(self.start) else math.inf

    def next_track(self) -> BehaviourTrack | None:
        """Return the behaviour whose sync point comes next, the first of those that tie."""
        if self._coming is None:
            self._coming = [
                (track.times[track.happened], number, track)
                for number, track in enumerate(self.tracks.values())
                if not track.over
            ]
            heapify(self._coming)
        return self._coming[0][2] if self._coming else None

    def advance(self) -> str:
        """Note that the next sync point has come, and return its name."""
        track = self.next_track()
        assert track is not None
        assert self._coming is not None
        sync = track.timing.syncs[track.happened]
        track.happened += 1
        if track.over:
            heappop(self._coming)
        else:
            entry = track.times[track.happened], self._coming[0][1], track
            heapreplace(self._coming, entry)
        return sync

    def reorder(self) -> None:
        """Look again which sync point comes next, as behaviours or their times have changed."""
        self._coming = None

    def behaviours(self, at: float | None = None) -> Iterator[Scheduled]:
        """Yield its behaviours that are not over, or only those that go on then."""
        for track in self.tracks.values():
            goes_on = not track.over if at is None else track.times[0] <= at < track.times[-1]
            if goes_on and not track.control:
                times = dict(zip(track.timing.syncs, track.times, strict=True))
                yield Scheduled(self.block.id, track.behaviour, times, self.block.attributes)

    def prediction(self) -> BlockPrediction:
        """Return when it is expected to be."""
        origin = self.start if math.isfinite(self.start) else self.ready
        behaviours = tuple(
            PredictedBehaviour(
                name,
                track.behaviour.kind,
                tuple(
                    (sync, time - origin)
                    for sync, time in zip(track.timing.syncs, track.times, strict=True)
                ),
            )
            for name, track in self.tracks.items()
        )
        return BlockPrediction(
            self.block.id, self.start, self.end, behaviours, self.block.character
        )

    def interrupt(self, now: float, only: Collection[str], but: Collection[str]) -> None:
        """End behaviours: those that run relax now, those that have not started never do.

        Parameters
        ----------
        now
            When [s].
        only
            Ids of those to end; empty for all.
        but
            Ids of those to leave alone.
        """
        self.latest = now
        self.reorder()
        for name, track in list(self.tracks.items()):
            if (only and name not in only) or name in but or track.over:
                continue
            if track.happened == 0:
                del self.tracks[name]
            elif not track.released:
                release = track.timing.release
                track.happened = release
                track.times[release] = now
                for index, span in enumerate(track.timing.spans[release:], release + 1):
                    track.times[index] = track.times[index - 1] + span
                track.interrupted = True

    def refers_to(self, blocks: Collection[str]) -> bool:
        """Return whether a time of it depends on one of other blocks."""
        references = [r for track in self.tracks.values() for r in track.behaviour.syncs.values()]
        for constraint in self.constraints:
            references += constraint.syncs
            references += [constraint.reference] if constraint.reference else []
        return any(reference.block in blocks for reference in references)

    def move(self, track: BehaviourTrack, index: int, time: float, now: float) -> None:
        """Note when a sync point that has not happened is to be [s]."""
        lowest = max(now, track.times[track.happened - 1] if track.happened else self.start)
        time = max(time, lowest)
        kept = {i: t for i, t in track.moved.items() if (t <= time) == (i < index)}
        track.moved = {**kept, index: time}

    def replan(self, now: float, external: External) -> None:
        """Find the times of all that has not happened again."""
        timings = {name: track.timing for name, track in self.tracks.items()}
        behaviours = [track.behaviour for track in self.tracks.values()]
        resolver = Resolver(self.block, timings, self.start, external)
        links, orders, _ = resolver.rules(behaviours, self.constraints)
        facts = {
            name: {
                index: time
                for index, time in enumerate(track.times)
                if index < track.happened or track.interrupted
            }
            | {i: time for i, time in track.moved.items() if i >= track.happened}
            for name, track in self.tracks.items()
        }
        moved = frozenset(name for name, track in self.tracks.items() if track.moved)
        problem = TimingProblem(timings, links, orders, self.start, now, facts, moved, strict=False)
        for name, times in plan(problem).items():
            self.tracks[name].times = times
        self.reorder()
