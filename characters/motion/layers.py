"""Layers over a motion: masked layers replace joints, additive layers add to them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.curves import Weight, value
from cubeling.characters.motion.motion import Motion, RootDelta, integrate_travel, mean_delta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import Mask, check_mask
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.skeleton.way_round import WayRound


@dataclass(frozen=True)
class _Layer:
    base: Motion
    """The lower motion; it defines the duration."""

    over: Motion
    """The motion of the layer, at the same time."""

    @property
    def duration(self) -> float:
        """Time until the base repeats or ends [s]."""
        return self.base.duration


@dataclass(frozen=True)
class MaskedLayer(_Layer):
    """A motion over another one on the joints of a mask, such as waving while walking."""

    mask: Mask | None = None
    """Share of `over` for each joint, (joints,), or None for 1."""

    weight: Weight = 1.0
    """Factor of the mask, 0…1."""

    morphs: float = 1.0
    """Factor of the weight for morphs, if `over` has any."""

    def __post_init__(self) -> None:
        check_mask("layer", self.mask)
        if isinstance(self.weight, (int, float)) and not 0.0 <= self.weight <= 1.0:
            raise CharacterError(f"layer: weight {self.weight}; give 0 to 1")

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        weight = value(self.weight, time, self.duration)
        base = self.base.sample(time)
        if weight <= 0.0:
            return base
        over = self.over.sample(time)
        return overlaid(base, over, _shares(self.mask, weight, over), weight * self.morphs)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s].

        The mask of joint 0 is the share of `over`.
        """
        if isinstance(self.weight, (int, float)):
            return self._travel(start, end, start)
        return integrate_travel(start, end, self._travel)

    def _travel(self, start: float, end: float, weight_time: float) -> RootDelta:
        share = value(self.weight, weight_time, self.duration)
        share *= 1.0 if self.mask is None else float(self.mask[0])
        if share <= 0.0:
            return self.base.travel(start, end)
        if share >= 1.0:
            return self.over.travel(start, end)
        deltas = [self.base.travel(start, end), self.over.travel(start, end)]
        return mean_delta(deltas, [1.0 - share, share])


@dataclass(frozen=True)
class AdditiveLayer(_Layer):
    """The difference of a motion from a reference, added to another motion: breathing in any pose.

    Rotations are added in the frame of each joint's parent. The root moves as the base's root.
    """

    reference: Pose | None = None
    """Pose of `over` that adds nothing; None for its first pose."""

    weight: Weight = 1.0
    """Factor of the difference; above 1 exaggerates it, below 0 inverts it."""

    mask: Mask | None = None
    """Factor of the weight for each joint, (joints,), or None for 1."""

    def __post_init__(self) -> None:
        check_mask("added layer", self.mask)
        if isinstance(self.weight, (int, float)) and not np.isfinite(self.weight):
            raise CharacterError(f"added layer: weight {self.weight}; give a finite number")

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        weight = value(self.weight, time, self.duration)
        base = self.base.sample(time)
        if weight == 0.0:
            return base
        over = self.over.sample(time)
        return add(base, over, self._reference, _shares(self.mask, weight, over), weight)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root of the base moves over the ground between two times [s]."""
        return self.base.travel(start, end)

    @cached_property
    def _reference(self) -> Pose:
        return self.over.sample(0.0) if self.reference is None else self.reference


def lay_over(
    pose: Pose,
    joints: NDArray[np.intp],
    turns: Array,
    weight: float,
    way: WayRound | None = None,
) -> Pose:
    """Return a pose with some joints, (n,), turned to the rotations `turns`, (n, 4), by a weight.

    The way is the shorter one, or goes on from the frame before by `way`; a weight a little over 1
    overshoots. `turns` need not be normalised, and are overwritten: what lays gestures over a body
    does so in every frame.
    """
    turns /= np.sqrt(np.vecdot(turns, turns))[:, None]
    if weight != 1.0:
        below = pose.rotations.take(joints, 0)
        turns = (way or WayRound()).mix(below, turns, weight)
    local = pose.rotations.copy()
    local[joints] = turns
    return pose.with_rotations(local)


def overlaid(base: Pose, over: Pose, shares: Array, morphs: float) -> Pose:
    """Return the mix of two poses with shares 0…1 of `over` for each joint, (joints,)."""
    _check_joints("layer", base, over)
    column = shares[:, None]
    scales = base.scales
    if base.scales is not None or over.scales is not None:
        scales = base.scales_or_ones + (over.scales_or_ones - base.scales_or_ones) * column
    mixed_morphs = base.morphs
    if over.morphs is not None:
        below = np.zeros_like(over.morphs) if base.morphs is None else base.morphs
        mixed_morphs = below + (over.morphs - below) * morphs
    turns = rotations.nlerp(base.rotations, over.rotations, shares)
    return Pose(
        base.translations + (over.translations - base.translations) * column,
        np.where(column > 0.0, turns, base.rotations),  # other joints keep their exact values
        scales,
        mixed_morphs,
    )


def add(base: Pose, over: Pose, reference: Pose, shares: Array, morphs: float) -> Pose:
    """Return the base plus shares (joints,) of the difference between `over` and the reference.

    Joints without a difference keep their exact values.
    """
    _check_joints("added layer", base, over)
    _check_joints("added layer", base, reference)
    column = shares[:, None]
    turns = rotations.multiply(over.rotations, rotations.conjugate(reference.rotations))
    alike = (over.rotations == reference.rotations).all(-1, keepdims=True)
    vectors = np.where(alike, 0.0, rotations.to_rotation_vector(turns)) * column
    scales = base.scales
    if over.scales is not None or reference.scales is not None:
        below = reference.scales_or_ones
        growth = over.scales_or_ones / np.where(below == 0.0, 1.0, below)
        scales = base.scales_or_ones * (1.0 + (growth - 1.0) * column)
    mixed_morphs = base.morphs
    if over.morphs is not None:
        change = over.morphs if reference.morphs is None else over.morphs - reference.morphs
        mixed_morphs = change * morphs if mixed_morphs is None else mixed_morphs + change * morphs
    return Pose(
        base.translations + (over.translations - reference.translations) * column,
        rotations.multiply(rotations.from_rotation_vector(vectors), base.rotations),
        scales,
        mixed_morphs,
    )


def _shares(mask: Mask | None, weight: float, pose: Pose) -> Array:
    joints = pose.rotations.shape[-2]
    if mask is None:
        return np.full(joints, weight)
    if len(mask) != joints:
        raise CharacterError(
            f"layer: a mask of {len(mask)} joints on a pose of {joints}; make it with mask_of"
        )
    return mask * weight


def _check_joints(what: str, a: Pose, b: Pose) -> None:
    if a.rotations.shape != b.rotations.shape:
        raise CharacterError(
            f"{what}: poses of shapes {a.rotations.shape} and {b.rotations.shape}; "
            "retarget one of the motions to the other's skeleton"
        )
