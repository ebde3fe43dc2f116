"""Phases as annotators write them: intervals of time with a word, one or several tiers of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from cubeling.characters.synthesis.gestures.marks import GestureMarks

WORDS = {
    "preparation": ("prep",),
    "hold": ("hold",),
    "stroke": ("stroke",),
    "retraction": ("retract", "recover", "return"),
    "apex": ("apex", "emphasis"),
}
"""Words of phases, and how what annotators write contains them (Kita's and McNeill's terms)."""

JOINED_S = 0.3
"""A phase belongs to a stroke from which it is no farther away [s]."""


@dataclass(frozen=True)
class PhaseInterval:
    """A word that holds from a time to a time [s]."""

    start: float
    end: float
    word: str


def gestures_of(intervals: Sequence[PhaseInterval]) -> Iterator[GestureMarks]:
    """Yield the gesture of each stroke; strokes of both hands at a time are one."""
    phases = {phase: _of_phase(phase, intervals) for phase in WORDS}
    strokes: list[PhaseInterval] = []
    for each in phases["stroke"]:
        if strokes and each.start < strokes[-1].end:
            strokes[-1] = replace(strokes[-1], end=max(strokes[-1].end, each.end))
        elif each.end > each.start:
            strokes.append(each)
    edges = [0.0, *(each.end for each in strokes)], [*(each.start for each in strokes[1:]), 1e9]
    for stroke, after, before in zip(strokes, *edges, strict=False):
        held = [each for each in phases["hold"] if after <= each.start and each.end <= before]
        early = [each for each in held if each.end <= stroke.start]
        ready = min((each.start for each in early if _joins(each, stroke)), default=stroke.start)
        late = [each for each in held if each.start >= stroke.end and _joins(stroke, each)]
        relax = max((each.end for each in late), default=stroke.end)
        starts = [p.start for p in phases["preparation"] if after <= p.start < stroke.start]
        ends = [r.end for r in phases["retraction"] if relax <= r.end <= before]
        apices = [a.start for a in phases["apex"] if stroke.start <= a.start <= relax]
        yield GestureMarks(
            min(starts, default=ready),
            ready,
            stroke.start,
            apices[0] if apices else stroke.end,
            stroke.end,
            relax,
            max(ends, default=relax),
        )


def intervals_of(marks: GestureMarks) -> Iterator[PhaseInterval]:
    """Yield the phases of a gesture that last, with their words."""
    end = marks.relax if marks.end is None else marks.end
    start = marks.ready if marks.start is None else marks.start
    times = start, marks.ready, marks.stroke_start, marks.stroke_end, marks.relax, end
    words = "preparation", "hold", "stroke", "hold", "retraction"
    for word, (first, last) in zip(words, pairwise(times), strict=True):
        if last > first:
            yield PhaseInterval(first, last, word)


def _of_phase(phase: str, intervals: Sequence[PhaseInterval]) -> list[PhaseInterval]:
    """Return the intervals of a phase in the order of time."""
    words = WORDS[phase]
    own = [each for each in intervals if any(word in each.word.lower() for word in words)]
    if phase == "stroke":  # "post-stroke hold"
        own = [each for each in own if "hold" not in each.word.lower()]
    return sorted(own, key=lambda each: each.start)


def _joins(before: PhaseInterval, after: PhaseInterval) -> bool:
    return after.start - before.end <= JOINED_S
