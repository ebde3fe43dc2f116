"""The tables and curves of chapter 3.5 of the thesis, from four clips: computed, not yet shown."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from cubeling.app.counted import quantity
from cubeling.characters import CharacterError
from cubeling.characters.motion import (
    Answers,
    Array,
    Comparison,
    EdgeCosts,
    MotionGraph,
    MotionLibrary,
    PartGraphs,
    Requests,
    SplitComparison,
    TransitionSummary,
    common_requests,
    graph_requests,
    merge_answers,
)

# Tables 3.2, 3.3 and 3.4 as the thesis prints them (Fernández-Baena 2015, chapter 3.5).
CRITICAL = {"SMG": 0.165, "BPMG": 0.105}
"""The least printed threshold at which all four clips are joined."""

TABLE_3_2 = {
    0.06: ((19.99, 14.24), (17.24, 4.34)),
    0.075: ((19.65, 13.61), (17.28, 4.42)),
    0.09: ((18.95, 13.30), (17.27, 4.41)),
    0.105: ((18.43, 12.92), (17.30, 4.40)),
    0.12: ((18.18, 12.74), (17.30, 4.37)),
    0.165: ((18.20, 12.53), (17.30, 4.37)),
}
"""By threshold: TBF and response of SMG, then of BPMG [frames at 60 Hz]."""

TABLE_3_3 = {
    "SMG": {
        (0, 1): (10.71, 6.35), (0, 2): (3.68, 0.43), (0, 3): (3.40, 0.63),
        (1, 0): (4.26, 0.84), (1, 2): (5.26, 0.84), (1, 3): (7.26, 0.84),
        (2, 0): (5.71, 2.52), (2, 1): (15.86, 11.50), (2, 3): (5.23, 2.91),
        (3, 0): (3.73, 0.01), (3, 1): (25.00, 18.23), (3, 2): (2.86, 0.00),
    },
    "BPMG": {
        (0, 1): (5.91, 0.00), (0, 2): (3.90, 0.00), (0, 3): (2.61, 0.02),
        (1, 0): (2.41, 0.00), (1, 2): (4.97, 0.00), (1, 3): (3.29, 0.00),
        (2, 0): (5.11, 0.06), (2, 1): (9.54, 1.53), (2, 3): (3.95, 0.15),
        (3, 0): (3.40, 0.00), (3, 1): (9.40, 0.01), (3, 2): (3.10, 0.00),
    },
}  # fmt: skip
"""LM and LM response from clip to clip [frames]."""

TABLE_3_4 = {
    (0, 1): "SP4b", (0, 2): "SP4b", (0, 3): "SP4b",
    (1, 0): "SP3a", (1, 2): "SP3a", (1, 3): "SP3a",
    (2, 0): "SP4b", (2, 1): "SP3a", (2, 3): "SP2",
    (3, 0): "SP4b", (3, 1): "SP3a", (3, 2): "SP2",
}  # fmt: skip
"""The best split profile from clip to clip."""


SPLIT_PROFILES = ("SP2", "SP3a", "SP3b", "SP4a", "SP4b", "SP5")
CURVE_FACTORS = np.geomspace(0.02, 4.0, 12)
"""Thresholds of the curves, as multiples of the standard graph's critical one."""


@dataclass
class Tables:
    """Rows of a table file, and the curves."""

    clips: tuple[str, ...]
    """C1 to C4: walk, run, long steps, slow."""

    critical: dict[str, float]
    """The least threshold that joins all clips, by method."""

    rows: list[tuple[str, str, str, str, str]] = field(default_factory=list)
    """Table, row, column, printed value, our value."""

    connectivity: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    """Thresholds and shares of frames, by profile."""

    cost: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    """Thresholds and mean costs of a transition, by profile; only where clips are joined."""

    def add(self, table: str, row: str, column: str, printed: object, ours: object) -> None:
        """Add a value beside the printed one."""
        texts = (f"{v:.2f}" if isinstance(v, float) else str(v) for v in (printed, ours))
        self.rows.append((table, row, column, *texts))  # type: ignore[arg-type]


def make_tables(
    library: MotionLibrary, stride: int, progress: Callable[[str], None] = lambda what: None
) -> Tables:
    """Return the tables of four clips: a walk, a run, a walk with long steps, a slow walk.

    Parameters
    ----------
    library
        The four clips, in this order.
    stride
        Frames from one request to the next; each asks for every other clip.
    progress
        Called with what is computed next.

    Raises
    ------
    CharacterError
        If there are not four clips, or nothing joins two of them.
    """
    if len(library.names) != 4:
        raise CharacterError(
            f"{quantity(len(library.names), 'clip')}: give four, a walk, a run, long steps and a "
            "slow walk"
        )
    progress("critical thresholds")
    whole = Comparison(library, EdgeCosts())
    splits = {profile: whole.split(profile) for profile in SPLIT_PROFILES}
    critical = {"SMG": whole.standard_threshold}
    critical |= {profile: split.threshold for profile, split in splits.items()}
    tables = Tables(library.names, critical)
    progress("table 3.2")
    _table_3_2(tables, whole, splits["SP4b"], stride)
    progress("table 3.3")
    _table_3_3(tables, whole, splits["SP4b"], stride)
    progress("table 3.4")
    _table_3_4(tables, library, stride)
    for profile in ("SMG", *SPLIT_PROFILES):
        progress(f"curves of {profile}")
        _curves(tables, whole, splits.get(profile), profile, 2 * stride)
    return tables


def _answers(
    whole: Comparison, split: SplitComparison | None, threshold: float, stride: int
) -> Answers:
    """Return the answers of the standard graph, or of part graphs, at a threshold."""
    if split is None:
        graph = whole.standard(threshold)
        return whole.answers(graph, graph_requests(whole.library, graph.kept, stride))
    graphs = split.graphs(threshold)
    return split.answers(graphs, graph_requests(whole.library, graphs.kept, stride))


def _table_3_2(tables: Tables, whole: Comparison, split: SplitComparison, stride: int) -> None:
    """Find TBF and response, at the printed multiples of the critical threshold."""
    for st, printed in TABLE_3_2.items():
        methods = (("SMG", None, "SMG"), ("BPMG", split, "SP4b"))
        for (method, parts, name), values in zip(methods, printed, strict=True):
            threshold = st / CRITICAL[method] * tables.critical[name]
            row = f"{st:g} (ours {threshold:.3f})"
            try:
                answers = _answers(whole, parts, threshold, stride)
            except CharacterError:  # nothing is joined yet
                answers = {}
            both = merge_answers(answers)
            ours = (both.duration, both.response) if both.outcomes else ("–", "–")
            for column, value, own in zip(("TBF", "response"), values, ours, strict=True):
                tables.add("3.2", row, f"{method} {column}", value, own)


def _table_3_3(tables: Tables, whole: Comparison, split: SplitComparison, stride: int) -> None:
    """Find duration and response from clip to clip, each method at its critical threshold."""
    standard = whole.standard(tables.critical["SMG"])
    graphs = split.graphs(tables.critical["SP4b"])
    asked = common_requests(standard, graphs, stride)
    found = {"SMG": whole.answers(standard, asked), "BPMG": split.answers(graphs, asked)}
    for method, printed in TABLE_3_3.items():
        for (origin, target), (duration, response) in printed.items():
            own = found[method].get((origin, target), TransitionSummary(()))
            row = f"C{origin + 1} → C{target + 1}"
            ours = (own.duration, own.response) if own.outcomes else ("–", "–")
            tables.add("3.3", row, f"{method} duration", duration, ours[0])
            tables.add("3.3", row, f"{method} response", response, ours[1])


def _table_3_4(tables: Tables, library: MotionLibrary, stride: int) -> None:
    """Find the best profile of each pair: graphs of both clips alone, at one threshold.

    It is the least one at which any profile joins both. The largest connectivity wins (erratum 7),
    then the shortest duration.
    """
    for origin in range(4):
        for target in range(origin + 1, 4):
            pair = Comparison(library.only((origin, target)), EdgeCosts())
            splits = {profile: pair.split(profile) for profile in SPLIT_PROFILES}
            least = min(split.threshold for split in splits.values())
            found = {profile: split.graphs(least) for profile, split in splits.items()}
            best = {}
            for way in ((0, 1), (1, 0)):
                ranks = {
                    name: _rank(splits[name], found[name], way, stride) for name in SPLIT_PROFILES
                }
                best[way] = min(SPLIT_PROFILES, key=ranks.__getitem__)
            for (a, b), name in best.items():
                ends = (origin, target)[a], (origin, target)[b]
                row = f"C{ends[0] + 1} → C{ends[1] + 1}"
                tables.add("3.4", row, "best profile", TABLE_3_4[ends], name)


def _rank(
    split: SplitComparison, graphs: PartGraphs, way: tuple[int, int], stride: int
) -> tuple[float, float]:
    """Return what makes a profile worse: less connectivity, then a longer duration."""
    asked = graph_requests(graphs.library, graphs.kept, stride)
    own: Requests = {way: asked[way]} if way in asked else {}
    both = merge_answers(split.answers(graphs, own))
    duration = both.duration if both.outcomes else np.inf
    return -round(graphs.connectivity, 2), duration


def _curves(
    tables: Tables, whole: Comparison, split: SplitComparison | None, name: str, stride: int
) -> None:
    """Find connectivity and cost against the threshold."""
    thresholds = tables.critical["SMG"] * CURVE_FACTORS
    shares, joined, costs = [], [], []
    for threshold in thresholds.tolist():
        try:
            graph: MotionGraph | PartGraphs = (
                whole.standard(threshold) if split is None else split.graphs(threshold)
            )
        except CharacterError:  # nothing is joined yet
            shares.append(0.0)
            continue
        shares.append(graph.connectivity)
        asked = graph_requests(whole.library, graph.kept, stride)
        both = merge_answers(
            whole.answers(graph, asked)
            if isinstance(graph, MotionGraph)
            else split.answers(graph, asked)  # type: ignore[union-attr]
        )
        if both.outcomes:
            joined.append(threshold)
            costs.append(both.cost)
    tables.connectivity[name] = thresholds, np.array(shares)
    tables.cost[name] = np.array(joined), np.array(costs)
    for threshold, share in zip(thresholds.tolist(), shares, strict=True):
        tables.add("connectivity", f"{threshold:.4f}", name, "", float(share))
    for threshold, cost in zip(joined, costs, strict=True):
        tables.add("cost", f"{threshold:.4f}", name, "", f"{cost:.4f}")
