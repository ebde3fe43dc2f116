"""Transitions of a body whose parts leave and arrive at slightly different times.

Source: Fernández-Baena 2015, chapters 3.3 and 3.4 (M2.4, M2.5, M3 eq. 3.3).
"""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.graphs.edges import Nodes
from cubeling.characters.synthesis.library import Frames, MotionLibrary


@dataclass(frozen=True)
class PartMove:
    """How one part gets from the current clip to the target. Times count frames of the output."""

    departure: int
    """When it leaves: the last frame of the clip, i_n."""

    arrival: int
    """When it has arrived: the first frame of the target, j_n."""

    frames: Nodes
    """The frames of its path from i_n to j_n; scaled in time to fit between both."""

    cost: float
    """Cost of the path (eq. 3.2)."""

    @property
    def length(self) -> int:
        """Number of edges of its path, l_n."""
        return len(self.frames) - 1

    @property
    def required(self) -> int:
        """Number of frames that it has, l'_n = l_P + (i_P − i_n) + (j_n − j_P) (M2.4)."""
        return self.arrival - self.departure

    @property
    def scaling(self) -> float:
        """Factor of its time, s_n = l'_n / l_n."""
        return self.required / self.length


@dataclass(frozen=True)
class Transition:
    """A planned way of all parts from a frame to a target; time 0 is the request."""

    request: int
    """The frame at the request, f_req."""

    moves: tuple[PartMove, ...]
    """The move of each part, the prior one first."""

    fallback: str = ""
    """How far the search went: "", "arrival", "window", "standard" or "legs"."""

    @property
    def duration(self) -> int:
        """Frames from the request until the target plays with all parts: T of eq. 3.3."""
        return max(move.arrival for move in self.moves)

    @property
    def response(self) -> int:
        """Frames from the request until the first part leaves: min Ī − f_req (erratum 5)."""
        return min(move.departure for move in self.moves)

    @property
    def cost(self) -> float:
        """Sum of the costs of the parts' paths."""
        return sum(move.cost for move in self.moves)

    def target(self, library: MotionLibrary) -> int:
        """Return the frame that plays when all parts have arrived."""
        prior = self.moves[0]
        frames = np.array([prior.frames[-1]])
        return int(library.onward(frames, self.duration - prior.arrival)[0])


@dataclass(frozen=True)
class PartStreams:
    """What each part plays at each time: a frame, the next, and the way between them."""

    before: Frames
    """(parts, times)."""

    after: Frames
    """(parts, times)."""

    between: Array
    """0…1, (parts, times)."""

    @staticmethod
    def of(
        transition: Transition, library: MotionLibrary, before: int = 0, after: int = 0
    ) -> "PartStreams":
        """Return what the parts play from the request to the arrival of the last part.

        `before` and `after` are frames of the old and of the target clip beyond these; at the ends
        of the clips their last frames stand.
        """
        times = np.arange(-before, transition.duration + 1 + after)
        origin = np.array([_along(library, transition.request, int(time)) for time in times])
        prior = transition.moves[0]
        landing = int(prior.frames[-1])
        target = np.array([_along(library, landing, int(time) - prior.arrival) for time in times])
        rows = []
        for move in transition.moves:
            along = np.clip((times - move.departure) / move.scaling, 0.0, move.length)
            first = np.minimum(along.astype(int), move.length - 1)
            left, right = move.frames[first], move.frames[first + 1]
            u = along - first
            early, late = times <= move.departure, times >= move.arrival
            for here, stream in ((early, origin), (late, target)):
                left, right = np.where(here, stream, left), np.where(here, stream, right)
            rows.append((left, right, np.where(early | late, 0.0, u)))
        left, right, u = (np.array(each) for each in zip(*rows, strict=True))
        return PartStreams(left, right, u)


def _along(library: MotionLibrary, frame: int, count: int) -> int:
    """Return the frame a number of frames on, or back, in its clip; at an end, the last there."""
    neighbours = library.successors if count > 0 else library.predecessors
    for _ in range(abs(count)):
        if neighbours[frame] < 0:
            break
        frame = int(neighbours[frame])
    return frame
