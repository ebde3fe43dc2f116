"""Motion graphs of recorded people: `python -m tests.bench.motion_graphs [--choices 8]`.

Needs the CMU recordings in `shared/data/cmu-mocap`; without them it says so and ends.

The first table is the speed: of an exact graph of 6,600 frames, and of one request. The second has
joint weights by cross-validation: their rank correlation with what is seen in clips that were left
out. The third checks the orderings of Fernández-Baena (2015), chapter 3.5 (M3), on many choices of
four clips: a walk, a run, a walk with long steps and a slow walk, by one actor or by several. Each
method has the least threshold that joins all four clips: the standard graph its own, the part
graphs (SP4b) one that is shared out by weight (M2.2), or one for each part. Intervals are 95 % of
the bootstrap over the choices. Times are of the processor, so that other programs do not count.

Tables 3.2 to 3.4 are those of `cubeling reproduce motion-graphs`.
"""

import argparse
import resource
import sys
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from cubeling.app.workshop.motion_graphs.recordings import fit_recording
from cubeling.app.workshop.reproduction.motion_graphs.measuring import SPLIT_PROFILES
from cubeling.app.workshop.reproduction.motion_graphs.summary import bootstrap_interval
from cubeling.characters import Character
from cubeling.characters.retargeting import load_recording
from cubeling.characters.synthesis.distances import thesis_distance
from cubeling.characters.synthesis.graphs.candidates import find_candidates
from cubeling.characters.synthesis.graphs.graph import EdgeCosts, build_graph
from cubeling.characters.synthesis.graphs.parts import PartGraphs
from cubeling.characters.synthesis.joint_weights import fit_weights
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.comparison import (
    Comparison,
    common_requests,
)
from cubeling.characters.synthesis.transitions.evaluation import graph_requests, merge_answers
from cubeling.characters.synthesis.transitions.live import Goals, PartsSource
from cubeling.characters.synthesis.transitions.progressive import SearchSettings, TransitionPlanner

CMU = Path(__file__).parents[3] / "shared" / "data" / "cmu-mocap"
FRAMES, MAX_GRAPH_S, MAX_MEMORY_MB, MAX_QUERY_MS = 6600, 10.0, 500.0, 5.0
MAX_LATE_QUERY_MS, MAX_STEP_MS = 20.0, 1e3 / 60
FRAMES_OF_PLAY = 12  # after a request: planning takes fewer than the body has parts

KINDS = {
    "walk": ("16_15", "16_16", "16_31", "16_32", "02_01"),
    "run": ("16_35", "16_36", "16_45", "16_46", "02_03"),
    "long": ("16_21", "16_22", "16_57", "16_08"),
    "slow": ("16_11", "16_12", "16_13", "16_14", "16_33", "49_01"),
}
"""Recordings of each of the four clips of the thesis: subject and take."""

CHOICES = 6
"""Transitions of each profile, of which the one that plays cheapest is taken."""

STRIDE = 8
"""Every so many frames of a clip, the other clips are asked for."""


@dataclass(frozen=True)
class Choice:
    """What came out for one choice of clips."""

    clips: tuple[str, ...]
    """The recordings."""

    values: dict[str, float]
    """The figures by name."""


@cache
def clip(name: str):
    """Return a recording on the skeleton of the bundled human."""
    human = Character.load("human")
    return fit_recording(load_recording(str(CMU / name[:2] / f"{name}.amc")), human)


def library(names: tuple[str, ...]) -> MotionLibrary:
    """Return a library of recordings."""
    human = Character.load("human")
    return MotionLibrary.of([clip(name) for name in names], human.skeleton, human.anatomy)


def evaluate(names: tuple[str, ...]) -> Choice:
    """Return the figures of a choice of clips."""
    whole = Comparison(library(names), EdgeCosts())
    split = whole.split("SP4b")
    critical = whole.standard_threshold
    standard = whole.standard(critical)
    shared, free = split.graphs(split.threshold), split.free()
    asked = common_requests(standard, shared, STRIDE)
    own_pairs, part_pairs = whole.answers(standard, asked), split.answers(shared, asked)
    own, symmetric = merge_answers(own_pairs), merge_answers(part_pairs)
    forward = merge_answers(split.answers(shared, asked, SearchSettings(symmetric=False)))
    free_asked = common_requests(standard, free, STRIDE)
    freely = merge_answers(split.answers(free, free_asked))
    free_own = merge_answers(whole.answers(standard, free_asked))
    graphs = [whole.split(profile) for profile in SPLIT_PROFILES]
    profiles = [each.graphs(each.threshold) for each in graphs]
    kept = standard.kept & np.logical_and.reduce([each.kept for each in profiles])
    best_asked = graph_requests(whole.library, kept, 2 * STRIDE)
    best_own = merge_answers(whole.answers(standard, best_asked))
    best = merge_answers(whole.part_answers(profiles, best_asked, SearchSettings(choices=CHOICES)))
    own_tbf, part_tbf = [own.duration], [symmetric.duration]
    for factor in (1.25, 1.6):
        higher, later = whole.standard(critical * factor), split.graphs(split.threshold * factor)
        again = common_requests(higher, later, STRIDE)
        own_tbf.append(merge_answers(whole.answers(higher, again)).duration)
        part_tbf.append(merge_answers(split.answers(later, again)).duration)
    gains = {
        pair: own_pairs[pair].duration - part_pairs[pair].duration
        for pair in own_pairs
        if own_pairs[pair].outcomes
    }
    worst = max(gains, key=lambda pair: own_pairs[pair].duration)
    place = sorted(gains.values(), reverse=True).index(gains[worst]) + 1
    values = {
        "st, standard": critical,
        "(a) st, parts ÷ standard, shared out": split.threshold / critical,
        "(a) sum of st of parts ÷ standard, free": sum(split.free_thresholds) / critical,
        "(b) response, standard ÷ parts, forward": own.response / max(forward.response, 0.05),
        "(b) response, standard ÷ parts, symmetric": own.response / max(symmetric.response, 0.05),
        "(b) the same, free thresholds": free_own.response / max(freely.response, 0.05),
        "median response of parts [frames]": symmetric.median_response,
        "TBF, standard [frames]": own.duration,
        "TBF, parts [frames]": symmetric.duration,
        "(c) spread of TBF over st, standard": np.ptp(own_tbf) / np.mean(own_tbf),
        "(c) spread of TBF over st, parts": np.ptp(part_tbf) / np.mean(part_tbf),
        "(c) parts ÷ standard": np.ptp(part_tbf) / max(float(np.ptp(own_tbf)), 0.05),
        "(d) cost, parts ÷ standard": symmetric.cost / own.cost,
        "(d) the same, free thresholds": freely.cost / free_own.cost,
        "(d) the same, best of all profiles": best.cost / best_own.cost,
        "(b) response of these, standard ÷ parts": best_own.response / max(best.response, 0.05),
        "(f) place of the gain of the worst pair": place,
        "answered by other arrivals": symmetric.share("arrival"),
        "answered by a wider window": symmetric.share("window"),
        "answered by the standard graph": symmetric.share("standard"),
        "not answered": symmetric.share("legs"),
    }
    return Choice(names, {name: float(value) for name, value in values.items()})


LIMITS = {
    "(a) st, parts ÷ standard, shared out": (0.0, 1.0),
    "(a) sum of st of parts ÷ standard, free": (0.0, 1.0),
    "(b) response, standard ÷ parts, forward": (1.3, np.inf),
    "(b) response, standard ÷ parts, symmetric": (2.5, np.inf),
    "(b) the same, free thresholds": (2.5, np.inf),
    "median response of parts [frames]": (0.0, 1.0),
    "(c) parts ÷ standard": (0.0, 0.5),
    "(f) place of the gain of the worst pair": (1.0, 1.0),
    "(d) cost, parts ÷ standard": (0.0, 0.6),
    "(d) the same, free thresholds": (0.0, 0.6),
    "(d) the same, best of all profiles": (0.0, 0.6),
    "(b) response of these, standard ÷ parts": (2.5, np.inf),
    "not answered": (0.0, 0.0),
}
"""The bar of M3; where an ordering does not come out, the table says so."""


def choose(choices: int, seed: int) -> list[tuple[str, ...]]:
    """Return random choices of four recordings."""
    rng = np.random.default_rng(seed)
    return [tuple(str(rng.choice(kind)) for kind in KINDS.values()) for _ in range(choices)]


def orderings(console: Console, names: list[tuple[str, ...]]) -> None:
    """Print the orderings over choices of clips."""
    found = [evaluate(each) for each in track(names, "choices of clips", console=console)]
    table = Table(title=f"orderings of M3 over {len(names)} choices of four clips")
    for heading in ("", "mean", "95 % of the mean", "least", "most", "bar", "comes out in"):
        table.add_column(heading, no_wrap=True)
    for name in found[0].values:
        values = np.array([choice.values[name] for choice in found])
        low, high = bootstrap_interval(values)
        bar = LIMITS.get(name)
        row = [name, f"{values.mean():.2f}", f"{low:.2f} … {high:.2f}"]
        row += [f"{values.min():.2f}", f"{values.max():.2f}", "", ""]
        if bar is not None:
            row[5] = f"≤ {bar[1]:g}" if bar[1] < np.inf else f"≥ {bar[0]:g}"
            row[6] = f"{np.mean((values >= bar[0]) & (values <= bar[1])):.0%} of the choices"
        table.add_row(*row)
    console.print(table)
    for choice in found:
        console.print("  " + ", ".join(choice.clips), style="dim")


def speed(console: Console, count: int) -> bool:
    """Print the speed of a large graph, and whether all requests were answered."""
    human = Character.load("human")
    names = [f"{path.parent.name}_{path.stem[3:]}" for path in sorted(CMU.glob("*/*.amc"))]
    clips = [clip(name) for name in names]
    rate = 60.0 * FRAMES / sum(each.duration * 60.0 for each in clips)
    frames = MotionLibrary.of(clips, human.skeleton, human.anatomy, rate)
    frames.positions  # noqa: B018  placed once, for all distances
    start = time.process_time()
    distance = thesis_distance(frames)
    found = find_candidates(distance, frames, 0.5, frames.phases)
    graph = build_graph(frames, distance, found, 0.5)
    graph_s = time.process_time() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    costs = EdgeCosts(per_frame=0.01, most_jumps=4)
    split = Comparison(frames, costs).split("SP4b")
    parts = split.free()
    planner = TransitionPlanner(parts, graph)
    times, steps, followed = _ask(planner, parts, count)
    table = Table(
        title=f"{len(frames)} frames of {len(names)} recordings, {len(graph.edges)} edges"
    )
    for heading in ("", "measured", "bar"):
        table.add_column(heading)
    table.add_row("exact graph", f"{graph_s:.1f} s", f"{MAX_GRAPH_S:g} s")
    table.add_row(
        "most memory of the program until then", f"{memory:.0f} MB", f"{MAX_MEMORY_MB:g} MB"
    )
    table.add_row(
        "a request of the part graphs, median",
        f"{np.median(times):.1f} ms",
        f"{MAX_QUERY_MS:g} ms",
    )
    late = float(np.percentile(times, 90))
    table.add_row("the same, 90th percentile", f"{late:.1f} ms", f"{MAX_LATE_QUERY_MS:g} ms")
    table.add_row("the same, longest", f"{max(times):.1f} ms", "")
    table.add_row(
        "most of a frame of play after it, 90th percentile, longest",
        f"{np.percentile(steps, 90):.1f}, {max(steps):.1f} ms",
        f"{MAX_STEP_MS:.1f} ms",
    )
    table.add_row("requests in which a part follows the legs", f"{followed} of {count}", "")
    console.print(table)
    return (
        graph_s <= MAX_GRAPH_S
        and memory <= MAX_MEMORY_MB
        and late <= MAX_LATE_QUERY_MS
        and max(steps) <= MAX_STEP_MS
    )


def _ask(
    planner: TransitionPlanner, parts: PartGraphs, count: int
) -> tuple[list[float], list[float], int]:
    """Return the times of requests, and of the longest frames of play they lead to [ms].

    A frame's time is all that the graph takes in it: the start of what was planned, too. Each is
    played twice, and the less of two times counts. The last is in how many of them a part follows
    the legs.
    """
    rng = np.random.default_rng(7)
    frames = parts.library
    kept = np.flatnonzero(parts.kept)
    goals = {clip: frames.clip_of == clip for clip in np.unique(frames.clip_of[kept]).tolist()}
    for each in goals.values():
        parts.graphs[0].to_go(each & parts.kept)
    planner.prepare()
    times, longest, followed = [], [], 0
    for _ in range(count):
        request, target = int(rng.choice(kept)), goals[int(rng.choice([*goals]))]
        start = time.process_time()
        planning = planner.plan_in_steps(request, target)
        while True:
            try:
                next(planning)
            except StopIteration as end:
                followed += end.value.fallback == "legs"
                break
        times.append(1e3 * (time.process_time() - start))
        plays = [_frame_times(PartsSource(planner, request), target) for _ in range(2)]
        longest.append(float(np.min(plays, axis=0).max()))
    return times, longest, followed


def _frame_times(source: PartsSource, goals: Goals) -> list[float]:
    """Return the times of the first frames after a request [ms]."""
    times = []
    for _ in range(FRAMES_OF_PLAY):
        start = time.process_time()
        source.advance(goals)
        times.append(1e3 * (time.process_time() - start))
    return times


def joint_weights(console: Console) -> None:
    """Print weights that are fitted to all clips, and to one of each kind."""
    every = tuple(name for kind in KINDS.values() for name in kind)
    table = Table(title="joint weights by cross-validation")
    for heading in ("clips", "agreement", "of the thesis", "weights"):
        table.add_column(heading)
    for names in (*(tuple(kind[n] for kind in KINDS.values()) for n in range(3)), every):
        found = fit_weights(library(names))
        weights = ", ".join(f"{part} {weight:.2f}" for part, weight in found.weights.items())
        clips = ", ".join(names) if len(names) < len(every) else f"all {len(names)}"
        table.add_row(clips, f"{found.agreement:.3f}", f"{found.default_agreement:.3f}", weights)
    console.print(table)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--choices", type=int, default=12, help="choices of four clips; 0 for none")
    parser.add_argument(
        "--requests", type=int, default=1000, help="requests of the large graph; 0 leaves it out"
    )
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    console = Console(width=130)
    if not CMU.is_dir():
        console.print(f"no recordings at {CMU}: nothing to measure")
        return
    names = choose(options.choices, options.seed)
    good = not options.requests or speed(console, options.requests)
    joint_weights(console)
    if names:
        orderings(console, names)
    sys.exit(not good)


if __name__ == "__main__":
    main()
