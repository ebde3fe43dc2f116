"""Schedule a block: what can be performed of it, and when."""

import math
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from cubeling.characters.behaviour.bml.constraints import (
    Contradictory,
    External,
    Link,
    Order,
    Resolver,
    not_performed,
)
from cubeling.characters.behaviour.bml.document import (
    BML,
    BMLA,
    MAX_BLOCK_S,
    SYNCS,
    Behaviour,
    Block,
    Constraint,
    SyncReference,
)
from cubeling.characters.behaviour.bml.feedback import WarningType
from cubeling.characters.behaviour.bml.planner import plan
from cubeling.characters.behaviour.bml.problem import TimingProblem
from cubeling.characters.behaviour.bml.spans import TOLERANCE
from cubeling.characters.behaviour.bml.timing import CannotRealize, Timing, TimingEstimator

MAX_ATTEMPTS = 25
"""Times that a block is planned, each without what could not be met the time before."""

YIELDING_ATTEMPTS = 3
"""So many times more if behaviours give up their times one after the other."""

CONTROLS = {
    "interrupt": Timing(("start", "end"), (0.0,), (0.0,), (0.0,)),
    "activate": Timing(("start", "end"), (0.0,), (0.0,), (0.0,)),
}
"""Behaviours that the realizer performs itself, of namespace `BMLA`."""


@dataclass
class BehaviourTrack:
    """A behaviour that is scheduled, and how far it has got."""

    behaviour: Behaviour

    timing: Timing
    """Its natural times, before constraints stretch or shift them."""

    times: list[float]
    """When its sync points are [s]; inf for what comes only by an interrupt."""

    fixed_end: bool = False
    """Whether a constraint says when it ends."""

    happened: int = 0
    """How many of its sync points have come."""

    moved: dict[int, float] = field(default_factory=dict)
    """Sync points whose times were learned since [s]."""

    interrupted: bool = False
    """Whether it was ended: its times are final."""

    @property
    def control(self) -> bool:
        """Whether the realizer performs it itself."""
        return self.behaviour.namespace == BMLA and self.behaviour.kind in CONTROLS

    @property
    def over(self) -> bool:
        """Whether all its sync points have come."""
        return self.happened >= len(self.times)

    @property
    def released(self) -> bool:
        """Whether it has relaxed: the next gesture may begin."""
        return self.happened > self.timing.release

    @property
    def release(self) -> float:
        """When it relaxes [s]."""
        return self.times[self.timing.release]


@dataclass(frozen=True)
class Failure:
    """A behaviour or a constraint that is left out."""

    id: str

    type: WarningType
    """What kind of failure."""

    reason: str
    """Why, in one line."""


class BlockFailed(Exception):  # noqa: N818 -- a verdict on a document, not a bug
    """Something that is required cannot be performed: the whole block is left out."""

    def __init__(self, failure: Failure) -> None:
        super().__init__(f"{failure.id}: {failure.reason}")
        self.type = failure.type
        """What kind of failure."""


@dataclass
class BlockSchedule:
    """What is performed of a block, and when."""

    tracks: dict[str, BehaviourTrack]
    """Behaviours by id, in the document's order."""

    constraints: tuple[Constraint, ...]
    """Constraints that are kept."""

    failures: list[Failure]
    """What is left out."""


class Scheduler:
    """Finds the times of one block: its constraints met, its behaviours stretched least."""

    def __init__(self, block: Block, estimator: TimingEstimator, external: External) -> None:
        self._block, self._external = block, external
        self._behaviours = {behaviour.id: behaviour for behaviour in block.behaviours}
        self._constraints = {constraint.id: constraint for constraint in block.constraints}
        self._parts: dict[str, Behaviour | Constraint] = {**self._behaviours, **self._constraints}
        self._ties = _ties(block)
        self._timings: dict[str, Timing] = {}
        self._failures: list[Failure] = []
        unable: list[Failure] = []
        for behaviour in block.behaviours:
            try:
                self._timings[behaviour.id] = _timing(behaviour, block, estimator)
            except CannotRealize as error:
                kind = _failure_type(behaviour, error)
                unable.append(Failure(behaviour.id, kind, str(error)))
        self._leave_out(unable)

    def schedule(self, start: float, others: Sequence[BehaviourTrack]) -> BlockSchedule:
        """Return the schedule of the block if it starts at `start` [s] beside `others`.

        Raises
        ------
        BlockFailed
            If something that is required cannot be performed, or too much contradicts itself.
        """
        yielding = any(each.yielding for each in self._block.behaviours)
        for _ in range(MAX_ATTEMPTS * (YIELDING_ATTEMPTS if yielding else 1)):
            try:
                tracks = self._attempt(start)
            except Contradictory as error:
                self._leave_out(_impossible(each.owner, str(each)) for each in error.unmet)
                continue
            conflicts = [*_late(tracks.values(), start), *_conflicts(tracks.values(), others)]
            if not conflicts:
                lead_over(tracks.values(), others, start)
                return BlockSchedule(tracks, tuple(self._constraints.values()), self._failures)
            self._leave_out(conflicts)
        reason = f"its constraints contradict each other in more than {MAX_ATTEMPTS} ways"
        raise BlockFailed(_impossible(self._block.id, reason))

    def _attempt(self, start: float) -> dict[str, BehaviourTrack]:
        links, orders = self._rules(start)
        times = plan(TimingProblem(self._timings, links, orders, start))
        ended = {
            end[0]
            for link in links
            for end in (link.a, link.b)
            if end is not None and end[1] == len(self._timings[end[0]].syncs) - 1
        }
        return {
            name: BehaviourTrack(self._behaviours[name], timing, times[name], name in ended)
            for name, timing in self._timings.items()
        }

    def _rules(self, start: float) -> tuple[list[Link], list[Order]]:
        behaviours = [self._behaviours[name] for name in self._timings]
        resolver = Resolver(self._block, self._timings, start, self._external)
        links, orders, unmet = resolver.rules(behaviours, self._constraints.values())
        if unmet:
            raise Contradictory(unmet)
        return links, orders

    def _leave_out(self, failures: Iterable[Failure]) -> None:
        """Leave behaviours and constraints out, and then what is tied to them; each once.

        A constraint that is tied to one goes without a warning, unless it is required.
        """
        waiting = deque(failures)
        while waiting:
            failure = waiting.popleft()
            part = self._parts.pop(failure.id, None)
            if part is None:
                continue
            if part.required:
                raise BlockFailed(failure)
            if isinstance(part, Behaviour) and self._give_up_a_time(part, failure):
                continue
            self._failures.append(failure)
            self._constraints.pop(failure.id, None)
            self._timings.pop(failure.id, None)
            for name, reference in self._ties.get(failure.id, ()):
                other = self._constraints.get(name)
                if other is not None and not other.required:
                    del self._constraints[name], self._parts[name]
                else:
                    waiting.append(_impossible(name, not_performed(reference)))

    def _give_up_a_time(self, behaviour: Behaviour, failure: Failure) -> bool:
        """Let a behaviour that yields give up its last time; return whether it has done so.

        What is tied to another behaviour by one time only is nothing without it.
        """
        timing = self._timings.get(behaviour.id)
        if not behaviour.yielding or not behaviour.syncs or timing is None:
            return False
        last = max(behaviour.syncs, key=lambda sync: timing.index.get(sync, math.inf))
        alone = len(behaviour.syncs) == 1 and bool(behaviour.syncs[last].behaviour)
        if alone or failure.type != "IMPOSSIBLE_TO_SCHEDULE":
            return False
        syncs = {sync: at for sync, at in behaviour.syncs.items() if sync != last}
        kept = replace(behaviour, syncs=syncs)
        self._behaviours[behaviour.id] = self._parts[behaviour.id] = kept
        self._failures.append(replace(failure, reason=f"its {last} is given up: {failure.reason}"))
        return True


def _ties(block: Block) -> Mapping[str, list[tuple[str, SyncReference]]]:
    """Return ids of behaviours and constraints by the behaviour that they refer to, and how."""
    tied: dict[str, list[tuple[str, SyncReference]]] = defaultdict(list)
    for behaviour in block.behaviours:
        for reference in behaviour.syncs.values():
            if reference.block in ("", block.id) and reference.behaviour != behaviour.id:
                tied[reference.behaviour].append((behaviour.id, reference))
    for constraint in block.constraints:
        moments = constraint.syncs + ((constraint.reference,) if constraint.reference else ())
        for reference in moments:
            if reference.block in ("", block.id):
                tied[reference.behaviour].append((constraint.id, reference))
    return tied


def _impossible(name: str, reason: str) -> Failure:
    return Failure(name, "IMPOSSIBLE_TO_SCHEDULE", reason)


def lead_over(
    tracks: Iterable[BehaviourTrack], others: Iterable[BehaviourTrack], now: float
) -> None:
    """Let behaviours end when the next one takes what they occupied: none returns to rest first.

    Those that others have taken from already end `now` [s].
    """
    tracks = [track for track in tracks if track.timing.occupies]
    before = [
        (other.release, other)
        for other in (*others, *tracks)
        if other.timing.occupies and not (other.fixed_end or other.over or other.interrupted)
    ]
    for track in tracks:
        start = track.times[0]
        for release, other in before:
            taken = release <= start + TOLERANCE < other.times[-1] and other is not track
            if taken and track.timing.occupies & other.timing.occupies:
                other.times[-1] = min(other.times[-1], max(start, release, now))


def _late(tracks: Iterable[BehaviourTrack], start: float) -> Iterator[Failure]:
    """Yield what of a block ends, or never begins, more than an hour after it has started."""
    for track in tracks:
        last = max((time for time in track.times if time < math.inf), default=math.inf)
        if last > start + MAX_BLOCK_S:
            reason = f"it would not be over {MAX_BLOCK_S:g} s after its block has started"
            yield _impossible(track.behaviour.id, reason)


def _conflicts(
    tracks: Iterable[BehaviourTrack], others: Iterable[BehaviourTrack]
) -> Iterator[Failure]:
    """Yield what of a block wants something of the body that another behaviour has, and why."""
    # Pairs are compared: what the loop needs of each is looked up once.
    earlier = [
        (other.times[0] + TOLERANCE, other.release - TOLERANCE, other)
        for other in others
        if other.timing.occupies and not other.over and not other.interrupted
    ]
    for track in tracks:
        if not track.timing.occupies:
            continue
        start, release = track.times[0], track.release
        for begins, ends, other in earlier:
            shared = (
                start < ends
                and begins < release
                and (track.timing.occupies & other.timing.occupies)
            )
            if shared:
                reason = f"{other.behaviour.id} has the {', '.join(sorted(shared))} at that time"
                yield _impossible(track.behaviour.id, reason)
                break
        else:
            earlier.append((start + TOLERANCE, release - TOLERANCE, track))


def _timing(behaviour: Behaviour, block: Block, estimator: TimingEstimator) -> Timing:
    if behaviour.namespace == BMLA and behaviour.kind in CONTROLS:
        return CONTROLS[behaviour.kind]
    timing = estimator.timing(behaviour, block)
    # A dialect's looks may overlap: the last one counts.
    return replace(timing, occupies=frozenset()) if behaviour.yielding else timing


def _failure_type(behaviour: Behaviour, error: CannotRealize) -> WarningType:
    if error.type is not None:
        return error.type
    if behaviour.namespace != BML:
        return "CUSTOM_BEHAVIOR_NOT_SUPPORTED"
    return "CANNOT_CREATE_BEHAVIOR" if behaviour.kind in SYNCS else "BEHAVIOR_TYPE_NOT_SUPPORTED"
