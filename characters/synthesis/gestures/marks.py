"""Times of gestures that people marked, and how far found ones are from them.

The names are those of BML's sync points. Sources: BML 1.0; the stroke F1 is that of
Ghaleb et al. (2024), "Co-speech gesture detection through multi-phase sequence labeling".
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cubeling.characters.synthesis.gestures.library import Bounds, GesturePhrase
from cubeling.characters.synthesis.gestures.segmentation import (
    HOLD,
    PREPARATION,
    REST,
    RETRACTION,
    STROKE,
    Labels,
)

LABELS = PREPARATION, HOLD, STROKE, HOLD, RETRACTION
"""The labels of the phases of a phrase."""

SAME_STROKE = 0.5
"""A found stroke is a marked one if they share this part of their union."""

NEAR_APEX_S = 0.1
"""How far a found apex may be from the marked one [s]."""


@dataclass(frozen=True)
class GestureMarks:
    """When a gesture does what, in seconds of its clip."""

    start: float | None
    """Its preparation begins; None: where the clip, or the gesture before it, ends."""

    ready: float
    """Its preparation ends: the hand is where the stroke begins, and may hold there."""

    stroke_start: float
    """Its stroke begins, after the hold before it."""

    stroke: float
    """Its apex: the emphasis."""

    stroke_end: float
    """Its stroke ends; the hand may hold there."""

    relax: float
    """Its retraction begins, after the hold that follows the stroke."""

    end: float | None
    """Its retraction ends; None: at the end of the clip."""

    @classmethod
    def of(cls, phrase: GesturePhrase, rate: float) -> "GestureMarks":
        """Return the times of a phrase that was found."""
        start, ready, stroke_start, stroke_end, relax, end = (
            round(frame / rate, 3) for frame in phrase.bounds
        )
        apex = round(phrase.apex / rate, 3)
        return cls(start, ready, stroke_start, apex, stroke_end, relax, end)

    def frames(self, rate: float, frames: int) -> tuple[Bounds, int]:
        """Return the bounds and the apex as frames of a clip, in order and inside of it."""
        last = frames - 1
        end = last if self.end is None else round(self.end * rate)
        times = self.ready, self.stroke_start, self.stroke_end, self.relax
        inner = [round(time * rate) for time in times]
        raw = [round((self.start or 0.0) * rate), *inner, end]
        a, b, c, d, e, f = np.maximum.accumulate(np.clip(raw, 0, last)).tolist()
        c = min(c, last - 1)  # a stroke has two frames
        d = max(d, c + 1)
        bounds = min(a, c), min(b, c), c, d, max(e, d), max(f, d)
        return bounds, int(np.clip(round(self.stroke * rate), c, bounds[5]))


MarkTable = Mapping[str, Sequence[GestureMarks]]
"""Marks by the name of the clip, without suffix."""


def marks_of(table: MarkTable, name: str) -> Sequence[GestureMarks]:
    """Return the marks of a clip; a table of one clip is that of any."""
    found = table.get(Path(name).stem)
    if found is None and len(table) == 1:
        (found,) = table.values()
    return found or ()


def marked_labels(phrases: Sequence[Bounds], frames: int) -> Labels:
    """Return the label of each frame, (frames,), from the bounds of phrases."""
    labels = np.full(frames, REST, np.int8)
    for bounds in phrases:
        for label, first, last in zip(LABELS, bounds[:-1], bounds[1:], strict=True):
            labels[first:last] = label
        labels[bounds[3]] = STROKE
    return labels


@dataclass(frozen=True)
class Agreement:
    """How found gestures agree with marked ones; agreements of clips add up."""

    marked: int = 0
    """How many strokes a person marked."""

    found: int = 0
    """How many strokes were found in their place."""

    met: int = 0
    """Marked strokes that a found one overlaps."""

    same: int = 0
    """Marked strokes that share half of their union with a found one."""

    shared_s: float = 0.0
    """Time in marked and in found strokes [s]."""

    marked_s: float = 0.0
    """Time in marked strokes [s]."""

    found_s: float = 0.0
    """Time in found strokes [s]."""

    apex_errors: tuple[float, ...] = ()
    """How much later each found apex is than that of the marked stroke that it overlaps [s]."""

    @classmethod
    def of(cls, marked: Sequence[GestureMarks], found: Sequence[GestureMarks]) -> "Agreement":
        """Compare the gestures of one clip."""
        result = cls(marked=len(marked), found=len(found), marked_s=_length(marked))
        result += cls(found_s=_length(found))
        for each in marked:
            overlaps = [_overlap(each, other) for other in found]
            shared = max(overlaps, default=0.0)
            if shared <= 0.0:
                continue
            best = found[int(np.argmax(overlaps))]
            union = _length([each, best]) - shared
            result += cls(
                met=1,
                same=int(shared >= SAME_STROKE * union),
                shared_s=sum(overlaps),
                apex_errors=(best.stroke - each.stroke,),
            )
        return result

    def __add__(self, other: "Agreement") -> "Agreement":
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return Agreement(*(a + b for a, b in pairs))

    @property
    def miss_share(self) -> float:
        """Share of marked strokes that no found one overlaps."""
        return 1.0 - self.met / max(self.marked, 1)

    @property
    def overlap_f1(self) -> float:
        """F1 of strokes; a stroke is found if a found one overlaps it."""
        return _f1(self.met, self.marked, self.found)

    @property
    def same_f1(self) -> float:
        """F1 of strokes; a stroke is found if a found one shares half of their union."""
        return _f1(self.same, self.marked, self.found)

    @property
    def time_f1(self) -> float:
        """F1 of the time in strokes."""
        return _f1(self.shared_s, self.marked_s, self.found_s)

    @property
    def apex_share(self) -> float:
        """Share of marked strokes whose apex is found within 0.1 s."""
        near = sum(abs(error) <= NEAR_APEX_S + 1e-9 for error in self.apex_errors)
        return near / max(self.marked, 1)


def _f1(both: float, marked: float, found: float) -> float:
    return 2.0 * both / (marked + found) if marked + found else 0.0


def _length(marks: Sequence[GestureMarks]) -> float:
    return sum(each.stroke_end - each.stroke_start for each in marks)


def _overlap(a: GestureMarks, b: GestureMarks) -> float:
    return max(min(a.stroke_end, b.stroke_end) - max(a.stroke_start, b.stroke_start), 0.0)
