"""The natural times of behaviours, and who tells them to a BML realizer."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from cubeling.characters.behaviour.bml.document import Behaviour, Block
from cubeling.characters.behaviour.bml.feedback import WarningType


class CannotRealize(Exception):  # noqa: N818 -- a verdict on a document, not a bug
    """A behaviour that cannot be done; the message says why, in one line."""

    def __init__(self, reason: str, type: WarningType | None = None) -> None:
        super().__init__(reason)
        self.type = type
        """Type of the warning; None for what suits the kind of the behaviour."""


@dataclass(frozen=True)
class Timing:
    """When the sync points of a behaviour are by nature, and how far that may be stretched."""

    syncs: tuple[str, ...]
    """Names in the order of time: "start" first, "end" last."""

    spans: tuple[float, ...]
    """Time from each sync point to the next by nature [s]; one fewer than `syncs`."""

    shortest: tuple[float, ...]
    """Least time from each sync point to the next [s]."""

    longest: tuple[float, ...]
    """Most time from each sync point to the next [s]; `math.inf` for a hold."""

    occupies: frozenset[str] = frozenset()
    """What of the body no other behaviour can use from its start until it relaxes: "gaze" …"""

    persistent: bool = False
    """Whether it goes on for ever if nothing says when it relaxes or ends."""

    @cached_property
    def index(self) -> Mapping[str, int]:
        """Indices in `syncs` by name."""
        return {sync: index for index, sync in enumerate(self.syncs)}

    @cached_property
    def release(self) -> int:
        """Index of the sync point from which on it gives way: "relax", or "end"."""
        return self.index.get("relax", len(self.syncs) - 1)


@dataclass(frozen=True)
class Scheduled:
    """A behaviour with its times, which may change until they have come."""

    block: str
    """Which block it is of."""

    behaviour: Behaviour

    times: Mapping[str, float]
    """When its sync points are, in their order [s]; inf for what comes only by an interrupt."""

    block_attributes: Mapping[str, str]
    """`Block.attributes` of its block."""

    @property
    def key(self) -> str:
        """Its name among all behaviours that are not over."""
        return f"{self.block}:{self.behaviour.id}"

    @property
    def start(self) -> float:
        """When it starts [s]."""
        return self.times["start"]

    @property
    def end(self) -> float:
        """When it ends [s]."""
        return self.times["end"]


class TimingEstimator(Protocol):
    """Tells natural times: a character, or a stand-in with fixed estimates."""

    def timing(self, behaviour: Behaviour, block: Block) -> Timing:
        """Return the natural times of a behaviour.

        Raises
        ------
        CannotRealize
            If nobody here can do it.
        """


def rigid(syncs: tuple[str, ...], spans: tuple[float, ...]) -> Timing:
    """Return the timing of something that cannot be stretched."""
    return Timing(syncs, spans, spans, spans)


def elastic(
    syncs: tuple[str, ...],
    spans: tuple[float, ...],
    *,
    holds: frozenset[str] = frozenset(),
    occupies: frozenset[str] = frozenset(),
    least: float = 0.4,
    most: float = 3.0,
) -> Timing:
    """Return the timing of a movement: spans may be `least` to `most` times as long.

    Spans that begin at one of `holds` may be nothing, or take as long as they want.
    """
    return Timing(
        syncs,
        spans,
        tuple(0.0 if s in holds else least * t for s, t in zip(syncs, spans, strict=False)),
        tuple(math.inf if s in holds else most * t for s, t in zip(syncs, spans, strict=False)),
        occupies,
    )
