"""From the streams of the parts to poses: put together, and smoothed around the transition.

Source: Fernández-Baena 2015, chapter 3.3 (M2.5).
"""

from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.motion.baking import placed_clip
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import gaussian_smooth, smoothstep
from cubeling.characters.synthesis.distances import thesis_distance
from cubeling.characters.synthesis.graphs.edges import Nodes
from cubeling.characters.synthesis.graphs.parts import PartGraphs
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.transition import PartStreams, Transition


@dataclass(frozen=True)
class LowPass:
    """The filter that smooths a transition."""

    sigma_frames: float = 2.0
    """Standard deviation [frames] (M2.5, [GAP])."""

    ramp_frames: int = 5
    """Frames before and after the transition over which it fades to nothing (M2.5)."""

    @property
    def context_frames(self) -> int:
        """Frames of the clips on each side that a smoothed transition depends on."""
        return self.ramp_frames + round(3 * self.sigma_frames)

    def weights(self, count: int, start: int, end: int) -> Array:
        """Return its weight at each time, (count,): 1 from start to end, 0 outside of the ramps.

        >>> LowPass().weights(14, 6, 7).tolist()
        [0.0, 0.0, 0.104, 0.352, 0.648, 0.896, 1.0, 1.0, 0.896, 0.648, 0.352, 0.104, 0.0, 0.0]
        """
        times = np.arange(count)
        outside = np.maximum(np.maximum(start - times, times - end), 0)
        share = np.clip(1.0 - outside / self.ramp_frames, 0.0, 1.0)
        return np.round(smoothstep(share), 12)


DEFAULT_LOW_PASS = LowPass()
"""The filter of M2.5."""


@dataclass(frozen=True)
class StitchedMotion:
    """A transition as it is played, with frames of the clips before and after it."""

    poses: Pose
    """(times, joints, …), the root at the origin."""

    steps: Array
    """How the root moves from each time to the next, (times, 3): x, z [m], yaw [rad]."""

    frames: Nodes
    """The frame of the legs at each time, (times,)."""

    before: int
    """Number of times before the request."""

    arrived: int
    """The first time at which all parts play the target."""

    def clip(self, rate: float, name: str = "transition") -> Clip:
        """Return it as a clip with root motion."""
        places = [RootDelta()]
        for step in self.steps[:-1].tolist():
            places.append(places[-1].then(RootDelta(*step)))
        return placed_clip(name, rate, self.poses, places)


def stitch(
    graphs: PartGraphs, transition: Transition, low_pass: LowPass | None = DEFAULT_LOW_PASS
) -> StitchedMotion:
    """Return a transition, with the frames of the clips on both sides that it depends on.

    The root follows the legs, whose timing never changes. Without a low-pass filter nothing is
    added on the sides.
    """
    before = low_pass.context_frames if low_pass else 0
    streams = PartStreams.of(transition, graphs.library, before, before)
    poses, steps = _compose(graphs, streams)
    if low_pass:
        start, end = before + transition.response, before + transition.duration
        weights = low_pass.weights(len(steps), start, end)
        poses = _smooth(poses, weights, low_pass)
        steps = steps + (gaussian_smooth(steps, low_pass.sigma_frames) - steps) * weights[:, None]
    arrived = before + transition.duration
    return StitchedMotion(poses, steps, streams.before[0], before, arrived)


def played_cost(graphs: PartGraphs, transition: Transition) -> float:
    """Return the sum of the distances of M1 from each played frame to the next, unsmoothed (M3)."""
    raw = stitch(graphs, transition, low_pass=None)
    return float(consecutive_distances(graphs.library, raw.poses, raw.frames).sum())


def consecutive_distances(library: MotionLibrary, poses: Pose, frames: Nodes) -> Array:
    """Return the distance of M1 between each pose and the next, (times − 1,).

    `frames` are those of the legs.
    """
    count = len(frames)
    played = replace(
        library,
        names=("played",),
        starts=np.array([0, count]),
        loops=np.array([False]),
        poses=poses,
        steps=library.steps[frames],
        contacts=library.contacts[frames],
    )
    times = np.arange(count - 1)
    return thesis_distance(played).pairs(times, times + 1)


def _compose(graphs: PartGraphs, streams: PartStreams) -> tuple[Pose, Array]:
    """Return the poses of all parts together, and the steps of the legs."""
    library = graphs.library
    source = library.poses
    times = streams.before.shape[1]
    joints = len(library.skeleton)
    turns, translations = np.empty((times, joints, 4)), np.empty((times, joints, 3))
    for part, before, after, between in zip(
        graphs.parts, streams.before, streams.after, streams.between, strict=True
    ):
        own = np.array(part.joints)
        rows, later = before[:, None], after[:, None]
        u = between[:, None]
        turns[:, own] = rotations.slerp(
            source.rotations[rows, own], source.rotations[later, own], u
        )
        low, high = source.translations[rows, own], source.translations[later, own]
        translations[:, own] = low + (high - low) * u[..., None]
    return Pose(translations, turns), library.steps[streams.before[0]]


def _smooth(poses: Pose, weights: Array, low_pass: LowPass) -> Pose:
    """Return poses of which a share, (times,), is low-passed: rotations and translations."""
    turns = rotations.continuous(poses.rotations)
    low = rotations.normalize(gaussian_smooth(turns, low_pass.sigma_frames))
    moved = gaussian_smooth(poses.translations, low_pass.sigma_frames)
    share = weights[:, None]
    return Pose(
        poses.translations + (moved - poses.translations) * share[..., None],
        rotations.nlerp(turns, low, share),
    )
