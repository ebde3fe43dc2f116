"""The constraints of a block as equations and orders of sync points."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from cubeling.characters.behaviour.bml.document import Behaviour, Block, Constraint, SyncReference
from cubeling.characters.behaviour.bml.timing import Timing
from cubeling.characters.errors import name_list

Moment = tuple[str, int]
"""A sync point: a behaviour's id, and the index in its `Timing.syncs`."""

External = Callable[[SyncReference], float | None]
"""Time of a sync point of another block without the offset [s]; None if it is not known."""


@dataclass(frozen=True)
class Link:
    """Two sync points that are at a fixed distance: time of `a` = time of `b` + offset."""

    a: Moment

    b: Moment | None
    """Another one; None for time 0."""

    offset: float
    """How much later `a` is than `b` [s]; may be negative."""

    owner: str
    """Id of the behaviour or the constraint that wants it."""


@dataclass(frozen=True)
class Order:
    """Two sync points in an order: time of `earlier` ≤ time of `later` + offset."""

    earlier: Moment | None
    """A sync point; None for time 0."""

    later: Moment | None
    """Another one; None for time 0."""

    offset: float
    """How much later than `later` the earlier one may be [s]."""

    owner: str
    """Id of the constraint that wants it."""


class Unmet(Exception):  # noqa: N818 -- a verdict on a document, not a bug
    """A constraint that cannot be met."""

    def __init__(self, owner: str, reason: str) -> None:
        super().__init__(reason)
        self.owner = owner
        """Id of the behaviour or the constraint that wants it."""


class Contradictory(Exception):  # noqa: N818 -- a verdict on a document, not a bug
    """Constraints that cannot be met, all that were found at once."""

    def __init__(self, unmet: Sequence[Unmet]) -> None:
        super().__init__("; ".join(map(str, unmet)))
        self.unmet = tuple(unmet)
        """They."""


_Place = tuple[Moment | None, float]
"""A sync point, or time 0, and seconds after it."""


class Resolver:
    """Finds the sync points that references name."""

    def __init__(
        self, block: Block, timings: Mapping[str, Timing], start: float, external: External
    ) -> None:
        self._block, self._timings, self._start = block, timings, start
        self._external = external

    def rules(
        self, behaviours: Iterable[Behaviour], constraints: Iterable[Constraint]
    ) -> tuple[list[Link], list[Order], list[Unmet]]:
        """Return all that behaviours and `constraint` elements want, and what names nothing."""
        links, orders, unmet = list[Link](), list[Order](), list[Unmet]()
        wants: list[Callable[[], Iterator[Link | Order]]] = [
            *(partial(self._links, behaviour) for behaviour in behaviours),
            *(partial(self._rules, constraint) for constraint in constraints),
        ]
        for want in wants:
            try:
                found = [*want()]
            except Unmet as error:
                unmet.append(error)
                continue
            links += [rule for rule in found if isinstance(rule, Link)]
            orders += [rule for rule in found if isinstance(rule, Order)]
        return links, orders, unmet

    def _links(self, behaviour: Behaviour) -> Iterator[Link]:
        """Yield what the attributes of a behaviour want."""
        for sync, reference in behaviour.syncs.items():
            own = self._place(SyncReference(behaviour.id, sync), behaviour.id)
            other = self._place(reference, behaviour.id)
            yield _link(own, other, behaviour.id)

    def _rules(self, constraint: Constraint) -> Iterator[Link | Order]:
        """Yield what a `constraint` wants."""
        places = [self._place(sync, constraint.id) for sync in constraint.syncs]
        if constraint.reference is None:
            for place in places[1:]:
                yield _link(places[0], place, constraint.id)
            return
        reference = self._place(constraint.reference, constraint.id)
        for place in places:
            first, second = (
                (place, reference) if constraint.kind == "before" else (reference, place)
            )
            yield Order(first[0], second[0], second[1] - first[1], constraint.id)

    def _place(self, reference: SyncReference, owner: str) -> _Place:
        if not reference.behaviour:
            return None, self._start + reference.offset
        if reference.block not in ("", self._block.id):
            time = self._external(reference)
            if time is None:
                raise Unmet(owner, f"{reference} is in no block that is planned")
            return None, time + reference.offset
        timing = self._timings.get(reference.behaviour)
        if timing is None:
            raise Unmet(owner, not_performed(reference))
        if reference.sync not in timing.index:
            points = name_list(timing.syncs)
            raise Unmet(owner, f"{reference} is no sync point of it; it has {points}")
        return (reference.behaviour, timing.index[reference.sync]), reference.offset


def not_performed(reference: SyncReference) -> str:
    """Return why what is tied to a sync point of a behaviour that is left out is left out too."""
    return f"{reference} is of no behaviour that is performed"


def _link(first: _Place, second: _Place, owner: str) -> Link:
    (a, a_offset), (b, b_offset) = first, second
    if a is None:
        a, b, a_offset, b_offset = b, a, b_offset, a_offset
    if a is None:
        raise Unmet(owner, "it names no sync point")
    if a == b:
        raise Unmet(owner, "a sync point refers to itself")
    return Link(a, b, b_offset - a_offset, owner)
