"""How fast and how smoothly graphs answer requests.

Source: Fernández-Baena 2015, chapters 3.4 and 3.5 (M3), with its errata.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import compress, pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.synthesis.graphs.graph import MotionGraph
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.progressive import TransitionPlanner, cheapest_plan
from cubeling.characters.synthesis.transitions.stitching import consecutive_distances, played_cost
from cubeling.characters.synthesis.transitions.transition import Transition

Goals = NDArray[np.bool_]
"""Which frames meet a request, (frames,)."""


@dataclass(frozen=True)
class TransitionOutcome:
    """The answer to one request."""

    duration: int
    """Frames from the request until the target plays: T of eq. 3.3."""

    response: int
    """Frames until the first part leaves its clip (erratum 5)."""

    cost: float
    """Sum of the distances of consecutive full-body frames until the target plays."""

    fallback: str = ""
    """How far the search went; see `transition.Transition`."""

    @property
    def answered(self) -> bool:
        """Whether the parts have found ways of their own in the usual window."""
        return self.fallback in ("", "arrival")


NO_ANSWER = TransitionOutcome(0, 0, 0.0, "none")
"""What a request without an answer comes to."""


def standard_outcome(graph: MotionGraph, request: int, goals: Goals) -> TransitionOutcome:
    """Return how the graph of the whole body answers a request."""
    path = np.array(graph.path(request, goals))
    library = graph.library
    cost = consecutive_distances(library, library.poses[path], path).sum()
    return TransitionOutcome(len(path) - 1, _departure(library, path.tolist()), float(cost))


def shortest_standard_outcome(graph: MotionGraph, request: int, goals: Goals) -> TransitionOutcome:
    """Return the shortest duration and the least response of the ways to each goal.

    This is the inner part of eq. 3.4, min_L T(k, L), and the same of the response: the ways are the
    cheapest ones to each frame of the target. It has no cost.
    """
    ways = [graph.to_frame(goal) for goal in np.flatnonzero(goals & graph.kept).tolist()]
    lengths = [int(way.lengths[request]) for way in ways]
    responses = [_departure(graph.library, way.path(request)) for way in ways]
    return TransitionOutcome(min(lengths), min(responses), 0.0)


def _departure(library: MotionLibrary, path: Sequence[int]) -> int:
    """Return after how many frames a path leaves its clip."""
    jumps = (n for n, (a, b) in enumerate(pairwise(path)) if library.successors[a] != b)
    return next(jumps, len(path) - 2)


def part_outcome(
    planners: Sequence[TransitionPlanner], request: int, goals: Goals
) -> TransitionOutcome:
    """Return how the graphs of the parts answer a request, with the best of several profiles.

    The cost is that of the synchronised motion before it is smoothed.
    """
    graphs, transition = cheapest_plan(planners, request, goals)
    cost = played_cost(graphs, transition)
    return TransitionOutcome(transition.duration, transition.response, cost, transition.fallback)


def shortest_part_outcome(
    planner: TransitionPlanner, request: int, goals: Goals
) -> TransitionOutcome:
    """Return the shortest duration and the least response of the transitions to each goal.

    As `shortest_standard_outcome`; a goal that the parts cannot reach is left out.
    """
    legs, settings = planner.graphs.graphs[0], planner.settings
    goal_frames = np.flatnonzero(goals & planner.graphs.kept).tolist()
    ways = {goal: legs.to_frame(goal) for goal in goal_frames}
    arrivals = {goal: int(way.lengths[request]) for goal, way in ways.items()}
    early = settings.window if settings.symmetric else 0
    earliest = {
        goal: _departure(planner.graphs.library, way.path(request)) - early
        for goal, way in ways.items()
    }
    plan = cache(partial(planner.plan_to, request))

    def least(bounds: dict[int, int], measure: Callable[[Transition], int]) -> int | None:
        found: int | None = None
        for goal in sorted(bounds, key=bounds.__getitem__):
            if found is not None and found <= max(bounds[goal], 0):
                break  # all others are later
            transition = plan(goal)
            if transition is not None:
                value = measure(transition)
                found = value if found is None else min(found, value)
        return found

    duration = least(arrivals, lambda transition: transition.duration)
    response = least(earliest, lambda transition: transition.response)
    if duration is None or response is None:
        return NO_ANSWER
    return TransitionOutcome(duration, response, 0.0)


@dataclass(frozen=True)
class TransitionSummary:
    """The answers to many requests."""

    outcomes: tuple[TransitionOutcome, ...]
    """One for each trial, in their order."""

    @property
    def duration(self) -> float:
        """Mean duration [frames]: the time between frames, TBF (M3)."""
        return float(np.mean([outcome.duration for outcome in self.outcomes]))

    @property
    def response(self) -> float:
        """Mean time from a request until the first part leaves [frames]."""
        return float(np.mean([outcome.response for outcome in self.outcomes]))

    @property
    def median_response(self) -> float:
        """Its median, which a few late answers do not move [frames]."""
        return float(np.median([outcome.response for outcome in self.outcomes]))

    @property
    def cost(self) -> float:
        """Mean cost of a transition."""
        return float(np.mean([outcome.cost for outcome in self.outcomes]))

    @property
    def answered(self) -> NDArray[np.bool_]:
        """Which of the requests are answered, (requests,)."""
        return np.array([outcome.answered for outcome in self.outcomes], bool)

    def where(self, keep: NDArray[np.bool_]) -> "TransitionSummary":
        """Return the answers to some of the requests, for which `keep` (requests,) is true."""
        return TransitionSummary(tuple(compress(self.outcomes, keep.tolist())))

    def share(self, fallback: str) -> float:
        """Return the share of answers that needed a fallback, 0…1."""
        return float(np.mean([outcome.fallback == fallback for outcome in self.outcomes]))


Requests: TypeAlias = dict[tuple[int, int], list[int]]
"""The frames that ask, by the numbers of their clip and of the target clip."""

Answers: TypeAlias = dict[tuple[int, int], TransitionSummary]
"""The answers to requests, by the same."""


def graph_requests(library: MotionLibrary, kept: Goals, stride: int = 1) -> Requests:
    """Return the frames from which each clip is asked for in each other clip, by their numbers.

    Every `stride`-th kept frame of a clip asks for all other clips that have kept frames.
    """
    clips = np.unique(library.clip_of[kept]).tolist()
    frames = {clip: np.flatnonzero(kept & (library.clip_of == clip))[::stride] for clip in clips}
    return {
        (origin, target): frames[origin].tolist()
        for origin in clips
        for target in clips
        if origin != target
    }


def by_pair(
    answer: Callable[[int, Goals], TransitionOutcome],
    library: MotionLibrary,
    asked: Requests,
) -> Answers:
    """Return the answers to requests, by the numbers of the clips.

    `answer` is `standard_outcome` or `part_outcome` of what answers.
    """
    return {
        (origin, target): TransitionSummary(
            tuple(answer(frame, library.clip_of == target) for frame in frames)
        )
        for (origin, target), frames in asked.items()
    }


def merge_answers(answers: Answers) -> TransitionSummary:
    """Return the answers of all pairs of clips as one."""
    return TransitionSummary(
        tuple(outcome for each in answers.values() for outcome in each.outcomes)
    )
