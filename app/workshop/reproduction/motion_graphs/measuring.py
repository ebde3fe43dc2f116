"""The tables and curves of chapter 3.5 of the thesis, measured on four clips."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeAlias

import numpy as np

from cubeling.app.counted import quantity
from cubeling.app.workshop.reproduction.motion_graphs.printed import CRITICAL, TABLE_3_2
from cubeling.characters import CharacterError
from cubeling.characters.motion import (
    PRINTED_COSTS,
    PRINTED_SEARCH,
    Answers,
    Array,
    Comparison,
    EdgeCosts,
    MotionGraph,
    MotionLibrary,
    PartGraphs,
    SearchSettings,
    SplitComparison,
    TransitionPlanner,
    TransitionSummary,
    common_requests,
    graph_requests,
    merge_answers,
    part_outcome,
)

SPLIT_PROFILES = ("SP2", "SP3a", "SP3b", "SP4a", "SP4b", "SP5")
CURVE_FACTORS = np.geomspace(0.02, 4.0, 12)
"""Thresholds of the curves, as multiples of the standard graph's critical one."""

INNER_TARGETS = 6
"""Frames of a clip that are asked for from inside it, in the diagonal of table 3.4."""

Key: TypeAlias = tuple[str, str, str]
"""Table, row and column of a value."""

Curves: TypeAlias = dict[str, tuple[Array, Array]]
"""Thresholds and values, by split profile."""

Value: TypeAlias = float | str | None
"""A number, the name of a profile, or nothing where no request was answered."""


@dataclass(frozen=True)
class SearchWay:
    """How graphs are built, searched, and measured."""

    name: str

    costs: EdgeCosts
    """Which jumps there are."""

    search: SearchSettings
    """How the parts find their ways."""

    printed: bool
    """Whether it is that of the thesis: table 3.3 has the shortest durations of all targets (eq.
    3.4) instead of those of the cheapest transitions, and only answers in the window count."""


AS_PRINTED = SearchWay("as printed", PRINTED_COSTS, PRINTED_SEARCH, printed=True)
OURS = SearchWay("ours", EdgeCosts(), SearchSettings(), printed=False)


@dataclass
class Measurement:
    """What was measured on one choice of four clips."""

    clips: tuple[str, ...]
    """C1 to C4: walk, run, long steps, slow."""

    critical: dict[str, float] = field(default_factory=dict)
    """The least threshold that joins all clips, by method, of the last of the ways."""

    values: dict[str, dict[Key, Value]] = field(default_factory=dict)
    """What each way gives, by its name."""

    joined: dict[str, dict[Key, int]] = field(default_factory=dict)
    """Of table 3.2: how many clips are joined, which is the colour of a cell."""

    pairs: dict[str, tuple[int, int, int]] = field(default_factory=dict)
    """Of table 3.3: in how many pairs the parts are shorter, and sooner, and how many there are."""

    connectivity: Curves = field(default_factory=dict)
    """Thresholds and shares of frames, by profile."""

    cost: Curves = field(default_factory=dict)
    """Thresholds and mean costs of a transition, by profile; only where clips are joined."""


def measure(
    library: MotionLibrary,
    stride: int,
    ways: Sequence[SearchWay] = (AS_PRINTED, OURS),
    curves: bool = True,
    progress: Callable[[str], None] = lambda what: None,
) -> Measurement:
    """Return the tables of four clips: a walk, a run, a walk with long steps, a slow walk.

    Parameters
    ----------
    library
        The four clips, in this order.
    stride
        Frames from one request to the next; each asks for every other clip.
    ways
        The ways to compare.
    curves
        Whether to measure the curves too, of the last way.
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
    found = Measurement(library.names)
    for way in ways:
        progress(f"critical thresholds, {way.name}")
        whole = Comparison(library, way.costs)
        splits = {profile: whole.split(profile) for profile in SPLIT_PROFILES}
        found.critical = {"SMG": whole.standard_threshold}
        found.critical |= {profile: split.threshold for profile, split in splits.items()}
        found.values[way.name], found.joined[way.name] = {}, {}
        for table, make in (("3.2", _table_3_2), ("3.3", _table_3_3), ("3.4", _table_3_4)):
            progress(f"table {table}, {way.name}")
            make(found, way, whole, splits["SP4b"], stride)
    for profile in ("SMG", *SPLIT_PROFILES) if curves else ():
        progress(f"curves of {profile}")
        _curves(found, whole, splits.get(profile), profile, 2 * stride)
    return found


def _table_3_2(
    found: Measurement, way: SearchWay, whole: Comparison, split: SplitComparison, stride: int
) -> None:
    """Find TBF and response, at the printed multiples of the critical threshold."""
    values, library = found.values[way.name], whole.library
    known: dict[tuple[int, ...], Answers] = {}  # a graph of as many edges is the same one
    for st in TABLE_3_2:
        for method, profile in (("SMG", "SMG"), ("BPMG", "SP4b")):
            threshold = st / CRITICAL[method] * found.critical[profile]
            joined, answers = 0, Answers()
            try:
                graph = whole.standard(threshold) if method == "SMG" else split.graphs(threshold)
            except CharacterError:  # nothing is joined yet
                pass
            else:
                joined = len(graph.joined_clips)
                asked = graph_requests(library, graph.kept, stride)
                if isinstance(graph, MotionGraph):
                    answers = whole.answers(graph, asked)
                else:
                    size = tuple(len(each.edges) for each in graph.graphs)
                    if size not in known:
                        known[size] = split.answers(graph, asked, way.search)
                    answers = known[size]
            both = merge_answers(answers)
            row = f"{st:g}"
            for column, value in zip(("TBF", "response"), _means(way, both), strict=True):
                values["3.2", row, f"{method} {column}"] = value
                found.joined[way.name]["3.2", row, f"{method} {column}"] = joined
            values["3.2", row, f"{method} st"] = threshold
            values["3.2", row, f"{method} clips"] = float(joined)
            if method == "BPMG":
                values["3.2", row, "BPMG no answer [%]"] = _unanswered(way, both)


def _means(way: SearchWay, answers: TransitionSummary) -> tuple[Value, Value]:
    """Return the mean duration and response of what counts as an answer."""
    counted = answers.where(answers.answered) if way.printed else answers
    return (counted.duration, counted.response) if counted.outcomes else (None, None)


def _unanswered(way: SearchWay, answers: TransitionSummary) -> Value:
    """Return the share of requests without an answer [%]; our own search answers all."""
    if not answers.outcomes:
        return None
    return 100.0 * float(1.0 - answers.answered.mean()) if way.printed else 0.0


def _table_3_3(
    found: Measurement, way: SearchWay, whole: Comparison, split: SplitComparison, stride: int
) -> None:
    """Find duration and response from clip to clip, each method at its critical threshold.

    Only requests that both methods answer are compared.
    """
    values = found.values[way.name]
    standard = whole.standard(found.critical["SMG"])
    graphs = split.graphs(found.critical["SP4b"])
    asked = common_requests(standard, graphs, stride)
    if way.printed:
        own, parts = whole.shortest(standard, asked), split.shortest(graphs, asked, way.search)
    else:
        own, parts = whole.answers(standard, asked), split.answers(graphs, asked, way.search)
    shorter = sooner = pairs = 0
    for (origin, target), answers in parts.items():
        row = f"C{origin + 1} → C{target + 1}"
        both = answers.answered if way.printed else np.ones(len(answers.outcomes), bool)
        pair = own[origin, target].where(both), answers.where(both)
        for method, each in zip(("SMG", "BPMG"), pair, strict=True):
            for column, value in zip(("duration", "response"), _means(way, each), strict=True):
                values["3.3", row, f"{method} {column}"] = value
        values["3.3", row, "BPMG no answer [%]"] = _unanswered(way, answers)
        if both.any():
            pairs += 1
            shorter += pair[1].duration < pair[0].duration
            sooner += pair[1].response < pair[0].response
    found.pairs[way.name] = shorter, sooner, pairs


def _table_3_4(
    found: Measurement, way: SearchWay, whole: Comparison, split: SplitComparison, stride: int
) -> None:
    """Find the best profile of each pair: graphs of both clips alone, at one threshold.

    As printed that is the one which joins all four clips; in our own way, the least one at which
    any profile joins both. Inside a clip it is the former. The largest connectivity wins (erratum
    7), then what is answered, then the shortest duration.
    """
    values = found.values[way.name]
    for origin in range(4):
        for target in range(origin, 4):
            clips = (origin,) if origin == target else (origin, target)
            pair = Comparison(whole.library.only(clips), way.costs)
            splits = {profile: pair.split(profile) for profile in SPLIT_PROFILES}
            threshold = found.critical["SP4b"]
            if not way.printed and origin != target:
                threshold = min(each.threshold for each in splits.values())
            graphs = _most_connected(splits, threshold)
            for here, there in {(0, len(clips) - 1), (len(clips) - 1, 0)}:
                ranks = {
                    profile: _rank(way, splits[profile], own, (here, there), stride)
                    for profile, own in graphs.items()
                }
                key = "3.4", f"C{clips[here] + 1}", f"C{clips[there] + 1}"
                values[key] = min(graphs, key=ranks.__getitem__, default=None)


def _most_connected(
    splits: Mapping[str, SplitComparison], threshold: float
) -> dict[str, PartGraphs]:
    """Return the graphs of the profiles that connect most frames, to a percent; none if none do."""
    found: dict[str, PartGraphs] = {}
    shared: dict[str, MotionGraph] = {}  # the paths in a part serve all of its profiles
    for profile, each in splits.items():
        try:
            own = each.graphs(threshold)
        except CharacterError:  # it connects nothing
            continue
        named = zip(own.parts, own.graphs, strict=True)
        same = tuple(shared.setdefault(part.name, graph) for part, graph in named)
        found[profile] = PartGraphs(own.parts, same)
    shares = {profile: round(own.connectivity, 2) for profile, own in found.items()}
    most = max(shares.values(), default=0.0)
    return {profile: own for profile, own in found.items() if shares[profile] == most > 0.0}


def _rank(
    way: SearchWay, split: SplitComparison, graphs: PartGraphs, pair: tuple[int, int], stride: int
) -> tuple[float, float]:
    """Return what makes a profile worse: fewer answers, then a longer duration."""
    if pair[0] == pair[1]:
        answers = _inner_answers(way, graphs, stride)
    else:
        asked = graph_requests(graphs.library, graphs.kept, stride)
        own = {pair: asked[pair]} if pair in asked else {}
        find = split.shortest if way.printed else split.answers
        answers = merge_answers(find(graphs, own, way.search))
    duration = _means(way, answers)[0]
    answered = float(answers.answered.mean()) if way.printed and answers.outcomes else 1.0
    return -round(answered, 2), duration if isinstance(duration, float) else np.inf


def _inner_answers(way: SearchWay, graphs: PartGraphs, stride: int) -> TransitionSummary:
    """Return the answers inside a clip: from frames of it to some others, each by itself."""
    kept = np.flatnonzero(graphs.kept)
    targets = kept[np.linspace(0, len(kept) - 1, min(INNER_TARGETS, len(kept))).astype(int)]
    ask = partial(part_outcome, [TransitionPlanner(graphs, None, way.search)])
    frames = np.arange(len(graphs.library))
    return TransitionSummary(
        tuple(
            ask(request, frames == target)
            for request in kept[::stride].tolist()
            for target in targets.tolist()
            if request != target
        )
    )


def _curves(
    found: Measurement, whole: Comparison, split: SplitComparison | None, name: str, stride: int
) -> None:
    """Find connectivity and cost against the threshold."""
    thresholds = found.critical["SMG"] * CURVE_FACTORS
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
    found.connectivity[name] = thresholds, np.array(shares)
    found.cost[name] = np.array(joined), np.array(costs)
