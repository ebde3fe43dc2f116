"""The gesture graph: which gesture may follow which, and how long the blend between them is.

Source: Fernández-Baena 2015, sections 4.4.4 and 4.5 (M7, M9).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from characters.skeleton import rotations
from characters.skeleton.pose import Array
from characters.synthesis.distances.angles import JointAngles
from characters.synthesis.gestures.library import GestureLibrary, GesturePhrase
from characters.synthesis.graphs.components import largest_component
from characters.synthesis.library import MotionLibrary

JOINT_WEIGHTS = dict.fromkeys(
    (
        *("spine", "chest", "upperChest", "neck", "leftUpperArm", "leftLowerArm"),
        *("rightUpperArm", "rightLowerArm"),
    ),
    1.0,
)
"""Weight of each body part in the distance of postures (M7); what is between spine and chest
counts as a spine."""

VELOCITY_INFLUENCE = 0.01
"""How much squared velocities [rad²/s²] count beside squared half angles [rad²]."""

BRANCHING_SHARE = 0.5
"""Share of the phrases that may follow a phrase, on average, at the threshold that is chosen."""

THRESHOLDS = tuple(round(0.1 * step, 1) for step in range(1, 41))
"""Similarity thresholds of which the smallest that will do is chosen (Table 4.2)."""

BLEND_S = tuple(round(0.1 + 0.05 * step, 2) for step in range(11))
"""Lengths of a blend that are considered [s] (M9)."""

FROM_REST_RAD_S, TO_REST_RAD_S, LONGEST_TO_REST_S = 2.8, 2.0, 0.9
"""Weighted speed of arms that are raised from rest, and let down [rad/s]; how long that takes at
most [s]."""

NEAR_S = 0.25
"""Over how long the speed of a gesture beside a blend is taken [s]."""


@dataclass(frozen=True)
class GestureNode:
    """A node of the graph: a phrase, or its stroke alone."""

    phrase: GesturePhrase
    """The phrase."""

    number: int
    """The phrase's number in the library."""

    alone: bool
    """Whether it is the stroke alone."""

    @property
    def frames(self) -> tuple[int, int]:
        """First and last frame that it plays."""
        return self.phrase.stroke if self.alone else (self.phrase.bounds[0], self.phrase.bounds[5])


@dataclass(frozen=True)
class Connectivity:
    """How well a graph is connected at one threshold: a row of Table 4.2."""

    threshold: float
    """Similarity threshold st."""

    branching: float
    """Edges per node: the branching factor BF."""

    component: int
    """Nodes of the largest strongly connected component."""

    component_branching: float
    """Edges per node in that component."""


@dataclass(frozen=True, eq=False)
class GestureGraph:
    """Gestures, and rest, and what may follow each; the last node is rest."""

    library: GestureLibrary
    """The gestures."""

    threshold: float
    """Below which distance gestures are joined."""

    nodes: tuple[GestureNode, ...]
    """All but rest: the phrases that are kept, then their strokes alone."""

    costs: Array
    """Smoothness cost of each edge, (nodes + 1, nodes + 1): distance ÷ threshold, 0 for what
    follows in its recording, infinite without an edge; between a gesture and rest at most 1."""

    blends: Array
    """Length of the blend of each edge, (nodes + 1, nodes + 1) [s]; 0 in a recording."""

    @staticmethod
    def of(
        library: GestureLibrary,
        threshold: float | None = None,
        weights: Mapping[str, float] = JOINT_WEIGHTS,
        strokes_alone: bool = True,
    ) -> "GestureGraph":
        """Return the graph of a library.

        Parameters
        ----------
        threshold
            Similarity threshold; None takes the smallest of `THRESHOLDS` that keeps every phrase
            and has branches enough.
        weights
            Weight of each body part in the distance.
        strokes_alone
            Whether strokes alone are gestures, too (M9).
        """
        phrases = _phrases(library)
        alone = [GestureNode(each.phrase, each.number, True) for each in phrases]
        nodes = [*phrases, *alone] if strokes_alone else phrases
        measured = _Measured.of(library, nodes, weights)
        count = len(phrases)
        distances, following = measured.distances[:count, :count], _following(library)
        if threshold is None:
            rows = (connectivity(distances, following, each) for each in THRESHOLDS)
            threshold = next(
                (
                    row.threshold
                    for row in rows
                    if row.component == count and row.branching >= BRANCHING_SHARE * count
                ),
                THRESHOLDS[-1],
            )
        joined = (distances < threshold) | following
        inside = largest_component([np.flatnonzero(row).tolist() for row in joined])
        kept = np.flatnonzero(inside[[node.number for node in nodes]])
        all_and_rest = np.append(kept, len(nodes))
        between = np.ix_(all_and_rest, all_and_rest)
        costs = measured.distances[between] / threshold
        costs[costs >= 1.0] = np.inf
        blends = measured.blends()[between]
        natural = np.zeros_like(costs, bool)
        own = int(inside.sum())
        natural[:own, :own] = following[np.ix_(inside, inside)]
        costs[natural] = blends[natural] = 0.0
        for edges in (costs[-1, :], costs[:, -1]):  # from rest, and to it
            np.minimum(edges, 1.0, out=edges)
        return GestureGraph(library, threshold, tuple(nodes[n] for n in kept), costs, blends)

    @property
    def rest(self) -> int:
        """Number of the node of rest."""
        return len(self.nodes)

    @cached_property
    def strengths(self) -> Array:
        """GSI of each node but rest, (nodes,)."""
        return np.array([node.phrase.strength for node in self.nodes])

    @property
    def branching(self) -> float:
        """Edges per node, rest and strokes alone with them."""
        return float(np.isfinite(self.costs).sum() / len(self.costs))


def connectivity(distances: Array, following: NDArray[np.bool_], threshold: float) -> Connectivity:
    """Return how well phrases (n, n) are connected at a threshold; rest is left out."""
    edges = (distances < threshold) | following
    inside = largest_component([np.flatnonzero(row).tolist() for row in edges])
    size = int(inside.sum())
    within = float(edges[np.ix_(inside, inside)].sum())
    return Connectivity(threshold, float(edges.sum()) / len(edges), size, within / size)


def sweep(
    library: GestureLibrary,
    thresholds: Sequence[float] = THRESHOLDS,
    weights: Mapping[str, float] = JOINT_WEIGHTS,
) -> list[Connectivity]:
    """Return how well the phrases of a library are connected at thresholds: Table 4.2."""
    distances = _Measured.of(library, _phrases(library), weights).distances[:-1, :-1]
    return [connectivity(distances, _following(library), each) for each in thresholds]


def joint_weights(library: GestureLibrary, weights: Mapping[str, float]) -> dict[int, float]:
    """Return the weight of each joint that counts.

    A joint between spine and chest that has no name of its own counts as the chest.
    """
    own = library.anatomy.joints
    found = {own[part]: weight for part, weight in weights.items() if part in own}
    if "chest" in own:
        below = set(library.skeleton.with_ancestors([own["chest"]])) - set(own.values())
        found |= dict.fromkeys(sorted(below), found.get(own["chest"], 0.0))
    return {joint: weight for joint, weight in found.items() if joint in library.joints and weight}


@dataclass(frozen=True, eq=False)
class _Measured:
    """How far nodes are apart; the last one is rest."""

    distances: Array
    """From the last frame of a node to the first of another, (nodes + 1, nodes + 1): posture and
    velocity, eq. 2.1 and 2.2 without places (M7)."""

    angles: Array
    """The weighted angle between these frames, (nodes + 1, nodes + 1) [rad]."""

    speeds: Array
    """Weighted speed of the joints at the end and the start of a node, (2, nodes + 1) [rad/s]."""

    @staticmethod
    def of(
        library: GestureLibrary, nodes: Sequence[GestureNode], weights: Mapping[str, float]
    ) -> "_Measured":
        clips = [_turns(library, node) for node in nodes]
        clips.append(np.repeat(library.rest[None], 2, axis=0))
        starts = np.concatenate([[0], np.cumsum([len(clip) for clip in clips])])
        motions = MotionLibrary(
            library.skeleton,
            library.anatomy,
            library.rate,
            tuple(map(str, range(len(clips)))),
            starts,
            np.zeros(len(clips), bool),
            library.poses(np.concatenate(clips)),
            np.zeros((starts[-1], 3)),
            np.zeros((starts[-1], 0), bool),
        )
        joints = joint_weights(library, weights)
        ends = starts[1:] - 1, starts[:-1]
        distances, halves = (
            JointAngles(motions, joints, velocity, height=0.0).block(*ends).astype(float)
            for velocity in (VELOCITY_INFLUENCE, 0.0)
        )
        columns = [library.joints.index(joint) for joint in joints]
        near = round(NEAR_S * library.rate) + 1
        shares = np.array([*joints.values()])
        speeds = [
            [_speed(part[:, columns], shares, library.rate) for part in (clip[-near:], clip[:near])]
            for clip in clips
        ]
        return _Measured(distances, 2.0 * np.sqrt(np.maximum(halves, 0.0)), np.array(speeds).T)

    def blends(self) -> Array:
        """Return the length of the blend of each pair, (nodes + 1, nodes + 1) [s].

        It is the one at which the joints are about as fast in the blend as beside it. Beside rest
        they are as fast as people raise and let down their arms.
        """
        ends, starts = self.speeds
        beside = np.maximum((ends[:, None] + starts[None]) / 2.0, 1e-6)
        low, step = BLEND_S[0], BLEND_S[1] - BLEND_S[0]
        nearest = np.clip(np.rint((self.angles / beside - low) / step), 0, len(BLEND_S) - 1)
        lengths: Array = np.array(BLEND_S)[nearest.astype(int)]
        lengths[-1, :] = np.clip(self.angles[-1, :] / FROM_REST_RAD_S, low, LONGEST_TO_REST_S)
        lengths[:, -1] = np.clip(self.angles[:, -1] / TO_REST_RAD_S, low, LONGEST_TO_REST_S)
        return lengths


def _phrases(library: GestureLibrary) -> list[GestureNode]:
    return [GestureNode(each, number, False) for number, each in enumerate(library.phrases)]


def _following(library: GestureLibrary) -> NDArray[np.bool_]:
    """Return which phrase follows which in a recording, (phrases, phrases): E1."""
    return np.diag(np.array(library.consecutive[1:], bool), 1)


def _turns(library: GestureLibrary, node: GestureNode) -> Array:
    """Return the rotations of a node, (frames, joints, 4)."""
    first, last = node.frames
    return library.recordings[node.phrase.recording].turns[first : last + 1]


def _speed(turns: Array, weights: Array, rate: float) -> float:
    """Return the mean weighted speed of joints (frames, joints, 4) [rad/s]."""
    between = rotations.multiply(rotations.conjugate(turns[:-1]), turns[1:])
    spins = rotations.to_rotation_vector(between) * rate
    squared = np.einsum("fji,fji,j->f", spins, spins, weights)
    return float(np.sqrt(squared).mean()) if len(squared) else 0.0
