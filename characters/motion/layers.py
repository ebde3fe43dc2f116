"""Motions on top of another: over some of its joints, or added to it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from characters.errors import CharacterError
from characters.motion.curves import Weight, value
from characters.motion.motion import Motion, RootDelta
from characters.motion.travel import accumulated, mean_step
from characters.skeleton import rotations
from characters.skeleton.masks import Mask, check_mask
from characters.skeleton.pose import Array, Pose


@dataclass(frozen=True)
class MaskedLayer:
    """A motion over another one, on the joints of a mask: waving while walking."""

    base: Motion
    """What plays below; its duration is that of the whole."""

    over: Motion
    """What plays above, at the same time."""

    mask: Mask | None = None
    """How much of `over` each joint takes, (joints,), or None for all."""

    weight: Weight = 1.0
    """What the mask is multiplied with, 0…1."""

    morphs: float = 1.0
    """What the weight is multiplied with for morphs, if `over` has any."""

    def __post_init__(self) -> None:
        """Refuse weights that are none."""
        check_mask("layer", self.mask)
        _check_weight("layer", self.weight)

    @property
    def duration(self) -> float:
        """Time until the base repeats or ends [s]."""
        return self.base.duration

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

        It is the base's as far as the mask leaves out joint 0.
        """
        if isinstance(self.weight, (int, float)):
            return self._moved(start, end, start)
        return accumulated(start, end, self._moved)

    def _moved(self, start: float, end: float, moment: float) -> RootDelta:
        share = value(self.weight, moment, self.duration)
        share *= 1.0 if self.mask is None else float(self.mask[0])
        if share <= 0.0:
            return self.base.travel(start, end)
        if share >= 1.0:
            return self.over.travel(start, end)
        steps = [self.base.travel(start, end), self.over.travel(start, end)]
        return mean_step(steps, [1.0 - share, share])


@dataclass(frozen=True)
class AdditiveLayer:
    """What a motion does beyond a reference, added to another: breathing in any pose.

    Rotations are added in each joint's parent's frame. The root moves as the base's.
    """

    base: Motion
    """What plays below; its duration is that of the whole."""

    over: Motion
    """What is added, at the same time."""

    reference: Pose | None = None
    """What of `over` adds nothing; None for its first pose."""

    weight: Weight = 1.0
    """How much of it is added; beyond 1 it is exaggerated, below 0 turned round."""

    mask: Mask | None = None
    """What the weight is multiplied with for each joint, (joints,), or None for 1."""

    def __post_init__(self) -> None:
        """Refuse a mask that is none."""
        check_mask("added layer", self.mask)
        if isinstance(self.weight, (int, float)) and not np.isfinite(self.weight):
            raise CharacterError(f"added layer: weight {self.weight}; give a finite number")

    @property
    def duration(self) -> float:
        """Time until the base repeats or ends [s]."""
        return self.base.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        weight = value(self.weight, time, self.duration)
        base = self.base.sample(time)
        if weight == 0.0:
            return base
        over = self.over.sample(time)
        return added(base, over, self._reference, _shares(self.mask, weight, over), weight)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root of the base moves over the ground between two times [s]."""
        return self.base.travel(start, end)

    @cached_property
    def _reference(self) -> Pose:
        return self.over.sample(0.0) if self.reference is None else self.reference


def overlaid(base: Pose, over: Pose, shares: Array, morphs: float) -> Pose:
    """Return the base where the shares (joints,) are 0 and `over` where they are 1."""
    _check_joints("layer", base, over)
    column = shares[:, None]
    scales = base.scales
    if base.scales is not None or over.scales is not None:
        scales = _scales(base) + (_scales(over) - _scales(base)) * column
    looks = base.morphs
    if over.morphs is not None:
        below = np.zeros_like(over.morphs) if base.morphs is None else base.morphs
        looks = below + (over.morphs - below) * morphs
    turns = rotations.nlerp(base.rotations, over.rotations, shares)
    return Pose(
        base.translations + (over.translations - base.translations) * column,
        np.where(column > 0.0, turns, base.rotations),  # what is left alone stays bit for bit
        scales,
        looks,
    )


def added(base: Pose, over: Pose, reference: Pose, shares: Array, morphs: float) -> Pose:
    """Return the base with the shares (joints,) of what `over` differs by from the reference.

    Where it differs by nothing, the base comes back bit for bit.
    """
    _check_joints("added layer", base, over)
    _check_joints("added layer", base, reference)
    column = shares[:, None]
    turns = rotations.multiply(over.rotations, rotations.conjugate(reference.rotations))
    alike = (over.rotations == reference.rotations).all(-1, keepdims=True)
    vectors = np.where(alike, 0.0, rotations.to_rotation_vector(turns)) * column
    scales = base.scales
    if over.scales is not None or reference.scales is not None:
        below = _scales(reference)
        growth = _scales(over) / np.where(below == 0.0, 1.0, below)
        scales = _scales(base) * (1.0 + (growth - 1.0) * column)
    looks = base.morphs
    if over.morphs is not None:
        change = over.morphs if reference.morphs is None else over.morphs - reference.morphs
        looks = change * morphs if looks is None else looks + change * morphs
    return Pose(
        base.translations + (over.translations - reference.translations) * column,
        rotations.multiply(rotations.from_rotation_vector(vectors), base.rotations),
        scales,
        looks,
    )


def _shares(mask: Mask | None, weight: float, pose: Pose) -> Array:
    """Return the share of each joint, (joints,)."""
    joints = pose.rotations.shape[-2]
    if mask is None:
        return np.full(joints, weight)
    if len(mask) != joints:
        raise CharacterError(
            f"layer: a mask of {len(mask)} joints on a pose of {joints}; make it with mask_of"
        )
    return mask * weight


def _scales(pose: Pose) -> Array:
    return np.ones_like(pose.translations) if pose.scales is None else pose.scales


def _check_joints(what: str, a: Pose, b: Pose) -> None:
    if a.rotations.shape != b.rotations.shape:
        raise CharacterError(
            f"{what}: poses of shapes {a.rotations.shape} and {b.rotations.shape}; "
            "retarget one of the motions to the other's skeleton"
        )


def _check_weight(what: str, weight: Weight) -> None:
    if isinstance(weight, (int, float)) and not 0.0 <= weight <= 1.0:
        raise CharacterError(f"{what}: weight {weight}; give 0 to 1")
