"""Nodes of the gesture graph, how far apart they are, and how long blends between them take.

Source: Fernández-Baena 2015, sections 4.4.4 and 4.5 (M7, M9).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.distances.angles import JointAngles
from cubeling.characters.synthesis.gestures.library import GestureLibrary, GesturePhrase
from cubeling.characters.synthesis.library import MotionLibrary

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

    number: int
    """The phrase's number in the library."""

    alone: bool
    """Whether it is the stroke alone."""

    @property
    def frames(self) -> tuple[int, int]:
        """First and last frame that it plays."""
        return self.phrase.stroke if self.alone else (self.phrase.bounds[0], self.phrase.bounds[5])


def phrase_nodes(library: GestureLibrary) -> list[GestureNode]:
    """Return the nodes of the phrases of a library."""
    return [GestureNode(each, number, False) for number, each in enumerate(library.phrases)]


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
class NodeMeasures:
    """How far nodes are apart, and how fast their ends are; the last one is rest."""

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
    ) -> "NodeMeasures":
        """Measure nodes of a library, and rest."""
        clips = [_turns(library, node) for node in nodes]
        clips.append(np.repeat(library.rest[None], 2, axis=0))
        ends = np.concatenate([clip[[0, 1, -2, -1]] for clip in clips])  # with their velocities
        starts = np.arange(0, len(ends) + 1, 4)
        motions = MotionLibrary(
            library.skeleton,
            library.anatomy,
            library.rate,
            tuple(map(str, range(len(clips)))),
            starts,
            np.zeros(len(clips), bool),
            library.poses(ends),
            np.zeros((len(ends), 3)),
            np.zeros((len(ends), 0), bool),
        )
        joints = joint_weights(library, weights)
        pairs = starts[1:] - 1, starts[:-1]
        distances, halves = (
            JointAngles(motions, joints, velocity, height=0.0).block(*pairs).astype(float)
            for velocity in (VELOCITY_INFLUENCE, 0.0)
        )
        columns = [library.joints.index(joint) for joint in joints]
        near = round(NEAR_S * library.rate) + 1
        shares = np.array([*joints.values()])
        speeds = [
            [_speed(part[:, columns], shares, library.rate) for part in (clip[-near:], clip[:near])]
            for clip in clips
        ]
        return NodeMeasures(distances, 2.0 * np.sqrt(np.maximum(halves, 0.0)), np.array(speeds).T)

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
