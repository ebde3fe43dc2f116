"""Actions that start when they are due and share the joints by their weights.

The blending engine MIRAnim (Egges, "Real-time animation of interactive virtual humans", 2006,
section 4.2). For each joint the mean is taken of all that plays, by weight, mask and fade curve;
a schedule is a motion, so schedules nest, and give the same as if all were in one.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from characters.errors import CharacterError
from characters.motion.curves import Weight, ease, value
from characters.motion.motion import Motion, RootDelta, integrate_travel, mean_delta
from characters.skeleton import rotations
from characters.skeleton.masks import Mask, check_mask
from characters.skeleton.pose import Array, Pose


@dataclass(frozen=True)
class Action:
    """A motion in a schedule."""

    motion: Motion
    """What is played; its time 0 is `start`."""

    start: float = 0.0
    """When it starts [s]."""

    weight: Weight = 1.0
    """How much it counts beside the others; none negative, and only the ratio matters."""

    mask: Mask | None = None
    """What the weight is multiplied with for each joint, (joints,), or None for 1."""

    scale: Weight = 1.0
    """How far it goes from the rest pose: 0 is that, 2 twice as far as the motion."""

    scales: Array | None = None
    """What the scale is multiplied with for each joint, (joints,), or None for 1."""

    morphs: float = 1.0
    """What the weight is multiplied with for morphs, if the motion has any."""

    always: bool = False
    """Whether it plays before its start and after its end, too, as loops do."""

    name: str = ""
    """What to call it when it shall be cut or removed."""

    until: float = math.inf
    """When it is cut off [s]."""

    release: float = 0.0
    """How long it fades before that [s]."""

    def __post_init__(self) -> None:
        """Refuse what cannot be mixed."""
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
        """When its motion has ended or it is cut off [s]."""
        return min(self.start + self.motion.duration, self.until)

    def loudness(self, time: float) -> float:
        """Return its weight at a time [s] of the schedule, 0 where it does not play."""
        own, duration = time - self.start, self.motion.duration
        if time >= self.until or not (self.always or 0.0 <= own <= duration):
            return 0.0
        weight = value(self.weight, own, duration)
        if self.release > 0.0:
            weight *= ease((self.until - time) / self.release, "gonio")
        return max(weight, 0.0)

    def size(self, time: float) -> float:
        """Return its scale at a time [s] of the schedule."""
        return value(self.scale, time - self.start, self.motion.duration)


@dataclass(frozen=True)
class _Voice:
    """A pose, and how much of it."""

    pose: Pose
    weights: Array
    """(joints,)."""

    looks: float
    """Of its morphs."""


@dataclass(frozen=True)
class Schedule:
    """Actions, mixed joint by joint; a `Motion`. Their order does not matter.

    It does not change: `adding`, `without` and `cut` return another one on the same time line.
    """

    actions: tuple[Action, ...]
    """What plays, each from its own start on."""

    rest: Pose
    """What joints show that no action moves, and what scales refer to: the skeleton's rest."""

    def __post_init__(self) -> None:
        """Refuse names that stand for two actions."""
        names = [action.name for action in self.actions if action.name]
        for name in names:
            if names.count(name) > 1:
                raise CharacterError(f"schedule: two actions are called {name!r}; rename one")

    @property
    def duration(self) -> float:
        """When the last action ends [s]; what plays always may go on."""
        return max((action.end for action in self.actions), default=0.0)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        voices = self._voices(time)
        return replace(_mixed(voices), morphs=_morphs(voices))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return integrate_travel(start, end, self._moved)

    def adding(self, action: Action) -> "Schedule":
        """Return the schedule with one action more."""
        return Schedule((*self.actions, action), self.rest)

    def without(self, name: str) -> "Schedule":
        """Return the schedule without an action, at once; `cut` lets it fade."""
        gone = self._named(name)
        return Schedule(tuple(a for a in self.actions if a is not gone), self.rest)

    def cut(self, name: str, time: float, fade: float = 0.25) -> "Schedule":
        """Return the schedule in which an action fades from a time on [s], over `fade` [s]."""
        old = self._named(name)
        until = min(old.until, time + fade)
        new = replace(old, until=until, release=fade if until < old.until else old.release)
        return Schedule(tuple(new if a is old else a for a in self.actions), self.rest)

    def _named(self, name: str) -> Action:
        for action in self.actions:
            if name and action.name == name:
                return action
        names = ", ".join(repr(a.name) for a in self.actions if a.name) or "none with a name"
        raise CharacterError(f"schedule: no action {name!r}; there are {names}")

    def _voices(self, time: float) -> list[_Voice]:
        """Return what sounds, its weights divided by their sum, joint by joint."""
        voices = [voice for action in self.actions for voice in self._heard(action, time)]
        joints = self.rest.rotations.shape[-2]
        total = sum((voice.weights for voice in voices), np.zeros(joints))
        looks = sum(v.looks for v in voices if v.pose.morphs is not None)
        silent = total <= 0.0
        whole = np.where(silent, 1.0, total)
        shared = [
            _Voice(v.pose, v.weights / whole, v.looks / looks if looks > 0 else 0.0) for v in voices
        ]
        if silent.any():
            shared.append(_Voice(replace(self.rest, morphs=None), silent.astype(float), 0.0))
        return shared

    def _heard(self, action: Action, time: float) -> Iterator[_Voice]:
        """Yield the voices of an action; those of a schedule one by one, as if they stood here."""
        loudness = action.loudness(time)
        if loudness <= 0.0:
            return
        own, joints = time - action.start, self.rest.rotations.shape[-2]
        mask = np.ones(joints) if action.mask is None else action.mask
        if isinstance(action.motion, Schedule):
            inner = action.motion._voices(own)
        else:
            inner = [_Voice(action.motion.sample(own), np.ones(joints), 1.0)]
        size = action.size(time)
        for voice in inner:
            if not voice.pose.rotations.shape[-2] == joints == len(mask):
                raise CharacterError(
                    f"action {action.name!r}: a mask of {len(mask)} and a pose of "
                    f"{voice.pose.rotations.shape[-2]} joints in a schedule of {joints}; "
                    "retarget the motion"
                )
            pose = _scaled(voice.pose, self.rest, size, action.scales)
            weights = voice.weights * (loudness * mask)
            yield _Voice(pose, weights, voice.looks * loudness * action.morphs)

    def _moved(self, start: float, end: float, moment: float) -> RootDelta:
        """Return the mean of the ways of what moves the root."""
        roots: list[tuple[Action, float]] = []
        for action in self.actions:
            share = action.loudness(moment) * (1.0 if action.mask is None else action.mask[0])
            if share > 0.0:
                roots.append((action, float(share)))
        total = sum(share for _, share in roots)
        sizes = [a.size(moment) * (1.0 if a.scales is None else a.scales[0]) for a, _ in roots]
        return mean_delta(
            [action.motion.travel(start - action.start, end - action.start) for action, _ in roots],
            [share / total * size for (_, share), size in zip(roots, sizes, strict=True)],
        )


class LiveSchedule:
    """A schedule that changes while it plays; a `Motion`.

    Changes count from when they are made on; what was shown before is forgotten. It is for one
    thread, like everything in this room: whoever has several hands the changes over.
    """

    def __init__(self, schedule: Schedule) -> None:
        self.schedule = schedule

    @property
    def duration(self) -> float:
        """It plays for ever, as more may come."""
        return math.inf

    def add(self, action: Action) -> None:
        """Add an action; its start may lie in the past."""
        self.schedule = self.schedule.adding(action)

    def remove(self, name: str) -> None:
        """Remove an action at once."""
        self.schedule = self.schedule.without(name)

    def cut(self, name: str, time: float, fade: float = 0.25) -> None:
        """Let an action fade from a time on [s], over `fade` [s]."""
        self.schedule = self.schedule.cut(name, time, fade)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.schedule.sample(time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.schedule.travel(start, end)


def _mixed(voices: list[_Voice]) -> Pose:
    """Return the mean of poses with weights for each joint, which sum to one; without morphs."""
    share = np.stack([voice.weights for voice in voices])
    turns = np.stack([voice.pose.rotations for voice in voices])
    heaviest = turns[share.argmax(0), np.arange(share.shape[1])]
    if len(voices) > 2:
        # The signs that agree best do not depend on the order, as those next to one of several
        # equals would (Markley et al., "Averaging quaternions", 2007).
        squares = np.einsum("kj,kja,kjb->jab", share, turns, turns)
        heaviest = rotations.align(np.linalg.eigh(squares)[1][..., -1], heaviest)
    turns = rotations.align(turns, heaviest)
    scales = None
    if any(voice.pose.scales is not None for voice in voices):
        scales = np.einsum("kj,kjc->jc", share, np.stack([v.pose.scales_or_ones for v in voices]))
    shifts = np.stack([voice.pose.translations for voice in voices])
    return Pose(
        np.einsum("kj,kjc->jc", share, shifts),
        rotations.normalize(np.einsum("kj,kjc->jc", share, turns)),
        scales,
    )


def _morphs(voices: list[_Voice]) -> Array | None:
    """Return the mean of the morphs of those that have any."""
    looks = [(v.pose.morphs, v.looks) for v in voices if v.pose.morphs is not None]
    if not looks:
        return None
    total: Array = np.sum([morphs * share for morphs, share in looks], axis=0)
    return total


def _scaled(pose: Pose, rest: Pose, size: float, sizes: Array | None) -> Pose:
    """Return the pose so many times as far from the rest pose."""
    if size == 1.0 and sizes is None:
        return pose
    factor = (np.ones(rest.rotations.shape[-2]) if sizes is None else sizes)[:, None] * size
    away = rotations.multiply(pose.rotations, rotations.conjugate(rest.rotations))
    turns = rotations.from_rotation_vector(rotations.to_rotation_vector(away) * factor)
    return Pose(
        rest.translations + (pose.translations - rest.translations) * factor,
        rotations.multiply(turns, rest.rotations),
        None
        if pose.scales is None
        else rest.scales_or_ones + (pose.scales - rest.scales_or_ones) * factor,
        None if pose.morphs is None else pose.morphs * size,
    )
