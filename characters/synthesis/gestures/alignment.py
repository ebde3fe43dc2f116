"""How a gesture is stretched so that its apex comes in time, and what that costs.

Source: Fernández-Baena 2015, sections 4.4.4 and 4.5 (M7, M9), with errata 8 and 10. A warp w is the
new length over the recorded one.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.gestures.graph import GestureGraph
from cubeling.characters.synthesis.gestures.nodes import GestureNode

CostModel = Literal["bodyspeech", "thesis"]
"""Which costs and warps: those of BodySpeech (M9), or those of the gesture motion graph (M7)."""

INVALID_COST = 10.0
"""Cost of a rule that is broken."""

WHOLE_WARPS = (1 / 1.5, 1.5)
"""Limits of the warp of a whole phrase, "thesis"."""

PHRASE_WARPS = (0.8, 1.2)
"""Limits of the warp of the phases around a stroke, "bodyspeech"."""

STROKE_WARPS = (0.9, 1.1)
"""Limits of the warp of a stroke alone, "bodyspeech"."""


@dataclass(frozen=True, eq=False)
class Timings:
    """How long gestures take before and after their apex; what is warped, and what is not."""

    before_fixed: Array
    """Before the apex, never warped, (nodes,) [s]."""

    before: Array
    """Before the apex, at w = 1, (nodes,) [s]."""

    after_fixed: Array
    """After the apex, never warped, (nodes,) [s]."""

    after: Array
    """After the apex, at w = 1, (nodes,) [s]."""

    low: Array
    """Least w of each gesture, (nodes,)."""

    high: Array
    """Greatest w of each gesture, (nodes,)."""

    whole: Array
    """Whether the stroke is warped as well, (nodes,)."""

    @staticmethod
    def of(graph: GestureGraph, model: CostModel) -> "Timings":
        """Return the timings of the nodes of a graph but rest."""
        rows = [_timing(node, graph.library.rate, model) for node in graph.nodes]
        before_fixed, before, after_fixed, after, low, high, whole = np.array(rows).T
        return Timings(before_fixed, before, after_fixed, after, low, high, whole > 0)

    @property
    def natural(self) -> Array:
        """From start to apex at w = 1, (nodes,) [s]."""
        return self.before_fixed + self.before

    def warp(self, available: Array) -> Array:
        """Return w so that apices are this long after the starts, (…, nodes) [s]."""
        return (available - self.before_fixed) / np.maximum(self.before, 1e-9)

    def after_apex(self, warps: Array) -> Array:
        """Return how long gestures go on after their apex, (…, nodes) [s]."""
        return self.after_fixed + warps * self.after

    def played_strength(self, strengths: Array, warps: Array) -> Array:
        """Return the GSI (…, nodes) of warped gestures: −2 ln w if the stroke is warped (M4)."""
        return strengths - np.where(self.whole, 2.0 * np.log(np.maximum(warps, 1e-9)), 0.0)


def warp_cost(warps: Array, low: Array | float, high: Array | float) -> Array:
    """Return the cost of warps: 0 at w = 1, 1 at the limits, infinite beyond (4.6, 4.9 corrected).

    >>> warp_cost(np.array([0.8, 1.0, 1.1, 1.3]), 0.8, 1.2).round(6).tolist()
    [1.0, 0.0, 0.5, inf]
    """
    cost = np.where(warps >= 1.0, (warps - 1.0) / (high - 1.0), (1.0 - warps) / (1.0 - low))
    return np.where(cost <= 1.0 + 1e-9, cost, np.inf)


def _timing(node: GestureNode, rate: float, model: CostModel) -> tuple[float, ...]:
    """Return a row of `Timings`."""
    first, last = node.frames
    stroke, stroke_end = node.phrase.stroke
    apex = min(node.phrase.apex, last)
    before, after = (apex - first) / rate, (last - apex) / rate
    if model == "thesis":
        return 0.0, before, 0.0, after, *WHOLE_WARPS, 1.0
    if stroke == first:  # nothing else can be warped
        return 0.0, before, 0.0, after, *STROKE_WARPS, 1.0
    held = max(stroke_end - apex, 0) / rate
    return (apex - stroke) / rate, (stroke - first) / rate, held, after - held, *PHRASE_WARPS, 0.0
