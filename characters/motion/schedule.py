"""Schedules: actions on a time line that share the joints by weight, mask and fade curve.

After the blending engine MIRAnim (Egges, "Real-time animation of interactive virtual humans", 2006,
section 4.2).
"""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.curves import Weight, ease, value
from cubeling.characters.motion.motion import Motion, RootDelta, integrate_travel, mean_delta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import Mask, check_mask
from cubeling.characters.skeleton.pose import Array, Pose


@dataclass(frozen=True)
class Action:
    """A motion in a schedule."""

    motion: Motion
    """The motion; its time 0 is `start`."""

    start: float = 0.0
    """Its start [s]."""

    weight: Weight = 1.0
    """Its weight relative to the other actions; not negative."""

    mask: Mask | None = None
    """Factor of the weight for each joint, (joints,), or None for 1."""

    scale: Weight = 1.0
    """Factor of its distance from the rest pose: 0 is the rest pose, 2 exaggerates."""

    scales: Array | None = None
    """Factor of the scale for each joint, (joints,), or None for 1."""

    morphs: float = 1.0
    """Factor of the weight for morphs, if the motion has any."""

    always: bool = False
    """Whether it also plays before its start and after its end, as loops do."""

    name: str = ""
    """Name by which it can be cut or removed."""

    until: float = math.inf
    """When it stops [s], if earlier than its end."""

    release: float = 0.0
    """Length of the fade before `until` [s]."""

    def __post_init__(self) -> None:
        what = f"action {self.name!r}"
        check_mask(what, self.mask)
        for weight in (self.weight, self.morphs):
            if isinstance(weight, (int, float)) and not 0.0 <= weight < math.inf:
                raise CharacterError(f"{what}: weight {weight}; give 0 or more")
        if not math.isfinite(self.start) or math.isnan(self.until) or not self.release >= 0.0:
            raise CharacterError(
                f"{what}: from {self.start} s until {self.until} s, released in {self.release} s; "
                "give numbers"
            )

    @property
    def end(self) -> float:
        """When it ends or stops [s]."""
        return min(self.start + self.motion.duration, self.until)

    def weight_at(self, time: float) -> float:
        """Return its weight at a time [s] of the schedule; 0 while it does not play."""
        own, duration = time - self.start, self.motion.duration
        if time >= self.until or not (self.always or 0.0 <= own <= duration):
            return 0.0
        weight = value(self.weight, own, duration)
        if self.release > 0.0:
            weight *= ease((self.until - time) / self.release, "gonio")
        return max(weight, 0.0)

    def scale_at(self, time: float) -> float:
        """Return its scale at a time [s] of the schedule."""
        return value(self.scale, time - self.start, self.motion.duration)


@dataclass(frozen=True)
class _Contribution:
    """A pose and its weights."""

    pose: Pose
    weights: Array
    """Of its joints, (joints,)."""

    morph_weight: float
    """Weight of its morphs, which fade apart from the joints."""


@dataclass(frozen=True)
class Schedule:
    """Actions, mixed joint by joint; a `Motion`. Their order does not matter.

    It is immutable: `with_action`, `without` and `cut` return a new schedule on the same time line.
    """

    actions: tuple[Action, ...]
    """In any order; where they overlap, their layers and weights decide."""

    rest: Pose
    """The skeleton's rest pose: shown by joints without actions, and reference of scales."""

    def __post_init__(self) -> None:
        names = Counter(action.name for action in self.actions if action.name)
        for name, count in names.items():
            if count > 1:
                raise CharacterError(f"schedule: two actions are named {name!r}; rename one")

    @property
    def duration(self) -> float:
        """End of the last action [s]; actions that play always may continue."""
        return max((action.end for action in self.actions), default=0.0)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        contributions = self._contributions(time)
        return replace(_mix(contributions), morphs=_mixed_morphs(contributions))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return integrate_travel(start, end, self._travel)

    def with_action(self, action: Action) -> "Schedule":
        """Return the schedule with another action."""
        return Schedule((*self.actions, action), self.rest)

    def without(self, name: str) -> "Schedule":
        """Return the schedule without an action, which disappears at once; see also `cut`."""
        gone = self._action(name)
        return Schedule(tuple(a for a in self.actions if a is not gone), self.rest)

    def cut(self, name: str, time: float, fade: float = 0.25) -> "Schedule":
        """Return the schedule in which an action fades out from a time on [s], over `fade` [s]."""
        old = self._action(name)
        until = min(old.until, time + fade)
        new = replace(old, until=until, release=fade if until < old.until else old.release)
        return Schedule(tuple(new if a is old else a for a in self.actions), self.rest)

    def _action(self, name: str) -> Action:
        for action in self.actions:
            if name and action.name == name:
                return action
        names = ", ".join(repr(a.name) for a in self.actions if a.name) or "none with a name"
        raise CharacterError(f"schedule: no action {name!r}; there are {names}")

    def _contributions(self, time: float) -> list[_Contribution]:
        """Return what is active, with weights that sum to one for each joint."""
        active = [part for action in self.actions for part in self._active(action, time)]
        joints = self.rest.rotations.shape[-2]
        total = sum((part.weights for part in active), np.zeros(joints))
        morphs = sum(part.morph_weight for part in active if part.pose.morphs is not None)
        unmoved = total <= 0.0
        divisor = np.where(unmoved, 1.0, total)
        shared = [
            _Contribution(
                part.pose, part.weights / divisor, part.morph_weight / morphs if morphs > 0 else 0.0
            )
            for part in active
        ]
        if unmoved.any():
            rest = replace(self.rest, morphs=None)
            shared.append(_Contribution(rest, unmoved.astype(float), 0.0))
        return shared

    def _active(self, action: Action, time: float) -> Iterator[_Contribution]:
        """Yield the contributions of an action; those of a nested schedule one by one."""
        weight = action.weight_at(time)
        if weight <= 0.0:
            return
        own, joints = time - action.start, self.rest.rotations.shape[-2]
        mask = np.ones(joints) if action.mask is None else action.mask
        if isinstance(action.motion, Schedule):
            inner = action.motion._contributions(own)
        else:
            inner = [_Contribution(action.motion.sample(own), np.ones(joints), 1.0)]
        scale = action.scale_at(time)
        for part in inner:
            if not part.pose.rotations.shape[-2] == joints == len(mask):
                raise CharacterError(
                    f"action {action.name!r}: a mask of {len(mask)} and a pose of "
                    f"{part.pose.rotations.shape[-2]} joints in a schedule of {joints}; "
                    "retarget the motion"
                )
            pose = _scale(part.pose, self.rest, scale, action.scales)
            weights = part.weights * (weight * mask)
            yield _Contribution(pose, weights, part.morph_weight * weight * action.morphs)

    def _travel(self, start: float, end: float, weight_time: float) -> RootDelta:
        """Return the mean of the root deltas of the actions that move joint 0."""
        active: list[tuple[Action, float]] = []
        for action in self.actions:
            mask = 1.0 if action.mask is None else action.mask[0]
            weight = action.weight_at(weight_time) * mask
            if weight > 0.0:
                active.append((action, float(weight)))
        total = sum(weight for _, weight in active)
        scales = [
            action.scale_at(weight_time) * (1.0 if action.scales is None else action.scales[0])
            for action, _ in active
        ]
        return mean_delta(
            [
                action.motion.travel(start - action.start, end - action.start)
                for action, _ in active
            ],
            [weight / total * scale for (_, weight), scale in zip(active, scales, strict=True)],
        )


class LiveSchedule:
    """A schedule that changes while it plays; a `Motion`.

    A change applies from now on; earlier times show the changed schedule. Not thread-safe, like
    everything in this room.
    """

    def __init__(self, schedule: Schedule) -> None:
        self.schedule = schedule

    @property
    def duration(self) -> float:
        """Infinite, because actions may be added."""
        return math.inf

    def add(self, action: Action) -> None:
        """Add an action; its start may be in the past."""
        self.schedule = self.schedule.with_action(action)

    def remove(self, name: str) -> None:
        """Remove an action at once."""
        self.schedule = self.schedule.without(name)

    def cut(self, name: str, time: float, fade: float = 0.25) -> None:
        """Fade out an action from a time on [s], over `fade` [s]."""
        self.schedule = self.schedule.cut(name, time, fade)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.schedule.sample(time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.schedule.travel(start, end)


def _mix(contributions: list[_Contribution]) -> Pose:
    """Return the weighted mean of poses, whose weights sum to one for each joint; no morphs."""
    share = np.stack([part.weights for part in contributions])
    turns = np.stack([part.pose.rotations for part in contributions])
    reference = turns[share.argmax(0), np.arange(share.shape[1])]
    if len(contributions) > 2:
        # The principal eigenvector, unlike one of several equal maxima, does not depend on the
        # order (Markley et al., "Averaging quaternions", 2007).
        squares = np.einsum("kj,kja,kjb->jab", share, turns, turns)
        reference = rotations.align(np.linalg.eigh(squares)[1][..., -1], reference)
    turns = rotations.align(turns, reference)
    scales = None
    if any(part.pose.scales is not None for part in contributions):
        all_scales = np.stack([part.pose.scales_or_ones for part in contributions])
        scales = np.einsum("kj,kjc->jc", share, all_scales)
    translations = np.stack([part.pose.translations for part in contributions])
    return Pose(
        np.einsum("kj,kjc->jc", share, translations),
        rotations.normalize(np.einsum("kj,kjc->jc", share, turns)),
        scales,
    )


def _mixed_morphs(contributions: list[_Contribution]) -> Array | None:
    """Return the weighted mean of the morphs of the poses that have any."""
    weighted = [
        part.pose.morphs * part.morph_weight
        for part in contributions
        if part.pose.morphs is not None
    ]
    if not weighted:
        return None
    total: Array = np.sum(weighted, axis=0)
    return total


def _scale(pose: Pose, rest: Pose, scale: float, scales: Array | None) -> Pose:
    if scale == 1.0 and scales is None:
        return pose
    factor = (np.ones(rest.rotations.shape[-2]) if scales is None else scales)[:, None] * scale
    away = rotations.multiply(pose.rotations, rotations.conjugate(rest.rotations))
    turns = rotations.from_rotation_vector(rotations.to_rotation_vector(away) * factor)
    own, sized = rest.scales_or_ones, None
    if pose.scales is not None:
        sized = own + (pose.scales - own) * factor
    return Pose(
        rest.translations + (pose.translations - rest.translations) * factor,
        rotations.multiply(turns, rest.rotations),
        sized,
        None if pose.morphs is None else pose.morphs * scale,
    )
