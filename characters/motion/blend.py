"""Mixing motions that are in step: blends, and spaces of parameters to take them from."""

import itertools
import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from characters.errors import CharacterError
from characters.motion.motion import Motion, RootDelta
from characters.motion.phase import Cyclic, UnphasedMotion, as_cyclic, unit
from characters.motion.travel import mean_step
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_PARTS = 2  # a cycle: long ways are taken in parts that turn by less than half a circle


def mix(poses: Sequence[Pose], weights: Sequence[float]) -> Pose:
    """Return the weighted mean of poses; the weights sum to one.

    Quaternions are brought to the side of the heaviest pose, so that the order of the poses does
    not matter, and their sum is normalised.
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
        ones = np.ones_like(poses[0].translations)
        scales = _sum([ones if p.scales is None else p.scales for p in poses], share)
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
    total: Array = np.tensordot(share, np.stack(arrays), 1)
    return total


class FootPlanter(Protocol):
    """Keeps the feet of mixed poses where those of the members are: `characters.ik.legs.LegIK`."""

    def plant(self, mixed: Pose, poses: Sequence[Pose], weights: Sequence[float]) -> Pose:
        """Return the mixed pose with its feet at the weighted mean of the members' feet."""
        ...


@dataclass(frozen=True)
class Blend:
    """Motions mixed in step; `Cyclic`, so blends can be blended.

    All members go through their cycles together. The shared pace is the weighted mean of theirs.
    A motion without a phase starts its cycle at its start; one without an end, such as a state
    machine, or a single pose has no say in the pace and plays by the clock.
    """

    members: tuple[Motion, ...]
    """What is mixed."""

    weights: tuple[float, ...]
    """How much of each; none negative, sum one: see `shares`."""

    legs: FootPlanter | None = None
    """Whose feet are kept where the members' feet are, or None to mix joints alone."""

    def __post_init__(self) -> None:
        """Refuse weights that do not share out one."""
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
        if self._endless:
            return math.inf
        heard = [(w, m.duration) for m, w in self._heard if 0.0 < m.duration < math.inf]
        if not heard:
            return 0.0
        return sum(w for w, _ in heard) / sum(w / duration for w, duration in heard)

    def at(self, phase: float) -> Pose:
        """Return the mixed pose at a phase; of an endless blend, after so many seconds."""
        poses = [member.at(phase * self._rate(member)) for member, _ in self._heard]
        weights = [weight for _, weight in self._heard]
        mixed = mix(poses, weights)
        if self.legs is None or len(poses) == 1:
            return mixed
        return self.legs.plant(mixed, poses, weights)

    def between(self, start: float, end: float) -> RootDelta:
        """Return the mean of the members' ways over the ground between two phases."""
        weights = [weight for _, weight in self._heard]
        total = RootDelta()
        parts = max(math.ceil((end - start) * _PARTS), 1)
        for part in range(parts):
            low, high = (start + (end - start) * p / parts for p in (part, part + 1))
            steps = [
                member.between(low * self._rate(member), high * self._rate(member))
                for member, _ in self._heard
            ]
            total = total.then(mean_step(steps, weights))
        return total

    def sample(self, time: float) -> Pose:
        """Return the mixed pose at a time [s] since phase 0."""
        return self.at(time / self._cycle)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        cycle = self._cycle
        return self.between(start / cycle, end / cycle)

    @property
    def _cycle(self) -> float:
        """What a unit of phase lasts [s]: one second, if nothing in it has a cycle."""
        return unit(self.duration)

    def _rate(self, member: Cyclic) -> float:
        """Return how far a member's own phase goes in a unit of phase."""
        return self._cycle if isinstance(member, UnphasedMotion) else 1.0

    @cached_property
    def _endless(self) -> bool:
        return all(isinstance(member, UnphasedMotion) for member, _ in self._heard)

    @cached_property
    def _heard(self) -> list[tuple[Cyclic, float]]:
        """What sounds, with blends inside this one taken apart."""
        heard: list[tuple[Cyclic, float]] = []
        for member, weight in zip(self.members, self.weights, strict=True):
            if weight <= 0:
                continue
            if isinstance(member, Blend):
                heard += [(inner, weight * share) for inner, share in member._heard]
            else:
                heard.append((as_cyclic(member), weight))
        return heard


def shares(weights: Sequence[float]) -> tuple[float, ...]:
    """Return weights divided by their sum.

    >>> shares([1.0, 3.0])
    (0.25, 0.75)

    Raises
    ------
    CharacterError
        If one is negative or no number, or all are nought.
    """
    total = sum(weights)
    if not all(weight >= 0.0 for weight in weights) or not 0.0 < total < math.inf:
        raise CharacterError(f"weights {tuple(weights)}; give none below 0, and one above it")
    return tuple(weight / total for weight in weights)


@dataclass(frozen=True)
class TimeScaled:
    """A cyclic motion at another pace and with another length of step; `Cyclic`."""

    motion: Cyclic
    """What is played."""

    rate: float = 1.0
    """How much faster; positive."""

    stride: float = 1.0
    """What the way over the ground is multiplied with; its turning is not."""

    @property
    def duration(self) -> float:
        """Length of one cycle [s]."""
        return self.motion.duration / self.rate

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.motion.at(phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        step = self.motion.between(start, end)
        return RootDelta(step.x * self.stride, step.z * self.stride, step.yaw)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] since phase 0."""
        return self.at(time * self.rate / unit(self.motion.duration))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        cycle = unit(self.motion.duration) / self.rate
        return self.between(start / cycle, end / cycle)


@dataclass(frozen=True)
class BlendSpace1D:
    """Motions at points of a line; between two points both are mixed, at most two sound."""

    knots: tuple[float, ...]
    """Where each motion stands, ascending."""

    motions: tuple[Motion, ...]
    """One for each knot."""

    def __post_init__(self) -> None:
        """Refuse knots that do not ascend."""
        ascending = all(a < b for a, b in itertools.pairwise(self.knots))
        if not self.knots or len(self.knots) != len(self.motions) or not ascending:
            raise CharacterError(
                f"blend space: {len(self.motions)} motions at {self.knots}; "
                "give one knot for each, in ascending order"
            )

    def weights(self, value: float) -> tuple[float, ...]:
        """Return how much of each motion sounds at a value; beyond the ends, the end.

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
    section 6.3. Each motion's influence falls along the line to each other motion; it keeps the
    least of them. Weights are continuous everywhere and do not depend on the order.
    """

    points: Array
    """Where each motion stands, (motions, 2); no two alike."""

    motions: tuple[Motion, ...]
    """One for each point."""

    def __post_init__(self) -> None:
        """Refuse points that cannot be told apart."""
        count = len(self.motions)
        if not np.isfinite(self.points).all():
            raise CharacterError(f"blend space: points {self.points.tolist()}; give finite numbers")
        if self.points.shape != (count, 2) or count != len(np.unique(self.points, axis=0)):
            raise CharacterError(
                f"blend space: {count} motions at points of shape {self.points.shape}; "
                "give each a place of its own in the plane"
            )

    def weights(self, point: ArrayLike) -> tuple[float, ...]:
        """Return how much of each motion sounds at a point (2,).

        >>> corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        >>> BlendSpace2D(corners, (None,) * 3).weights([0.5, 0.0])
        (0.5, 0.5, 0.0)
        """
        if not np.isfinite(point).all() or np.shape(point) != (2,):
            raise CharacterError(
                f"blend space: a point of {np.asarray(point).tolist()}; give two finite numbers"
            )
        towards = self.points[None] - self.points[:, None]  # from each to each other
        squared = np.einsum("ijk,ijk->ij", towards, towards)
        here = np.asarray(point, float) - self.points
        along = np.einsum("ik,ijk->ij", here, towards) / np.where(squared > 0, squared, 1.0)
        influence = np.clip(1.0 - along, 0.0, 1.0).min(axis=1)
        return tuple((influence / influence.sum()).tolist())

    def at(self, point: ArrayLike) -> Blend:
        """Return the mix at a point (2,)."""
        return Blend(self.motions, self.weights(point))
