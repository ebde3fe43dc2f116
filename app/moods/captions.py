"""What is written about a picture of moods: heading, legend, and how long each mood lasted."""

from collections.abc import Sequence

import numpy as np

from app.moods.curves import Curve, spans
from app.moods.drawing import Drawing, text_width
from app.moods.history import Felt, History
from app.moods.tints import INK, LINES, OBSERVED, QUIET
from app.moods.wire import Wire

OWN = "the scenario's own personality"


def heading(drawing: Drawing, left: float, history: History, again: Sequence[Felt]) -> None:
    """Say which session it is, how it was recorded, and who felt it again."""
    told = history.about
    drawing.text(f"Moods of {history.name}", left, 42, 20, INK, bold=True)
    parts = [f"scenario {told.scenario}", f"{told.duration:.1f} s"]
    parts.append(f"recorded with {told.personality or OWN}")
    if again:
        names = [felt.who for felt in again]
        listed = " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
        parts.append(f"felt again by {listed}")
        if len(names) > 1:
            parts.append(f"bands: {names[0]}")
    drawing.text("   ·   ".join(parts), left, 64, 12, QUIET)


def legend(drawing: Drawing, left: float, curves: Sequence[Curve], wire: Wire) -> None:
    """Name the lines in a row."""
    entries = [(curve.name, curve.colour, curve.width, curve.dashes) for curve in curves]
    if len(wire.acknowledged.times):
        median = 1e3 * float(np.median(wire.delays)) if len(wire.delays) else 0.0
        late = f" (median {median:.0f} ms later)" if median >= 0.5 else ""
        entries.append((f"acknowledged{late}", LINES[1][0], 1.6, (4.0, 4.0)))
    if wire:
        entries.append(("observed on the robot", OBSERVED, 5.0, ()))
    x = left
    for name, colour, width, dashes in entries:
        drawing.line([(x, 91), (x + 30, 91)], colour, width, dashes)
        drawing.text(name, x + 37, 95, 11.5, INK)
        x += 58 + text_width(name, 11.5)


def shares(drawing: Drawing, x: float, y: float, curves: Sequence[Curve]) -> None:
    """Say how long each label lasted."""
    drawing.text("Time in each mood", x, y, 11.5, INK, bold=True)
    for curve in curves:
        if len(curves) > 1:
            y += 16
            drawing.text(curve.name, x, y, 10, QUIET)
        y += 13 if len(curves) > 1 else 18
        seconds: dict[str, float] = {}
        for label, start, end in spans(curve.felt.labels, curve.felt.times):
            seconds[label] = seconds.get(label, 0.0) + end - start
        most = sorted(seconds.items(), key=lambda item: -item[1])[:4]
        told = " · ".join(f"{label} {length:.1f} s" for label, length in most)
        drawing.text(told, x, y, 10, INK)
