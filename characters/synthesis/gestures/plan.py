"""The gestures that were chosen for a speech, and the motion that plays them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from cubeling.characters.speech.speech import Accent
from cubeling.characters.synthesis.gestures.alignment import INVALID_COST, Timings
from cubeling.characters.synthesis.gestures.graph import GestureGraph
from cubeling.characters.synthesis.gestures.library import PHASES
from cubeling.characters.synthesis.gestures.nodes import GestureNode
from cubeling.characters.synthesis.gestures.playing import (
    Ends,
    PlannedGestureMotion,
    PlayedSegment,
    RestToRestSpan,
    bridge,
    weight_curve,
)

SHORTEST_BRIDGE_S = 1e-6
"""What follows sooner follows at once [s]."""


@dataclass(frozen=True)
class GestureCosts:
    """What a gesture costs, before weights (4.4 to 4.9)."""

    smooth: float
    """Of the way to it: 0…1."""

    strength: float
    """"bodyspeech": how far its strength is from the accent's, 0…1; "thesis": 10 if its GSI is out
    of the band."""

    time: float
    """Of its warp, or of the hold before it: 0…1."""

    repetition: float
    """Because it, or the same hands, were played lately."""


@dataclass(frozen=True)
class PlannedGesture:
    """A gesture with its times."""

    accent: Accent
    """The pitch accent whose time its stroke meets."""

    emphasized: float
    """The accent's strength with the slider, 0…1."""

    node: GestureNode
    """The gesture phrase that is played."""

    number: int
    """Its number in the graph."""

    knots: tuple[tuple[float, int], ...]
    """Times [s], ascending, and the frames of the recording that are played then."""

    apex: float
    """When its apex is [s]."""

    warp: float
    """New length over recorded one, of what may be warped."""

    hold: float
    """How long hands are held before it, besides the blend [s]."""

    by_rest: bool
    """Whether it begins in rest."""

    strength: float
    """GSI as it is played."""

    costs: GestureCosts

    @property
    def relaxed(self) -> bool:
        """Whether its strength is out of the band of the intensity rule ("thesis")."""
        return self.costs.strength >= INVALID_COST

    @property
    def start(self) -> float:
        """When it begins [s]."""
        return self.knots[0][0]

    @property
    def end(self) -> float:
        """When it ends [s]."""
        return self.knots[-1][0]

    @property
    def lead(self) -> float:
        """How long its apex is before the accent [s]: Δ."""
        return self.accent.time - self.apex

    def time_of(self, frame: int) -> float:
        """Return when a frame of its recording is played [s]."""
        times, frames = zip(*self.knots, strict=True)
        return float(np.interp(frame, frames, times))

    @cached_property
    def phases(self) -> tuple[tuple[str, float, float], ...]:
        """Name, start and end of its phases [s], without empty ones."""
        found: list[tuple[str, float, float]] = []
        first, last = self.node.frames
        for name in PHASES:
            begin, end = self.node.phrase.phase(name)
            if max(begin, first) < min(end, last):
                times = self.time_of(max(begin, first)), self.time_of(min(end, last))
                found.append((name, *times))
        return tuple(found)


@dataclass(frozen=True, eq=False)
class GesturePlan:
    """The gestures of a speech."""

    graph: GestureGraph
    """What they are chosen from."""

    gestures: tuple[PlannedGesture, ...]
    """In order of time."""

    skipped: tuple[Accent, ...]
    """Accents for which no gesture came in time."""

    duration: float
    """Length of the speech [s]."""

    cost: float
    """Sum of all costs, weighted; of a skipped accent 5 to 15."""

    def motion(self) -> PlannedGestureMotion:
        """Return the motion of these gestures, from rest to rest."""
        library, blends, rest = self.graph.library, self.graph.blends, self.graph.rest
        still, rate = Ends.still(library.rest), library.rate
        segments, spans = [PlayedSegment(0.0, library.rest[None])], []
        for group in self._groups():
            first, last = group[0], group[-1]
            up, down = float(blends[rest, first.number]), float(blends[last.number, rest])
            left, again = first.start - up, last.end + down
            segments += [
                bridge(left, up, still, self._ends(first, leaving=False), rate),
                *self._join(group),
                bridge(last.end, down, self._ends(last, leaving=True), still, rate),
                PlayedSegment(again, library.rest[None]),
            ]
            begin = first.time_of(first.node.phrase.stroke[0])
            end = last.time_of(last.node.phrase.stroke[1])
            spans.append(RestToRestSpan(left, begin, end, again))
        ended = max([self.duration, *(span.again for span in spans[-1:])])
        return PlannedGestureMotion(library, tuple(segments), ended, weight_curve(spans))

    def _groups(self) -> list[list[PlannedGesture]]:
        """Return the gestures from rest to rest."""
        groups: list[list[PlannedGesture]] = []
        for gesture in self.gestures:
            if gesture.by_rest or not groups:
                groups.append([])
            groups[-1].append(gesture)
        return groups

    def _join(self, group: Sequence[PlannedGesture]) -> Iterator[PlayedSegment]:
        """Yield what is played of gestures, with bridges between them."""
        library = self.graph.library
        for number, gesture in enumerate(group):
            turns = library.recordings[gesture.node.phrase.recording].turns
            for (start, first), (end, last) in pairwise(gesture.knots):
                if last > first:
                    yield PlayedSegment(start, turns, float(first), (last - first) / (end - start))
            if number + 1 < len(group):
                after = group[number + 1]
                if after.start - gesture.end > SHORTEST_BRIDGE_S:
                    ends = self._ends(gesture, leaving=True), self._ends(after, leaving=False)
                    yield bridge(gesture.end, after.start - gesture.end, *ends, library.rate)

    def _ends(self, gesture: PlannedGesture, leaving: bool) -> Ends:
        library = self.graph.library
        frame = gesture.node.frames[int(leaving)]
        turns = library.recordings[gesture.node.phrase.recording].turns
        return Ends.of(turns, frame, library.rate, gesture.warp, leaving)


def knots_of(
    node: GestureNode, timings: Timings, number: int, apex: float, warp: float, rate: float
) -> tuple[tuple[float, int], ...]:
    """Return the times [s] of the frames between which a gesture is played evenly.

    `apex` is when its apex is [s]; `number` is that of the node.
    """
    first, last = node.frames
    top = min(node.phrase.apex, last)
    if timings.whole[number]:
        frames = (first, last)
        return tuple((apex + (frame - top) / rate * warp, frame) for frame in frames)
    stroke, held = node.phrase.stroke[0], max(node.phrase.stroke[1], top)
    begin, end = apex - (top - stroke) / rate, apex + (held - top) / rate
    return (
        (begin - (stroke - first) / rate * warp, first),
        (begin, stroke),
        (end, held),
        (end + (last - held) / rate * warp, last),
    )
