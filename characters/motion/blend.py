"""Blends of motions at one phase, and blend spaces that give the weights for a parameter."""

import itertools
import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.motion import Motion, RootDelta, mean_delta
from cubeling.characters.motion.phase import Cyclic, PhaseDriven, as_cyclic, cycle_length
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_PARTS_PER_CYCLE = 2  # so that no part turns by half a circle or more


def mix(poses: Sequence[Pose], weights: Sequence[float]) -> Pose:
    """Return the weighted mean of poses; the weights sum to one.

    Quaternion signs are aligned with the pose of the largest weight, so the order of the poses does
    not matter; the weighted sum is normalised.
    """
    if len(poses) == 1:
        return poses[0]
    share = np.asarray(weights, float)
    if any(pose.rotations.shape != poses[0].rotations.shape for pose in poses):
        shapes = ", ".join(str(pose.rotations.shape) for pose in poses)
        raise CharacterError(f"mix: poses of shapes {shapes}; retarget them to one skeleton")
    turns = np.stack([pose.rotations for pose in poses])
    turns = rotations.align(turns, turns[int(share.argmax())])
    scales = None
    if any(pose.scales is not None for pose in poses):
        scales = _sum([pose.scales_or_ones for pose in poses], share)
    morphs = None
    if any(pose.morphs is not None for pose in poses):
        width = max(0 if pose.morphs is None else pose.morphs.shape[-1] for pose in poses)
        none = np.zeros(width)
        morphs = _sum([none if p.morphs is None else p.morphs for p in poses], share)
    return Pose(
        _sum([pose.translations for pose in poses], share),
        rotations.normalize(np.tensordot(share, turns, 1)),
        scales,
        morphs,
    )


def _sum(arrays: Sequence[Array], share: Array) -> Array:
    return np.tensordot(share, np.stack(arrays), 1)


@dataclass(frozen=True)
class Blend(PhaseDriven):
    """Motions mixed at one phase; `Cyclic`, so blends can be blended.

    All members go through their cycles together; the common speed is the weighted mean of their
    speeds. A motion without footfalls has phase 0 at its start. A motion without an end, such as a
    state machine, and a single pose do not influence the speed and play in real time.
    """

    members: tuple[Motion, ...]
    """The motions that are mixed, one for each weight."""

    weights: tuple[float, ...]
    """Weight of each; none negative, sum one: see `shares`."""

    def __post_init__(self) -> None:
        least, total = min(self.weights, default=math.nan), sum(self.weights)
        # Written so that NaN is refused as well.
        if len(self.weights) == len(self.members) and least >= 0.0 and abs(total - 1.0) < 1e-6:
            return
        raise CharacterError(
            f"blend: {len(self.members)} motions with weights {self.weights}; give one for each, "
            "none negative, sum one (`shares` makes them so)"
        )

    @property
    def duration(self) -> float:
        """Length of one cycle [s]."""
        durations = [(weight, member.duration) for member, weight in self._active]
        if all(math.isinf(duration) for _, duration in durations):
            return math.inf
        cycles = [(w, duration) for w, duration in durations if 0.0 < duration < math.inf]
        if not cycles:
            return 0.0
        return sum(w for w, _ in cycles) / sum(w / duration for w, duration in cycles)

    def at(self, phase: float) -> Pose:
        """Return the mixed pose at a phase, or at a time [s] if no member has an end."""
        poses = [
            member.at(phase * rate)
            for (member, _), rate in zip(self._active, self._rates, strict=True)
        ]
        return mix(poses, [weight for _, weight in self._active])

    def between(self, start: float, end: float) -> RootDelta:
        """Return the mean of the members' root deltas between two phases."""
        weights = [weight for _, weight in self._active]
        total = RootDelta()
        parts = max(math.ceil((end - start) * _PARTS_PER_CYCLE), 1)
        for part in range(parts):
            low, high = (start + (end - start) * p / parts for p in (part, part + 1))
            deltas = [
                member.between(low * rate, high * rate)
                for (member, _), rate in zip(self._active, self._rates, strict=True)
            ]
            total = total.then(mean_delta(deltas, weights))
        return total

    @cached_property
    def _rates(self) -> list[float]:
        """Change of each member's phase per unit of phase; without an end, its phase is time."""
        cycle = cycle_length(self.duration)
        return [cycle if math.isinf(member.duration) else 1.0 for member, _ in self._active]

    @cached_property
    def _active(self) -> list[tuple[Cyclic, float]]:
        """Members of positive weight, with nested blends replaced by their members."""
        active: list[tuple[Cyclic, float]] = []
        for member, weight in zip(self.members, self.weights, strict=True):
            if weight <= 0:
                continue
            if isinstance(member, Blend):
                active += [(inner, weight * share) for inner, share in member._active]
            else:
                active.append((as_cyclic(member), weight))
        return active


def shares(weights: Sequence[float]) -> tuple[float, ...]:
    """Return weights divided by their sum.

    >>> shares([1.0, 3.0])
    (0.25, 0.75)

    Raises
    ------
    CharacterError
        If a weight is negative or NaN, or all are zero.
    """
    total = sum(weights)
    if not all(weight >= 0.0 for weight in weights) or not 0.0 < total < math.inf:
        raise CharacterError(f"weights {tuple(weights)}; give none below 0, and one above it")
    return tuple(weight / total for weight in weights)


@dataclass(frozen=True)
class TimeScaled:
    """A cyclic motion at another speed and with another stride length; `Cyclic`."""

    motion: Cyclic

    rate: float = 1.0
    """Factor of the speed; positive."""

    stride: float = 1.0
    """Factor of the distance over the ground, but not of the turning."""

    @property
    def duration(self) -> float:
        """Length of one cycle [s]."""
        return self.motion.duration / self.rate

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.motion.at(phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        return self.motion.between(start, end).scale(self.stride)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] since phase 0."""
        return self.at(time * self.rate / cycle_length(self.motion.duration))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        cycle = cycle_length(self.motion.duration) / self.rate
        return self.between(start / cycle, end / cycle)


@dataclass(frozen=True)
class BlendSpace1D:
    """Motions at points of a line; between two points their motions are mixed."""

    knots: tuple[float, ...]
    """Position of each motion, ascending."""

    motions: tuple[Motion, ...]
    """One for each knot."""

    def __post_init__(self) -> None:
        ascending = all(a < b for a, b in itertools.pairwise(self.knots))
        if not self.knots or len(self.knots) != len(self.motions) or not ascending:
            raise CharacterError(
                f"blend space: {len(self.motions)} motions at {self.knots}; "
                "give one knot for each, in ascending order"
            )

    def weights(self, value: float) -> tuple[float, ...]:
        """Return the weight of each motion at a value; beyond the ends, the end motion has 1.

        >>> BlendSpace1D((0.0, 1.0, 3.0), (None,) * 3).weights(2.5)
        (0.0, 0.25, 0.75)
        """
        if not math.isfinite(value):
            raise CharacterError(f"blend space: a value of {value}; give a finite number")
        shares = [0.0] * len(self.knots)
        after = bisect_right(self.knots, value)
        if after == 0 or after == len(self.knots):
            shares[min(after, len(self.knots) - 1)] = 1.0
        else:
            low, high = self.knots[after - 1], self.knots[after]
            shares[after] = (value - low) / (high - low)
            shares[after - 1] = 1.0 - shares[after]
        return tuple(shares)

    def at(self, value: float) -> Blend:
        """Return the mix at a value."""
        return Blend(self.motions, self.weights(value))


@dataclass(frozen=True)
class BlendSpace2D:
    """Motions at points of a plane, mixed by gradient bands.

    Source: Johansen, "Automated semi-procedural animation for character locomotion", 2009,
    section 6.3. The influence of a motion decreases linearly towards each other motion; the
    smallest of these values counts. Weights are continuous and do not depend on the order.
    """

    points: Array
    """Position of each motion, (motions, 2); all different."""

    motions: tuple[Motion, ...]
    """One for each point."""

    def __post_init__(self) -> None:
        count = len(self.motions)
        if not np.isfinite(self.points).all():
            raise CharacterError(f"blend space: points {self.points.tolist()}; give finite numbers")
        if self.points.shape != (count, 2) or count != len(np.unique(self.points, axis=0)):
            raise CharacterError(
                f"blend space: {count} motions at points of shape {self.points.shape}; "
                "give each motion a different point"
            )

    def weights(self, point: ArrayLike) -> tuple[float, ...]:
        """Return the weight of each motion at a point (2,).

        >>> corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        >>> BlendSpace2D(corners, (None,) * 3).weights([0.5, 0.0])
        (0.5, 0.5, 0.0)
        """
        if not np.isfinite(point).all() or np.shape(point) != (2,):
            raise CharacterError(
                f"blend space: a point of {np.asarray(point).tolist()}; give two finite numbers"
            )
        towards = self.points[None] - self.points[:, None]  # from each point to each other
        squared = np.einsum("ijk,ijk->ij", towards, towards)
        here = np.asarray(point, float) - self.points
        along = np.einsum("ik,ijk->ij", here, towards) / np.where(squared > 0, squared, 1.0)
        influence = np.clip(1.0 - along, 0.0, 1.0).min(axis=1)
        return tuple((influence / influence.sum()).tolist())

    def at(self, point: ArrayLike) -> Blend:
        """Return the mix at a point (2,)."""
        return Blend(self.motions, self.weights(point))
