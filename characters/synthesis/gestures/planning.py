"""Choosing gestures for the accents of a speech, by greedy or beam search.

Source: Fernández-Baena 2015, sections 4.4.4 and 4.5 (M7, M9), with errata 8 to 11.
"""

from bisect import bisect
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.speech import Accent
from cubeling.characters.synthesis.choices import Database
from cubeling.characters.synthesis.gestures.alignment import INVALID_COST, CostModel, Timings
from cubeling.characters.synthesis.gestures.graph import GestureGraph
from cubeling.characters.synthesis.gestures.library import GestureLibrary
from cubeling.characters.synthesis.gestures.plan import (
    GestureCosts,
    GesturePlan,
    PlannedGesture,
    knots_of,
)
from cubeling.characters.synthesis.gestures.rules import IntensityRule, SynchronyRule
from cubeling.characters.synthesis.gestures.search import BeamSearch, SearchStep, SearchWeights

EQUAL_COST = 1e-3
"""Gestures whose costs differ by less are equals [of a cost]."""


@dataclass(frozen=True)
class GestureSettings:
    """How gestures are chosen."""

    model: CostModel = "bodyspeech"
    """Which costs choose gestures, and which warps fit them."""

    database: Database = "full"
    """Which phrases are used."""

    threshold: float | None = None
    """Similarity threshold of the graph; None for the smallest that keeps every phrase."""

    beam: int = 20
    """Width of the beam search; 1 is the greedy search."""

    smooth_weight: float = 1.0
    """Weight of the cost of transitions."""

    strength_weight: float = 1.0
    """Weight of the intensity rule, or of the emphasis; 0 switches it off."""

    time_weight: float = 1.0
    """Weight of the cost of warps and holds."""

    variety: float = 0.5
    """Cost of the same phrase again, less the longer ago it was, and of the same hands for long."""

    synchrony: SynchronyRule = field(default_factory=SynchronyRule)
    """Window of the anticipation, which is drawn at random."""

    anticipations: int = 3
    """How many are drawn for each accent; one that fits is taken. 1 is the thesis."""

    intensity: IntensityRule | None = None
    """The intensity rule of the model "thesis"; None spreads it over the library."""

    accent_floor: float = 0.4
    """Strength of an accent that counts as 0: detectors report no weak ones. 0 is the thesis."""

    longest_hold_s: float = 0.8
    """How long hands may be held between two gestures [s]; 0 is the thesis to the letter."""

    min_spacing_s: float = 0.6
    """Of accents that are closer, the stronger carries a gesture [s]."""

    first_s: float = 0.65
    """Earlier accents carry none: hands need time to rise [s]."""


DEFAULT_SETTINGS = GestureSettings()


class GesturePlanner:
    """Plans gestures of a library for the accents of speeches.

    Parameters
    ----------
    library
        The gestures.
    settings
        How they are chosen.
    graph
        What may follow what; None makes the graph that the settings ask for.
    """

    def __init__(
        self,
        library: GestureLibrary,
        settings: GestureSettings = DEFAULT_SETTINGS,
        graph: GestureGraph | None = None,
    ) -> None:
        self.settings = settings
        """How gestures are chosen."""
        self.graph = graph or GestureGraph.of(
            library.database(settings.database), settings.threshold
        )
        """What may follow what."""
        self._timings = Timings.of(self.graph, settings.model)
        strengths = self.graph.strengths
        self.intensity = settings.intensity or IntensityRule.spread_over(strengths)
        """The intensity rule."""
        self._weakest, self._range = strengths.min(), max(float(np.ptp(strengths)), 1e-9)
        smooth, time = (max(w, EQUAL_COST) for w in (settings.smooth_weight, settings.time_weight))
        self._weights = SearchWeights(smooth, time, settings.variety, settings.longest_hold_s)

    @staticmethod
    def of(graph: GestureGraph, settings: GestureSettings = DEFAULT_SETTINGS) -> "GesturePlanner":
        """Return a planner for a graph that is there already."""
        return GesturePlanner(graph.library, settings, graph)

    def plan(
        self, accents: Sequence[Accent], duration: float, emphasis: float = 0.0, seed: int = 0
    ) -> GesturePlan:
        """Return gestures for the accents of a speech.

        Parameters
        ----------
        accents
            The accents, in order.
        duration
            Length of the speech [s]; the gestures may end later.
        emphasis
            The gesture slider, −1…1: added to the strength of accents, which stay in 0…1.
        seed
            Of the anticipations, and of choices between equals.
        """
        late = [each for each in accents if each.time >= self.settings.first_s]
        carried = carrying_accents(late, self.settings.min_spacing_s)
        rng, window = np.random.default_rng(seed), self.settings.synchrony
        shape = len(carried), self.settings.anticipations
        leads = rng.uniform(window.shortest, window.longest, shape)
        favour = rng.uniform(0.0, EQUAL_COST, (*shape, len(self.graph.nodes)))
        apices = np.array([each.time for each in carried])[:, None] - leads
        strengths = [self._emphasize(each.strength, emphasis) for each in carried]
        widths = sorted({1, self.settings.beam})
        searches = [self._search(width, apices, strengths, favour) for width in widths]
        best = min(searches, key=lambda search: search.cost)
        gestures, skipped = [], []
        for accent, strength, (step, state) in zip(carried, strengths, best.path(), strict=True):
            if step.node[state] < 0:
                skipped.append(accent)
            else:
                gestures.append(self._gesture(accent, strength, step, state))
        return GesturePlan(self.graph, tuple(gestures), tuple(skipped), duration, best.cost)

    def _search(
        self, width: int, apices: Array, strengths: list[float], favour: Array
    ) -> BeamSearch:
        """Return a finished search of a width; the greedy one, of width 1, looks no further."""
        search = BeamSearch(self.graph, self._timings, self._weights, width)
        skips = [INVALID_COST * (0.5 + strength) for strength in strengths]
        for number, strength in enumerate(strengths):
            ways, ahead = search.ways(apices[number]), None
            cost = self.settings.strength_weight * self._strength_cost(strength, ways.warp)
            if width > 1 and number + 1 < len(strengths):
                ahead = float(apices[number + 1].max()), skips[number + 1]
            search.step(apices[number], ways, cost, skips[number], favour[number], ahead)
        return search

    def _emphasize(self, strength: float, emphasis: float) -> float:
        """Return the strength of an accent above the floor, with the slider, 0…1 (erratum 11)."""
        floor = self.settings.accent_floor
        return min(max((strength - floor) / (1.0 - floor) + emphasis, 0.0), 1.0)

    def _strength_cost(self, strength: float, warps: Array) -> Array:
        """Return what the strength of gestures costs for an accent, like their warps (…, nodes)."""
        played = self._timings.played_strength(self.graph.strengths, warps)
        if self.settings.model == "thesis":
            weakest, strongest = self._weakest, self._weakest + self._range
            centre = np.clip(self.intensity.centre(strength), weakest, strongest)
            return np.where(np.abs(played - centre) < self.intensity.margin, 0.0, INVALID_COST)
        shares: Array = (played - self._weakest) / self._range
        return np.abs(strength - shares)

    def _gesture(
        self, accent: Accent, strength: float, step: SearchStep, state: int
    ) -> PlannedGesture:
        number, ways, apex = int(step.node[state]), step.ways, float(step.apex[state])
        node, warp = self.graph.nodes[number], float(ways.warp[state])
        weight = self.settings.strength_weight
        return PlannedGesture(
            accent,
            strength,
            node,
            number,
            knots_of(node, self._timings, number, apex, warp, self.graph.library.rate),
            apex,
            warp,
            float(ways.hold[state]),
            bool(ways.by_rest[state]),
            float(self._timings.played_strength(self.graph.strengths, np.array(warp))[number]),
            GestureCosts(
                float(ways.smooth[state]),
                float(step.strength[state]) / weight if weight else 0.0,
                float(ways.time[state]),
                float(step.repetition[state]),
            ),
        )


def carrying_accents(accents: Sequence[Accent], min_spacing_s: float) -> list[Accent]:
    """Return the accents that carry a gesture: of those that are closer, the stronger ones.

    >>> accents = [Accent(1.0, 0.5), Accent(1.3, 0.9), Accent(2.0, 0.4)]
    >>> [each.time for each in carrying_accents(accents, 0.5)]
    [1.3, 2.0]
    """
    times: list[float] = []  # of those that were chosen, in order
    chosen: list[Accent] = []
    for accent in sorted(accents, key=lambda each: -each.strength):
        place = bisect(times, accent.time)
        beside = times[max(place - 1, 0) : place + 1]
        if all(abs(accent.time - time) >= min_spacing_s for time in beside):
            times.insert(place, accent.time)
            chosen.append(accent)
    return sorted(chosen, key=lambda each: each.time)
