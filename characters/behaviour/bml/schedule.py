"""Schedule a block: what can be performed of it, and when."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from cubeling.characters.behaviour.bml.constraints import (
    Contradictory,
    External,
    Link,
    Order,
    Resolver,
)
from cubeling.characters.behaviour.bml.document import (
    BML,
    BMLA,
    SYNCS,
    Behaviour,
    Block,
    Constraint,
)
from cubeling.characters.behaviour.bml.feedback import WarningType
from cubeling.characters.behaviour.bml.planner import plan
from cubeling.characters.behaviour.bml.problem import TimingProblem
from cubeling.characters.behaviour.bml.spans import TOLERANCE
from cubeling.characters.behaviour.bml.timing import CannotRealize, Timing, TimingEstimator

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
        self._timings: dict[str, Timing] = {}
        self._failures: list[Failure] = []
        for behaviour in block.behaviours:
            try:
                self._timings[behaviour.id] = _timing(behaviour, block, estimator)
            except CannotRealize as error:
                self._leave_out(behaviour.id, _failure_type(behaviour, error), str(error))

    def schedule(self, start: float, others: Sequence[BehaviourTrack]) -> BlockSchedule:
        """Return the schedule of the block if it starts at `start` [s] beside `others`.

        Raises
        ------
        BlockFailed
            If something that is required cannot be performed.
        """
        while True:
            try:
                tracks = self._attempt(start)
            except Contradictory as error:
                for unmet in error.unmet:
                    self._leave_out(unmet.owner, "IMPOSSIBLE_TO_SCHEDULE", str(unmet))
                continue
            conflicts = [*_conflicts(tracks.values(), others)]
            if not conflicts:
                lead_over(tracks.values(), others, start)
                return BlockSchedule(tracks, tuple(self._constraints.values()), self._failures)
            for name, reason in conflicts:
                self._leave_out(name, "IMPOSSIBLE_TO_SCHEDULE", reason)

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

    def _leave_out(self, name: str, kind: WarningType, reason: str) -> None:
        """Leave a behaviour or a constraint out, and constraints on it; once is enough."""
        part = self._parts.pop(name, None)
        if part is None:
            return
        failure = Failure(name, kind, reason)
        if part.required:
            raise BlockFailed(failure)
        self._failures.append(failure)
        self._timings.pop(name, None)
        self._constraints.pop(name, None)
        for constraint in list(self._constraints.values()):
            if not constraint.required and _names(constraint, self._block.id, name):
                del self._constraints[constraint.id], self._parts[constraint.id]


def lead_over(
    tracks: Iterable[BehaviourTrack], others: Iterable[BehaviourTrack], now: float
) -> None:
    """Let behaviours end when the next one takes what they occupied: none returns to rest first.

    Those that others have taken from already end `now` [s].
    """
    tracks = [track for track in tracks if track.timing.occupies]
    for track in tracks:
        for other in [*others, *tracks]:
            if other is track or other.fixed_end or other.over or other.interrupted:
                continue
            shares = track.timing.occupies & other.timing.occupies
            if shares and other.release <= track.times[0] + TOLERANCE < other.times[-1]:
                end = max(track.times[0], other.release, now)
                other.times[-1] = min(other.times[-1], end)


def _conflicts(
    tracks: Iterable[BehaviourTrack], others: Iterable[BehaviourTrack]
) -> Iterator[tuple[str, str]]:
    """Yield what of a block wants something of the body that another behaviour has, and why."""
    earlier = [o for o in others if o.timing.occupies and not o.over and not o.interrupted]
    for track in tracks:
        if not track.timing.occupies:
            continue
        for other in earlier:
            shared = track.timing.occupies & other.timing.occupies
            overlaps = (
                track.times[0] < other.release - TOLERANCE
                and other.times[0] < track.release - TOLERANCE
            )
            if shared and overlaps:
                what = ", ".join(sorted(shared))
                yield track.behaviour.id, f"{other.behaviour.id} has the {what} at that time"
                break
        else:
            earlier.append(track)


def _timing(behaviour: Behaviour, block: Block, estimator: TimingEstimator) -> Timing:
    if behaviour.namespace == BMLA and behaviour.kind in CONTROLS:
        return CONTROLS[behaviour.kind]
    return estimator.timing(behaviour, block)


def _failure_type(behaviour: Behaviour, error: CannotRealize) -> WarningType:
    if error.type is not None:
        return error.type
    if behaviour.namespace != BML:
        return "CUSTOM_BEHAVIOR_NOT_SUPPORTED"
    return "CANNOT_CREATE_BEHAVIOR" if behaviour.kind in SYNCS else "BEHAVIOR_TYPE_NOT_SUPPORTED"


def _names(constraint: Constraint, block: str, behaviour: str) -> bool:
    syncs = constraint.syncs + ((constraint.reference,) if constraint.reference else ())
    return any(sync.behaviour == behaviour and sync.block in ("", block) for sync in syncs)
